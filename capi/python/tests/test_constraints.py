"""Constraints: against dense solutions of the KKT system, closed forms, differences, and Pinocchio where it is installed."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import MODELS

import dyn
from dyn import constraint as dc

FEET = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")


def go2(**options):
    m = dyn.load(MODELS / "robots" / "go2.urdf", base="floating", **options)
    d = m.data()
    for foot in FEET:
        d.add_constraint(dc.point(foot))
    return m, d


def rod(b, name, parent, placement, length, type="revolute", axis=(0, 0, 1), mass=1.0, **more):
    """A joint and a slender rod along x."""
    b.joint(name, type, parent, placement, axis=axis, **more)
    b.body(name + "_rod", name, mass=mass, com=(length / 2, 0, 0), inertia=np.diag([1e-3, mass * length**2 / 12, mass * length**2 / 12]))


def four_bar(crank=1.0, coupler=1.0, rocker=1.0, ground=1.0, kind="loop", copies=1, **more):
    """Three rods in the plane, closed at the ground by a hinge, `copies` times."""
    b = dyn.Builder("four_bar")
    rod(b, "a", None, None, crank)
    rod(b, "b", "a", (crank, 0, 0), coupler)
    rod(b, "c", "b", (coupler, 0, 0), rocker)
    b.frame("tip", "c", (rocker, 0, 0))
    for k in range(copies):
        if kind == "loop":
            c = dc.loop("revolute", "tip", None, axis=(0, 0, 1), placement2=(ground, 0, 0), **more)
        else:
            c = getattr(dc, kind)("tip", None, placement2=(ground, 0, 0), **more)
        b.constraint(f"pin{k}", c)
    return b.finish()


def closed(m, seed=1, **options):
    d = m.data()
    q = np.array([1.0, -0.9, -1.2]) + 0.1 * np.random.default_rng(seed).normal(size=3) if m.nv == 3 else m.random(seed=seed)
    v = np.random.default_rng(seed).normal(size=m.nv)
    return d, d.project(q, v, **options)


def kkt(d, q, v, tau, gains=(0, 0), redundant=False):
    """ddq and J' lambda of the dense system."""
    t = d.constraint_terms(q, v)
    M, h = d.crba(q), d.nonlinear_effects(q, v)
    b = -t.drift - gains[0] * t.C - gains[1] * t.Jv
    L = np.linalg.cholesky(M)
    A = np.linalg.solve(L, t.J.T)
    free = np.linalg.solve(M, tau - h)
    forces = np.linalg.lstsq(A.T @ A, b - t.J @ free, rcond=1e-11)[0] if redundant else np.linalg.solve(A.T @ A, b - t.J @ free)
    return free + np.linalg.solve(M, t.J.T @ forces), t.J.T @ forces


def random_state(m, seed):
    g = np.random.default_rng(seed)
    return m.random(seed=seed), g.normal(size=m.nv), g.normal(size=m.nv)


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
    d.enable_constraint(1, False)
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
        type, reference = (pin.ContactType.CONTACT_3D, pin.LOCAL_WORLD_ALIGNED) if kind == "point" else (pin.ContactType.CONTACT_6D, pin.LOCAL)
        contacts.append(pin.RigidConstraintModel(type, pm, f.parentJoint, f.placement, reference))
        work.append(contacts[-1].createData())
    pin.initConstraintDynamics(pm, pd, contacts, work)
    order_q, order_v = list(range(7)), list(range(6))
    for name in list(pm.names)[2:]:
        order_q.append(m.joint(name).idx_q), order_v.append(m.joint(name).idx_v)
    for seed in range(1, 5):
        q, v, tau = random_state(m, seed)
        v = d.constraint_impulse(q, v).v  # so that references of accelerations do not differ
        expected = pin.constraintDynamics(pm, pd, q[order_q], v[order_v], tau[order_v], contacts, work, pin.ProximalSettings(1e-15, 1e-15, 50))
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


