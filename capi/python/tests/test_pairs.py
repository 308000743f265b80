"""Collision pairs and meshes of robot files: what the file states, and warnings for what is missing."""

import warnings

import pytest

from conftest import dyn

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def pairs_of(model):
    """Pairs of links that new data tests."""
    name = lambda shape: model.frames[model.shapes[shape].frame].name
    return [tuple(sorted((name(p.shape_a), name(p.shape_b)))) for p in model.pairs if p.reason is dyn.PairReason.TESTED]


def mjcf(option="", contact=""):
    """A base welded to the world, an arm of two links, a body that slides on the world; all overlap, and overlap the floor."""
    return f"""<mujoco>{option}<worldbody><geom name="floor" type="plane" size="1 1 1"/><body name="base"><geom size=".1"/>
<body name="arm"><joint/><geom size=".1"/><body name="lid"><geom size=".1"/></body><body name="hand"><joint/><joint axis="0 1 0"/><geom size=".1"/></body></body></body>
<body name="cart"><joint type="slide"/><geom size=".1"/></body></worldbody><contact>{contact}</contact></mujoco>"""


PAIRS = {("arm", "universe"), ("hand", "universe"), ("lid", "universe"), ("cart", "universe"), ("arm", "base"), ("base", "lid"),
         ("base", "hand"), ("base", "cart"), ("arm", "cart"), ("cart", "lid"), ("cart", "hand")}


def test_mjcf_has_the_pairs_of_mujoco():
    """The world and what is fixed to it are nobody's parent, bodies without joints are one with their parent, and overlaps
    count."""
    assert set(pairs_of(dyn.load_string(mjcf()))) == PAIRS
    assert set(pairs_of(dyn.load_string(mjcf(contact='<exclude body1="base" body2="hand"/>')))) == PAIRS - {("base", "hand")}
    parents = dyn.load_string(mjcf('<option><flag filterparent="disable"/></option>'))
    assert set(pairs_of(parents)) == PAIRS | {("arm", "hand"), ("hand", "lid")}
    assert not any("overlap" in r.message for r in parents.report)


def test_pairs_are_saved(tmp_path):
    """As MJCF, where pairs that MuJoCo would test are excluded, and as .dynb."""
    models = [dyn.load_string(mjcf(option)) for option in ("", '<option><flag filterparent="disable"/></option>')]
    for model in models + [dyn.load_string(chain(0.05), base="fixed")]:
        model.save(tmp_path / "m.xml"), model.save(tmp_path / "m.dynb")
        for file in ("m.xml", "m.dynb"):
            assert sorted(pairs_of(dyn.load(tmp_path / file))) == sorted(pairs_of(model))
        assert (pairs_of(dyn.Model.from_image(model.image())) == pairs_of(dyn.Builder.from_model(model).finish())
                == pairs_of(model))


def test_a_body_that_begins_in_the_floor_is_pushed_out():
    """gymnasium's hopper: its foot overlaps the floor at q = 0, where its root stands higher by ref."""
    text = """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 1.25"><joint type="slide" axis="0 0 1" ref="1.25"/><geom type="sphere" size=".1"/></body></worldbody></mujoco>"""
    model = dyn.load_string(text)
    data = model.data()
    data.set_state([1.25], [0])
    for _ in range(1000):
        data.step(1e-3)
    assert data.q[0] == pytest.approx(0.1, abs=1e-3)


def chain(length, limits="", shape='<sphere radius="0.1"/>'):
    """Links on hinges about y, at a distance along z."""
    links = "".join(f'<link name="l{k}">{INERTIAL}<collision><geometry>{shape}</geometry></collision></link>' for k in range(3))
    kind = "revolute" if limits else "continuous"
    joints = "".join(f'<joint name="j{k}" type="{kind}"><parent link="l{k}"/><child link="l{k + 1}"/><origin xyz="0 0 '
                     f'{length}"/><axis xyz="0 1 0"/>{limits}</joint>' for k in range(2))
    return f'<robot name="chain">{links}{joints}</robot>'


