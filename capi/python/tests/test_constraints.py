"""Constraints: against dense solutions of the KKT system, closed forms, differences, and Pinocchio where it is installed."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import MODELS
from linkages import FEET, four_bar, go2, kkt, random_state, rod

import libdyn as dyn
from libdyn import constraint as dc


def test_quadruped_on_four_points():
    m, d = go2()
    for seed in range(1, 6):
        q, v, tau = random_state(m, seed)
        ddq, forces = d.constrained_dynamics(q, v, tau)
        assert d.constraint_result.solved and d.constraint_result.rank == 12
        expected, push = kkt(d, q, v, tau)
        np.testing.assert_allclose(ddq, expected, rtol=0, atol=1e-10 * abs(expected).max())
        np.testing.assert_allclose(d.constraint_terms(q, v).J.T @ forces, push, rtol=0, atol=1e-10 * abs(push).max())


def test_fields_and_switches():
    m, d = go2()
    q, v, tau = random_state(m, 3)
    all_feet = d.constrained_dynamics(q, v, tau)
    assert np.array_equal(d.constrained_ddq, all_feet.ddq) and np.array_equal(d.field("lambda")[:12], all_feet.forces)
    d.set_constraint_enabled(1, False)
    with pytest.raises(dyn.StaleError):
        d.constrained_ddq
    assert d.constraint_rows() == slice(0, 9) and d.constraint_rows(2) == slice(3, 6) and d.constraint_rows(1) == slice(3, 3)
    three = d.constrained_dynamics()
    assert abs(three.ddq - all_feet.ddq).max() > 1e-3 and len(three.forces) == 9
    for slot in range(4):
        d.set_constraint(slot, None)
    np.testing.assert_allclose(d.constrained_dynamics().ddq, d.aba(q, v, tau), rtol=1e-13)


def standing(robot="go2", kind="point", feet=FEET):
    m = dyn.load(MODELS / "robots" / f"{robot}.urdf", base="floating")
    d = m.data()
    for foot in feet:
        d.add_constraint(getattr(dc, kind)(foot))
    return m, d


ROBOTS = {"go2": ("point", FEET), "humanoid": ("frame", ("left_sole", "right_sole"))}


@pytest.mark.parametrize("robot", ROBOTS)
def test_pinocchio(robot):
    pin = pytest.importorskip("pinocchio")
    kind, feet = ROBOTS[robot]
    m, d = standing(robot, kind, feet)
    path = str(MODELS / "robots" / f"{robot}.urdf")
    pm = pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer())
    pd = pm.createData()
    contacts, work = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for foot in feet:
        f = pm.frames[pm.getFrameId(foot)]
        type, reference = (pin.ContactType.CONTACT_3D,
                           pin.LOCAL_WORLD_ALIGNED) if kind == "point" else (pin.ContactType.CONTACT_6D, pin.LOCAL)
        contacts.append(pin.RigidConstraintModel(type, pm, f.parentJoint, f.placement, reference))
        work.append(contacts[-1].createData())
    pin.initConstraintDynamics(pm, pd, contacts, work)
    order_q, order_v = list(range(7)), list(range(6))
    for name in list(pm.names)[2:]:
        order_q.append(m.joint(name).idx_q), order_v.append(m.joint(name).idx_v)
    for seed in range(1, 5):
        q, v, tau = random_state(m, seed)
        v = d.constraint_impulse(q, v).v  # so that references of accelerations do not differ
        expected = pin.constraintDynamics(pm, pd, q[order_q], v[order_v], tau[order_v], contacts, work,
                                          pin.ProximalSettings(1e-15, 1e-15, 50))
        ddq = d.constrained_dynamics(q, v, tau).ddq
        np.testing.assert_allclose(ddq[order_v], expected, rtol=0, atol=1e-9 * max(1, abs(expected).max()))
        pin.computeConstraintDynamicsDerivatives(pm, pd, contacts, work, pin.ProximalSettings(1e-15, 1e-15, 50))
        ours = d.constrained_dynamics_derivatives(q, v, tau)
        for mine, theirs in ((ours.ddq_dq, pd.ddq_dq), (ours.ddq_dv, pd.ddq_dv), (ours.ddq_dtau, pd.ddq_dtau)):
            np.testing.assert_allclose(mine[np.ix_(order_v, order_v)], theirs, rtol=0, atol=1e-9 * max(1, abs(theirs).max()))


@pytest.mark.parametrize("robot", ROBOTS)
def test_golden(robot):
    """Pinocchio's figures (tests/golden/constraints)."""
    golden = json.loads((Path(__file__).resolve().parents[3] / "tests/golden/constraints/figures.json").read_text())["robots"][robot]
    m, d = standing(robot, golden["kind"], golden["feet"])
    for state in golden["states"]:
        expected = {k: np.array(x) for k, x in state.items()}
        q, v, tau = expected["q"], expected["v"], expected["tau"]
        ddq, forces = d.constrained_dynamics(q, v, tau)
        got = {"ddq": ddq, "lambda": forces, "push": d.constraint_terms(q, v).J.T @ forces}
        by = d.constrained_dynamics_derivatives(q, v, tau)
        got |= {name: getattr(by, name) for name in ("ddq_dq", "ddq_dv", "ddq_dtau", "lambda_dq", "lambda_dv", "lambda_dtau")}
        for name, x in got.items():
            assert abs(x - expected[name]).max() < 1e-9 * max(1, abs(expected[name]).max()), name


