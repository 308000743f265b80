"""Loops that rounding over-constrains move as the exact mechanism does: a planar four-bar with one tilted hinge axis."""

import numpy as np
import pytest
from linkages import rod

import libdyn as dyn
from libdyn import constraint as dc

TILTS = (0.0, 1e-12, 1e-8, 3.7e-6, 1e-4)
INTEGRATORS = ("semi_implicit_euler", "implicit_fast", "rk4", "rk45", "implicit_midpoint", "reference")
LENGTHS = dict(crank=1.0, coupler=1.3, rocker=0.8, ground=1.1)


def tilted_four_bar(tilt, kind="loop"):
    """The coupler's hinge leans by `tilt` from the normal of the plane."""
    b = dyn.Builder("tilted")
    b.set_gravity((0, -9.81, 0))
    rod(b, "a", None, None, LENGTHS["crank"])
    rod(b, "b", "a", (LENGTHS["crank"], 0, 0), LENGTHS["coupler"], axis=(0.6 * np.sin(tilt), 0.8 * np.sin(tilt), np.cos(tilt)))
    rod(b, "c", "b", (LENGTHS["coupler"], 0, 0), LENGTHS["rocker"])
    b.add_frame("tip", "c", (LENGTHS["rocker"], 0, 0))
    if kind == "loop":
        b.add_constraint("pin", dc.loop("revolute", "tip", None, axis=(0, 0, 1), placement2=(LENGTHS["ground"], 0, 0)))
    else:
        b.add_constraint("pin", dc.connect("tip", None, placement2=(LENGTHS["ground"], 0, 0)))
    return b.finish()


@pytest.fixture(scope="module")
def exact():
    """Start and end of the exact mechanism: q at rest, and q half a second later."""
    d = tilted_four_bar(0.0, "connect").data()
    start = d.project(np.array([1.0, -0.9, -1.2])).q.copy()
    d.q = start
    d.set_step_options("rk4", 1e-4)
    for _ in range(5000):
        d.step()
    return start, d.q.copy()


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", ("loop", "connect"))
@pytest.mark.parametrize("tilt", TILTS)
def test_tilted_four_bar_moves_as_the_exact_one(exact, tilt, kind, integrator):
    """In default steps of 1 ms it ends within the method's own error and ten times the tilt; the loop opens by no more than twice
    the tilt."""
    start, end = exact
    d = tilted_four_bar(tilt, kind).data()
    d.q = start
    d.set_step_options(integrator, 1e-3)
    own = 2e-3 if integrator in INTEGRATORS[:2] else 1e-5
    for _ in range(500):
        d.step()
        assert d.step_report.unsolved == 0
    np.testing.assert_allclose(d.q, end, atol=own + 10 * tilt)
    drift = abs(d.constraint_terms(d.q, d.v).C).max()
    assert drift < 2 * tilt + (1e-4 if integrator in INTEGRATORS[:2] else 1e-11)


@pytest.mark.parametrize("solver", ("pgs", "admm", "newton"))
@pytest.mark.parametrize("tilt", TILTS)
def test_every_solver_moves_it(exact, tilt, solver):
    start, end = exact
    d = tilted_four_bar(tilt).data()
    d.q = start
    d.set_step_options("implicit_fast", 1e-3, solver=solver)
    for _ in range(500):
        d.step()
    np.testing.assert_allclose(d.q, end, atol=2e-3)


@pytest.mark.parametrize("kind", ("loop", "connect"))
@pytest.mark.parametrize("tilt", TILTS)
def test_project_closes_it_where_the_exact_one_closes(tilt, kind):
    """Not at the one q, 0.4 rad away, where the tilted loop closes without error."""
    far, v = np.array([0.8, -0.9, -1.2]), np.array([1.0, 2.0, -1.0])
    exact, found = (tilted_four_bar(x, kind).data().project(far, v) for x in (0.0, tilt))
    assert found.result.reason == dyn.ConstraintReason.CONVERGED and found.result.residual < 2 * tilt + 1e-12
    np.testing.assert_allclose(found.q, exact.q, atol=10 * tilt + 1e-12)
    np.testing.assert_allclose(found.v, exact.v, atol=10 * tilt + 1e-12)
    if tilt > 1e-12:
        assert found.result.contradiction == found.result.residual