@pytest.mark.parametrize("kind", ["loop", "connect"])
def test_duplicates_change_nothing(kind):
    lengths = dict(crank=1.0, coupler=1.3, rocker=0.8, ground=1.1)
    d, state = closed(four_bar(**lengths, kind=kind))
    assert state.result.residual < 1e-12
    tau = np.array([0.7, -0.3, 0.2])
    once = d.constrained_dynamics(state.q, state.v, tau)
    for copies in (2, 10):
        many = four_bar(**lengths, kind=kind, copies=copies).data()
        again = many.constrained_dynamics(state.q, state.v, tau)
        assert abs(again.ddq - once.ddq).max() < 1e-10 * abs(once.ddq).max()
        push = many.constraint_terms(state.q, state.v).J.T @ again.forces
        np.testing.assert_allclose(push, d.constraint_terms(state.q, state.v).J.T @ once.forces, atol=1e-10 * abs(push).max())
        assert many.constraint_result.rank == 2 and many.constraint_result.solved


def test_twelve_decades_of_regularisation():
    d, state = closed(four_bar(copies=3))
    tau = np.array([0.7, -0.3, 0.2])
    exact = kkt(d, state.q, state.v, tau, redundant=True)[0]
    for k in range(-14, -1):
        ddq, forces = d.constrained_dynamics(state.q, state.v, tau, regularisation=10.0**k, max_iterations=2000)
        assert np.isfinite(ddq).all() and np.isfinite(forces).all()
        assert abs(ddq - exact).max() < 1e-9 * abs(exact).max(), k
    assert d.constrained_dynamics(state.q, state.v, tau, regularisation=1e-2, max_iterations=1) and not d.constraint_result.solved


def test_planar_mechanism_in_space():
    """Four hinges, 3 moving bodies, 20 rows of rank 17: the loop's five rows hold two degrees of freedom of three."""
    d, state = closed(four_bar(crank=0.7, coupler=1.2, rocker=0.9))
    report = d.constraint_report(state.q)
    assert (report.rank, report.redundant, report.contradictory) == (2, 3, 0)
    assert [r.row for r in report.rows if r.verdict != dyn.RowVerdict.INDEPENDENT] == [2, 3, 4]
    assert abs(kkt(d, state.q, state.v, np.zeros(3), redundant=True)[0] - d.constrained_dynamics(state.q, state.v, np.zeros(3)).ddq).max() < 1e-9


def test_singular_pose_of_the_parallel_four_bar():
    m = four_bar(kind="connect")
    d = m.data()
    q = np.array([0.0, 0.0, np.pi])  # flat: crank and coupler along x, the rocker back on the ground
    assert abs(d.constraint_terms(q, np.zeros(3)).C).max() < 1e-15
    report = d.constraint_report(q)
    assert report.rank == 1 and {r.constraint for r in report.rows if r.verdict != dyn.RowVerdict.INDEPENDENT} == {"pin0"}
    for seed in range(20):
        tau = np.random.default_rng(seed).normal(size=3)
        ddq, forces = d.constrained_dynamics(q, np.zeros(3), tau)
        assert np.isfinite(ddq).all() and np.isfinite(forces).all() and d.constraint_result.solved
        np.testing.assert_allclose(ddq, kkt(d, q, np.zeros(3), tau, redundant=True)[0], atol=1e-9 * abs(ddq).max())


def bricard():
    """Six hinges, each across the next, of a regular orthogonal linkage: one degree of freedom, one redundant row of five."""
    b = dyn.Builder("bricard")
    parent, placement = None, None
    for k in range(5):
        b.joint(f"h{k}", "revolute", parent, placement, axis=(0, 0, 1))
        b.body(f"link{k}", f"h{k}", mass=1, com=(0.5, 0, 0), inertia=np.diag([0.01, 0.1, 0.1]))
        sign = 1 if k % 2 == 0 else -1
        parent, placement = f"h{k}", (np.array([[1.0, 0, 0], [0, 0, -sign], [0, sign, 0]]), np.array([1.0, 0, 0]))
    b.frame("end", parent, placement)
    # the sixth link is the ground: its far end is where the first hinge is
    b.constraint("sixth", dc.loop("revolute", "end", None, axis=(0, 0, 1), placement2=(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), (-1, 0, 0))))
    return b.finish()