def test_delassus_in_four_forms():
    for m, d in (go2(), standing("humanoid", *ROBOTS["humanoid"])):
        q, v, _ = random_state(m, 2)
        J, M = d.constraint_terms(q, v).J, d.crba(q)
        G = d.delassus(q)
        np.testing.assert_allclose(G, J @ np.linalg.solve(M, J.T), atol=1e-13 * abs(G).max())
        Y, D = d.delassus_factor()
        np.testing.assert_allclose(Y.T @ (D[:, None] * Y), G, atol=1e-13 * abs(G).max())
        x = np.random.default_rng(1).normal(size=12)
        np.testing.assert_allclose(d.delassus_times(x), G @ x, atol=1e-12 * abs(G).max())
        for mu in (0.0, 1e-3, 10.0):
            np.testing.assert_allclose((G + mu * np.eye(12)) @ d.delassus_solve(x, mu), x, atol=1e-9)
    d.set_constraint(2, dc.frame("left_sole"))
    with pytest.raises(dyn.NumericError, match="dependent"):
        d.delassus_solve(np.ones(18))
    assert np.isfinite(d.delassus_solve(np.ones(18), 1e-8)).all()


def test_humanoid_on_both_feet():
    m = dyn.load(MODELS / "mechanisms" / "humanoid_on_both_feet.urdf", base="fixed")
    d, zero = m.data(), np.zeros(m.nv)
    p = d.project(m.neutral())  # the pelvis in the ground
    assert p.result.solved and p.result.rank == 12
    np.testing.assert_allclose(p.q[:3], [0, 0, 0.88], atol=1e-9)
    report = d.constraint_report(p.q)
    assert (report.rank, report.redundant, report.contradictory) == (12, 0, 0)
    # it stands still: each sole carries half of the weight, by least forces, and symmetrical ones
    tau, forces = d.constrained_inverse_dynamics(p.q, zero, zero)
    left, right = forces.reshape(2, 6)
    np.testing.assert_allclose(left[2] + right[2], 66.7 * 9.81, rtol=1e-12)
    np.testing.assert_allclose(left * [1, -1, 1, -1, 1, -1], right, atol=1e-9)
    ddq, again = d.constrained_dynamics(p.q, zero, tau)
    np.testing.assert_allclose(ddq, 0, atol=1e-9)


def test_mimic_joints():
    m = dyn.load(MODELS / "robots" / "gripper.urdf", base="fixed")
    assert any(j.mimic_leader is not None and j.nv == 0 for j in m.joints[1:])
    d = m.data()
    links = [f.name for f in m.frames if f.type == dyn.FrameType.BODY][-2:]
    d.add_constraint(dc.distance(links[0], links[1], 0.1, stiffness=10, damping=2))
    q, v, tau = random_state(m, 2)
    ddq = d.constrained_dynamics(q, v, tau).ddq
    np.testing.assert_allclose(ddq, kkt(d, q, v, tau, (10, 2))[0], atol=1e-9 * max(1, abs(ddq).max()))
    G, J = d.delassus(), d.constraint_terms(q, v).J
    np.testing.assert_allclose(G, J @ np.linalg.solve(d.crba(q), J.T), atol=1e-12 * abs(G).max())
    D = d.constrained_dynamics_derivatives(q, v, tau)
    for k in range(m.nv):
        e = np.zeros(m.nv)
        e[k] = 1e-4
        f = lambda s: d.constrained_dynamics(m.integrate(q, s * e), v, tau).ddq
        np.testing.assert_allclose((8 * (f(1) - f(-1)) - (f(2) - f(-2))) / 12e-4, D.ddq_dq[:, k],
                                   atol=1e-6 * max(1, abs(D.ddq_dq).max()))


