"""`dyn effects`: what acts in a robot."""

import math

import pytest
from command import answer, pytestmark, run  # noqa: F401 (fixtures)

DAMPED = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="continuous"><parent link="a"/>
<child link="b"/><axis xyz="0 0 1"/><dynamics damping="0.5" friction="0.25"/></joint></robot>"""


def test_effects(tmp_path):
    robot = tmp_path / "r.urdf"
    robot.write_text(DAMPED)

    def final(*more):
        found = answer("sim", robot, "--fixed", "--duration", "1", "--dt", "1e-4", "--v", "2", *more)
        return found["v"][0], {e["name"] for e in found["effects"] if e["active"]}

    assert final("--effects", "none") == (pytest.approx(2), {"gravity"})
    assert final() == final("--effects", "all")
    warnings = answer("sim", robot, "--fixed", "--duration", "0.01", "--effects", "armature")["warnings"]
    assert [w.split(":")[0] for w in warnings if "--effects" in w] == ["damping", "friction"]
    v, active = final("--effects", "damping")
    assert v == pytest.approx(2 * math.exp(-0.5), rel=1e-4) and active == {"gravity", "damping"}
    v, active = final("--effects", "all")
    assert v == pytest.approx(2.5 * math.exp(-0.5) - 0.5, rel=1e-3) and active == {"gravity", "damping", "friction"}
    for effects, tau in {"armature": 0, "damping": 1, "friction,damping": 1.25, "all": 1.25}.items():
        found = answer("eval", robot, "--fixed", "--compute", "tau", "--v", "2", "--effects", effects)
        assert found["tau"] == pytest.approx([tau])
    for command in (["sim", "--duration", "1"], ["eval", "--compute", "tau"], ["bench"]):
        assert "wind" in run(command[0], robot, "--fixed", *command[1:], "--effects", "wind", status=2)