def test_bricard():
    """A closed pose exists (a cube's edges), where the sixth hinge of a 6R loop, which would make it rigid, leaves it one motion."""
    m = bricard()
    d = m.data()
    best = None
    for seed in range(40):
        q = np.random.default_rng(seed).uniform(-2.5, 2.5, 5)
        p = d.project(q)
        if p.result.solved and (best is None or d.constraint_report(p.q).rank < best[1]):
            best = p.q, d.constraint_report(p.q).rank
    assert best is not None
    q, rank = best
    assert rank == 4, "one redundant row"
    report = d.constraint_report(q)
    assert report.redundant == 1 and report.contradictory == 0 and {r.constraint for r in report.rows if r.verdict == dyn.RowVerdict.REDUNDANT} == {"sixth"}
    v = d.project(q, np.ones(5)).v
    tau = np.arange(5.0)
    ddq = d.constrained_dynamics(q, v, tau).ddq
    np.testing.assert_allclose(ddq, kkt(d, q, v, tau, redundant=True)[0], atol=1e-8 * max(1, abs(ddq).max()))


def test_contradictions_by_name():
    """A rod of one metre between points that are 1.001 m apart."""
    b = dyn.Builder("rod")
    b.joint("free", "free_flyer")
    b.body("rod", "free", mass=1, inertia=np.diag([0.01, 0.1, 0.1]))
    b.frame("left", "free", (-0.5, 0, 0)).frame("right", "free", (0.5, 0, 0))
    b.constraint("here", dc.weld("left", placement2=(-0.5005, 0, 0))).constraint("there", dc.weld("right", placement2=(0.5005, 0, 0)))
    m = b.finish()
    d = m.data()
    q0 = np.array([0.1, 0.2, -0.1, 0.05, 0.02, -0.1, 1])
    q0[3:] /= np.linalg.norm(q0[3:])
    q, _, result = d.project(q0)
    assert result.reason == dyn.ConstraintReason.CONTRADICT
    np.testing.assert_allclose(result.residual, 5e-4, rtol=1e-6)
    np.testing.assert_allclose(q[:3], 0, atol=1e-8)
    report = d.constraint_report(q)
    assert report.rank == 6 and report.redundant == 6
    assert {r.constraint for r in report.rows if r.verdict == dyn.RowVerdict.CONTRADICTORY} == {"here", "there"}
    np.testing.assert_allclose(report.contradiction, 5e-4, rtol=1e-6)
    # accelerations that contradict each other: the least squares of them
    d.set_constraint("here", dc.weld("left", placement2=(-0.6, 0, 0), stiffness=100, damping=20))
    ddq, forces = d.constrained_dynamics(np.array([0, 0, 0, 0, 0, 0, 1.0]), np.zeros(6), np.zeros(6))
    assert d.constraint_result.reason == dyn.ConstraintReason.CONTRADICT and d.constraint_result.contradiction > 1
    np.testing.assert_allclose(ddq, [-5, 0, 0, 0, 0, 0], atol=1e-6)
    assert np.isfinite(forces).all()


def test_projection_is_near_in_either_metric():
    for weigh in (True, False):
        m = four_bar(crank=0.7, coupler=1.2, rocker=0.9)
        d, p = closed(m, weigh=weigh)
        assert p.result.solved and p.result.residual <= 1e-12
        t = d.constraint_terms(p.q, p.v)
        assert abs(t.C).max() <= 1e-12 and abs(t.Jv).max() < 1e-12
    M = d.crba(p.q)
    v = np.array([0.3, -1, 2.0])
    for weigh, W in ((True, M), (False, np.eye(3))):
        w = d.project(p.q, v, weigh=weigh).v
        J = d.constraint_terms(p.q, w).J
        move = W @ (v - w)  # in the range of J'
        assert abs(move - J.T @ np.linalg.lstsq(J.T, move, rcond=None)[0]).max() < 1e-10


LOOPS = {"revolute": 5, "prismatic": 5, "helical": 5, "cylindrical": 4, "universal": 4, "spherical": 3, "planar": 3, "translation": 3}