def test_limits_and_friction_are_complementary():
    b = dyn.Builder("arm")
    parent = None
    for k in range(4):
        rod(b, f"j{k}", parent, None if k == 0 else (0.5, 0, 0), 0.5, axis=(0, 1, 0), lower=[-0.5], upper=[0.5])
        b.add_constraint(f"limit{k}", dc.limit(f"j{k}", stiffness=100,
                                               damping=20)).add_constraint(f"friction{k}", dc.friction(f"j{k}", 0.7))
        parent = f"j{k}"
    m = b.finish()
    d = m.data()
    g = np.random.default_rng(3)
    for _ in range(200):
        q = g.choice([-0.5, 0.5, -0.6, 0.7, 0.1], 4)
        v, tau = g.choice([0.0, 0.01, -1.0], 4), 5 * g.normal(size=4)
        ddq, forces = d.constrained_dynamics(q, v, tau)
        assert d.constraint_result.solved
        t = d.constraint_terms(q, v)
        np.testing.assert_allclose(d.crba(q) @ ddq + d.compute_nle(q, v) - tau, t.J.T @ forces, atol=1e-9)
        for k in range(4):
            limit, dry = forces[2 * k], forces[2 * k + 1]
            excess = ddq[k] + 100 * (q[k] - np.clip(q[k], -0.5, 0.5)) + 20 * v[k]
            if abs(q[k]) < 0.5:
                assert limit == 0
            else:
                side = -np.sign(q[k])
                assert limit * side >= 0 and excess * side > -1e-8 and abs(limit * excess) < 1e-6
            slip = ddq[k] + 100 * v[k]
            assert abs(dry) <= 0.7 + 1e-12
            assert abs(slip) < 1e-7 or (abs(abs(dry) - 0.7) < 1e-9 and dry * slip < 0)


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_impulses(restitution):
    m, d = go2()
    for slot, foot in enumerate(FEET):
        d.set_constraint(slot, dc.point(foot, restitution=restitution))
    for seed in range(1, 5):
        q, v, _ = random_state(m, seed)
        after, impulses = d.constraint_impulse(q, v)
        t, M = d.constraint_terms(q, v), d.crba(q)
        np.testing.assert_allclose(t.J @ after, -restitution * t.J @ v, atol=1e-11)
        np.testing.assert_allclose(M @ (after - v), t.J.T @ impulses, atol=1e-10)
        assert after @ M @ after <= v @ M @ v * (1 + 1e-12)
    if restitution == 1:
        np.testing.assert_allclose(after @ M @ after, v @ M @ v, rtol=1e-12)


def test_inverse_dynamics_shares_the_load():
    """A table on four legs, its weight off centre: the least forces are W/4 (1 + x x_c / a^2 + y y_c / b^2)."""
    a, c, W = np.array([0.4, 0.3]), np.array([0.1, -0.05]), 9.81 * 5
    b = dyn.Builder("table")
    b.add_joint("free", "free_flyer").add_body("top", "free", mass=5, com=(*c, 0), inertia=np.diag([0.2, 0.3, 0.4]))
    feet = [(sx * a[0], sy * a[1]) for sx in (1, -1) for sy in (1, -1)]
    for k, (x, y) in enumerate(feet):
        b.add_frame(f"foot{k}", "free", (x, y, 0)).add_constraint(f"leg{k}", dc.point(f"foot{k}"))
    d = b.finish().data()
    q = np.array([0, 0, 0, 0, 0, 0, 1.0])
    tau, forces = d.constrained_inverse_dynamics(q, np.zeros(6), np.zeros(6))
    assert abs(tau).max() == 0 and d.constraint_result.residual < 1e-9
    for k, (x, y) in enumerate(feet):
        np.testing.assert_allclose(forces[3 * k : 3 * k + 3], [0, 0, W / 4 * (1 + x * c[0] / a[0] ** 2 + y * c[1] / a[1] ** 2)],
                                   atol=1e-6)
    m, d = go2()
    q, v, tau = random_state(m, 2)
    tau[:6] = 0
    ddq = d.constrained_dynamics(q, v, tau).ddq
    held = d.constrained_inverse_dynamics(q, v, ddq)
    np.testing.assert_allclose(d.constrained_dynamics(q, v, held.tau).ddq, ddq, atol=1e-6 * abs(ddq).max())


