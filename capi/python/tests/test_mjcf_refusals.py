"""MJCF files that are refused, and physics of them that is reported because it is dropped."""

import libdyn as dyn
import pytest
from mjcf_pieces import BODY, HINGE


def test_report_and_strict():
    text = """<mujoco><worldbody><body name="a"><joint name="j" margin="1"/><geom size=".1"/></body><body name="b"><freejoint name="f"/><geom size=".1"/></body><camera/><light/></worldbody>
<deformable><flex name="t"/></deformable><equality><flex flex="t"/></equality><actuator><orientation name="m" joint="j"/></actuator>
<sensor><camprojection site="s" camera="c"/></sensor><custom/></mujoco>"""
    messages = [r.message for r in dyn.load_string(text).report]
    for part in ("<deformable>", "equality 'flex_0': <flex> is not supported", "actuator 'm': <orientation> is not supported",
                 "<sensor>", "<camera>"):
        assert any(part in m for m in messages), part
    with pytest.raises(dyn.Error, match="line 2: .*<deformable>"):
        dyn.load_string(text, strict=True)


# What acts and is not read: a line of the report each, and with strict an error that names it.
DROPPED = [
    ('<worldbody>{b}</worldbody><tendon><fixed name="t" stiffness="1 2"><joint joint="j" coef="1"/></fixed></tendon>',
     "<fixed stiffness>: terms of higher order"),
    ('<worldbody>{b}</worldbody><deformable><flex name="x"/></deformable>', "<deformable>: flex 'x'"),
    ('<worldbody>{b}</worldbody><extension><plugin plugin="p"/></extension>', "<extension>"),
    ('<worldbody>{b}</worldbody><equality><flex flex="x"/></equality>', "<flex> is not supported"),
    ('<worldbody>{b}</worldbody><actuator><muscle joint="j"/></actuator>', "has no limits: give lengthrange"),
    ('<worldbody>{b}</worldbody><actuator><orientation joint="j"/></actuator>', "<orientation> is not supported"),
    ('<worldbody>{b}</worldbody><actuator><general joint="j" dyntype="muscle"/></actuator>',
     "neither a first-order filter nor an integrator"),
    ('<worldbody>{b}</worldbody><actuator><general joint="j" biastype="muscle"/></actuator>', "bias is not affine"),
    ('<worldbody><body><joint type="free" stiffness="1"/><geom size=".1"/></body></worldbody>', "spring of a free joint"),
    ('<worldbody><body><joint type="free" springdamper="1 1"/><geom size=".1"/></body></worldbody>', "spring of a free joint"),
    ('<worldbody><body><joint stiffness="1 2"/><geom size=".1"/></body></worldbody>', "higher order"),
    ('<worldbody>{b}<body><composite type="cable"/></body></worldbody>', "composite"),
    ('<worldbody>{b}<flexcomp name="x" type="grid"/></worldbody>', "flexcomp"),
]


@pytest.mark.parametrize("text, message", DROPPED, ids=[m for _, m in DROPPED])
def test_what_is_dropped_is_listed_and_an_error_when_strict(text, message):
    text = "<mujoco>\n" + text.format(b=BODY) + "</mujoco>"
    lines = [r for r in dyn.load_string(text).report if message in r.message]
    assert lines and lines[0].line == 2 and lines[0].level == dyn.ReportLevel.DROPPED
    with pytest.raises(dyn.Error, match="line 2") as error:
        dyn.load_string(text, strict=True)
    assert message in str(error.value)


