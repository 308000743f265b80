"""MJCF models: against MuJoCo's figures (tests/mjcf/generate.py makes golden.json), and what bad ones get."""

import json
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest
from mjcf_pieces import BODY

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


def test_a_model_without_a_name_has_its_own(tmp_path):
    (tmp_path / "part.xml").write_text('<mujoco model="Arm"><worldbody>' + BODY + "</worldbody></mujoco>")
    (tmp_path / "m.xml").write_text('<mujoco><asset><model file="part.xml"/></asset><worldbody><attach model="Arm" body="a" '
                                    'prefix="x_"/></worldbody></mujoco>')
    assert dyn.load(tmp_path / "m.xml").joint_id("x_j") == 1
    (tmp_path / "part.xml").write_text("<mujoco><worldbody>" + BODY + "</worldbody></mujoco>")
    with pytest.raises(dyn.Error, match="no model 'Arm'"):
        dyn.load(tmp_path / "m.xml")


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


def test_what_refers_to_replicas_is_replicated():
    """The order is MuJoCo 4.0.0's: first what refers to no copy, then copy by copy."""
    m = dyn.load_string(
        '<mujoco><worldbody><body name="base"><joint name="b" type="slide"/><geom name="bottom" size=".1"/></body><replicate '
        'count="2" offset="0 1 0"><replicate count="2" sep="-" offset="1 0 0"><body name="arm"><joint name="j"/><geom size=".1" '
        'pos=".3 0 0"/><site name="s"/><body name="sub"><joint name="k"/><geom name="g" size=".1"/></body></body></replicate>'
        '</replicate></worldbody><contact><exclude body1="base" body2="arm"/><pair geom1="bottom" geom2="g"/></contact>'
        '<equality><joint joint1="j" joint2="k"/><joint name="e" joint1="b" joint2="j"/></equality>'
        '<actuator><motor name="first" joint="j"/><motor name="B" joint="b"/><position joint="k"/></actuator></mujoco>')
    copies = ["-00", "-10", "-01", "-11"]
    drive = [("B", "b")] + [pair for c in copies for pair in (("first" + c, "j" + c), (None, "k" + c))]
    names = ["B", "first-00", None, "first-10", None, "first-01", None, "first-11", None]
    assert len(m.actuator_names) == len(names) and all(x in (None, y) for x, y in zip(names, m.actuator_names))
    drive = ["b"] + [joint + copy for copy in ("-00", "-10", "-01", "-11") for joint in "jk"]
    assert [m.joint_name(m.actuator(k).joint) for k in range(9)] == drive
    assert len(m.constraint_names) == 8 and set(m.constraint_names) >= {"e-00", "e-10", "e-01", "e-11"}
    assert len(m.disabled_pairs) == 4
    tested = {p.shape_b for p in m.pairs if p.reason == dyn.PairReason.TESTED and p.shape_a == 0}
    assert tested == {2, 4, 6, 8}  # the geoms "g"; those of the arms are excluded


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


@pytest.mark.parametrize("joint, geom, what", [
    ('<joint name="j" actuatorgravcomp="true" actuatorfrcrange="-1 1"/>', "", "joint 'j': actuatorfrcrange does not limit the compensation of gravity"),
    ('<joint name="j" type="free" stiffness="3"/>', "", "joint 'j': the spring of a free joint"),
    ('<joint/>', 'name="g" shellinertia="true"', "geom 'g': <geom>: attribute shellinertia"),
    ('<joint actuatorgravcomp="true"/>', "", None),
    ('<joint actuatorgravcomp="false" actuatorfrcrange="-1 1"/>', "", None),
])  # yapf: disable
def test_physics_that_has_no_place_is_named(joint, geom, what):
    text = f'<mujoco><worldbody><body gravcomp="1">{joint}<geom size=".1" {geom}/></body></worldbody></mujoco>'
    said = [e.message for e in dyn.load_string(text).report if e.level == dyn.ReportLevel.DROPPED]
    assert [what in message for message in said] == ([True] if what else []), said