def test_project_calls_a_short_rod_contradictory():
    """Two rods between the same bodies, of lengths 1 m and 1.001 m: redundant rows, but no misalignment explains 0.5 mm."""
    b = dyn.Builder("rods")
    rod(b, "a", None, None, 1.0)
    b.add_frame("tip", "a", (1.0, 0, 0))
    for name, length in (("short", 1.0), ("long", 1.001)):
        b.add_constraint(name, dc.distance("tip", None, length, placement2=(0.5, 1.0, 0)))
    found = b.finish().data().project(np.array([0.1])).result
    assert found.reason == dyn.ConstraintReason.CONTRADICTORY and 4e-4 < found.contradiction < 6e-4


@pytest.mark.parametrize("kind", ("loop", "connect"))
@pytest.mark.parametrize("tilt", TILTS)
def test_report_gives_the_mobility_of_the_exact_mechanism(exact, tilt, kind):
    m = tilted_four_bar(tilt, kind)
    d = m.data()
    report = d.constraint_report(d.project(exact[0]).q)
    assert m.nv - report.rank == 1 and report.contradictory == 0
    assert report.contradiction < 2 * tilt + 1e-12


def test_a_larger_misalignment_locks(exact):
    m = tilted_four_bar(2e-3, "connect")
    assert m.data().constraint_report(exact[0]).rank == m.nv


def test_light_bodies_are_no_misalignment():
    """A combination of rows that only a body of 1e4 kg moves, beside others of 1 g, counts: the measure knows no masses."""
    b = dyn.Builder("masses")
    b.add_joint("heavy", "prismatic", axis=(0, 0, 1)).add_body("block", "heavy", mass=1e4, inertia=np.eye(3))
    b.add_joint("x", "prismatic", "heavy", axis=(1, 0, 0)).add_body("slide", "x", mass=1e-3, inertia=1e-6 * np.eye(3))
    b.add_joint("y", "prismatic", "x", axis=(0, 1, 0)).add_body("tip", "y", mass=1e-3, inertia=1e-6 * np.eye(3))
    turned = np.array([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3
    b.add_constraint("pin", dc.connect("tip", None, placement2=(turned, np.zeros(3))))
    d = b.finish().data()
    d.set_step_options("semi_implicit_euler", 1e-3)
    for _ in range(100):
        d.step()
    np.testing.assert_allclose(d.q, 0, atol=1e-9)
    assert d.constraint_report(d.q).rank == 3


def bricard(six_rows):
    """IFToMM A04: five rods of 1 m and six hinges; its ring has one redundant row of five, or two of six."""
    P = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], float)
    axes = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    b = dyn.Builder("bricard")
    b.set_gravity((0, -9.81, 0))
    parent, along = None, np.zeros(3)
    for k in range(5):
        before, along = along, P[k + 1] - P[k]
        b.add_joint(f"h{k}", "revolute", parent, tuple(before), axis=tuple(axes[k]))
        b.add_body(f"rod{k}", f"h{k}", mass=1, com=tuple(along / 2), inertia=np.diag((1 - along**2) / 12))
        parent = f"h{k}"
    b.add_frame("end", parent, tuple(along)).add_frame("beyond", parent, tuple(along + [1, 0, 0]))
    if six_rows:
        b.add_constraint("end", dc.connect("end", None, placement2=tuple(P[5])))
        b.add_constraint("axis", dc.connect("beyond", None, placement2=tuple(P[5] + [1, 0, 0])))
    else:
        b.add_constraint("end", dc.loop("revolute", "end", None, axis=(1, 0, 0), placement2=tuple(P[5])))
    return b.finish()


@pytest.mark.parametrize("solver", ("pgs", "admm", "newton"))
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("six_rows", (False, True))
def test_bricard_in_steps_of_1_ms(six_rows, integrator, solver):
    """Within 3 mrad of the exact motion after a second by the methods of order 1, 2e-6 by the midpoint rule, 1e-11 by the
    others."""
    m = bricard(six_rows)
    exact, d = m.data(), m.data()
    exact.set_step_options("reference", 0.1)
    for _ in range(10):
        exact.step()
    d.set_step_options(integrator, 1e-3, solver=solver)
    for _ in range(1000):
        d.step()
        assert d.step_report.unsolved == 0
    own = {"semi_implicit_euler": 3e-3, "implicit_fast": 3e-3, "implicit_midpoint": 2e-6}.get(integrator, 1e-11)
    np.testing.assert_allclose(d.q, exact.q, atol=own)
    assert abs(d.constraint_terms(d.q, d.v).C).max() < 1e-5