@pytest.mark.parametrize("text, message", [
    ("<mujoco><worldbody>" + BODY + BODY + "</worldbody></mujoco>", "the name 'j?a?'|taken"),
    ('<mujoco><worldbody><joint/></worldbody></mujoco>', "the world has no joints"),
    ('<mujoco><worldbody><body><freejoint/><geom size=".1"/><body><freejoint/><geom '
     'size=".1"/></body></body></worldbody></mujoco>', "a free joint belongs to a body of the world"),
    ('<mujoco><worldbody><body><joint/><freejoint/><geom size=".1"/></body></worldbody></mujoco>', "only joint"),
    ('<mujoco><worldbody><body><joint type="screw"/></body></worldbody></mujoco>', "hinge, slide, ball or free"),
    ('<mujoco><worldbody><body><joint axis="0 0 0"/></body></worldbody></mujoco>', "no direction"),
    ('<mujoco><worldbody><body><joint range="1 -1"/></body></worldbody></mujoco>', "not below"),
    ('<mujoco><worldbody><body><joint limited="true"/></body></worldbody></mujoco>', "needs range"),
    ('<mujoco><compiler autolimits="false"/><worldbody><body><joint range="0 1"/></body></worldbody></mujoco>', "autolimits"),
    ('<mujoco><worldbody><body><joint limited="maybe"/></body></worldbody></mujoco>', "true or false"),
    ('<mujoco><worldbody><body><joint damping="-1"/></body></worldbody></mujoco>', "negative"),
    ('<mujoco><worldbody><body><joint springdamper="0 1"/></body></worldbody></mujoco>', "both positive"),
    ('<mujoco><worldbody><body><joint springdamper="1 -1"/></body></worldbody></mujoco>', "both positive"),
    ('<mujoco><worldbody><body><joint springdamper="1"/></body></worldbody></mujoco>', "1 number where 2"),
    ('<mujoco><worldbody><body><joint springdamper="nan 1"/></body></worldbody></mujoco>', "nan"),
    ('<mujoco><worldbody><body><joint springdamper="1e-200 1"/><geom size=".1"/></body></worldbody></mujoco>',
     "no finite stiffness"),
    ('<mujoco><worldbody><body><joint springdamper="1 1"/></body></worldbody></mujoco>', "mass"),
    ('<mujoco><worldbody><body><joint type="ball" range="5 40"/><geom size=".1"/></body></worldbody></mujoco>', "begins at 0"),
    ('<mujoco><worldbody><body><joint type="ball" range="0 -40"/><geom size=".1"/></body></worldbody></mujoco>', "not below"),
    ('<mujoco><worldbody><body><joint type="ball" range="-40 40"/><geom size=".1"/></body></worldbody></mujoco>', "begins at 0"),
    ('<mujoco><worldbody><body><joint type="ball" range="0 1e-9"/><geom size=".1"/></body></worldbody></mujoco>', "below 1"),
    ('<mujoco><worldbody><body><joint type="ball" range="0 nan"/><geom size=".1"/></body></worldbody></mujoco>', "nan"),
    ('<mujoco><worldbody>' + BODY + '</worldbody><actuator><intvelocity joint="j" actrange="1 -1"/></actuator></mujoco>',
     "above the upper"),
    ('<mujoco><worldbody>' + BODY
     + '</worldbody><actuator><general joint="j" dyntype="integrator" actlimited="true"/></actuator></mujoco>', "needs actrange"),
    ('<mujoco><worldbody>' + BODY + '</worldbody><actuator><intvelocity joint="j" kp="nan"/></actuator></mujoco>', "nan"),
    ('<mujoco><worldbody>' + BODY + '</worldbody><actuator><intvelocity joint="j" kp="-1"/></actuator></mujoco>', "negative"),
    ('<mujoco><worldbody>' + BODY + '</worldbody><actuator><cylinder joint="j" bias="1 2"/></actuator></mujoco>',
     "2 numbers where 3"),
    ('<mujoco><worldbody><body><joint armature="nan"/></body></worldbody></mujoco>', "nan"),
    ('<mujoco><worldbody><geom type="blob" size="1"/></worldbody></mujoco>', "<geom type> is 'blob'"),
    ('<mujoco><worldbody><geom type="box" size="1 1"/></worldbody></mujoco>', "needs 3 numbers"),
    ('<mujoco><worldbody><geom size="-1"/></worldbody></mujoco>', "positive"),
    ('<mujoco><worldbody><geom size="1e400"/></worldbody></mujoco>', "1e400"),
    ('<mujoco><worldbody><geom type="capsule" size="1" fromto="0 0 0 0 0 0"/></worldbody></mujoco>', "same point"),
    ('<mujoco><worldbody><geom size="1" mass="-1"/></worldbody></mujoco>', "negative"),
    ('<mujoco><worldbody><geom size="1" contype="1.5"/></worldbody></mujoco>', "integer of 32 bits"),
    ('<mujoco><worldbody><geom size="1" class="no"/></worldbody></mujoco>', "no class 'no'"),
    ('<mujoco><worldbody><body childclass="no"/></worldbody></mujoco>', "no class 'no'"),
    ('<mujoco><worldbody><geom type="mesh" mesh="no"/></worldbody></mujoco>', "no mesh 'no'"),
    ('<mujoco><worldbody><geom type="hfield" hfield="no"/></worldbody></mujoco>', "no height field 'no'"),
    ('<mujoco><worldbody><body quat="0 0 0 0"/></worldbody></mujoco>', "no rotation"),
    ('<mujoco><worldbody><body quat="1 0 0 0" euler="0 0 0"/></worldbody></mujoco>', "twice"),
    ('<mujoco><worldbody><body pos="1 2"/></worldbody></mujoco>', "2 numbers where 3"),
    ('<mujoco><compiler angle="turns"/></mujoco>', "degree or radian"),
    ('<mujoco><compiler eulerseq="xyzx"/></mujoco>', "three of x, y, z"),
    ('<mujoco><compiler coordinate="global"/></mujoco>', "local coordinates"),
    ('<mujoco><worldbody><body><joint/><inertial pos="0 0 0" mass="-1"/></body></worldbody></mujoco>', "negative"),
    ('<mujoco><worldbody><body><joint/><inertial mass="1"/></body></worldbody></mujoco>', "no attribute pos"),
    ('<mujoco><worldbody><body><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 9"/></body></worldbody></mujoco>',
     "impossible"),
    ('<mujoco><worldbody><body><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 -1"/></body></worldbody></mujoco>',
     "negative principal"),
    ('<mujoco><worldbody><body name="b"><joint name="j"/></body></worldbody></mujoco>', "mass"),
    ('<mujoco><worldbody><replicate count="0"><geom size="1"/></replicate></worldbody></mujoco>', "integer from 1"),
    ('<mujoco><worldbody><replicate count="1e9"><geom size="1"/></replicate></worldbody></mujoco>', "integer from 1"),
    ('<mujoco><worldbody><attach model="no"/></worldbody></mujoco>', "no model 'no'"),
    ('<mujoco><include file="/nowhere/x.xml"/></mujoco>', "does not exist"),
    ('<mujoco><contact><exclude body1="a" body2="b"/></contact></mujoco>', "no body 'a'"),
    ('<mujoco><worldbody>' + BODY + '</worldbody><keyframe><key qpos="1 2"/></keyframe></mujoco>', "2 numbers"),
    ('<mujoco><default><default class="c"/><default class="c"/></default></mujoco>', "there already"),
    ('<mujoco><asset><mesh name="m"/><mesh name="m"/></asset></mujoco>', "two of this name"),
    ('<mujoco><asset><mesh name="m" vertex="0 0 0 1 1"/></asset><worldbody><body><joint/><geom type="mesh" '
     'mesh="m"/></body></worldbody></mujoco>', "three numbers a vertex"),
    ('<mujoco><asset><mesh name="m" vertex="0 0 0 1 1 1" face="0 1 2"/></asset><worldbody><body><joint/><geom type="mesh" '
     'mesh="m"/></body></worldbody></mujoco>', "vertex 2 does not exist"),
    ('<mujoco><asset><mesh name="m" vertex="0 0 0 1 1 1"/></asset><worldbody><body><joint/><geom type="mesh" '
     'mesh="m"/></body></worldbody></mujoco>', "fewer than four|four points"),
    ('<mujoco><asset><mesh name="m" file="none.stl"/></asset><worldbody><body><joint/><geom type="mesh" '
     'mesh="m"/></body></worldbody></mujoco>', "none.stl"),
    ('<mujoco><asset><hfield name="h" nrow="2" ncol="2" elevation="1 2 3" size="1 1 1 1"/></asset><worldbody><geom '
     'type="hfield" hfield="h"/></worldbody></mujoco>', "3 numbers where 4"),
    ('<mujoco><asset><hfield name="h" nrow="1" ncol="2" size="1 1 1 1"/></asset><worldbody><geom type="hfield" '
     'hfield="h"/></worldbody></mujoco>', "at least 2"),
    ('<mujoco><asset><hfield name="h" nrow="1e5" ncol="1e5" size="1 1 1 1"/></asset><worldbody><geom type="hfield" '
     'hfield="h"/></worldbody></mujoco>', "at most"),
    ("<mujocoinclude/>", "a part of an MJCF model"),
    ("<mujoco><worldbody>", "closed"),
])
def test_bad_models(text, message):
    with pytest.raises(dyn.Error, match=message):
        dyn.load_string(text)


