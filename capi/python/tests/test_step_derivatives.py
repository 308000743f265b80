"""Data.step_derivatives: shapes, methods, modes, and that a linear model predicts the next steps."""

import libdyn as dyn
import numpy as np
import pytest


def ball(friction=0.5):
    b = dyn.Builder("ball").add_shape("universe", "half_space", material=dyn.Material(friction=friction))
    b.add_joint("free", "free_flyer").add_body("ball", "free", 1.0, (0, 0, 0), 4e-3 * np.eye(3))
    return b.add_shape("ball", "sphere", (0.1,), material=dyn.Material(friction=friction)).finish()


def at(model, gap, v, **parts):
    d = model.data(**parts)
    d.set_state([0, 0, 0.1 + gap, 0, 0, 0, 1], v)
    return d


def test_methods_agree():
    d = at(ball(), -1e-4, [0.3, 0, 0, 0, 3, 0])
    analytic, central = d.step_derivatives("analytic"), d.step_derivatives("central_differences")
    assert analytic.method is dyn.DerivativeMethod.ANALYTIC and analytic.reason == ""
    assert central.method is dyn.DerivativeMethod.CENTRAL_DIFFERENCES
    assert analytic.A.shape == (12, 12) and analytic.B.shape == (12, 6) and analytic.B_control.shape == (12, 0)
    np.testing.assert_allclose(analytic.A, central.A, atol=1e-6)
    np.testing.assert_allclose(analytic.B, central.B, atol=1e-6)
    assert analytic.modes == [dyn.ContactMode.STICK] and analytic.degenerate == [False] and analytic.degenerate_count == 0
    assert analytic.contacts[0].force_on_b[2] == pytest.approx(9.81, rel=1e-6)


def test_next_state_is_that_of_the_step():
    d = at(ball(), -1e-5, [1, 0.2, 0, 0, 0, 2])
    x = d.step_derivatives()
    d.set_step_options(tolerance=1e-12)
    d.step()
    np.testing.assert_allclose(x.q, d.q, atol=1e-13)
    np.testing.assert_allclose(x.v, d.v, atol=1e-11)
    assert x.modes == [dyn.ContactMode.SLIDE]


def test_linear_model_predicts_a_step():
    m = ball()
    v = np.array([1, 0.2, 0, 0, 0, 2.0])
    x = at(m, -1e-4, v).step_derivatives()
    dx, tau = 1e-4 * np.array([1, -2, 0.1, 0.5, 2, -1, 1, 2, 0.3, -1, 1, 2]), 1e-3 * np.arange(6.0)
    d = m.data()
    d.set_state(m.integrate([0, 0, 0.1 - 1e-4, 0, 0, 0, 1], dx[:6]), v + dx[6:], tau=tau)
    d.step()
    predicted = x.A @ dx + x.B @ tau
    found = np.r_[m.difference(x.q, d.q), d.v - x.v]
    np.testing.assert_allclose(found, predicted, atol=1e-6)  # of second order


def test_refusals():
    d = at(ball(), 0, np.zeros(6), parts=dyn.Part.SIMULATION)
    with pytest.raises(dyn.PartError, match="STEP_DERIVATIVES"):
        d.step_derivatives()
    d = at(ball(), 0, np.zeros(6))
    with pytest.raises(dyn.ArgumentError, match="epsilon"):
        d.step_derivatives(epsilon=0)
    with pytest.raises(dyn.Error, match="method"):
        d.step_derivatives("exact")
    d.set_step_options("rk4")
    d.set_state([0, 0, 1, 0, 0, 0, 1])
    with pytest.raises(dyn.Error, match="SEMI_IMPLICIT_EULER"):
        d.step_derivatives("analytic")
    assert "SEMI_IMPLICIT_EULER" in d.step_derivatives().reason