def arms(constraint):
    """Two arms on a moving base, with what ties their ends."""
    b = dyn.Builder("arms")
    b.joint("base", "free_flyer").body("trunk", "base", mass=3, inertia=np.diag([0.2, 0.3, 0.4]))
    g = np.random.default_rng(5)
    for side, y in (("l", 0.3), ("r", -0.3)):
        parent, at = "base", (0.1, y, 0.2)
        for k, (type, axis) in enumerate((("revolute", (0, 0, 1)), ("revolute", (0, 1, 0)), ("spherical", (0, 0, 1)), ("prismatic", (1, 0.2, 0)), ("continuous", (1, 0, 0)))):
            b.joint(f"{side}{k}", type, parent, at, axis=axis)
            b.body(f"{side}{k}_link", f"{side}{k}", mass=1, com=g.normal(size=3) * 0.1, inertia=np.diag([0.1, 0.12, 0.15]))
            parent, at = f"{side}{k}", (0.3, 0.05, -0.1)
        Q, _ = np.linalg.qr(g.normal(size=(3, 3)))
        b.frame(f"{side}_end", parent, (Q * np.linalg.det(Q), (0.2, 0.1, 0)))
    if constraint is not None:
        b.constraint("tie", constraint)
    return b.finish()


GAINS = dict(stiffness=30.0, damping=7.0)
TIES = {f"loop {k}": dc.loop(k, "l_end", "r_end", axis=(0.2, 0.3, 1), axis2=(3.0, -2.0, 0.0), pitch=0.2, **GAINS) for k in LOOPS}
TIES |= {
    "point": dc.point("l_end", **GAINS),
    "frame": dc.frame("l_end", None, placement2=(0.3, 0.2, 0.1), **GAINS),
    "connect": dc.connect("l_end", "r_end", placement1=(0.1, 0, 0), **GAINS),
    "weld": dc.weld("l_end", "r_end", **GAINS),
    "distance": dc.distance("l_end", "r_end", 0.4, **GAINS),
    "coupling": dc.coupling("l0", "r3", (0.1, 0.5, -0.3, 0.2, 0.05), **GAINS),
    "friction": dc.friction("l0", 1e-3, damping=5.0),
}


@pytest.mark.parametrize("name", TIES)
def test_rows_are_derivatives_of_each_other(name):
    """C, J v and drift along a curve q(t), by extrapolated differences."""
    m = arms(TIES[name])
    d = m.data()
    q, v, tau = random_state(m, 4)
    if name.split()[0] in ("loop", "weld", "frame"):
        d.anchor_constraint(0, q)  # rates of orientations are those of C where C = 0
        v = d.constraint_impulse(q, v).v
    if name == "friction":
        return
    t = d.constraint_terms(q, v)
    a = d.constrained_dynamics(q, v, tau).ddq
    np.testing.assert_allclose(t.J @ v, t.Jv, atol=1e-12)
    np.testing.assert_allclose(t.J @ a + t.drift + 30 * t.C + 7 * t.Jv, 0, atol=1e-9 * max(1, abs(a).max()))

    def along(h):  # a curve with this velocity and acceleration at h = 0
        return m.integrate(q, v * h + a * h * h / 2), v + a * h

    def difference(f, h=1e-3):
        D = lambda s: (f(s) - f(-s)) / (2 * s)
        return (4 * D(h / 2) - D(h)) / 3

    np.testing.assert_allclose(difference(lambda h: d.constraint_terms(*along(h)).C), t.Jv, atol=1e-7)
    # q(t) + v(t) is such a curve to first order in v only where v is a vector space; so along velocities alone
    rate = difference(lambda h: d.constraint_terms(m.integrate(q, v * h), v).Jv)
    np.testing.assert_allclose(rate, t.drift, atol=2e-6 * max(1, abs(t.drift).max()))


def differences(f, n):
    """Extrapolated central differences, a column for each direction."""
    out = []
    for k in range(n):
        e = np.zeros(n)
        e[k] = 1.0
        D = lambda h: (f(h * e) - f(-h * e)) / (2 * h)
        h = 2e-3
        out.append((64 * D(h / 4) - 20 * D(h / 2) + D(h)) / 45)
    return np.array(out).T