def overlaps(model):
    return [r.message for r in model.report if "overlap" in r.message]


def test_urdf_pairs_that_always_overlap_are_named():
    model = dyn.load_string(chain(0.05), base="fixed")
    assert pairs_of(model) == []
    assert (overlaps(model)
            == ["not tested for collision, because they overlap in nearly every configuration: links 'l0' and 'l2', 1 pair of "
                "shapes"])
    assert overlaps(dyn.Model.from_image(model.image())) == overlaps(dyn.Builder.from_model(model).finish()) == overlaps(model)


def test_urdf_pairs_that_overlap_in_the_neutral_configuration_alone_are_pairs_of():
    """Links of 15 cm under 0 rad lie on one another where the elbow is bent by half a turn: not in most configurations."""
    folded = chain(0.15).replace('<origin xyz="0 0 0.15"/><axis xyz="0 1 0"/></joint></robot>',
                                 '<origin xyz="0 0 -0.15"/><axis xyz="0 1 0"/></joint></robot>')
    model = dyn.load_string(folded, base="fixed")
    assert pairs_of(model) == [("l0", "l2")] and overlaps(model) == []
    assert dyn.load_string(chain(0.15), base="fixed").pairs[0].reason is dyn.PairReason.TESTED


def test_an_srdf_decides(tmp_path):
    """It disables another pair; l0 and l2 overlap everywhere, and are tested."""
    text = chain(0.05).replace("</robot>",
                               f'<link name="far">{INERTIAL}</link><joint name="f" type="continuous"><parent link="l2"/><child '
                               'link="far"/></joint></robot>')
    for pairs, expected in (('<disable_collisions link1="l0" link2="far"/>', [("l0", "l2")]), ("", [])):
        (tmp_path / "r.srdf").write_text(f'<robot name="chain">{pairs}</robot>')
        model = dyn.load_string(text, base="fixed", srdf=tmp_path / "r.srdf")
        assert pairs_of(model) == expected and bool(overlaps(model)) == (not expected)


CUBE = "".join(f"v {x} {y} {z}\n" for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)) + "".join(
    f"f {a} {b} {c}\n" for a, b, c in ((1, 2, 4), (1, 4, 3), (5, 8, 6), (5, 7, 8), (1, 6, 2), (1, 5, 6), (3, 4, 8), (3, 8, 7),
                                       (1, 3, 7), (1, 7, 5), (2, 6, 8), (2, 8, 4)))


@pytest.fixture
def cube(tmp_path):
    (tmp_path / "cube.obj").write_text(CUBE)
    points = "".join(line + "\n" for line in CUBE.replace("0.1", "0.125").splitlines() if line.startswith("v"))
    (tmp_path / "points.obj").write_text(points)
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    return tmp_path


