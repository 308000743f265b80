"""`dyn eval`: quantities of a state, for programs and people."""

import numpy as np
import pytest
from command import GO2, ROBOTS, answer, arm_file, pytestmark, run, state_file  # noqa: F401 (fixtures)

ALL = (
    "tau,ddq,M,Minv,nle,g,static_torque,coriolis,com,vcom,acom,Jcom,subtree_com,energy,placements,J,dJ,"
    "frame_velocity,frame_acceleration,frame_classical_acceleration"
)


def test_eval_everything(go2, state, state_file):
    q, v, a, tau = state
    path = state_file({"q": q.tolist(), "v": v.tolist(), "a": a.tolist(), "tau": tau.tolist()})
    frame = go2.frame_name(go2.nframes - 1)
    found = answer(
        "eval", GO2, "--floating", "--compute", ALL, "--state", path, "--frame", frame, "--reference", "LOCAL_WORLD_ALIGNED"
    )
    assert list(found) == ALL.split(",")
    d, r = go2.data(), "LOCAL_WORLD_ALIGNED"
    expected = {
        "tau": d.rnea(q, v, a), "ddq": d.aba(q, v, tau), "M": d.crba(q), "Minv": d.minv(q), "nle": d.compute_nle(q, v),
        "g": d.gravity_torque(q), "static_torque": d.compute_static_torque(q), "coriolis": d.coriolis_matrix(q, v),
        "com": d.compute_com(q, v, a), "vcom": d.vcom.copy(), "acom": d.acom.copy(), "Jcom": d.jcom(q),
    }  # fmt: skip
    d.forward_kinematics(q, v, a)
    expected |= {
        "J": d.frame_jacobian(frame, r), "dJ": d.frame_jacobian_time_variation(frame, r),
        "frame_velocity": d.frame_velocity(frame, r), "frame_acceleration": d.frame_acceleration(frame, r),
        "frame_classical_acceleration": d.frame_classical_acceleration(frame, r),
    }  # fmt: skip
    for name, value in expected.items():
        np.testing.assert_array_equal(found[name], value, name)
    X = d.frame_placement(frame)
    np.testing.assert_array_equal(found["placements"][frame]["rotation"], X.rotation)
    np.testing.assert_array_equal(found["placements"][frame]["translation"], X.translation)
    energy = d.energy(q, v)
    assert found["energy"] == {"kinetic": energy.kinetic, "potential": energy.potential, "mechanical": sum(energy)}
    d.compute_com(q)
    com, mass = d.subtree_com(2)
    assert found["subtree_com"][go2.joint_name(2)] == {"com": com.tolist(), "mass": mass}


@pytest.mark.parametrize("robot", ["go2", "gripper"])
@pytest.mark.parametrize("name", ALL.split(","))
def test_eval_one_by_one(robot, name):
    """Each quantity asks for the parts that it needs."""
    base = "--floating" if robot == "go2" else "--fixed"
    frame = "base" if robot == "go2" else "thumb"
    assert list(answer("eval", ROBOTS / f"{robot}.urdf", base, "--compute", name, "--frame", frame)) == [name]


def test_eval_defaults(go2):
    found = answer("eval", GO2, "--floating", "--compute", "tau,placements", "--compute", "J")
    np.testing.assert_array_equal(found["tau"], go2.data().rnea(go2.neutral(), np.zeros(18), np.zeros(18)))
    assert len(found["placements"]) == go2.nframes and set(go2.frame_name(i) for i in range(go2.nframes)) <= set(
        found["placements"]
    )
    np.testing.assert_array_equal(found["J"], go2.data().joint_jacobians(go2.neutral()))


def test_eval_lists(arm_file, arm):
    expected = arm.data().rnea([-0.5, 0.25], [1, -2], [0.5, 1e-3]).tolist()
    for q in (["-0.5", "0.25"], ["-0.5,0.25"], ["-0.5,", "+0.25"], ["[-0.5, .25]"], [" -0.5 , 0.25 "]):
        assert (
            answer("eval", arm_file, "--fixed", "--compute", "tau", "--q", *q, "--v", "1,-2", "--a=0.5,1e-3")["tau"] == expected
        )


def test_eval_for_people(arm_file):
    text = run("eval", arm_file, "--fixed", "--compute", "M,energy,com")
    assert "M\n" in text and "kinetic" in text and "com\n" in text