@pytest.mark.parametrize("name", TIES)
def test_derivatives(name):
    m = arms(TIES[name])
    d = m.data()
    q, v, tau = random_state(m, 6)
    base = d.constrained_dynamics_derivatives(q, v, tau)

    both = lambda q, v, tau: np.concatenate(d.constrained_dynamics(q, v, tau))
    expected = {
        "q": differences(lambda e: both(m.integrate(q, e), v, tau), m.nv),
        "v": differences(lambda e: both(q, v + e, tau), m.nv),
        "tau": differences(lambda e: both(q, v, tau + e), m.nv),
    }
    for by, e in expected.items():
        got = np.vstack([getattr(base, f"ddq_d{by}"), getattr(base, f"lambda_d{by}")])
        assert abs(got - e).max() < 1e-7 * max(1, abs(e).max()), by
    base = d.constraint_impulse_derivatives(q, v)
    both = lambda q, v: np.concatenate(d.constraint_impulse(q, v))
    expected = {"q": differences(lambda e: both(m.integrate(q, e), v), m.nv), "v": differences(lambda e: both(q, v + e), m.nv)}
    for by, e in expected.items():
        got = np.vstack([getattr(base, f"ddq_d{by}"), getattr(base, f"lambda_d{by}")])
        assert abs(got - e).max() < 1e-7 * max(1, abs(e).max()), f"impulse by {by}"
    # nothing of it is left in the derivatives of inverse dynamics
    a = np.ones(m.nv)
    for mine, fresh in zip(d.rnea_derivatives(q, v, a), m.data().rnea_derivatives(q, v, a)):
        assert np.array_equal(mine, fresh)


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


def test_duplicates_share_the_force():
    """Of the same foot three times each has a third of its force, to round-off: the least forces."""
    m, d = go2()
    q, v, tau = random_state(m, 3)
    once = d.constrained_dynamics(q, v, tau).forces
    for _ in range(2):
        d.add_constraint(dc.point(FEET[0]))
    forces = d.constrained_dynamics(q, v, tau).forces
    for part in (forces[:3], forces[12:15], forces[15:18]):
        np.testing.assert_allclose(part, once[:3] / 3, atol=1e-11 * abs(once).max())


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
        np.testing.assert_allclose((8 * (f(1) - f(-1)) - (f(2) - f(-2))) / 12e-4, D.ddq_dq[:, k], atol=1e-6 * max(1, abs(D.ddq_dq).max()))


def test_limits_and_friction_are_complementary():
    b = dyn.Builder("arm")
    parent = None
    for k in range(4):
        rod(b, f"j{k}", parent, None if k == 0 else (0.5, 0, 0), 0.5, axis=(0, 1, 0), lower=[-0.5], upper=[0.5])
        b.constraint(f"limit{k}", dc.limit(f"j{k}", stiffness=100, damping=20)).constraint(f"friction{k}", dc.friction(f"j{k}", 0.7))
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
        np.testing.assert_allclose(d.crba(q) @ ddq + d.nonlinear_effects(q, v) - tau, t.J.T @ forces, atol=1e-9)
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
    b.joint("free", "free_flyer").body("top", "free", mass=5, com=(*c, 0), inertia=np.diag([0.2, 0.3, 0.4]))
    feet = [(sx * a[0], sy * a[1]) for sx in (1, -1) for sy in (1, -1)]
    for k, (x, y) in enumerate(feet):
        b.frame(f"foot{k}", "free", (x, y, 0)).constraint(f"leg{k}", dc.point(f"foot{k}"))
    d = b.finish().data()
    q = np.array([0, 0, 0, 0, 0, 0, 1.0])
    tau, forces = d.constrained_inverse_dynamics(q, np.zeros(6), np.zeros(6))
    assert abs(tau).max() == 0 and d.constraint_result.residual < 1e-9
    for k, (x, y) in enumerate(feet):
        np.testing.assert_allclose(forces[3 * k : 3 * k + 3], [0, 0, W / 4 * (1 + x * c[0] / a[0] ** 2 + y * c[1] / a[1] ** 2)], atol=1e-6)
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
    held = d.get_constraint(2)
    assert held.type == dyn.constraint.ConstraintType.POINT and m.frames[held.first].name == FEET[2]
    np.testing.assert_allclose(np.array(held.placement2)[-3:], d.frame_placement(FEET[2])[1], atol=1e-14)
    assert d.get_constraint(4).type == dyn.constraint.ConstraintType.NONE
    moved = m.integrate(q, 0.05 * np.ones(m.nv))
    assert abs(d.constraint_terms(moved, v).C).max() > 1e-3
    p = d.project(moved)
    assert p.result.solved and abs(d.constraint_terms(p.q, v).C).max() < 1e-12


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
        d.enable_constraint(9)
    with pytest.raises(dyn.UnknownNameError):
        dyn.Builder("x").constraint("c", dc.point("nobody"))
    b = dyn.Builder.from_model(m)
    b.constraint("c", dc.point("FL_foot"))
    with pytest.raises(dyn.UnknownNameError, match="already"):
        b.constraint("c", dc.point("FR_foot"))


