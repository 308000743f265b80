"""Data: kinematics, dynamics and steps agree with each other."""

import numpy as np
import pytest

import libdyn as dyn

close = np.testing.assert_allclose


@pytest.fixture
def d(go2):
    return go2.data()


def test_frames(d, go2, state):
    q, v, a, _ = state
    d.forward_kinematics(q, v, a)
    every = d.frame_placements()
    assert every.rotation.shape == (go2.nframes, 3, 3) and every.matrix.shape == (go2.nframes, 4, 4)
    foot = go2.nframes - 1
    X = d.frame_placement(foot)
    close(every.rotation[foot], X.rotation)
    close(every.translation[foot], X.translation)
    close(X.rotation @ X.rotation.T, np.eye(3), atol=1e-12)
    local, world, aligned = (d.frame_velocity(foot, r) for r in dyn.Reference)
    close(aligned[:3], X.rotation @ local[:3], atol=1e-12)
    close(aligned[3:], X.rotation @ local[3:], atol=1e-12)
    close(world[:3], aligned[:3] - np.cross(aligned[3:], X.translation), atol=1e-11)
    np.testing.assert_array_equal(world, d.frame_velocity(foot, "world"))
    np.testing.assert_array_equal(world, d.frame_velocity(go2.frame_name(foot), 1))
    spatial = d.frame_acceleration(foot, "LOCAL_WORLD_ALIGNED")
    classical = d.frame_classical_acceleration(foot, "LOCAL_WORLD_ALIGNED")
    close(classical[:3], spatial[:3] + np.cross(aligned[3:], aligned[:3]), atol=1e-10)
    for r in dyn.Reference:
        J, dJ = d.frame_jacobian(foot, r), d.frame_jacobian_time_variation(foot, r)
        assert J.shape == dJ.shape == (6, 18)
        close(J @ v, d.frame_velocity(foot, r), atol=1e-11)
        if r != dyn.Reference.LOCAL_WORLD_ALIGNED:
            close(J @ a + dJ @ v, d.frame_acceleration(foot, r), atol=1e-9)
    with pytest.raises(dyn.ArgumentError, match="LOCAL_WORLD_ALIGNED"):
        d.frame_velocity(foot, "body")
    with pytest.raises(dyn.UnknownNameError):
        d.frame_velocity("no_foot")
    with pytest.raises(dyn.ArgumentError):
        d.frame_placement(go2.nframes)


def test_joint_jacobians(d, state):
    q, v = state[:2]
    J = d.joint_jacobians(q)
    np.testing.assert_array_equal(J, d.J)
    dJ = d.joint_jacobians_time_variation(q, v)
    np.testing.assert_array_equal(dJ, d.dJ)
    assert J.shape == dJ.shape == (6, 18)


def test_center_of_mass(d, go2, state):
    q, v, a, _ = state
    com = d.compute_com(q, v, a)
    np.testing.assert_array_equal(com, d.com)
    vcom, acom = d.vcom.copy(), d.acom.copy()
    Jcom = d.jcom(q)
    assert Jcom.shape == (3, 18) and acom.shape == (3,)
    close(Jcom @ v, vcom, atol=1e-12)
    d.compute_com(q, v, a)
    whole, mass = d.subtree_com(0)
    close(whole, com)
    assert mass == pytest.approx(go2.total_mass)
    joint = go2.joints[2].name
    assert 0 < d.subtree_com(joint)[1] < mass
    assert d.subtree_jcom(joint).shape == (3, 18)
    close(d.subtree_jcom(1), Jcom, atol=1e-12)


