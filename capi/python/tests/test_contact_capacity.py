"""Room for contact points: what a wall needs by default, and a warning where points are left out."""

import warnings

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