def test_files_that_include_and_attach_themselves(tmp_path):
    (tmp_path / "a.xml").write_text('<mujoco><include file="b.xml"/></mujoco>')
    (tmp_path / "b.xml").write_text('<mujocoinclude><include file="b.xml"/></mujocoinclude>')
    with pytest.raises(dyn.Error, match="b.xml:1: .*a second time"):
        dyn.load(tmp_path / "a.xml")
    (tmp_path / "c.xml").write_text('<mujoco><asset><model name="c" file="c.xml"/></asset><worldbody><attach '
                                    'model="c"/></worldbody></mujoco>')
    with pytest.raises(dyn.Error, match="attaches itself"):
        dyn.load(tmp_path / "c.xml")
    (tmp_path / "d.xml").write_text('<mujoco><include file="e.xml"/></mujoco>')
    (tmp_path / "e.xml").write_text('<mujoco><worldbody>\n<geom size="x"/></worldbody></mujoco>')
    with pytest.raises(dyn.Error, match="e.xml:2: .*'x'"):
        dyn.load(tmp_path / "d.xml")


@pytest.mark.parametrize(("text", "what"), [
    (HINGE + '<option actuatorgroupdisable="0"/>', "actuatorgroupdisable"),
    (HINGE + '<actuator><motor joint="j" delay="0.5" nsample="3"/></actuator>', "delay"),
    ('<worldbody><body><freejoint align="true"/><geom size=".1" pos="1 2 3"/></body></worldbody>', "not aligned"),
    ('<compiler alignfree="true"/><worldbody><body><freejoint/><geom size=".1" pos="1 2 3"/></body></worldbody>', "not aligned"),
    ('<worldbody><body><joint type="free" armature="1"/><geom size=".1"/></body></worldbody>', "armature of a free joint"),
])
def test_physics_that_is_not_used_is_reported(text, what):
    text = f"<mujoco>{text}</mujoco>"
    assert any(what in r.message and r.level != dyn.ReportLevel.INFO for r in dyn.load_string(text).report)
    with pytest.raises(dyn.Error, match=what):
        dyn.load_string(text, strict=True)


@pytest.mark.parametrize(("text", "message"), [
    ('<option><flag gravity="disabled"/></option>', "enable or disable is expected"),
    ('<worldbody><body name="world"><joint/><geom size=".1"/></body></worldbody>', "the world has this name"),
    ('<worldbody><body mocap="true"><joint/><geom size=".1"/></body></worldbody>', "a mocap body has no joints"),
    ('<worldbody><body><joint/><geom size=".1"/><body mocap="true"><geom size=".1"/></body></body></worldbody>',
     "a mocap body is a child of the world"),
    (HINGE + '<actuator><position joint="j" kv="-1"/></actuator>', "it is negative"),
])
def test_what_mujoco_refuses_is_refused(text, message):
    with pytest.raises(dyn.Error, match=message):
        dyn.load_string(f"<mujoco>{text}</mujoco>")
