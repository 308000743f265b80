"""rollout_vjp: gradients of motions with contact against differences of the motions."""

import libdyn as dyn
import numpy as np
import pytest

STEPS = 23


def ball():
    rough = dyn.Material(friction=0.3)
    b = dyn.Builder("ball").add_shape("universe", "half_space", material=rough)
    b.add_joint("free", "free_flyer").add_body("ball", "free", 1.0, (0.01, 0, 0.02), 4e-3 * np.eye(3))
    return b.add_shape("ball", "sphere", (0.1,), material=rough).finish()


def sliding(m, dx=np.zeros(12), gravity=-9.81):
    d = m.data()
    d.set_gravity([0, 0, gravity])
    d.set_step_options(tolerance=1e-12)
    d.set_state(m.integrate([0, 0, 0.1 - 1e-4, 0, 0, 0, 1], dx[:6]), np.array([1, 0.5, 0, 0.2, 0.1, 2]) + dx[6:])
    return d


def end(d, taus):
    for tau in taus:
        d.tau_applied = tau
        d.step()
    return d.q, d.v


@pytest.mark.parametrize("every", [None, 1, 7, 100])
def test_gradient_is_that_of_the_motion(every):
    m, rng = ball(), np.random.default_rng(1)
    taus, y = rng.normal(size=(STEPS, 6)), rng.normal(size=12)
    q0, v0 = end(sliding(m), taus)

    def value(dx=np.zeros(12), taus=taus, gravity=-9.81):
        q, v = end(sliding(m, dx, gravity), taus)
        return y @ np.r_[m.difference(q0, q), v - v0]

    d = sliding(m)
    before = d.save_state()
    g = dyn.rollout_vjp(d, STEPS, y, taus=taus, parameters=["gravity"], every=every)
    assert d.save_state() == before and g.control.shape == (STEPS, 0)
    s = 1e-6
    dx, dtau = rng.normal(size=12), rng.normal(size=(STEPS, 6))
    assert g.x @ dx == pytest.approx((value(s * dx) - value(-s * dx)) / (2 * s), rel=1e-5)
    assert np.sum(g.tau * dtau) == pytest.approx((value(taus=taus + s * dtau) - value(taus=taus - s * dtau)) / (2 * s), rel=1e-5)
    assert g.parameters[2] == pytest.approx((value(gravity=-9.81 + s) - value(gravity=-9.81 - s)) / (2 * s), rel=1e-5)


def test_gradients_by_all_states_add_up():
    m, rng = ball(), np.random.default_rng(2)
    y = rng.normal(size=(STEPS, 12))
    whole = dyn.rollout_vjp(sliding(m), STEPS, y).x
    parts = sum(dyn.rollout_vjp(sliding(m), k + 1, y[k]).x for k in range(STEPS))
    np.testing.assert_allclose(whole, parts, rtol=1e-9, atol=1e-9)


def test_refusals():
    d = sliding(ball())
    with pytest.raises(dyn.ArgumentError, match="steps"):
        dyn.rollout_vjp(d, 0, np.zeros(12))
    with pytest.raises(dyn.ArgumentError, match="every"):
        dyn.rollout_vjp(d, 3, np.zeros(12), every=0)
    with pytest.raises(dyn.SizeError, match="cotangents"):
        dyn.rollout_vjp(d, 3, np.zeros((2, 12)))
    with pytest.raises(dyn.SizeError, match="taus"):
        dyn.rollout_vjp(d, 3, np.zeros(12), taus=np.zeros((2, 6)))
