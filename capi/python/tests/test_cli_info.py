"""`dyn info`: what a robot is."""

import math
from ctypes import byref

import numpy as np
from command import GO2, ROBOTS, answer, arm_file, pytestmark, run  # noqa: F401 (fixtures)
from conftest import ARM

from libdyn import abi, enums
from libdyn.library import lib


def effects_with_numbers():
    """Names of the effects that have an array of the model, in the order of their bits."""
    info = abi.EffectTypeInfo()
    bits = (e for e in enums.Effect if lib.dyn_effect_type_info(e, byref(info)) == 0)  # the others are sets
    return [info.name.decode() for _ in bits if info.array >= 0]


def test_info(go2):
    info = answer("info", GO2, "--floating")
    keys = ["name", "nq", "nv", "gravity", "total_mass", "joints", "frames", "effects", "report", "model_bytes", "data_bytes"]
    assert [k for k in info if k in keys] == keys
    assert (info["name"], info["nq"], info["nv"], info["gravity"]) == (go2.name, 19, 18, [0, 0, -9.81])
    assert info["total_mass"] == go2.total_mass and info["model_bytes"] == go2.size and info["data_bytes"] == go2.data_size()
    assert [j["name"] for j in info["joints"]] == [j.name for j in go2.joints]
    assert (info["joints"][0]["name"], info["joints"][0]["type"], info["frames"][0]["name"]) == ("universe",) * 3
    for said, known in zip(info["joints"][1:], go2.joints[1:]):
        assert said["type"].upper() == known.type.name
        for key in ("parent", "idx_q", "idx_v", "nq", "nv"):
            assert said[key] == getattr(known, key)
        limits = said["limits"]
        lower = [-math.inf if x is None else x for x in limits["lower"]]
        np.testing.assert_array_equal(lower, go2.lower_limit[known.idx_q : known.idx_q + known.nq])
        assert len(limits["velocity"]) == len(limits["effort"]) == known.nv
    assert [(f["name"], f["type"], f["joint"]) for f in info["frames"]][1:] == [
        (f.name, f.type.name, f.joint) for f in go2.frames
    ][1:]
    assert [e["name"] for e in info["effects"]] == ["gravity", *effects_with_numbers(), "limits", "contact", "constraints",
                                                    "actuators", "tendons", "fluid", "fluid_ellipsoids",
                                                    "gravity_compensation", "mimic", "sleeping"]  # fmt: skip
    assert all(isinstance(e["active"], bool) and e["reason"] and e["bytes"] >= 0 for e in info["effects"])
    assert all(set(e) == {"level", "message", "line"} for e in info["report"])
    assert ([e["level"] for e in info["report"] if "not applied" in e["message"] and "12 x effort limit" in e["message"]]
            == ["info"])


def test_info_for_people(arm_file):
    text = run("info", arm_file, "--fixed")
    for word in ("shoulder", "continuous", "[-2, 2.5]", "tool", "gravity", "load report", "nq 2"):
        assert word in text


def test_info_options(arm_file, tmp_path):
    assert answer("info", arm_file, "--fixed", "--cos-sin")["nq"] == 3
    arm_file.write_text(
        ARM.replace(
            '<link name="base"/>',
            '<link name="base"><visual><geometry><mesh filename="package://p/a.stl"/></geometry></visual></link>',
        )
    )
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "a.stl").write_text("solid a\nendsolid a\n")
    info = answer("info", arm_file, "--fixed", "--package-dir", tmp_path / "elsewhere", "--package-dir", tmp_path)
    assert any(s["mesh"].endswith("a.stl") for s in info["shapes"])


def test_mimic_in_info():
    info = answer("info", ROBOTS / "gripper.urdf", "--fixed")
    assert [e["active"] for e in info["effects"] if e["name"] == "mimic"] == [True]
    thumb = next(j for j in info["joints"] if j["name"] == "thumb_joint")
    assert thumb["mimic"] == {"leader": "left_knuckle_joint", "ratio": 0.5, "offset": 0.2} and thumb["nv"] == 0


TENDONS = """<mujoco><worldbody><site name="hook" pos=".3 0 0"/><body name="b"><joint name="j" axis="0 1 0"/><site name="s" pos="0 0 -.4"/>
<geom size=".1" pos="0 0 -.5"/></body></worldbody><tendon><spatial name="cord" stiffness="20" limited="true" range="0 2"><site site="hook"/>
<site site="s"/></spatial><fixed name="angle"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor name="pull" tendon="cord"/>
<motor name="turn" joint="j"/></actuator></mujoco>"""


def test_tendons_and_actuators_in_info(tmp_path):
    file = tmp_path / "t.xml"
    file.write_text(TENDONS)
    info = answer("info", file)
    cord, angle = info["tendons"]
    assert (cord["name"], cord["type"], cord["stiffness"], cord["range"], cord["length"]) == ("cord", "spatial", 20, [0, 2], 0.5)
    assert cord["elements"] == [{"type": "site", "name": "hook"}, {"type": "site", "name": "s"}]
    assert angle["elements"] == [{"type": "joint", "name": "j", "value": 2}] and angle["range"] == [None, None]
    assert info["actuators"] == [{"name": "pull", "type": "motor", "transmission": "tendon", "target": "cord"},
                                 {"name": "turn", "type": "motor", "transmission": "joint", "target": "j", "component": 0}]
    assert [e["reason"] for e in info["effects"] if e["name"] == "tendons"] == ["1 of 2 tendons have forces of their own"]
    text = run("info", file)
    assert "stiffness 20, within [0, 2], driven by pull" in text and "tendon cord" in text
    plain = run("info", ROBOTS / "gripper.urdf", "--fixed")
    assert "\ntendons\n" not in plain and "\nactuators\n" not in plain and "no tendon has a force of its own" in plain
    found = answer("eval", file, "--q", "0.2", "--v", "3", "--compute", "tendons,tendon_length")
    assert found["tendons"]["angle"] == {"length": 0.4, "velocity": 6.0, "J": [2.0]}
    assert found["tendon_length"] == [t["length"] for t in found["tendons"].values()]
