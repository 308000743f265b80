"""The Fetch scenes of gymnasium-robotics, whose gripper is welded to a mocap body, beside MuJoCo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import libdyn as dyn

mujoco = pytest.importorskip("mujoco")
gymnasium_robotics = pytest.importorskip("gymnasium_robotics")

GRIPPER = "robot0:gripper_link"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["reach", "push", "pick_and_place", "slide"])
def test_the_gripper_follows_the_mocap_body(name):
    path = str(Path(gymnasium_robotics.__file__).parent / "envs/assets/fetch" / f"{name}.xml")
    theirs = mujoco.MjModel.from_xml_path(path)
    state = mujoco.MjData(theirs)
    mujoco.mj_forward(theirs, state)
    body = mujoco.mj_name2id(theirs, mujoco.mjtObj.mjOBJ_BODY, GRIPPER)
    m = dyn.load(path)
    assert m.mocap_names == ["robot0:mocap"] and not any("mocap" in r.message for r in m.report)
    d = m.data()

    def gripper():
        d.forward_kinematics(), d.frame_placements()
        return d.placements[9:, m.frame_id(GRIPPER)].copy()

    start = state.xpos[body].copy()
    relative = theirs.eq_data[0, 3:6]  # the weld's, both unturned
    np.testing.assert_allclose(gripper(), start, atol=1e-12)
    steps, lag, apart = round(1 / theirs.opt.timestep), 0.0, 0.0
    for k in range(2 * steps):
        s = min(1, k / steps)
        target = start + s * np.array([-0.1, 0.1 * np.sin(np.pi * s), 0.1])
        state.mocap_pos[0], state.mocap_quat[0] = target - relative, (1, 0, 0, 0)
        d.set_mocap("robot0:mocap", target - relative)
        mujoco.mj_step(theirs, state), d.step()
        if k < steps:
            mujoco.mj_kinematics(theirs, state)
            lag, apart = max(lag, np.abs(gripper() - target).max()), max(apart, np.abs(gripper() - state.xpos[body]).max())
    mujoco.mj_kinematics(theirs, state)
    assert lag < 2e-3  # a step of the target is 0.5 mm; welds here are rigid
    assert apart < 0.03  # MuJoCo's soft weld lags by up to 17 mm
    np.testing.assert_allclose(gripper(), target, atol=1e-6)
    np.testing.assert_allclose(gripper(), state.xpos[body], atol=1e-3)
