"""Meshes and SRDF files."""

import numpy as np
import pytest
from conftest import ARM
from test_cli import CLI, answer, run

import libdyn as dyn

CUBE = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)], float)
TRIANGLES = [
    [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7],
    [1, 7, 5],
]  # fmt: skip


def obj(path, vertices=CUBE):
    lines = ["v " + " ".join(map(str, v)) for v in vertices] + ["f " + " ".join(str(i + 1) for i in t) for t in TRIANGLES]
    path.write_text("\n".join(lines) + "\n")
    return path


def has_module(tmp_path):
    try:
        dyn.load_mesh(obj(tmp_path / "probe.obj"))
    except dyn.UnsupportedError:
        return False
    return True


def test_arrays():
    mesh = dyn.Mesh.from_arrays(CUBE * [1, 2, 3], TRIANGLES)
    i = mesh.info
    assert (i.vertices, i.triangles, i.closed, i.orientation, i.components) == (8, 12, True, 1, 1)
    assert i.volume == pytest.approx(6, rel=1e-14) and np.allclose(i.com, [0.5, 1, 1.5])
    assert np.allclose(i.inertia, np.diag([0.5 * 13, 0.5 * 10, 0.5 * 5]))
    assert mesh.vertices.shape == (8, 3) and mesh.triangles.shape == (12, 3) and not mesh.vertices.flags.writeable
    assert mesh.faces == [] and mesh.planes.shape == (0, 4)
    view = mesh.vertices
    del mesh
    assert view[7].tolist() == [1, 2, 3]  # keeps the mesh alive


def test_bad_arrays():
    with pytest.raises(dyn.SizeError):
        dyn.Mesh.from_arrays(np.zeros((3, 2)), TRIANGLES)
    with pytest.raises(dyn.ArgumentError, match="integers"):
        dyn.Mesh.from_arrays(CUBE, np.zeros((1, 3)))
    with pytest.raises(dyn.ArgumentError):
        dyn.Mesh.from_arrays(CUBE, [[0, 1, -1]])
    with pytest.raises(dyn.ArgumentError, match="triangle 0 has the vertex 8"):
        dyn.Mesh.from_arrays(CUBE, [[0, 1, 8]])
    with pytest.raises(dyn.NonFiniteError, match="vertex 0 has x = NaN"):
        dyn.Mesh.from_arrays(CUBE * np.nan, TRIANGLES)
    with pytest.raises(dyn.FileError, match="not found: tried"):
        dyn.load_mesh("no/such/file.stl")


def test_files_and_hulls(tmp_path):
    if not has_module(tmp_path):
        pytest.skip("built without qhull")
    mesh = dyn.load_mesh(obj(tmp_path / "a.obj"), scale=(1, 1, -2))
    assert mesh.info.convex and mesh.info.volume == pytest.approx(2, rel=1e-14) and mesh.info.orientation == 1
    assert dyn.load_mesh("a.obj", relative_to=tmp_path / "robot.urdf").info.hull_volume_ratio == pytest.approx(1)
    assert len(dyn.load_mesh("package://p/a.obj", package_dirs=tmp_path).vertices) == 8
    hull = dyn.Mesh.from_arrays(np.random.default_rng(1).normal(size=(200, 3))).hull()
    assert hull.info.convex and len(hull.faces) == len(hull.planes) and len(hull.neighbours) == len(hull.vertices)
    assert (hull.planes[:, :3] @ hull.vertices.T <= hull.planes[:, 3:] + 1e-13).all()
    with pytest.raises(dyn.InvalidRobotError, match="plane"):
        dyn.Mesh.from_arrays(CUBE * [1, 1, 0]).hull()


