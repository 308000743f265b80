"""`dyn eval`: momentum, regressors and derivatives."""

import numpy as np
import pytest
from command import GO2, ROBOTS, answer, pytestmark, state_file  # noqa: F401 (fixtures)

CENTROIDAL = "Ag,dAg,hg,dhg,Ig,dh_dq,dhdot_dq,dhdot_dv"


DERIVATIVES = "dtau_dq,dtau_dv,ddq_dq,ddq_dv,ddq_dtau"
REGRESSORS = "regressor,static_regressor,kinetic_energy_regressor,potential_energy_regressor,inertial_parameters"


def test_eval_centroidal_and_regressors(go2, state, state_file):
    q, v, a, _ = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist()})
    found = answer("eval", GO2, "--floating", "--compute", f"{CENTROIDAL},{REGRESSORS}", "--state", path)
    d = go2.data()
    c, pi = d.centroidal(q, v, a), go2.inertial_parameters().reshape(-1, 10)
    expected = c._asdict() | d.centroidal_derivatives(q, v, a)._asdict() | {
        "regressor": d.joint_torque_regressor(q, v, a), "static_regressor": d.compute_static_regressor(q),
        "kinetic_energy_regressor": d.compute_kinetic_energy_regressor(q, v),
        "potential_energy_regressor": d.compute_potential_energy_regressor(q),
    }  # fmt: skip
    Ig = found.pop("Ig")
    np.testing.assert_allclose(Ig["inertia"], c.Ig[3:, 3:], atol=1e-14)
    np.testing.assert_allclose(Ig["com"], d.compute_com(q), atol=1e-14)
    assert abs(Ig["mass"] - go2.total_mass) < 1e-12
    for i, (joint, parameters) in enumerate(found.pop("inertial_parameters").items()):
        assert joint == go2.joint_name(i + 1) and parameters == pi[i].tolist()
    assert found.keys() == set(f"{CENTROIDAL},{REGRESSORS}".split(",")) - {"Ig", "inertial_parameters"}
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-12, err_msg=name)


OF_FRAMES = "dv_dq,da_dq,da_dv,dclassical_dq,dclassical_dv,kinematic_hessian"
SECOND_ORDER = "d2tau_dqdq,d2tau_dvdv,d2tau_dqdv,d2tau_dadq"


def test_eval_derivatives_of_frames_and_second_order(go2, state, state_file):
    q, v, a, _ = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist()})
    names = f"{OF_FRAMES},dvcom_dq,dg_dq,dstatic_torque_dq,{SECOND_ORDER}"
    found = answer("eval", GO2, "--floating", "--compute", names, "--state", path, "--frame", "FL_foot", "--reference", "WORLD")
    d, of = go2.data(), ("FL_foot", "WORLD")
    d.forward_kinematics(q, v, a)
    acceleration, classical = d.frame_acceleration_derivatives(*of), d.frame_classical_acceleration_derivatives(*of)
    expected = d.rnea_second_order_derivatives(q, v, a)._asdict() | {
        "dv_dq": d.frame_velocity_derivatives(*of).dv_dq, "da_dq": acceleration.da_dq, "da_dv": acceleration.da_dv,
        "dclassical_dq": classical.da_dq, "dclassical_dv": classical.da_dv,
        "kinematic_hessian": d.frame_kinematic_hessian(*of).transpose(2, 0, 1), "dg_dq": d.gravity_torque_derivatives(q),
        "dvcom_dq": d.vcom_derivatives(q, v).dvcom_dq, "dstatic_torque_dq": d.static_torque_derivatives(q),
    }  # fmt: skip
    assert found.keys() == expected.keys() == set(names.split(","))
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-11, err_msg=name)


@pytest.mark.parametrize("name", f"{OF_FRAMES},dvcom_dq,dg_dq,dstatic_torque_dq,{SECOND_ORDER}".split(","))
@pytest.mark.parametrize("robot", ["go2", "gripper"])
def test_eval_of_one_derivative_alone(robot, name):
    base, frame = ("--floating", "base") if robot == "go2" else ("--fixed", "thumb")
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name, "--frame", frame)) == [name]


def test_eval_derivatives(go2, state, state_file):
    q, v, a, tau = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist(), "tau": tau.tolist()})
    found = answer("eval", GO2, "--floating", "--compute", DERIVATIVES, "--state", path)
    d = go2.data()
    expected = d.rnea_derivatives(q, v, a)._asdict() | d.aba_derivatives(q, v, tau)._asdict()
    assert list(found) == DERIVATIVES.split(",")
    for name, value in found.items():
        np.testing.assert_allclose(value, expected[name], atol=1e-9, err_msg=name)


@pytest.mark.parametrize("name", f"{CENTROIDAL},{REGRESSORS},{DERIVATIVES}".split(","))
@pytest.mark.parametrize("robot", ["go2", "gripper"])
def test_eval_of_one_quantity_alone(robot, name):
    base = "--floating" if robot == "go2" else "--fixed"
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name)) == [name]
