"""Centroidal quantities through the package."""

import numpy as np
import pytest

import libdyn as dyn

close = np.testing.assert_allclose


def test_definitions(go2, state):
    q, v, a, _ = state
    d = go2.data()
    c = d.centroidal(q, v, a)
    nv = go2.nv
    assert c.Ag.shape == c.dAg.shape == (6, nv) and c.hg.shape == c.dhg.shape == (6,) and c.Ig.shape == (6, 6)
    close(c.hg, c.Ag @ v, atol=1e-11)
    close(c.dhg, c.Ag @ a + c.dAg @ v, atol=1e-10)
    close(c.Ig[:3, :3], go2.total_mass * np.eye(3), atol=1e-12)
    d.compute_com(q, v, a)
    close(c.hg[:3], go2.total_mass * d.vcom, atol=1e-11)
    close(c.dhg[:3], go2.total_mass * d.acom, atol=1e-10)
    np.testing.assert_array_equal(d.centroidal_map(q, v), d.Ag)
    np.testing.assert_array_equal(d.centroidal_map_time_variation(q, v), d.dAg)
    np.testing.assert_array_equal(d.centroidal_momentum(q, v), d.hg)
    np.testing.assert_array_equal(d.centroidal_momentum_time_variation(q, v, a), d.dhg)
    close(d.hg, c.hg, atol=1e-11)


def test_free_fall(go2, state):
    q, v, _, tau = state
    tau = tau.copy()
    tau[:6] = 0
    d = go2.data()
    dhg = d.centroidal_momentum_time_variation(q, v, d.aba(q, v, tau))
    close(dhg, [0, 0, -9.81 * go2.total_mass, 0, 0, 0], atol=1e-8)


def test_derivatives(go2, state):
    q, v, a, _ = state
    d = go2.data()
    x = d.centroidal_derivatives(q, v, a)
    np.testing.assert_array_equal(x.dhdot_da, d.Ag)
    u, h = np.cos(np.arange(go2.nv)), 1e-5

    def momenta(s):
        dhg = d.centroidal_momentum_time_variation(go2.integrate(q, s * u), v, a)
        return d.hg.copy(), dhg

    (h1, dh1), (h0, dh0) = momenta(h), momenta(-h)
    close(x.dh_dq @ u, (h1 - h0) / (2 * h), atol=1e-6)
    close(x.dhdot_dq @ u, (dh1 - dh0) / (2 * h), atol=1e-5)
    dhg = [d.centroidal_momentum_time_variation(q, v + s * u, a) for s in (h, -h)]
    close(x.dhdot_dv @ u, (dhg[0] - dhg[1]) / (2 * h), atol=1e-6)


def test_held_values_and_staleness(go2, state):
    q, v, a, _ = state
    d = go2.data(parts=dyn.Part.CENTROIDAL)
    with pytest.raises(dyn.StaleError, match="call Data.centroidal_map first"):
        d.Ag
    d.set_state(q, v, a)
    close(d.centroidal_map() @ v, d.hg, atol=1e-11)
    d.set_state(v=2 * v)
    assert d.Ag.shape == (6, go2.nv)  # of q alone
    with pytest.raises(dyn.StaleError, match="call Data.centroidal_momentum"):
        d.hg
    close(d.centroidal_momentum(), 2 * d.Ag @ v, atol=1e-11)
    with pytest.raises(dyn.PartError, match="CENTROIDAL"):
        go2.data(parts=dyn.Part.COM).centroidal_map()
    with pytest.raises(dyn.NonFiniteError, match=r"v\[2\]"):
        d.centroidal_map(q, np.where(np.arange(go2.nv) == 2, np.nan, v))


def test_mimic(gripper):
    q, v = gripper.random(1), np.ones(gripper.nv)
    d = gripper.data()
    close(d.centroidal_map(q, v) @ v, d.centroidal_momentum(), atol=1e-14)
