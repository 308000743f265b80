"""Rows of constraints of every kind: C, J v and drift as derivatives of each other, and derivatives of what they hold."""

import numpy as np
import pytest
from linkages import TIES, arms, differences, random_state


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
