"""What a course on rigid-body dynamics asks for, each as a few lines of dyn beside the formula written out: capi/pages/exercises.md is the list."""

import numpy as np
import pytest
from conftest import MODELS
from command import answer

import libdyn as dyn

close = np.testing.assert_allclose
ROBOTS = [("go2", "floating"), ("humanoid", "floating"), ("panda", "fixed"), ("gripper", "fixed")]
REFERENCES = ("local", "world", "local_world_aligned")


def load(name, base):
    return dyn.load(MODELS / "robots" / f"{name}.urdf", base=base)


def motion(model, seed=3):
    random = np.random.default_rng(seed)
    return (model.random(seed), *(random.standard_normal(model.nv) for _ in range(2)))


def skew(x):
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def action(R, p):
    """[linear; angular] of a motion in B's axes at B's origin, in A's axes at A's origin; B at (R, p) in A."""
    return np.block([[R, skew(p) @ R], [np.zeros((3, 3)), R]])


def cross(v):
    """v x, on motions [linear; angular]."""
    return np.block([[skew(v[3:]), skew(v[:3])], [np.zeros((3, 3)), skew(v[3:])]])


# ------------------------------------------------------------------------------------------------- spaces and sizes


@pytest.mark.parametrize("name, base", ROBOTS)
def test_sizes_add_up(name, base):
    """nq, nv, njoints, nframes of the model, of its joints, and of `dyn info`."""
    m = load(name, base)
    assert m.nq == sum(j.nq for j in m.joints) and m.nv == sum(j.nv for j in m.joints)
    assert [j.idx_v for j in m.joints[1:] if j.nv] == sorted(j.idx_v for j in m.joints[1:] if j.nv)
    said = answer("info", MODELS / "robots" / f"{name}.urdf", f"--{base}")
    assert (said["nq"], said["nv"], len(said["joints"]), len(said["frames"])) == (m.nq, m.nv, m.njoints, m.nframes)
    assert sum(j["nv"] for j in said["joints"]) == m.nv
    kinds = [f["type"] for f in said["frames"]]
    assert kinds.count("JOINT") == m.njoints - 1 and kinds.count("BODY") == m.nbodies


def test_adding_to_q_is_not_moving(go2, state):
    """q + v dt leaves the manifold; integrate does not, and difference undoes it."""
    q, v, *_ = state
    moved = go2.integrate(q, 0.1 * v)
    close(go2.difference(q, moved), 0.1 * v, atol=1e-13)
    assert go2.is_normalized(moved, 1e-14) and len(q) != len(v)


# ------------------------------------------------------------------------------------------------- spatial algebra


@pytest.mark.parametrize("frame", ["base", "FL_foot", "RR_calf"])
def test_a_twist_in_three_references(go2, state, frame):
    """act, by the formula: v_A = [R, p x R; 0, R] v_B."""
    q, v, *_ = state
    d = go2.data()
    d.forward_kinematics(q, v)
    R, p = d.frame_placement(frame)
    local = d.frame_velocity(frame, "local")
    close(d.frame_velocity(frame, "world"), action(R, p) @ local, atol=1e-13)
    close(d.frame_velocity(frame, "local_world_aligned"), action(R, np.zeros(3)) @ local, atol=1e-13)
    for reference, X in zip(REFERENCES, (np.eye(6), action(R, p), action(R, np.zeros(3)))):
        close(d.frame_jacobian(frame, reference), X @ d.frame_jacobian(frame, "local"), atol=1e-13)


def test_cross_is_the_matrix_ad(go2, state):
    """Columns of J that a joint carries turn with it: dJ_k/dt = v_parent x J_k in the world's reference, ad in the order [linear;
    angular]."""
    q, v, *_ = state
    d = go2.data()
    J, dJ = d.joint_jacobians(q), d.joint_jacobians_time_variation(q, v)
    d.forward_kinematics(q, v)
    for joint in go2.joints[2:]:
        close(dJ[:, joint.idx_v], cross(d.frame_velocity(joint.name, "world")) @ J[:, joint.idx_v], atol=1e-12)
    a, b = np.arange(6.0), np.cos(np.arange(6.0))
    by_parts = np.concatenate([np.cross(a[3:], b[:3]) + np.cross(a[:3], b[3:]), np.cross(a[3:], b[3:])])
    close(cross(a) @ b, by_parts, atol=1e-15)


# ------------------------------------------------------------------------------------------------- frames


@pytest.mark.parametrize("reference", REFERENCES)
def test_a_frame_of_ones_own(reference):
    """A tool 0.1 m before the hand: J v is its twist, whatever the reference."""
    panda = dyn.load(MODELS / "robots" / "panda.urdf", base="fixed")
    m = dyn.Builder.from_model(panda).add_frame("tool", "panda_hand", (np.eye(3), (0, 0, 0.1))).finish()
    assert m.nv == panda.nv and m.nframes == panda.nframes + 1
    d = m.data()
    for seed in range(5):
        q, v, _ = motion(m, seed)
        d.forward_kinematics(q, v)
        close(d.frame_jacobian("tool", reference) @ v, d.frame_velocity("tool", reference), atol=1e-13)
        hand, tool = d.frame_placement("panda_hand"), d.frame_placement("tool")
        close(tool.translation, hand.translation + 0.1 * hand.rotation[:, 2], atol=1e-15)