def test_srdf(tmp_path):
    path = tmp_path / "arm.srdf"
    joint = dyn.load_string(ARM, "fixed").joints[1].name
    links = [f.name for f in dyn.load_string(ARM, "fixed").frames if f.type == dyn.FrameType.BODY]
    path.write_text(
        f'<robot name="arm"><group_state name="up" group="g"><joint name="{joint}" value="0.5"/></group_state>'
        f'<disable_collisions link1="{links[0]}" link2="{links[1]}" reason="Adjacent"/></robot>'
    )
    m = dyn.load_string(ARM, "fixed", srdf=path)
    assert m.configurations["up"][0] == 0.5
    (pair,) = m.disabled_pairs
    assert (m.frame_name(pair.frame1), m.frame_name(pair.frame2), pair.reason) == (links[0], links[1], "Adjacent")


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
def test_command(tmp_path):
    path = tmp_path / "arm.urdf"
    obj(tmp_path / "cube.obj")
    mesh = '<collision><geometry><mesh filename="cube.obj" scale="1 2 3"/></geometry></collision><visual><geometry><mesh filename="none.obj"/></geometry></visual>'
    path.write_text(ARM.replace('<link name="base"/>', f'<link name="base">{mesh}</link>'))
    srdf = tmp_path / "arm.srdf"
    srdf.write_text('<robot name="arm"><group_state name="up" group="g"/><disable_collisions link1="base" link2="tool" '
                    'reason="Never"/></robot>')
    info = answer("info", path, "--fixed", "--srdf", srdf, "--meshes")
    assert info["configurations"] == ["neutral", "up"]
    assert info["disabled_pairs"] == [{"frame1": "base", "frame2": "tool", "reason": "Never"}]
    cube, none = info["meshes"]
    assert "not found" in none["error"] and none["link"] == "base"
    if has_module(tmp_path):
        assert cube["info"]["volume"] == pytest.approx(6) and cube["info"]["convex"]
        assert "hull/mesh" in run("info", path, "--fixed", "--meshes")
    else:
        assert "libdyn_mesh.so" in cube["error"]
    assert "meshes" not in answer("info", path, "--fixed")
    assert "none.srdf" in run("info", path, "--fixed", "--srdf", tmp_path / "none.srdf", status=1)


def test_shapes_of_meshes(tmp_path):
    cube = dyn.Mesh.from_arrays(CUBE - 0.5, TRIANGLES)
    X = [1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0.2, 0.1]
    here = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]
    expected = dyn.geometry_distance(("box", (1, 1, 1)), here, ("cylinder", (0.3, 0.5)), X)
    found = dyn.geometry_distance(("triangles", cube), here, ("cylinder", (0.3, 0.5)), X)
    assert found.distance == pytest.approx(expected.distance, abs=1e-9)
    field = dyn.Mesh.height_field(np.full((3, 5), 0.5), 0.5, -1)
    assert field.info.triangles == 16 and field.info.area == pytest.approx(2)
    X[9:] = [0.3, 0.1, 0.6]
    assert dyn.geometry_distance(("height_field", field), here, ("sphere", 0.2), X).distance == pytest.approx(-0.1)
    with pytest.raises(dyn.ArgumentError, match="no hull"):
        dyn.geometry_distance(("convex", cube), here, ("sphere", 0.2), X)
    with pytest.raises(dyn.SizeError):
        dyn.Mesh.height_field(np.zeros(4), 1, -1)
    with pytest.raises(dyn.InvalidRobotError, match="not above the bottom"):
        dyn.Mesh.height_field(np.zeros((2, 2)), 1, 0)
    b = dyn.Builder("scene").add_body("ground", None, 0, [0, 0, 0],
                                      np.zeros((3, 3))).add_joint("slide", "prismatic").add_joint("turn", "revolute", "slide")
    b.add_body("cube", "turn", 1, [0, 0, 0], np.eye(3)).add_shape("ground", "height_field",
                                                                  surface=field).add_shape("cube", "triangles", surface=cube)
    m = b.finish()
    d = m.data()
    d.set_pair(None, True)
    assert d.compute_distances([1.5, 0.0]) == pytest.approx([0.5])
    assert len(m.shape_mesh(1).triangles) == 12 and m.shapes[1].type == dyn.ShapeType.TRIANGLES
    with pytest.raises(dyn.ArgumentError):
        dyn.Builder("scene").add_body("a", None, 0, [0, 0, 0], np.zeros((3, 3))).add_shape("a", "triangles")