def test_anchor():
    m, d = go2()
    q, v, _ = random_state(m, 1)
    for slot in range(4):
        d.anchor_constraint(slot, q)
    assert abs(d.constraint_terms(q, v).C).max() < 1e-14
    d.forward_kinematics(q)
    held = d.constraint(2)
    assert held.type == dyn.constraint.ConstraintType.POINT and m.frames[held.first].name == FEET[2]
    np.testing.assert_allclose(np.array(held.placement2)[-3:], d.frame_placement(FEET[2])[1], atol=1e-14)
    assert d.constraint(4).type == dyn.constraint.ConstraintType.NONE
    moved = m.integrate(q, 0.05 * np.ones(m.nv))
    assert abs(d.constraint_terms(moved, v).C).max() > 1e-3
    p = d.project(moved)
    assert p.result.solved and abs(d.constraint_terms(p.q, v).C).max() < 1e-12


@pytest.mark.parametrize("type", [t for t in dc.ConstraintType if t.name not in ("NONE", "COUPLING", "LIMIT", "FRICTION")])
def test_every_type_between_frames(type, tmp_path):
    """Each has its function, is anchored, and comes back from a URDF."""
    assert callable(getattr(dc, type.name.lower()))
    m = dyn.load(MODELS / "robots" / "go2.urdf", base="floating", constraint_slots=1)
    d, (q, v, _) = m.data(), random_state(m, 4)
    d.set_constraint(0, dc.Constraint(type, "FL_foot", None, {}))
    d.anchor_constraint(0, q)
    C = d.constraint_terms(q, v).C
    assert 1 <= len(C) <= 6 and abs(C).max() < 1e-12
    b = dyn.Builder.from_model(m)
    held = b.add_constraint("held", dc.Constraint(type, "FL_foot", "base", {"length": 0.7})).finish()
    held.save(tmp_path / "held.urdf")
    back = dyn.load(tmp_path / "held.urdf", base="floating")
    for x in (held, back):
        assert x.data().constraint("held").type == type


def test_refusals():
    m, d = go2(constraint_slots=5)
    assert m.nconstraints == 0 and m.nconstraint_slots == 5
    d.add_constraint(dc.frame("base"))
    with pytest.raises(dyn.ArgumentError, match="slots are full"):
        d.add_constraint(dc.point("base"))
    for bad, error, words in [
        (dc.point("base", "base"), dyn.InvalidRobotError, "same body"),
        (dc.point("base", stiffness=-1), dyn.ArgumentError, "stiffness"),
        (dc.point("base", damping=np.nan), dyn.NonFiniteError, "damping"),
        (dc.distance("base", None, 0.0), dyn.ArgumentError, "length"),
        (dc.loop("fixed", "base"), dyn.ArgumentError, "WELD"),
        (dc.friction("FL_hip_joint", -1), dyn.ArgumentError, "force"),
        (dc.coupling("FL_hip_joint", "FL_hip_joint"), dyn.InvalidRobotError, "itself"),
    ]:
        before = d.constraint_terms().C.copy()
        with pytest.raises(error, match=words):
            d.set_constraint(0, bad)
        assert np.array_equal(before, d.constraint_terms().C)
    with pytest.raises(dyn.ArgumentError, match="slot 9"):
        d.set_constraint_enabled(9)
    with pytest.raises(dyn.UnknownNameError):
        dyn.Builder("x").add_constraint("c", dc.point("nobody"))
    b = dyn.Builder.from_model(m)
    b.add_constraint("c", dc.point("FL_foot"))
    with pytest.raises(dyn.UnknownNameError, match="already"):
        b.add_constraint("c", dc.point("FR_foot"))


def test_operations_on_models_keep_constraints():
    m = four_bar(crank=0.7, coupler=1.2, rocker=0.9)
    assert m.constraint_names == ["pin0"] and m.nconstraint_slots == 9
    again = dyn.Builder.from_model(m).finish()
    assert again.constraint_names == ["pin0"] and again.constraint("pin0").joint_type == dyn.JointType.REVOLUTE
    two = dyn.Builder.from_model(m).attach(m, "other_").finish()
    assert two.constraint_names == ["pin0", "other_pin0"]
    d = two.data()
    assert d.constraint_rows() == slice(0, 10)
    assert dyn.Builder.from_model(m).remove_subtree("c").finish().constraint_names == []
    assert dyn.Builder.from_model(m).lock(["a", "b", "c"], np.zeros(3)).finish().constraint_names == []
