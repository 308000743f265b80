"""Regressors, inertial parameters and their forms; and the example that identifies a robot."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import libdyn as dyn

close = np.testing.assert_allclose
BALL = np.array([2, 0.1, 0, -0.1, 1.5, 0.1, 1.5, 0, 0, 1.5])
ROD = np.array([1, 0, 0, 0, 2, 0, 1, 0, 0, 1])


@pytest.mark.parametrize("robot", ["go2", "gripper", "arm"])
def test_regressors(robot, request):
    m = request.getfixturevalue(robot)
    q, v, a = m.random(3), np.cos(np.arange(m.nv)), np.sin(np.arange(m.nv))
    d, pi = m.data(), m.inertial_parameters()
    n = 10 * (m.njoints - 1)
    assert pi.shape == (n,) and np.isclose(pi[::10].sum(), m.total_mass)
    Y = d.joint_torque_regressor(q, v, a)
    assert Y.shape == (m.nv, n) and d.regressor.shape == (m.nv, n)
    close(Y @ pi + m.armature * a, d.rnea(q, v, a), atol=1e-10)
    close(d.joint_torque_regressor(q, 0 * v, 0 * a) @ pi, d.gravity_torque(q), atol=1e-10)
    close(d.compute_static_regressor(q) @ pi, d.compute_com(q), atol=1e-12)
    close(d.compute_kinetic_energy_regressor(q, v) @ pi + 0.5 * m.armature @ v**2, d.kinetic_energy(q, v), rtol=1e-12)
    close(d.compute_potential_energy_regressor(q) @ pi, d.potential_energy(q), atol=1e-11)


def test_bodies(arm):
    d = arm.data()
    q, v, a = [0.3, -0.4], [1, 2], [-1, 0.5]
    with pytest.raises(dyn.StaleError, match="call Data.forward_kinematics"):
        d.joint_body_regressor(1)
    d.forward_kinematics(q, v, a)
    last = d.joint_body_regressor("elbow")
    force = last @ arm.inertial_parameters()[10:]
    close(force[4], d.rnea(q, v, a)[1], atol=1e-12)  # about y, the axis of the last joint
    close(d.frame_body_regressor("elbow"), last, atol=1e-12)
    # of any body, from its motion
    R = d.frame_placement("elbow").rotation
    acceleration = d.frame_acceleration("elbow") - np.r_[R.T @ arm.gravity, 0, 0, 0]
    close(dyn.body_regressor(d.frame_velocity("elbow"), acceleration), last, atol=1e-12)


def test_forms_of_the_parameters():
    J = dyn.pseudo_inertia_from_parameters(BALL)
    close(J, J.T)
    close(J[:3, 3], BALL[1:4])
    close(np.trace(J[:3, :3]), 0.5 * (1.5 + 1.5 + 1.5))
    close(dyn.parameters_from_pseudo_inertia(J), BALL)
    theta = dyn.log_cholesky_from_parameters(BALL)
    close(np.exp(2 * theta[0]), BALL[0])
    close(dyn.parameters_from_log_cholesky(theta), BALL, atol=1e-14)
    jacobian, h = dyn.log_cholesky_jacobian(theta), 1e-6
    for k in range(10):
        step = h * np.eye(10)[k]
        difference = dyn.parameters_from_log_cholesky(theta + step) - dyn.parameters_from_log_cholesky(theta - step)
        close(jacobian[:, k], difference / (2 * h), atol=1e-8)
    assert dyn.is_physically_consistent(BALL) and not dyn.is_physically_consistent(ROD)


def test_refusals():
    with pytest.raises(dyn.InvalidRobotError, match="no body has these parameters"):
        dyn.log_cholesky_from_parameters(ROD)
    with pytest.raises(dyn.SizeError, match="pi"):
        dyn.is_physically_consistent(np.ones(9))
    with pytest.raises(dyn.NonFiniteError, match=r"theta\[3\]"):
        dyn.parameters_from_log_cholesky([0, 0, 0, np.nan, 0, 0, 0, 0, 0, 0])
    with pytest.raises(dyn.ArgumentError, match="not symmetric"):
        dyn.parameters_from_pseudo_inertia(np.triu(np.ones((4, 4))))


@pytest.fixture(scope="module")
def example():
    path = Path(__file__).resolve().parents[1] / "examples" / "identification.py"
    spec = importlib.util.spec_from_file_location("identification", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_example_recovers_what_torques_determine(example):
    figures = example.identify(noise=0)
    assert (figures["parameters"], figures["base parameters"]) == (90, 48)
    assert figures["guess"]["prediction error"] > 0.1
    assert figures["least squares"]["base error"] < 1e-12
    assert figures["least squares"]["prediction error"] < 1e-12


def test_example_with_noise(example):
    figures = example.identify(noise=0.05)
    least_squares, consistent = figures["least squares"], figures["consistent"]
    assert least_squares["prediction error"] < 1e-3 and consistent["prediction error"] < 1e-3
    assert least_squares["bodies that can exist"] < 9 and consistent["bodies that can exist"] == 9
    assert consistent["base error"] < min(0.02, least_squares["base error"])