def quiet(load, *args, **options):
    """Loads without any warning of Python."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return load(*args, **options)


def test_hulls_of_meshes_by_default(cube):
    (cube / "r.urdf").write_text(chain(1, shape='<mesh filename="cube.obj"/>'))
    model = quiet(dyn.load, cube / "r.urdf", base="fixed")
    assert [s.type.name for s in model.shapes] == ["CONVEX"] * 3 and len(pairs_of(model)) == 1
    (cube / "m.xml").write_text('<mujoco><asset><mesh file="cube.obj"/></asset><worldbody><body><freejoint/><geom type="mesh" '
                                'mesh="cube"/></body></worldbody></mujoco>')
    assert [s.type.name for s in quiet(dyn.load, cube / "m.xml").shapes] == ["CONVEX"]
    assert [s.type.name for s in quiet(dyn.load, cube / "m.xml", meshes="none").shapes] == ["MESH"]


def test_a_missing_mesh_is_a_warning_and_an_error_when_strict(cube):
    (cube / "r.urdf").write_text(chain(1, shape='<mesh filename="none.obj"/>'))
    with pytest.warns(dyn.LoadWarning) as seen:
        model = dyn.load(cube / "r.urdf", base="fixed")
    assert len(seen) == 1 and "none.obj" in str(seen[0].message) and seen[0].filename == __file__
    assert [s.type.name for s in model.shapes] == ["MESH"] * 3
    with pytest.raises(dyn.StrictError, match="none.obj"):
        dyn.load(cube / "r.urdf", base="fixed", strict=True)
    with pytest.raises(dyn.FileError, match="none.obj"):
        dyn.load(cube / "r.urdf", base="fixed", meshes="hull")
    body = '<inertial mass="1" diaginertia="1 1 1" pos="0 0 0"/>'
    (cube / "m.xml").write_text(f'<mujoco><asset><mesh file="none.obj"/></asset><worldbody><body><freejoint/>{body}<geom '
                                'type="mesh" mesh="none"/></body></worldbody></mujoco>')
    with pytest.warns(dyn.LoadWarning, match="none.obj"):
        assert [s.type.name for s in dyn.load(cube / "m.xml").shapes] == ["MESH"]
    with pytest.raises(dyn.StrictError, match="none.obj"):
        dyn.load(cube / "m.xml", strict=True)


def test_flat_meshes_and_points(cube):
    """A flat mesh has no hull: its triangles. An OBJ of vertices alone is their hull."""
    for use in ("auto", "hull"):
        (cube / "r.urdf").write_text(chain(1, shape='<mesh filename="flat.obj"/>'))
        model = quiet(dyn.load, cube / "r.urdf", base="fixed", meshes=use)
        assert [s.type.name for s in model.shapes] == ["TRIANGLES"] * 3
        assert any("flat" in r.message and r.level is dyn.ReportLevel.WARNING for r in model.report)
        (cube / "m.xml").write_text('<mujoco><asset><mesh file="points.obj"/></asset><worldbody><body><freejoint/><geom '
                                    'type="mesh" mesh="points"/></body></worldbody></mujoco>')
        model = quiet(dyn.load, cube / "m.xml", meshes=use)
        assert [s.type.name for s in model.shapes] == ["CONVEX"]
        assert model.total_mass == pytest.approx(15.625, rel=1e-12)


@pytest.mark.parametrize("builtin, vertices, volume", [
    ('"sphere" params="0"', 12, 2.53615071), ('"sphere" params="2"', 162, None), ('"sphere" params="4"', 2562, None),
    ('"hemisphere" params="0"', 5, 2 / 3), ('"hemisphere" params="2"', 25, None), ('"cone" params="4 0.5"', 8, 7 / 3),
    ('"cone" params="4 0"', 5, 4 / 3)])
def test_builtin_meshes(builtin, vertices, volume):
    """Those of MuJoCo 4 with closed forms: as many corners on their hull (without the middle of a base), the volume of Platonic
    solids, prisms and pyramids."""
    model = quiet(dyn.load_string, f"""<mujoco><asset><mesh name="m" builtin={builtin}/></asset><worldbody><body><freejoint/>
        <geom type="mesh" mesh="m" density="1"/></body></worldbody></mujoco>""")
    assert (model.shapes[0].type is dyn.ShapeType.CONVEX
            and f"a hull of {vertices} vertices" in " ".join(r.message for r in model.report))
    if volume:
        assert model.total_mass == pytest.approx(volume, rel=2e-7)  # corners have single precision
    elif "sphere" in builtin:
        full = 4.18879 if builtin.startswith('"sphere') else 2.0944
        assert 0.75 * full < model.total_mass < full


BRICK = "".join(f"{x} {y} {z} " for x in (0, 0.25) for y in (0, 0.5) for z in (0, 0.75))


@pytest.mark.parametrize("bounds", [False, True])
def test_primitives_fitted_to_a_mesh(bounds):
    """A brick of 0.25 x 0.5 x 0.75 m in a corner: its box is the brick, other primitives follow MuJoCo's formulas."""
    sizes = {"box": (0.125, 0.25, 0.375), "ellipsoid": (0.125, 0.25, 0.375), "sphere": (0.375,) if bounds else (0.25,),
             "cylinder": (0.078125**0.5 if bounds else 0.1875, 0.375),
             "capsule": (0.078125**0.5, 0.375 - 0.078125**0.5) if bounds else (0.1875, 0.28125)}
    for kind, expected in sizes.items():
        model = dyn.load_string(f"""<mujoco><compiler fitaabb="{"true" if bounds else "false"}"/><asset><mesh name="m" vertex="{BRICK}"/></asset><worldbody><body><freejoint/>
            <geom type="{kind}" mesh="m" pos="1 0 0" fitscale="2"/></body></worldbody></mujoco>""")
        shape = model.shapes[0]
        factor = [2] * 3 if kind == "box" else [1, 2] if kind in ("cylinder", "capsule") else [1] * 3
        assert shape.size[: len(expected)] == pytest.approx([2 * f * x for f, x in zip(factor, expected)], rel=1e-9), kind
        assert shape.placement.translation == pytest.approx([1.125, 0.25, 0.375], abs=1e-12)


