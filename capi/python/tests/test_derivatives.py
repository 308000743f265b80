"""Derivatives of inverse and forward dynamics through Python: against differences, and as inverses of each other."""

import libdyn as dyn
import numpy as np
import pytest


def slopes(model, f, x, tangent):
    """Columns of df/dx by central differences with one extrapolation, along q (+) or x +."""
    move = model.integrate if tangent else np.add

    def difference(u, h):
        return (f(move(x, h * u)) - f(move(x, -h * u))) / (2 * h)

    return np.array([(4 * difference(u, 1e-4) - difference(u, 2e-4)) / 3 for u in np.eye(model.nv)]).T


def close(a, b, tolerance):
    np.testing.assert_allclose(a, b, atol=tolerance * (1 + np.abs(b).max()), rtol=0)


def test_inverse(go2, state):
    q, v, a, _ = state
    d, e = go2.data(), go2.data()
    fext = np.random.default_rng(4).normal(size=(6, go2.njoints))
    x = d.rnea_derivatives(q, v, a, fext)
    close(x.dtau_dq, slopes(go2, lambda y: e.rnea(y, v, a, fext), q, True), 1e-9)
    close(x.dtau_dv, slopes(go2, lambda y: e.rnea(q, y, a, fext), v, False), 1e-9)
    close(d.M, e.crba(q), 1e-12)
    close(d.tau, e.rnea(q, v, a, fext), 1e-12)


def test_forward(go2, state):
    q, v, _, tau = state
    d, e = go2.data(), go2.data()
    x = d.aba_derivatives(q, v, tau)
    close(x.ddq_dq, slopes(go2, lambda y: e.aba(y, v, tau), q, True), 1e-8)
    close(x.ddq_dv, slopes(go2, lambda y: e.aba(q, y, tau), v, False), 1e-8)
    close(x.ddq_dtau @ e.crba(q), np.eye(go2.nv), 1e-11)
    with pytest.raises(dyn.StaleError, match="call Data.rnea"):  # a was not that of forward dynamics
        d.dtau_dq
    inverse = d.rnea_derivatives(a=d.ddq)
    close(-x.ddq_dtau @ inverse.dtau_dq, x.ddq_dq, 1e-10)
    close(-x.ddq_dtau @ inverse.dtau_dv, x.ddq_dv, 1e-10)


def test_parts(go2):
    with pytest.raises(dyn.PartError, match="FORWARD_DERIVATIVES"):
        go2.data(parts=dyn.Part.INVERSE_DERIVATIVES).aba_derivatives()


def test_minverse_alone_of_a_long_chain():
    """Beyond the size that goes by a dense factor, with no part but its own."""
    b = dyn.Builder("chain")
    for k in range(128):
        b.add_joint(f"j{k}", "revolute", parent=f"j{k - 1}" if k else None, axis=(k % 2, 1, 0))
        b.add_body(f"b{k}", f"j{k}", 1.0, (0, 0, 0.1), np.eye(3) * 0.01)
    m = b.finish()
    d = m.data(dyn.Part.MINV)
    assert np.abs(d.minv(m.neutral()) @ d.crba(m.neutral()) - np.eye(128)).max() < 1e-9