def test_meshes_of_robots(tmp_path):
    if not has_module(tmp_path):
        pytest.skip("built without qhull")
    dented = CUBE.copy()
    dented[7] = [0.6, 0.6, 0.6]
    obj(tmp_path / "a.obj", dented)
    part = "<collision><geometry><mesh filename='a.obj'/></geometry></collision>"
    mass = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
    joint = "<joint name='{0}' type='prismatic'><parent link='{1}'/><child link='{2}'/><axis xyz='1 0 0'/><limit effort='1' velocity='1' lower='-9' upper='9'/></joint>"
    path = tmp_path / "r.urdf"
    path.write_text(
        f"<robot name='r'><link name='a'>{part}</link><link name='b'>{mass}</link><link name='c'>{mass}{part}</link>"
        + joint.format("x", "a", "b") + joint.format("y", "b", "c") + "</robot>"
    )  # fmt: skip
    assert dyn.load(path, "fixed").shapes[0].type == dyn.ShapeType.CONVEX
    names = dyn.load(path, "fixed", meshes="none")
    assert names.shapes[0].type == dyn.ShapeType.MESH and names.pairs[0].reason == dyn.PairReason.MESH
    hull, triangles = dyn.load(path, "fixed", meshes="hull"), dyn.load(path, "fixed", meshes="triangles")
    assert hull.shapes[0].type == dyn.ShapeType.CONVEX and triangles.shapes[0].type == dyn.ShapeType.TRIANGLES
    assert any("not convex" in str(r.message) for r in hull.report)
    for m in (hull, triangles):
        d = m.data()
        d.set_pair(None, True)
        assert d.compute_distances([1.0, 2.0]) == pytest.approx([2.0])
    assert hull.shape_mesh(0).info.convex and not triangles.shape_mesh(0).info.convex
    (tmp_path / "a.obj").unlink()
    with pytest.raises(dyn.FileError, match="link 'a'"):
        dyn.load(path, "fixed", meshes="hull")


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
def test_cli_collision_meshes(tmp_path):
    if not has_module(tmp_path):
        pytest.skip("built without qhull")
    obj(tmp_path / "a.obj")
    part = "<collision><geometry><mesh filename='a.obj'/></geometry></collision>"
    path = tmp_path / "r.urdf"
    path.write_text(
        f"<robot name='r'><link name='w'/><link name='a'>{part}</link><link name='b'>{part}</link><joint name='x' "
        "type='floating'><parent link='w'/><child link='a'/></joint><joint name='y' type='floating'><parent link='w'/><child "
        "link='b'/></joint></robot>".replace(
            part, part + "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
        )
    )
    assert "--collision-meshes" in run("info", path, "--fixed", "--pairs", "--collision-meshes", "none")
    for kind, name in (("hull", "convex"), ("triangles", "triangles")):
        info = answer("info", path, "--fixed", "--collision-meshes", kind)
        assert [s["type"] for s in info["shapes"]] == [name, name]
    run("info", path, "--fixed", "--collision-meshes", "boxes", status=2)


def test_colours(tmp_path):
    if not has_module(tmp_path):
        pytest.skip("built without qhull")
    (tmp_path / "m.mtl").write_text("newmtl paint\nKd 0.2 0.4 1\nnewmtl bare\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "m.obj").write_text("mtllib m.mtl\n" + corners
                                    + "usemtl bare\nf 1 3 2\nusemtl paint\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    m = dyn.load_mesh(tmp_path / "m.obj")
    assert m.colours.shape == (4, 3)
    np.testing.assert_array_equal(np.sort(m.colours, axis=0)[:3], [[0.2, 0.4, 1]] * 3)
    assert np.isnan(m.colours).sum() == 3
    assert np.isnan(dyn.Mesh.from_arrays(m.vertices, m.triangles).colours).all() and np.isnan(m.hull().colours).all()
