"""Redundant and contradictory rows: duplicates, singular poses, linkages that move against the count, and their names."""

import numpy as np
import pytest
from linkages import FEET, closed, four_bar, go2, kkt, random_state, rod

import libdyn as dyn
from libdyn import constraint as dc


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
    assert abs(kkt(d, state.q, state.v, np.zeros(3),
                   redundant=True)[0] - d.constrained_dynamics(state.q, state.v, np.zeros(3)).ddq).max() < 1e-9


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
        b.add_joint(f"h{k}", "revolute", parent, placement, axis=(0, 0, 1))
        b.add_body(f"link{k}", f"h{k}", mass=1, com=(0.5, 0, 0), inertia=np.diag([0.01, 0.1, 0.1]))
        sign = 1 if k % 2 == 0 else -1
        parent, placement = f"h{k}", (np.array([[1.0, 0, 0], [0, 0, -sign], [0, sign, 0]]), np.array([1.0, 0, 0]))
    b.add_frame("end", parent, placement)
    # the sixth link is the ground: its far end is where the first hinge is
    b.add_constraint("sixth", dc.loop("revolute", "end", None, axis=(0, 0, 1),
                                      placement2=(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), (-1, 0, 0))))
    return b.finish()


def test_bricard():
    """A closed pose exists (a cube's edges), where the sixth hinge of a 6R loop, which would make it rigid, leaves it one
    motion."""
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
    assert (report.redundant == 1 and report.contradictory == 0
            and {r.constraint for r in report.rows if r.verdict == dyn.RowVerdict.REDUNDANT} == {"sixth"})
    v = d.project(q, np.ones(5)).v
    tau = np.arange(5.0)
    ddq = d.constrained_dynamics(q, v, tau).ddq
    np.testing.assert_allclose(ddq, kkt(d, q, v, tau, redundant=True)[0], atol=1e-8 * max(1, abs(ddq).max()))


def test_contradictions_by_name():
    """A rod of one metre between points that are 1.001 m apart."""
    b = dyn.Builder("rod")
    b.add_joint("free", "free_flyer")
    b.add_body("rod", "free", mass=1, inertia=np.diag([0.01, 0.1, 0.1]))
    b.add_frame("left", "free", (-0.5, 0, 0)).add_frame("right", "free", (0.5, 0, 0))
    b.add_constraint("here", dc.weld("left", placement2=(-0.5005, 0, 0)))
    b.add_constraint("there", dc.weld("right", placement2=(0.5005, 0, 0)))
    m = b.finish()
    d = m.data()
    q0 = np.array([0.1, 0.2, -0.1, 0.05, 0.02, -0.1, 1])
    q0[3:] /= np.linalg.norm(q0[3:])
    q, _, result = d.project(q0)
    assert result.reason == dyn.ConstraintReason.CONTRADICTORY
    np.testing.assert_allclose(result.residual, 5e-4, rtol=1e-6)
    np.testing.assert_allclose(q[:3], 0, atol=1e-8)
    report = d.constraint_report(q)
    assert report.rank == 6 and report.redundant == 6
    assert {r.constraint for r in report.rows if r.verdict == dyn.RowVerdict.CONTRADICTORY} == {"here", "there"}
    np.testing.assert_allclose(report.contradiction, 5e-4, rtol=1e-6)
    # accelerations that contradict each other: the least squares of them
    d.set_constraint("here", dc.weld("left", placement2=(-0.6, 0, 0), stiffness=100, damping=20))
    ddq, forces = d.constrained_dynamics(np.array([0, 0, 0, 0, 0, 0, 1.0]), np.zeros(6), np.zeros(6))
    assert d.constraint_result.reason == dyn.ConstraintReason.CONTRADICTORY and d.constraint_result.contradiction > 1
    np.testing.assert_allclose(ddq, [-5, 0, 0, 0, 0, 0], atol=1e-6)
    assert np.isfinite(forces).all()
