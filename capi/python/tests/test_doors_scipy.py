"""The SciPy door: operators of a step, and residuals with Jacobians."""

import doors
import numpy as np
import pytest

pytest.importorskip("scipy", reason="package scipy is not installed")

from scipy.optimize import least_squares  # noqa: E402

import libdyn as dyn  # noqa: E402
from libdyn.doors import scipy as door  # noqa: E402

close = np.testing.assert_allclose


def test_step_operators():
    f, x = doors.opened("go2", "step")
    d = f.model.data()
    d.set_state(x[0][0], x[1][0], tau=x[2][0])
    found, rng = d.step_derivatives(), np.random.default_rng(0)
    A, B, B_control = door.step_operators(d)
    assert A.shape == (36, 36) and B.shape == (36, 18) and B_control.shape == (36, 0)
    dx, y = rng.standard_normal((2, 36))
    close(A @ dx, found.A @ dx, atol=1e-12)
    close(A.rmatvec(y), found.A.T @ y, atol=1e-12)
    close(B.T @ y, found.B.T @ y, atol=1e-12)


@doors.every
def test_jacobians(robot, name):
    f, x = doors.opened(robot, name)
    start, rng = [a[0] for a in x], np.random.default_rng(8)
    over = [i.name for i in f.inputs][::-1]
    target = rng.standard_normal(sum(o.size for o in f.outputs))
    r = door.Residual(f.model, name, start, target, over, weight=rng.uniform(0.5, 2, target.size), **doors.options(f.model, name))
    z = 0.05 * rng.standard_normal(r.zero.size)
    doors.assert_derivatives(lambda z: [r.fun(z)], [z], [[r.jac(z)]])


def test_least_squares_on_a_floating_base():
    """A foot is brought to a pose that it can take."""
    m = doors.load("go2")
    f = doors.Function(m, "frame_placement", frame="FL_foot")
    target = f(m.random(2))[0]
    r = door.Residual(m, "frame_placement", [m.random(3)], target, frame="FL_foot")
    found = least_squares(r.fun, r.zero, r.jac, xtol=1e-15, ftol=1e-15, gtol=1e-12)
    q = r.inputs(found.x)[0]
    assert found.cost < 1e-18 and m.is_normalized(q)
    close(f(q)[0], target, atol=1e-9)


def test_refusals():
    m = doors.load("panda")
    for over in ("q", (), ("q", "q"), ("x",)):
        with pytest.raises(dyn.ArgumentError, match="over"):
            door.Residual(m, "frame_placement", [m.neutral()], np.zeros(12), over, frame=1)
    with pytest.raises(dyn.SizeError, match="target"):
        door.Residual(m, "frame_placement", [m.neutral()], np.zeros(3), frame=1)
    with pytest.raises(dyn.SizeError, match="z has shape"):
        door.Residual(m, "frame_placement", [m.neutral()], np.zeros(12), frame=1).fun(np.zeros(3))