def test_small_things_do_not_refuse_a_model():
    """A zero quaternion in a key, a sphere of radius 0 in a URDF, joints that move no mass."""
    model = dyn.load_string("""<mujoco><worldbody><body><freejoint/><geom size=".1"/></body><body><joint name="b" type="ball"/><geom size=".1"/></body></worldbody>
        <keyframe><key name="k" qpos="1 2 3 0 0 0 0 0 0 0 0"/></keyframe></mujoco>""")
    assert list(model.configuration("k")) == [1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 1]
    for shape in ('<sphere radius="0"/>', '<box size="0 0 0"/>', '<cylinder radius="0" length="0"/>'):
        with pytest.warns(dyn.LoadWarning, match="size of 0"):
            assert len(dyn.load_string(chain(1, shape=shape), base="fixed").shapes) == 0
    with pytest.raises(dyn.InvalidRobotError, match="box> size is 0"):  # a floor, perhaps
        dyn.load_string(chain(1, shape='<box size="1 1 0"/>'), base="fixed")


def test_joints_without_mass_load_and_forward_dynamics_names_them(tmp_path):
    text = chain(1).replace("</robot>",
                            '<link name="tip"/><joint name="massless" type="continuous"><parent link="l2"/><child '
                            'link="tip"/><axis xyz="1 0 0"/></joint></robot>')
    with pytest.warns(dyn.LoadWarning, match="forward dynamics may be undefined: joint 'massless'"):
        model = dyn.load_string(text, base="fixed")
    plain = dyn.load_string(chain(1), base="fixed")
    data, other = model.data(), plain.data()
    q, v, a = [0.3, -0.4, 0.2], [1, 2, 3], [0.1, 0.2, 0.3]
    assert data.rnea(q, v, a) == pytest.approx([*other.rnea(q[:2], v[:2], a[:2]), 0], abs=1e-12)
    with pytest.raises(dyn.NumericError, match="massless"):
        data.aba(q, v, [0, 0, 0])
    with pytest.raises(dyn.NumericError, match="massless"):
        data.step(1e-3)
    model.save(tmp_path / "m.dynb")
    assert len(dyn.Builder.from_model(model).finish().report) == len(dyn.load(tmp_path / "m.dynb").report) == len(model.report)
    with pytest.raises(dyn.InvalidRobotError, match="massless"):
        dyn.load_string(text, base="fixed", strict=True)