def test_dynamics_agree(d, go2, state):
    q, v, a, tau = state
    M, nle, g, C = d.crba(q), d.compute_nle(q, v), d.gravity_torque(q), d.coriolis_matrix(q, v)
    np.testing.assert_array_equal(M, M.T)
    close(d.rnea(q, v, a), M @ a + nle, rtol=1e-9, atol=1e-9)
    close(C @ v + g, nle, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(d.rnea(q, 0 * v, 0 * a), g)
    ddq = d.aba(q, v, tau)
    close(d.rnea(q, v, ddq), tau, atol=1e-8)
    Minv = d.minv(q)
    close(Minv @ M, np.eye(18), atol=1e-8)
    close(Minv @ (tau - nle), ddq, rtol=1e-6, atol=1e-6)
    np.testing.assert_array_equal(d.Minv, Minv)


def test_external_forces(d, go2, state):
    q, v, a, tau = state
    fext = np.random.default_rng(1).standard_normal((6, go2.njoints))
    d.forward_kinematics(q)
    pushed = sum(
        d.frame_jacobian(go2.frame_id(go2.joint_name(i), "joint"), "LOCAL").T @ fext[:, i] for i in range(1, go2.njoints)
    )
    close(d.rnea(q, v, a, fext), d.rnea(q, v, a) - pushed, atol=1e-9)
    close(d.compute_static_torque(q, fext), d.gravity_torque(q) - pushed, atol=1e-9)
    close(d.rnea(q, v, d.aba(q, v, tau, fext), fext), tau, atol=1e-8)
    np.testing.assert_array_equal(d.rnea(q, v, a, fext), d.rnea(q, v, a, np.asfortranarray(fext)))
    np.testing.assert_array_equal(d.rnea(q, v, a, fext), d.rnea(q, v, a, fext.tolist()))


def test_factor_and_solve(d, state):
    q = state[0]
    with pytest.raises(dyn.StaleError):
        d.cholesky()
    M = d.crba(q)
    d.cholesky()
    b = np.random.default_rng(2).standard_normal((18, 3))
    close(M @ d.cholesky_solve(b), b, atol=1e-9)
    close(d.cholesky_solve(b[:, 1]), d.cholesky_solve(b)[:, 1], rtol=1e-12)
    assert d.cholesky_solve(b[:, 0]).shape == (18,)
    for bad in (b[:5], b.T, np.zeros((18, 1, 1))):
        with pytest.raises(dyn.SizeError):
            d.cholesky_solve(bad)


def test_energy(d, state):
    q, v = state[:2]
    energy = d.energy(q, v)
    M, com = d.crba(q), d.compute_com(q)
    assert energy.kinetic == pytest.approx(0.5 * v @ M @ v)
    assert energy.potential == pytest.approx(9.81 * d.model.total_mass * com[2])
    assert (d.kinetic_energy(q, v), d.potential_energy(q)) == energy
    d.energy(q, v)
    assert d.mechanical == pytest.approx(sum(energy)) and isinstance(d.kinetic, float)


def test_all_terms(d, state):
    q, v = state[:2]
    filled = d.all_terms(q=q, v=v)
    assert filled == dyn.Term.ALL
    M, nle, com = d.M.copy(), d.nle.copy(), d.com.copy()
    np.testing.assert_allclose(M, d.crba(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(nle, d.compute_nle(q, v), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(com, d.compute_com(q), rtol=1e-12)
    d.set_state(q, v)
    assert dyn.Term.MASS in d.all_terms("mass") and dyn.Term.COM in d.all_terms(["mass", dyn.Term.COM])
    with pytest.raises(dyn.Error):
        d.all_terms(1 << 31)
    with pytest.raises(dyn.ArgumentError):
        d.all_terms("everything")


@pytest.mark.parametrize("integrator, drift", [("semi_implicit_euler", 3e-2), (dyn.Integrator.RK4, 1e-9)])
def test_step(arm, integrator, drift):
    d = arm.data()
    d.set_effects(("armature", "limits"))
    d.set_state([1, 0.5], [0, 0])
    start = sum(d.energy())
    for _ in range(1000):
        d.step(1e-3, integrator)
    assert d.time == pytest.approx(1) and not np.array_equal(d.q, [1, 0.5])
    assert abs(sum(d.energy()) - start) < drift


def test_step_under_torque(arm):
    d = arm.data()
    d.set_effects("armature")
    d.set_state([0, 0], [0, 0], tau=[0.5, -0.25])
    ddq = d.aba([0, 0], [0, 0], [0.5, -0.25])
    d.step(1e-6)
    close(d.v, 1e-6 * ddq, rtol=1e-5)


def test_step_errors(arm):
    d = arm.data()
    for bad in (float("nan"), float("inf"), 0, -1e-3):
        with pytest.raises(dyn.Error):
            d.step(bad)
    with pytest.raises(dyn.ArgumentError, match="RK4"):
        d.step(1e-3, "euler")
    assert d.time == 0
    q = d.q.copy()
    d.set_state(v=[1e200, -1e200])
    with pytest.raises(dyn.NumericError):
        for _ in range(10):
            d.step(1e100, "rk4")
    np.testing.assert_array_equal(d.q, q)


def test_mimic(gripper):
    d = gripper.data()
    q, v = [0.4], [1.5]
    ddq = d.aba(q, v, [0.2])
    close(d.rnea(q, v, ddq), [0.2], atol=1e-12)
    assert d.crba(q).shape == d.M.shape == (1, 1) and d.joint_jacobians(q).shape == d.J.shape == (6, 1)
    d.forward_kinematics(q, v)
    assert d.frame_jacobian("thumb").shape == (6, 1)
    close(d.frame_jacobian("thumb") @ v, d.frame_velocity("thumb"), atol=1e-14)
