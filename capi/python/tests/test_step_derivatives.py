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


PARAMETERS = [("inertia", 1), "gravity", ("contact_friction", 0), ("time_step", 0)]


def test_products_are_those_with_the_matrices():
    d, rng = at(ball(), 5e-6, [1, 0.5, 0, 0.2, 0.1, 2]), np.random.default_rng(0)
    x = d.step_derivatives(parameters=PARAMETERS)
    assert x.modes == [dyn.ContactMode.SLIDE] and x.P.shape == (12, 15)
    J = np.c_[x.A, x.B, x.B_control, x.P]
    dx, y = rng.normal(size=(33, 2)), rng.normal(size=12)
    np.testing.assert_allclose(d.step_jvp(dx, PARAMETERS), J @ dx, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(d.step_jvp(dx[:18, 0]), J[:, :18] @ dx[:18, 0], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(d.step_vjp(y, PARAMETERS), y @ J, rtol=1e-10, atol=1e-10)
    assert d.step_vjp(np.eye(12)).shape == (18, 12)


def test_parameters_of_the_model():
    v = [1, 0.5, 0, 0.2, 0.1, 2]
    d = at(ball(), 5e-6, v)
    P = d.step_derivatives(parameters=PARAMETERS).P
    for column, change in (
        (10, lambda d, s: d.set_gravity([s, 0, -9.81])),
        (12, lambda d, s: d.set_gravity([0, 0, -9.81 + s])),
        (13, lambda d, s: [d.set_shape_material(k, dyn.Material(friction=0.5 + s)) for k in (0, 1)]),
        (14, lambda d, s: d.set_step_options(dt=d.step_options.dt * (1 + s))),
    ):
        ends, s = [], 1e-4
        for side in (s, -s):
            d = at(ball(), 5e-6, v)
            scale = d.step_options.dt if column == 14 else 1
            change(d, side)
            ends.append(d.step_derivatives())
        dq = d.model.difference(ends[1].q, ends[0].q)
        np.testing.assert_allclose(P[6:, column], (ends[0].v - ends[1].v) / (2 * s * scale), rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(P[:6, column], dq / (2 * s * scale), rtol=1e-5, atol=1e-6)


def test_product_refusals():
    d = at(ball(), 5e-6, np.zeros(6))
    with pytest.raises(dyn.SizeError, match="tangents"):
        d.step_jvp(np.zeros(17))
    with pytest.raises(dyn.SizeError, match="cotangents"):
        d.step_vjp(np.zeros((2, 12)))
    with pytest.raises(dyn.ArgumentError, match="parameters"):
        d.step_vjp(np.zeros(12), [("mass", 1)])
    with pytest.raises(dyn.ArgumentError, match="joints are from 1 to 1"):
        d.step_vjp(np.zeros(12), [("inertia", 2)])
    with pytest.raises(dyn.Error, match="central differences"):
        d.step_vjp(np.zeros(12), [("inertia", 1)], "central_differences")


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