def test_bodies_nested_ten_thousand_deep():
    depth = 10000
    body = '<body pos="0 0 0.001">\n'
    text = f'<mujoco><worldbody><geom type="plane" size="1 1 1" pos="0 0 -1"/><body name="root"><joint type="slide"/><geom size=".1"/>{body * (depth - 2)}<body name="last" pos="0 0 0.001"><geom size=".1"/>\n</body>{"</body>" * (depth - 2)}</body></worldbody></mujoco>'
    model = quiet(dyn.load_string, text)
    assert model.nv == 1
    data = model.data()
    data.forward_kinematics()
    assert data.frame_placement("last").translation[2] == pytest.approx(0.001 * (depth - 1), rel=1e-12)
    with pytest.raises(dyn.ParseError, match="line 5000"):
        dyn.load_string("<mujoco><worldbody>" + body * 4999 + '<body pos="x">' + "</body>" * 5000 + "</worldbody></mujoco>")


def test_negative_moments_of_inertia_are_kept_with_a_warning(tmp_path):
    """As Pinocchio loads them: inverse dynamics takes the numbers of the file, tau = I a about the axis."""
    text = chain(1).replace('<link name="l2"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"',
                            '<link name="l2"><inertial><mass value="1"/><inertia ixx="-0.1" iyy="0.2" izz="0.2"')
    with pytest.warns(dyn.LoadWarning, match="no negative one"):
        model = dyn.load_string(text, base="fixed")
    assert model.data().rnea([0, 0], [0, 0], [0, 1])[1] == pytest.approx(0.2, abs=1e-12)
    model.save(tmp_path / "m.dynb")
    assert len(dyn.Builder.from_model(model).finish().report) == len(dyn.load(tmp_path / "m.dynb").report) == len(model.report)
    with pytest.raises(dyn.StrictError, match="no negative one"):
        dyn.load_string(text, base="fixed", strict=True)


def test_saved_meshes_are_read_by_mujoco(cube):
    """A flat visual mesh has no volume, a DAE is none of MuJoCo's formats: masses stand in the file, and meshes too."""
    mujoco = pytest.importorskip("mujoco")
    dae = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
    (cube / "corner.dae").write_text(dae)
    (cube / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
    flat = '<visual><geometry><mesh filename="quad.obj"/></geometry></visual></link>'
    (cube / "r.urdf").write_text(chain(2, shape='<mesh filename="corner.dae" scale="2 2 2"/>').replace("</link>", flat))
    lines = dyn.load(cube / "r.urdf", base="fixed").save(cube / "r.xml")
    assert not any(line.level is dyn.ReportLevel.DROPPED for line in lines)
    m = mujoco.MjModel.from_xml_path(str(cube / "r.xml"))
    assert m.nv == 2 and m.nmesh == 2 and m.mesh_vertnum.max() == 4
    again = dyn.load(cube / "r.xml")
    assert sorted(s.type.name for s in again.shapes) == ["CONVEX"] * 3 + ["MESH"] * 3
    assert again.total_mass == pytest.approx(2) and m.body_subtreemass[0] == pytest.approx(3)  # libdyn counts what moves


def test_large_meshes_are_saved_with_whole_numbers(tmp_path):
    """More than 100,000 vertices, in a format that MuJoCo does not read: STL as text."""
    mujoco = pytest.importorskip("mujoco")
    facets = "".join(
        f"facet normal 0 0 1\nouter loop\nvertex {k} 0 {k % 7}\nvertex {k} 1 {k % 5}\nvertex {k + 0.5} 0 {k % 3}\nendloop\nendfacet\n" for k in range(33400))
    (tmp_path / "long.stl").write_text(f"solid s\n{facets}endsolid s\n")
    visual = '<visual><geometry><mesh filename="long.stl" scale="1e-4 1 1"/></geometry></visual></link>'
    (tmp_path / "r.urdf").write_text(chain(2).replace("</link>", visual))
    dyn.load(tmp_path / "r.urdf", base="fixed").save(tmp_path / "r.xml")
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "r.xml")).mesh_facenum.max() == 33400