@pytest.mark.parametrize("frame", ["base", "FL_foot"])
def test_two_accelerations(go2, state, frame):
    """classical = spatial + [omega x v; 0] where the reference's origin is the frame's; and it is the second derivative of the
    position."""
    q, v, a, _ = state
    d = go2.data()
    d.forward_kinematics(q, v, a)
    for reference in ("local", "local_world_aligned"):
        twist = d.frame_velocity(frame, reference)
        sum_ = d.frame_acceleration(frame, reference) + np.r_[np.cross(twist[3:], twist[:3]), 0, 0, 0]
        close(d.frame_classical_acceleration(frame, reference), sum_, atol=1e-12)
    classical, h, path = d.frame_classical_acceleration(frame, "local_world_aligned")[:3], 1e-4, []
    for t in (-h, 0, h):
        # to second order: v is constant on the tangent space but for a
        d.forward_kinematics(go2.integrate(q, t * v + t * t / 2 * a))
        path.append(d.frame_placement(frame).translation)
    close((path[0] - 2 * path[1] + path[2]) / h**2, classical, atol=1e-6 * max(1, np.abs(classical).max()))


# ------------------------------------------------------------------------------------------------- momentum


@pytest.mark.parametrize("name, base", ROBOTS[:2])
def test_free_fall(name, base):
    """In flight only gravity changes the momentum: with a = aba(q, v, 0), and with no other a."""
    m = load(name, base)
    d, (q, v, _) = m.data(), motion(m)
    a = d.aba(q, v, np.zeros(m.nv))
    d.centroidal_momentum_time_variation(q, v, a)
    scale = 9.81 * m.total_mass
    close(d.dhg[:3], m.total_mass * m.gravity, atol=1e-12 * scale)
    close(d.dhg[3:], 0, atol=1e-10 * scale)  # about the centre of mass, which moves: not about the world's origin
    d.compute_com(q, v, a)
    close(d.acom, m.gravity, atol=1e-12 * 9.81)
    assert abs(d.centroidal_momentum_time_variation(q, v, 0 * a)[2] - -scale) > 1e-3, "another acceleration is another motion"


@pytest.mark.parametrize("name, base", ROBOTS[:2])
def test_the_base_in_the_momentum_matrix(name, base):
    """The first six columns of Ag are the whole's inertia times what takes the base's twist to the centre of mass; and rows of M
    say the same."""
    m = load(name, base)
    d, (q, v, _) = m.data(), motion(m)
    Ag = d.centroidal_map(q, v)
    com = d.compute_com(q)
    d.forward_kinematics(q)
    R, p = d.frame_placement(m.joint_name(1))
    X = action(R, p - com)  # base's axes and origin to world's axes at the centre of mass
    close(Ag[:, :6], d.Ig @ X, atol=1e-11 * m.total_mass)
    close(X.T @ Ag, d.crba(q)[:6], atol=1e-11 * m.total_mass)
    close(Ag[:3] / m.total_mass, d.jcom(q), atol=1e-12)


def test_one_rigid_body_carries_the_momentum(go2):
    """The single-rigid-body model: contact forces and gravity alone change the momentum about the centre of mass."""
    d = go2.data()
    q, v = go2.neutral(), 0.3 * np.cos(np.arange(go2.nv))
    q[2], q[7:] = 0.3, [0, 0.8, -1.6] * 4
    feet = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")
    for foot in feet:
        d.add_constraint(dyn.constraint.point(foot))
    ddq, forces = d.constrained_dynamics(q, v, np.r_[np.zeros(6), np.linspace(-3, 3, 12)])
    rate = d.centroidal_momentum_time_variation(q, v, ddq)
    com = d.compute_com(q)
    d.forward_kinematics(q)
    f = forces.reshape(-1, 3)
    moment = sum(np.cross(d.frame_placement(foot).translation - com, x) for foot, x in zip(feet, f))
    size = np.abs(f).sum()
    close(rate[:3], f.sum(axis=0) + go2.total_mass * go2.gravity, atol=1e-11 * size)
    close(rate[3:], moment, atol=1e-11 * size)


# ------------------------------------------------------------------------------------------------- what textbooks and code get
# wrong


def test_m_is_full(go2, state):
    """crba needs no completing: adding the transpose would double what is off the diagonal."""
    d, (q, v, a, _) = go2.data(), state
    M = d.crba(q)
    assert np.array_equal(M, M.T)
    close(M @ a + d.compute_nle(q, v), d.rnea(q, v, a), atol=1e-10)


def test_random_configurations_are_finite(go2):
    """A free flyer has no limits, and a sample is finite all the same."""
    for seed in range(20):
        q = go2.random(seed)
        assert np.isfinite(q).all() and go2.is_normalized(q, 1e-14)


def test_gradient_of_a_distance_apart_touching_and_overlapping():
    """By the witness points: n'(J_b p_b - J_a p_a), with the normal of the result, which does not turn round where shapes
    overlap."""
    b = dyn.Builder("balls").add_joint("slide", "prismatic", axis=(1, 0, 0)).add_body("moving", "slide", 1, inertia=np.eye(3))
    b.add_shape("universe", "sphere", 0.5, name="still").add_shape("moving", "sphere", 0.5, (np.eye(3), (0, 0.3, 0)), name="ball")
    b.add_pair("still", "ball")  # a body and its parent are no pair until they are asked to be
    d = b.finish().data()
    for x in (2.0, np.sqrt(1 - 0.09), 0.4):
        exact = np.hypot(x, 0.3) - 1
        close(d.compute_distances([x]), [exact], atol=1e-12)
        close(d.distance_gradients()[0], [x / np.hypot(x, 0.3)], atol=1e-9)


def test_planar_joints_follow_their_axis():
    """A URDF's planar joint moves in the plane normal to its axis, not always in that of x and y."""
    link = '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    urdf = f'<robot name="r">{link.format("a")}{link.format("b")}<joint name="j" type="planar"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint></robot>'
    m = dyn.load_string(urdf, base="fixed")
    d = m.data()
    for q in np.eye(3)[:2]:
        d.forward_kinematics(q)
        assert abs(d.frame_placement("b").translation[0]) < 1e-15
