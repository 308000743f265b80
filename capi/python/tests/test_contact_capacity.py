"""Room for contact points: what a wall needs by default, and a warning where points are left out."""

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import libdyn as dyn


def wall(rows, columns, capacity=0):
    """Bricks in running bond on the ground."""
    b = dyn.Builder("wall")
    b.add_shape("universe", "half_space", name="ground")
    for k in range(rows * columns):
        b.add_joint(f"joint{k}", "free_flyer")
        b.add_body(f"brick{k}", f"joint{k}", mass=1.0, inertia=np.diag([0.01, 0.02, 0.02]))
        b.add_shape(f"brick{k}", "box", (0.4, 0.2, 0.2))
    b.set_contact_capacity(capacity)
    m = b.finish()
    d = m.data()
    q = d.q.copy()
    for k in range(rows * columns):
        row, column = divmod(k, columns)
        q[7 * k : 7 * k + 3] = 0.4 * column + 0.2 * (row % 2), 0, 0.1 + 0.2 * row
    d.q = q
    return d


def test_a_wall_of_100_bricks_drops_no_point():
    d = wall(10, 10)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = d.advance(0.005)
    assert report.dropped == 0
    assert report.contacts > 16 + 8 * 101  # eight a shape were too few


def test_dropped_points_are_a_warning_once():
    d = wall(4, 4, capacity=40)
    with pytest.warns(dyn.ContactWarning, match="contact_capacity") as seen:
        for _ in range(200):
            d.step()
        d.advance(0.01)
    assert len(seen) == 1


def robot(count, type, size=(), surface=None):
    """A floating body and others around it that joints hold, with a shape each; on the ground where z is that of its lowest point."""
    b = dyn.Builder("robot")
    b.add_shape("universe", "half_space", name="ground")
    b.add_joint("base", "free_flyer")
    for k in range(count):
        if k:
            b.add_joint(f"joint{k}", "revolute", parent="base", placement=(1.0 * k, 0, 0), axis=(0, 1, 0))
        b.add_body(f"body{k}", f"joint{k}" if k else "base", mass=1.0, inertia=np.diag([0.01, 0.01, 0.02]))
        b.add_shape(f"body{k}", type, size, surface=surface)
    return b.finish()


def plate():
    """A hexagon 0.1 m high."""
    turn = np.arange(6) * np.pi / 3
    ring = 0.2 * np.stack([np.cos(turn), np.sin(turn)], 1)
    return dyn.Mesh.from_arrays([(x, y, z) for z in (-0.05, 0.05) for x, y in ring]).hull()


def test_the_default_is_what_the_header_says():
    for count in (5, 20):
        assert robot(count, "sphere", [0.1]).contact_capacity == 16 + count
        assert robot(count, "box", [0.1, 0.1, 0.1]).contact_capacity == 16 + 2 * count
        hulls = min(count, 12)
        assert robot(count, "convex", surface=plate()).contact_capacity == 16 + 6 * hulls + 2 * (count - hulls)


def test_ten_hulls_of_a_robot_lie_flat():
    m = robot(10, "convex", surface=plate())
    d = m.data()
    q = d.q.copy()
    q[2] = 0.05
    d.q = q
    d.step()
    assert (d.step_report.contacts, d.step_report.dropped) == (60, 0)


SHARES = [Path(p) / "cmeel.prefix/share" for p in sys.path]
FALLING = {f.stem: f for share in SHARES for f in share.glob("example-robot-data/robots/*/*/*.urdf")
           if f.stem in ("kinova", "solo", "bolt", "so100", "icub", "anymal-kinova")}


@pytest.mark.skipif(not FALLING, reason="package example-robot-data is not installed")
@pytest.mark.parametrize("name", FALLING)
def test_robots_fall_onto_the_ground_without_a_dropped_point(name):
    b = dyn.Builder.from_model(dyn.load(FALLING[name], base="floating", package_dirs=FALLING[name].parents[4]))
    b.add_shape("universe", "half_space", name="ground")
    m = b.finish()
    ground = [k for k, p in enumerate(m.pairs) if m.nshapes - 1 in (p.shape_a, p.shape_b)]
    for seed in range(5):
        d = m.data()
        q = np.array(m.random(seed))
        turn = np.random.default_rng(seed).normal(size=4)
        q[:3], q[3:7] = 0, turn / np.linalg.norm(turn)
        q[2] = 0.02 - d.compute_distances(q)[ground].min()
        d.q = q
        while d.time < 0.5:
            d.step()
            assert d.step_report.dropped == 0, (seed, d.time)