def test_operations_on_models_keep_constraints():
    m = four_bar(crank=0.7, coupler=1.2, rocker=0.9)
    assert m.constraint_names == ["pin0"] and m.nconstraint_slots == 9
    again = dyn.Builder.from_model(m).finish()
    assert again.constraint_names == ["pin0"] and again.constraint_info("pin0").joint_type == dyn.JointType.REVOLUTE
    two = dyn.Builder.from_model(m).attach(m, "other_").finish()
    assert two.constraint_names == ["pin0", "other_pin0"]
    d = two.data()
    assert d.constraint_rows() == slice(0, 10)
    assert dyn.Builder.from_model(m).remove("c").finish().constraint_names == []
    assert dyn.Builder.from_model(m).lock(["a", "b", "c"], np.zeros(3)).finish().constraint_names == []


def arm(lengths, target, **more):
    """Rods in the plane whose tip is held at a point."""
    b, parent, tip = dyn.Builder("arm"), None, None
    for k, length in enumerate(lengths):
        rod(b, f"j{k}", parent, tip, length)
        parent, tip = f"j{k}", (length, 0, 0)
    b.frame("tip", parent, tip)
    b.constraint("wall", dc.loop("revolute", "tip", None, axis=(0, 0, 1), placement2=(*target, 0), **more))
    return b.finish()


@pytest.mark.parametrize("weigh", [True, False])
def test_projection_onto_linkages_stretched_flat(weigh):
    """J loses rank at the solution: an arm that just reaches the wall, from many starts; and one that cannot quite ends stretched towards it."""
    far = 1.5 * np.array([np.cos(0.4), np.sin(0.4)])
    for lengths in ((1.0, 0.5), (0.5, 1.0), (0.6, 0.5, 0.4)):
        d = arm(lengths, far).data()
        for seed in range(10):
            p = d.project(np.random.default_rng(seed).uniform(-1, 1, len(lengths)), weigh=weigh)
            assert p.result.solved and p.result.residual <= 1e-12, (lengths, seed, p.result)
            np.testing.assert_allclose(np.exp(1j * p.q), np.exp([0.4j] + [0] * (len(lengths) - 1)), atol=1e-5)  # errors of q are roots of those of C
        d = arm(lengths, 1.01 * far).data()
        p = d.project(np.random.default_rng(1).uniform(-1, 1, len(lengths)), weigh=weigh)
        near = 1e-6 if len(lengths) == 2 else 1e-2  # of three it gets there more slowly, and says so
        assert p.result.reason == dyn.ConstraintReason.CONTRADICT or (len(lengths) == 3 and p.result.reason == dyn.ConstraintReason.ITERATIONS)
        np.testing.assert_allclose(p.result.residual, 0.015 * np.cos(0.4), rtol=near)
        np.testing.assert_allclose(np.exp(1j * p.q), np.exp([0.4j] + [0] * (len(lengths) - 1)), atol=10 * near)


@pytest.mark.parametrize("weigh", [True, False])
def test_projection_from_a_saddle(weigh):
    """Stretched flat along the line to a nearer target no small step makes the error less; beside it one does."""
    for target, q in (((0.9, 0), (0, 0)), ((0.9, 0), (np.pi, 0)), ((1.2, 0), (0, np.pi))):
        d = arm((1.0, 0.5), target).data()
        p = d.project(np.array(q, float), weigh=weigh)
        assert p.result.solved, p.result
        assert abs(d.constraint_terms(p.q, np.zeros(2)).C).max() <= 1e-12


def test_projection_of_a_parallel_four_bar_in_its_singular_pose():
    m = four_bar()
    d = m.data()
    flat = np.array([0, 0, np.pi])
    assert d.project(flat).result.solved
    for seed in range(20):
        for size in (1e-6, 1e-3, 0.1):
            p = d.project(flat + size * np.random.default_rng(seed).normal(size=3))
            assert p.result.solved and p.result.residual <= 1e-12, (seed, size, p.result)
            assert abs(p.q - flat).max() < 5 * size ** 0.5
