"""MJCF models: against MuJoCo's figures (tests/mjcf/generate.py makes golden.json), and what bad ones get."""

import json
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest

MJCF = Path(__file__).resolve().parents[3] / "tests" / "mjcf"
GOLDEN = json.loads((MJCF / "golden.json").read_text())["models"]
FREE, BALL = 0, 1
TIGHT = 1e-11
AXES = 1e-9  # MuJoCo's principal axes of inertia are iterated, to about 1e-10


@pytest.fixture(scope="module", params=GOLDEN)
def both(request):
    return dyn.load(MJCF / "models" / request.param), GOLDEN[request.param]


def configuration(golden, qpos):
    q = np.array(qpos)
    for j in golden["joints"]:
        if j["type"] in (FREE, BALL):
            k = j["qpos"] + (3 if j["type"] == FREE else 0)
            q[k : k + 4] = np.roll(q[k : k + 4], -1)  # (w, x, y, z) to (x, y, z, w)
    return q


def velocity_map(golden, q):
    """v = T v_MuJoCo, and the acceleration that MuJoCo's zero acceleration is, for a velocity v."""
    T = np.eye(golden["nv"])
    for j in golden["joints"]:
        if j["type"] == FREE:
            x, y, z, w = q[j["qpos"] + 3 : j["qpos"] + 7]
            R = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                          [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                          [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
            T[j["dof"] : j["dof"] + 3, j["dof"] : j["dof"] + 3] = R.T

    def zero_acceleration(v):
        a = np.zeros(golden["nv"])
        for j in golden["joints"]:
            if j["type"] == FREE:
                k = j["dof"]
                a[k : k + 3] = -np.cross(v[k + 3 : k + 6], v[k : k + 3])
        return a

    return T, zero_acceleration


def close(a, b):
    a, b = np.asarray(a), np.asarray(b)
    assert np.abs(a - b).max() <= TIGHT * max(1.0, np.abs(b).max())


def test_sizes_and_masses(both):
    model, golden = both
    assert (model.nq, model.nv) == (golden["nq"], golden["nv"])
    close(model.gravity, golden["gravity"])
    for name, body in golden["bodies"].items():
        frame = model.frame(model.frame_id(name, "BODY"))
        assert frame.mass == pytest.approx(body["mass"], rel=TIGHT)
        close(frame.com, body["com"])
        scale = np.abs(body["inertia"]).max()
        assert np.abs(np.reshape(frame.inertia, (3, 3)) - body["inertia"]).max() <= AXES * scale


def test_dynamics(both):
    model, golden = both
    d = model.data()
    for s in golden["states"]:
        q = configuration(golden, s["qpos"])
        T, zero_acceleration = velocity_map(golden, q)
        v = T @ s["qvel"]
        close(T.T @ d.crba(q) @ T, s["M"])
        close(T.T @ d.rnea(q, v, zero_acceleration(v)), s["bias"])
        d.forward_kinematics(q)
        placements = d.frame_placements()
        for k, name in enumerate(golden["bodies"]):
            f = model.frame_id(name, "BODY")
            close(placements.translation[f], s["x"][k])
            close(placements.rotation[f].ravel(), s["R"][k])


def test_joints(both):
    model, golden = both
    for mine, theirs in ((model.damping, "damping"), (model.armature, "armature"), (model.friction, "friction")):
        close(mine, golden[theirs])
    for k, j in enumerate(golden["joints"]):
        if j["type"] == BALL:
            assert model.stiffness[j["dof"]] == pytest.approx(golden["stiffness"][k], rel=TIGHT)
            limit = model.lower_limit[j["qpos"] + 3]
            assert 2 * np.arccos(limit) == pytest.approx(j["range"][1], rel=1e-12) if j["range"] else limit == -np.inf
        if j["type"] in (FREE, BALL):
            continue
        limits = j["range"] or [-np.inf, np.inf]
        assert np.allclose([model.lower_limit[j["qpos"]], model.upper_limit[j["qpos"]]], limits, rtol=1e-15)
        assert model.stiffness[j["dof"]] == pytest.approx(golden["stiffness"][k])
        if golden["stiffness"][k]:
            assert model.spring_reference[j["qpos"]] == pytest.approx(golden["spring"][j["qpos"]], rel=1e-14)


def test_configurations_and_frames(both):
    model, golden = both
    close(model.configuration("qpos0") if "qpos0" in model.configurations else model.configuration("neutral"),
          configuration(golden, golden["qpos0"]))
    for name, qpos in golden["keys"].items():
        q = configuration(golden, qpos)
        for j in golden["joints"]:
            if j["type"] in (FREE, BALL):
                k = j["qpos"] + (3 if j["type"] == FREE else 0)
                q[k : k + 4] /= np.linalg.norm(q[k : k + 4])
        close(model.configuration(name), q)
    for site in golden["sites"]:
        assert model.frame_id(site) > 0


def test_collision_geometry():
    model = dyn.load(MJCF / "models" / "meshes.xml", meshes="hull")
    shapes = model.shapes
    assert [s.type.name for s in shapes] == ["HEIGHT_FIELD"] + ["CONVEX"] * 5
    assert any("not convex" in r.message for r in model.report)
    assert any("legacy" in r.message for r in model.report)
    assert [s.type.name for s in dyn.load(MJCF / "models" / "meshes.xml").shapes] == ["HEIGHT_FIELD"] + ["CONVEX"] * 5
    bare = dyn.load(MJCF / "models" / "meshes.xml", meshes="none")
    assert [s.type.name for s in bare.shapes] == ["HEIGHT_FIELD"] + ["MESH"] * 5
    tree = dyn.load(MJCF / "models" / "tree.xml")
    kinds = [(s.type.name, s.role.name) for s in tree.shapes]
    assert ("HALF_SPACE", "COLLISION") in kinds and ("BOX", "VISUAL") in kinds


BODY = '<body name="a"><joint name="j"/><geom size=".1"/></body>'


def test_report_and_strict():
    text = """<mujoco><worldbody><body name="a"><joint name="j" margin="1"/><geom size=".1"/></body><body name="b"><freejoint name="f"/><geom size=".1"/></body><camera/><light/></worldbody>
<tendon><spatial name="t"/></tendon><equality><tendon tendon1="t"/></equality><actuator><muscle name="m" joint="j"/></actuator>
<sensor><jointpos joint="j"/></sensor><custom/></mujoco>"""
    messages = [r.message for r in dyn.load_string(text).report]
    for part in ("<tendon>", "equality 'tendon_0': <tendon> is not supported", "actuator 'm': <muscle> is not supported",
                 "<sensor>", "<camera>"):
        assert any(part in m for m in messages), part
    with pytest.raises(dyn.Error, match="line 2: .*<tendon>"):
        dyn.load_string(text, strict=True)


# What acts and is not read: a line of the report each, and with strict an error that names it.
DROPPED = [
    ('<worldbody>{b}</worldbody><tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>', "<tendon>: fixed 't'"),
    ('<worldbody>{b}</worldbody><deformable><flex name="x"/></deformable>', "<deformable>: flex 'x'"),
    ('<worldbody>{b}</worldbody><extension><plugin plugin="p"/></extension>', "<extension>"),
    ('<worldbody>{b}</worldbody><equality><joint joint1="j"/></equality>', "joint equality without joint2"),
    ('<worldbody>{b}</worldbody><equality><flex flex="x"/></equality>', "<flex> is not supported"),
    ('<worldbody>{b}</worldbody><actuator><muscle joint="j"/></actuator>', "<muscle> is not supported"),
    ('<worldbody>{b}</worldbody><actuator><adhesion body="a"/></actuator>', "<adhesion> is not supported"),
    ('<worldbody>{b}</worldbody><actuator><damper joint="j" kv="1"/></actuator>', "<damper> is not supported"),
    ('<worldbody>{b}<body><site name="s"/></body></worldbody><actuator><motor site="s"/></actuator>', "it drives no joint"),
    ('<worldbody>{b}</worldbody><actuator><general joint="j" dyntype="muscle"/></actuator>',
     "neither a first-order filter nor an integrator"),
    ('<worldbody>{b}</worldbody><actuator><general joint="j" gaintype="affine" gainprm="1 2 0"/></actuator>',
     "gain depends on length"),
    ('<worldbody>{b}</worldbody><actuator><general joint="j" biastype="muscle"/></actuator>', "bias is not affine"),
    ('<worldbody><body><joint name="k" type="ball"/><geom size=".1"/></body></worldbody><actuator><motor joint="k" gear="1 1 '
     '0"/></actuator>', "several degrees of freedom"),
    ('<worldbody><body><freejoint name="k"/><geom size=".1"/></body></worldbody><actuator><motor joint="k" gear="1"/></actuator>',
     "axis of the world"),
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
    assert lines and lines[0].line == 2 and lines[0].level == dyn.ReportLevel.WARNING
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


def test_a_model_without_a_name_has_its_own(tmp_path):
    (tmp_path / "part.xml").write_text('<mujoco model="Arm"><worldbody>' + BODY + "</worldbody></mujoco>")
    (tmp_path / "m.xml").write_text('<mujoco><asset><model file="part.xml"/></asset><worldbody><attach model="Arm" body="a" '
                                    'prefix="x_"/></worldbody></mujoco>')
    assert dyn.load(tmp_path / "m.xml").joint_id("x_j") == 1
    (tmp_path / "part.xml").write_text("<mujoco><worldbody>" + BODY + "</worldbody></mujoco>")
    with pytest.raises(dyn.Error, match="no model 'Arm'"):
        dyn.load(tmp_path / "m.xml")


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


def test_binary_assets(tmp_path):
    """A box as MuJoCo's .msh, and a height field in a file."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], np.float32)
    faces = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                      [0, 6, 4], [1, 5, 7], [1, 7, 3]], np.int32)
    (tmp_path / "box.msh").write_bytes(np.array([8, 0, 0, 12], np.int32).tobytes() + corners.tobytes() + faces.tobytes())
    (tmp_path / "hills.bin").write_bytes(np.array([2, 3], np.int32).tobytes() + np.arange(6, dtype=np.float32).tobytes())
    text = """<mujoco><asset><mesh file="box.msh"/><hfield name="h" file="hills.bin" size="1 1 2 1"/></asset><worldbody><geom type="hfield" hfield="h"/>
<body name="b"><freejoint/><geom type="mesh" mesh="box" density="10"/></body></worldbody></mujoco>"""
    (tmp_path / "m.xml").write_text(text)
    model = dyn.load(tmp_path / "m.xml")
    body = model.frame(model.frame_id("b", "BODY"))
    assert body.mass == pytest.approx(60, rel=1e-14) and np.allclose(body.com, [0.5, 1, 1.5], rtol=1e-14)
    for cut in (3, 20, 60):
        (tmp_path / "box.msh").write_bytes((np.array([8, 0, 0, 12], np.int32).tobytes() + corners.tobytes())[:cut])
        with pytest.raises(dyn.Error, match="ends early"):
            dyn.load(tmp_path / "m.xml")
    (tmp_path / "box.msh").write_bytes(np.array([-1, 0, 0, 12], np.int32).tobytes())
    with pytest.raises(dyn.Error, match="not of MuJoCo's format"):
        dyn.load(tmp_path / "m.xml")


def test_constraint_slots():
    text = "<mujoco><worldbody>" + BODY + "</worldbody></mujoco>"
    assert dyn.load_string(text, constraint_slots=3).nconstraint_slots == 3


def test_a_free_joint_is_not_limited_whatever_its_class_says():
    m = dyn.load_string(
        "<mujoco><default><joint limited='true'/></default><worldbody><body><joint type='free'/><geom size='.1'/>"
        "<body><joint name='hinge' range='-10 10'/><geom size='.1'/></body></body></worldbody></mujoco>"
    )
    assert m.nq == 8 and m.lower_limit[7] == pytest.approx(-np.pi / 18)
    with pytest.raises(dyn.Error, match="needs range"):
        dyn.load_string("<mujoco><worldbody><body><joint type='hinge' limited='true'/><geom "
                        "size='.1'/></body></worldbody></mujoco>")


def test_actuators_that_integrate_and_cylinders():
    """As MuJoCo's compiler makes them: gainprm, biasprm, dyntype, actrange."""
    base = "<mujoco><worldbody><body><joint name='j' range='-10 20'/><geom size='.1'/></body></worldbody><actuator>{}</actuator></mujoco>"
    one = lambda text: dyn.load_string(base.format(text)).actuator(0)  # noqa: E731
    x = one("<intvelocity joint='j' kp='3' kv='2' actrange='-1 2' ctrlrange='-4 4'/>")
    assert ((x.type.name, x.kp, x.kv, x.integrates, x.act_range, x.control_range, x.idx_act)
            == ("POSITION", 3, 2, True, (-1, 2), (-4, 4), 0))
    x = one("<intvelocity joint='j' kp='3' inheritrange='1'/>")
    assert x.act_range == pytest.approx((-np.pi / 18, np.pi / 9)) and x.control_range == (-np.inf, np.inf)
    assert (one("<intvelocity joint='j' kp='3' dampratio='1' actrange='-1 1'/>").kv
            == pytest.approx(0.4483993, rel=1e-6))  # MuJoCo's
    assert one("<intvelocity joint='j'/>").act_range == (-np.inf, np.inf)
    x = one("<general joint='j' dyntype='integrator' gainprm='4' biastype='affine' biasprm='1 -2 -3' actlimited='true' "
            "actrange='0 5'/>")
    assert (x.gain, x.bias, x.integrates, x.act_range) == (4, (1, -2, -3), True, (0, 5))
    assert one("<general joint='j' dyntype='filter' dynprm='.3' actrange='0 5'/>").act_range == (0, 5)
    x = one("<cylinder joint='j' diameter='2' bias='1 -2 -3' timeconst='.2'/>")
    assert x.gain == pytest.approx(np.pi) and (x.bias, x.time_constant) == ((1, -2, -3), 0.2)
    assert one("<motor joint='j'/>").idx_act == -1


def test_an_integrated_control_moves_as_in_mujoco():
    """A servo whose target is the integral of its control follows it: at rest q is the integral, within its range."""
    m = dyn.load_string("<mujoco><option gravity='0 0 0'/><worldbody><body><joint name='j' damping='1'/><geom size='.1' "
                        "mass='1'/></body></worldbody><actuator><intvelocity joint='j' kp='50' kv='5' actrange='-1 "
                        ".4'/></actuator></mujoco>")  # fmt: skip
    d = m.data("simulation")
    d.set_step_options(dt=1e-3)
    d.set_control([0.5])
    for _ in range(400):
        d.step()
    assert d.act[0] == pytest.approx(0.2, abs=1e-12)
    for _ in range(3000):
        d.step()
    assert d.act[0] == 0.4 and d.q[0] == pytest.approx(0.4, abs=1e-6)


HINGE = '<worldbody><body name="b"><joint name="j" axis="0 1 0"/><geom size=".1" pos=".5 0 0"/></body></worldbody>'
BOXES = '<worldbody><body name="a"><joint name="ja"/><geom size=".1"/></body><body name="b" pos="0 0 1"><joint name="jb"/><geom size=".1"/></body></worldbody>'


def parameters(defaults, element):
    """gain and bias of an actuator as those of <general>."""
    a = dyn.load_string(f"<mujoco><default>{defaults}</default>{HINGE}<actuator>{element}</actuator></mujoco>").actuator(0)
    laws = {"motor": (1, (0, 0, 0)), "position": (a.kp, (0, -a.kp, -a.kv)), "velocity": (a.kv, (0, 0, -a.kv)),
            "affine": (a.gain, tuple(a.bias))}
    gain, bias = laws[a.type.name.lower()]
    return (gain, *bias, a.time_constant)


@pytest.mark.parametrize(("defaults", "element", "expected"),
                         [  # MuJoCo 4.0.0: actuator_gainprm[0], actuator_biasprm[:3], actuator_dynprm[0] of a filter
    ('<general gainprm="10" biastype="affine" biasprm="4 -10 -1"/>', '<position joint="j"/>', (10, 0, -10, -1, 0)),
    ('<general gainprm="10" dyntype="filter" dynprm=".2"/>', '<position joint="j" kp="3"/>', (3, 0, -3, 0, 0)),
    ('<general gainprm="10" biasprm="4 -9 -1" dynprm=".2"/>', '<cylinder joint="j"/>', (10, 4, -9, -1, 0.2)),
    ('<general biastype="affine" gainprm="100" biasprm="0 -100 -10"/>', '<general joint="j" gainprm="50" biasprm="0 -50"/>',
     (50, 0, -50, -10, 0)),
    ('<position kp="77" kv="3"/>', '<general joint="j"/>', (77, 0, -77, -3, 0)),
    ('<position kp="77" kv="3"/>', '<velocity joint="j"/>', (1, 0, 0, -1, 0)),
    ('<position kp="7" timeconst=".3"/>', '<position joint="j"/>', (7, 0, -7, 0, 0.3)),
    ('<position kp="7" timeconst=".3"/>', '<motor joint="j"/>', (1, 0, 0, 0, 0)),
    ('<velocity kv="5"/>', '<position joint="j"/>', (1, 0, -1, 0, 0)),
    ('<cylinder area="5" timeconst=".3" bias="1 2 3"/>', '<general joint="j"/>', (5, 1, 2, 3, 0.3)),
    ('<cylinder area="5" timeconst=".3" bias="1 2 3"/>', '<position joint="j"/>', (1, 0, -1, 0, 0)),
])
def test_actuators_share_their_defaults(defaults, element, expected):
    assert parameters(defaults, element) == expected


def test_the_last_range_of_any_actuator_is_the_default_of_all():
    text = f'<mujoco><default><position ctrlrange="-1 1"/><motor ctrlrange="-2 2"/></default>{HINGE}<actuator><position joint="j"/></actuator></mujoco>'
    assert list(dyn.load_string(text).actuator(0).control_range) == [-2, 2]


def test_a_joints_range_of_forces_bounds_its_actuator():
    joint = HINGE.replace('axis="0 1 0"', 'axis="0 1 0" actuatorfrcrange="-0.5 0.3"')
    for gear, expected in ((1, (-0.5, 0.3)), (-2, (-0.15, 0.25))):
        m = dyn.load_string(f'<mujoco>{joint}<actuator><motor joint="j" gear="{gear}"/></actuator></mujoco>', strict=True)
        assert tuple(m.actuator(0).force_range) == pytest.approx(expected)
    two = f'<mujoco>{joint}<actuator><motor joint="j"/><motor joint="j"/></actuator></mujoco>'
    assert any("2 actuators drive it" in r.message for r in dyn.load_string(two).report)
    with pytest.raises(dyn.Error, match="2 actuators drive it"):
        dyn.load_string(two, strict=True)


def test_numbers_that_are_not_given_are_those_of_the_class():
    m = dyn.load_string('<mujoco><default><geom friction="0.9 0.3 0.2" condim="6" type="box" size=".1 .2 '
                        '.3"/></default><worldbody><body><joint/><geom name="g" friction="0.5" '
                        'size=".5"/></body></worldbody></mujoco>')
    shape = next(s for s in m.shapes if s.name == "g")
    assert (shape.material.friction, shape.material.torsion, shape.material.rolling) == (0.5, 0.3, 0.2)
    assert tuple(shape.size) == pytest.approx((1.0, 0.4, 0.6))
    m = dyn.load_string(f'<mujoco>{BOXES}<equality><joint joint1="ja" joint2="jb" polycoef="0.27"/></equality></mujoco>')
    q = m.data().project([0.9, 0.4])[0]
    assert q[0] == pytest.approx(0.27 + q[1], abs=1e-9)


def test_a_box_between_two_ends_has_one_width():
    m = dyn.load_string('<mujoco><worldbody><body><joint/><geom type="box" fromto="0 0 0 1 0 0" size="0.2 0.3 0.4" '
                        'density="1"/></body></worldbody></mujoco>')
    assert m.total_mass == pytest.approx(0.4 * 0.4 * 1.0)


def test_inertial_of_a_body_without_geoms_that_count():
    text = ('<mujoco><compiler inertiafromgeom="true"/><worldbody><body><joint axis="0 1 0"/><inertial pos="1 0 0" mass="2" '
            'diaginertia="1 1 1"/>{}</body></worldbody></mujoco>')
    for geom in ("", '<geom size=".1" group="6"/>', '<geom size=".1" mass="0"/>'):
        assert dyn.load_string(text.format(geom)).total_mass == 2
    assert dyn.load_string(text.format('<geom size=".1" mass="3"/>')).total_mass == 3


def test_replicas_are_turned_by_multiples_of_the_angles():
    m = dyn.load_string('<mujoco><worldbody><body name="b"><joint/><geom size=".1"/><replicate count="3" offset=".1 .2 .3" '
                        'euler="36.6 -32.1 -51.4"><site name="s" pos=".3 .4 .1"/></replicate></body>'
                        "</worldbody></mujoco>")
    d = m.data()
    d.forward_kinematics(m.neutral())

    def turned(k):  # about the turned axes x, y, z
        R = np.eye(3)
        for axis, angle in enumerate(np.radians([36.6, -32.1, -51.4]) * k):
            c, s = np.cos(angle), np.sin(angle)
            i, j = (axis + 1) % 3, (axis + 2) % 3
            T = np.eye(3)
            T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
            R = R @ T
        return R

    p, offset = np.zeros(3), np.array([0.1, 0.2, 0.3])
    for k in range(3):
        close(d.frame_placement(f"s{k}").translation, p + turned(k) @ [0.3, 0.4, 0.1])
        p = p + turned(k) @ offset


@pytest.mark.parametrize("names", [("world", "a"), ("a", "world")])
def test_what_is_excluded_from_the_world_falls_through_its_floor(names):
    m = dyn.load_string('<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="a"><freejoint/><geom '
                        f'size=".1"/></body></worldbody><contact><exclude body1="{names[0]}" '
                        f'body2="{names[1]}"/></contact></mujoco>')
    d = m.data()
    d.advance(1.0)
    assert d.q[2] == pytest.approx(-9.81 / 2, rel=2e-3)


def test_one_body_of_another_model(tmp_path):
    (tmp_path / "part.xml").write_text('<mujoco><worldbody><frame pos="1 0 0"><body name="base" pos="0 .5 0"><joint '
                                       'name="j"/><geom size=".1"/><body name="hand" pos="0 0 .7"><joint name="h"/><geom '
                                       'size=".1"/></body></body></frame><body name="other"><joint name="o"/><geom '
                                       'size=".1"/></body></worldbody><contact><exclude body1="base" '
                                       'body2="other"/></contact><actuator><motor name="mj" joint="j"/><motor name="mo" '
                                       'joint="o"/></actuator><equality><joint joint1="j" joint2="o"/></equality></mujoco>')
    for body, joints, motors, height in (("base", ["P_j", "P_h"], ["P_mj"], 0.5), ("hand", ["P_h"], [], 0.0),
                                         ("other", ["P_o"], ["P_mo"], 0.0)):
        (tmp_path / "whole.xml").write_text('<mujoco><asset><model name="s" file="part.xml"/></asset><worldbody><attach '
                                            f'model="s" body="{body}" prefix="P_"/></worldbody></mujoco>')
        m = dyn.load(tmp_path / "whole.xml", strict=True)
        assert [j.name for j in m.joints if j.nv] == joints and m.actuator_names == motors
        d = m.data()
        d.forward_kinematics(m.neutral())
        assert d.frame_placement("P_" + body).translation[1] == height
    (tmp_path / "whole.xml").write_text('<mujoco><asset><model name="s" file="part.xml"/></asset><worldbody><attach model="s" '
                                        'body="nobody"/></worldbody></mujoco>')
    with pytest.raises(dyn.Error, match="no body 'nobody' in the model that is attached"):
        dyn.load(tmp_path / "whole.xml")


def test_files_beside_an_included_file(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "field.bin").write_bytes(np.array([2, 2], np.int32).tobytes()
                                                 + np.array([0, 1, 0, 1], np.float32).tobytes())
    (tmp_path / "sub" / "part.xml").write_text('<mujoco><asset><hfield name="h" file="field.bin" size="1 1 .5 '
                                               '.1"/></asset><worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>')
    (tmp_path / "whole.xml").write_text('<mujoco><include file="sub/part.xml"/><worldbody><body pos="0 0 2"><freejoint/><geom '
                                        'size=".1"/></body></worldbody></mujoco>')
    assert dyn.load(tmp_path / "whole.xml", confined=True).nv == 6
    (tmp_path / "sub" / "field.bin").write_bytes(np.array([2, 2], np.int32).tobytes()
                                                 + np.array([np.nan, 1, 0, 1], np.float32).tobytes())
    with pytest.raises(dyn.Error, match="height that is not finite"):
        dyn.load(tmp_path / "whole.xml")


def test_a_moving_surface_is_a_belt():
    m = dyn.load_string('<mujoco><worldbody><geom type="plane" size="9 9 1" euler="0 0 90" surfacevel=".5 0 0 0 0 0"/><body '
                        'pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>', strict=True)
    d = m.data()
    d.set_state(q=m.configuration("qpos0"))
    d.advance(1.0)
    assert d.v[:2] == pytest.approx([0, 0.5], abs=1e-6)


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
