"""Meshcat: every shape is drawn where it is."""

from ctypes import byref

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn import abi
from libdyn.native import lib

meshcat = pytest.importorskip("meshcat", reason="package meshcat is not installed")

from libdyn.meshcat import Display, pieces  # noqa: E402


class Paper:
    """Keeps what a meshcat.Visualizer is told."""

    def __init__(self, path="", told=None):
        self.path, self.told = path, {} if told is None else told

    def __getitem__(self, path):
        return Paper(f"{self.path}/{path}", self.told)

    def set_object(self, geometry, material):
        self.told[self.path, "object"] = geometry.lower({})["type"] if hasattr(geometry, "lower") else geometry
        self.told[self.path, "material"] = material.lower({})

    def set_transform(self, X):
        self.told[self.path, "transform"] = np.array(X)


def test_shapes_are_where_they_are(go2):
    paper = Paper()
    display = Display(go2, paper)
    shown = {path for path, what in paper.told if what == "object"}
    assert shown
    q = go2.random(3)
    display(q)
    d = go2.data()
    d.forward_kinematics(q)
    for path in shown:
        shape = go2.shapes[int(path.split("/")[2])]
        X, at = d.frame_placement(go2.frame_name(shape.frame)), shape.placement
        T = paper.told[path.rsplit("/", 1)[0], "transform"]
        np.testing.assert_allclose(T[:3, 3], X.rotation @ at.translation + X.translation, atol=1e-13)
        np.testing.assert_allclose(T[:3, :3], X.rotation @ at.rotation, atol=1e-13)
    display.play([q, q], dt=1e-3)


def sizes():
    """Numbers for each primitive: as many as the library's table of shapes says."""
    found, info = {}, abi.ShapeTypeInfo()
    for shape in dyn.ShapeType:
        assert lib.dyn_shape_type_info(shape, byref(info)) == 0
        if not info.surface and shape != dyn.ShapeType.MESH:
            found[shape.name.lower()] = (0.3, 1, 2)[: info.sizes]
    return found


SIZES = sizes()


def test_a_ground_and_a_box_are_primitives():
    assert len(SIZES["box"]) == 3 and SIZES["half_space"] == () and "convex" not in SIZES and len(SIZES) >= 7


@pytest.mark.parametrize("kind", SIZES)
def test_every_primitive(kind):
    b = dyn.Builder("one").add_joint("j", "free_flyer").add_body("x", "j", mass=1, inertia=np.eye(3))
    m = b.add_shape("x" if kind != "half_space" else "universe", kind, SIZES[kind]).finish()
    drawn = pieces(m, m.shapes[0])
    assert len(drawn) == (3 if kind == "capsule" else 1)
    if kind == "cone":  # closed, on a polygon of 24 sides
        x = drawn[0][0]
        a, b, c = (x.vertices[x.faces[:, k]] for k in range(3))  # meshcat keeps them in single precision
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        assert volume == pytest.approx(12 * np.sin(np.pi / 12) * 0.09 / 3, rel=1e-6)


def test_meshes(tmp_path):
    (tmp_path / "corner.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="l"><visual><geometry><mesh filename="corner.obj" scale="2 2 '
        '2"/></geometry></visual></link></robot>'
    )
    m = dyn.load(tmp_path / "r.urdf", base="fixed")
    try:
        (geometry, _), = pieces(m, m.shapes[0])
    except dyn.UnsupportedError as error:
        pytest.skip(str(error))
    assert np.max(geometry.vertices) == 2 and len(geometry.faces) == 4


def test_colours_of_the_files(tmp_path):
    """A material's colour and opacity; without one those of the mesh's own triangles; else what is asked for."""
    (tmp_path / "corner.mtl").write_text("newmtl a\nKd 0.2 0.4 1\n")
    (tmp_path / "corner.obj").write_text("mtllib corner.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 3 2\nf 1 2 4\nf "
                                         "1 4 3\nf 2 3 4\n")
    mesh, paint = '<geometry><mesh filename="corner.obj"/></geometry>', '<material name=""><color rgba="1 0.2 0 0.4"/></material>'
    box = '<geometry><box size="1 1 1"/></geometry>'
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="l">' + "".join(f"<visual>{x}</visual>" for x in (box + paint, box, mesh, mesh + paint))
        + "</link></robot>"
    )
    m, paper = dyn.load(tmp_path / "r.urdf", base="fixed"), Paper()
    try:
        Display(m, paper, color=0x123456)
    except dyn.UnsupportedError as error:
        pytest.skip(str(error))
    red, plain, own, painted = (paper.told[f"/robot/{k}/0", "material"] for k in range(4))
    for x in (red, painted):
        assert (x["color"] == 0xFF3300 and x["opacity"] == pytest.approx(0.4, abs=1 / 255) and x["transparent"]
                and not x["vertexColors"])
    assert plain["color"] == 0x123456 and plain["opacity"] == 1 and not plain["transparent"]
    assert own["color"] == 0xFFFFFF and own["vertexColors"]
    (drawn, _), = pieces(m, m.shapes[2])
    np.testing.assert_allclose(drawn.color, np.tile([0.2, 0.4, 1], (12, 1)), atol=1e-6)
    assert (drawn.vertices.shape == (12, 3)
            and sorted(map(tuple, drawn.vertices.tolist())) == sorted([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)] * 3))


def test_a_server():
    robot = dyn.load(MODELS / "robots" / "panda.urdf", base="fixed")
    visualizer = meshcat.Visualizer()
    try:
        Display(robot, visualizer)(robot.random(1))
        assert visualizer.url().startswith("http://127.0.0.1:")
    finally:
        if visualizer.window.server_proc is not None:
            visualizer.window.server_proc.kill()
