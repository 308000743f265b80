"""Meshes of MJCF have the masses that MuJoCo gives them: builtin ones, shells, files in single precision."""

import struct

import libdyn as dyn
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")


def inertias(mesh, folder="."):
    """(ours, theirs): mass and moments of a free body of this mesh about its joint."""
    text = f"""<mujoco><compiler meshdir="{folder}"/><asset><mesh name="m" {mesh}/></asset><worldbody><body><freejoint/>
      <geom type="mesh" mesh="m" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""
    m, mm, theirs = dyn.load_string(text), mujoco.MjModel.from_xml_string(text), np.empty((6, 6))
    md = mujoco.MjData(mm)
    mujoco.mj_forward(mm, md)
    mujoco.mj_fullM(mm, md, theirs)
    d = m.data()
    return d.crba(d.q), theirs


def same(mesh, folder=".", tolerance=2e-8):
    """MuJoCo's principal axes are good to about 1e-8 (its eigenvalues end at an absolute tolerance); its masses to rounding."""
    ours, theirs = inertias(mesh, folder)
    assert abs(ours[0, 0] / theirs[0, 0] - 1) < 1e-12
    assert abs(ours - theirs).max() < tolerance * abs(theirs[3:, 3:]).max()


@pytest.mark.parametrize(
    "mesh",
    [
        'builtin="sphere" params="0"',
        'builtin="sphere" params="2"',
        'builtin="hemisphere" params="0"',
        'builtin="hemisphere" params="5"',
        'builtin="cone" params="8 0"',
        'builtin="cone" params="12 0.4"',
        'builtin="supersphere" params="12 1 1"',
        'builtin="supersphere" params="20 0.4 0.6"',
        'builtin="supersphere" params="9 2.5 2"',
        'builtin="supertorus" params="16 0.3 1 1"',
        'builtin="supertorus" params="10 0.5 0.4 2"',
        'builtin="wedge" params="5 6 60 40 0"',
        'builtin="wedge" params="8 4 90 45 0.7"',
        'builtin="sphere" params="2" inertia="shell"',
        'builtin="supertorus" params="16 0.3 1 1" inertia="shell" scale="1 2 -3"',
        'builtin="supertorus" params="16 0.3 1 1" inertia="exact"',
        'builtin="supertorus" params="16 0.3 1 1" inertia="convex"',
    ],
)
def test_builtin_meshes(mesh):
    same(mesh)


def test_a_supertorus_has_the_volume_of_its_polygon_turned():
    """Pappus: area of the tube's polygon times the way of its middle, less what the corners of the ring cut off."""
    n, r = 400, 0.3
    ours, _ = inertias(f'builtin="supertorus" params="{n} {r} 1 1" inertia="exact"')
    area = n / 2 * r**2 * np.sin(2 * np.pi / n)
    assert ours[0, 0] == pytest.approx(1000 * area * 2 * np.pi, rel=3 * (np.pi / n) ** 2)


def test_a_plate_is_a_shell():
    """Its corners are the middles of 3 x 5 cells of the square of 2 m: 4/3 by 8/5 m."""
    ours = dyn.load_string("""<mujoco><asset><mesh name="m" builtin="plate" params="3 5"/></asset><worldbody><body><freejoint/>
      <geom type="mesh" mesh="m" density="1" contype="0" conaffinity="0"/></body></worldbody></mujoco>""")
    a, b = 4 / 3, 8 / 5
    assert ours.total_mass == pytest.approx(a * b, rel=1e-6)
    d = ours.data()
    assert np.diag(d.crba(d.q))[3:] == pytest.approx(
        a * b * np.array([b**2 / 12 + 1, a**2 / 12 + 1, (a**2 + b**2) / 12]), rel=1e-6
    )


@pytest.mark.parametrize(
    "params, what",
    [
        ('"sphere" params="5"', "from 0 to 4"),
        ('"supertorus" params="9 0 1 1"', "number 2 is positive"),
        ('"wedge" params="3 3 190 40 0"', "at most"),
        ('"supersphere" params="9 -1 1"', "0 or more"),
        ('"prism" params="3"', "none of sphere"),
        ('"cone"', "needs params"),
    ],
)
def test_impossible_builtin_meshes_are_errors(params, what):
    with pytest.raises(dyn.Error, match=what):
        inertias(f"builtin={params}")


def test_files_have_single_precision(tmp_path):
    """A tetrahedron with corners that are no floats: MuJoCo's volume follows from the rounded ones."""
    corners = np.array([[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [0.1, 1.3, 0.3], [0.1, 0.2, 1.7]])
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    (tmp_path / "m.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join("f %d %d %d\n" % tuple(k + 1 for k in f) for f in faces)
    )
    (tmp_path / "m.stl").write_bytes(
        bytes(80) + struct.pack("<I", 4) + b"".join(struct.pack("<12fH", 0, 0, 0, *corners[list(f)].ravel(), 0) for f in faces)
    )
    for name in ("m.obj", "m.stl"):
        same(f'file="{name}"', tmp_path)
    same(f'vertex="{" ".join(map(str, corners.ravel()))}" face="{" ".join(str(k) for f in faces for k in f)}"')


def test_quadrilaterals_of_obj_files_split_at_the_shorter_diagonal(tmp_path):
    """A box whose lid is bent: the volume depends on the diagonal."""
    for n, lift in enumerate(((0, 0, 0.3, 0), (0, 0.3, 0, 0), (0.2, 0, 0.3, 0))):
        corners = [
            (x, y, z + (lift[k] if z else 0)) for z in (0, 1) for k, (x, y) in enumerate(((0, 0), (1, 0), (1, 1.2), (0, 1)))
        ]
        faces = [(4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8)]
        text = "".join("v %g %g %g\n" % c for c in corners) + "".join("f %d %d %d %d\n" % f for f in faces)
        (tmp_path / f"m{n}.obj").write_text(text)  # MuJoCo caches files by their names
        same(f'file="m{n}.obj"', tmp_path)
