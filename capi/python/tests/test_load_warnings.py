"""Collision meshes are hulls by default; what is missing is a warning, and small defects do not refuse a model."""

import warnings

import libdyn as dyn
import numpy as np
import pytest

CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
FACES = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
MJCF = """<mujoco><asset><mesh name="m" file="{file}"/></asset><worldbody><body name="b"><joint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
  <geom type="{type}" mesh="m" {more}/></body></worldbody></mujoco>"""
URDF = """<robot name="r"><link name="l"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry>{shape}</geometry></collision></link></robot>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "cube.obj").write_text(CUBE + FACES)
    (tmp_path / "points.obj").write_text(CUBE)
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4\nf 1 4 3\n")
    return tmp_path


def mjcf(folder, file="cube.obj", type="mesh", more="", **options):
    path = folder / "m.xml"
    path.write_text(MJCF.format(file=file, type=type, more=more))
    return dyn.load(path, **options)


def urdf(folder, shape, **options):
    path = folder / "r.urdf"
    path.write_text(URDF.format(shape=shape))
    return dyn.load(path, base="fixed", **options)


def shapes(m):
    return [s.type for s in m.shapes]


def test_hulls_by_default(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert shapes(mjcf(folder)) == shapes(urdf(folder, '<mesh filename="cube.obj"/>')) == [dyn.ShapeType.CONVEX]
        assert shapes(mjcf(folder, meshes="none")) == [dyn.ShapeType.MESH]


@pytest.mark.parametrize("load", [lambda f, **o: mjcf(f, "gone.obj", **o), lambda f, **o: urdf(f, '<mesh filename="gone.obj"/>', **o)])
def test_a_missing_mesh_is_one_warning_and_an_error_under_strict(folder, load):
    with pytest.warns(dyn.LoadWarning, match="gone.obj") as said:
        m = load(folder)
    assert len(said) == 1 and shapes(m) == [dyn.ShapeType.MESH]
    with pytest.raises(dyn.StrictError, match="gone.obj"):
        load(folder, strict=True)
    with pytest.raises(dyn.Error):
        load(folder, meshes="hull")


def test_a_flat_mesh_is_a_warning(folder):
    for meshes in ("auto", "hull"):
        with pytest.warns(dyn.LoadWarning, match="not tested"):
            assert shapes(urdf(folder, '<mesh filename="flat.obj"/>', meshes=meshes)) == [dyn.ShapeType.MESH]


def test_an_obj_of_vertices_alone_is_its_hull(folder):
    m = mjcf(folder, "points.obj")
    assert shapes(m) == [dyn.ShapeType.CONVEX]


@pytest.mark.parametrize("type, size", [("sphere", [0.5]), ("box", [0.5, 0.5, 0.5]), ("capsule", [0.5, 0.25]), ("cylinder", [0.5, 0.5]), ("ellipsoid", [0.5, 0.5, 0.5])])
def test_primitives_fitted_to_a_cube(folder, type, size):
    mujoco = pytest.importorskip("mujoco")
    m = mjcf(folder, type=type)
    mm = mujoco.MjModel.from_xml_path(str(folder / "m.xml"))
    g = mm.geom(0)
    np.testing.assert_allclose(g.size[: len(size)], size, atol=1e-6)
    s = m.shapes[0]
    ours = np.array([x for x in s.size if x > 0])
    if type in ("capsule", "cylinder"):
        ours = [s.size[0], s.size[1] / 2]
    elif type == "box":
        ours = ours / 2
    np.testing.assert_allclose(ours, size, atol=1e-6)
    np.testing.assert_allclose(s.placement.translation, [0.5, 0.5, 0.5], atol=1e-6)


def test_a_builtin_mesh_is_left_out(folder):
    path = folder / "b.xml"
    path.write_text('<mujoco><asset><mesh name="m" builtin="sphere" params="2"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>')
    with pytest.warns(dyn.LoadWarning, match="built in"):
        assert shapes(dyn.load(path)) == []


def test_a_sphere_of_radius_0_is_left_out(folder):
    with pytest.warns(dyn.LoadWarning, match="size of 0"):
        assert shapes(urdf(folder, '<sphere radius="0"/>')) == []


def test_a_mocap_body_is_a_warning():
    text = '<mujoco><worldbody><body mocap="true"><geom size=".1"/></body></worldbody></mujoco>'
    with pytest.warns(dyn.LoadWarning, match="stands still"):
        dyn.load_string(text)
    with pytest.raises(dyn.StrictError, match="mocap"):
        dyn.load_string(text, strict=True)
