"""Contacts, rays, closest points, sweeps, groups, and the broad phase."""

import numpy as np
import pytest

import libdyn as dyn
from libdyn import PairReason, SweepStatus

I = np.eye(3)


def at(x, y, z):
    return (I, (x, y, z))


def scene():
    b = dyn.Builder("scene").add_shape("universe", "half_space")
    b.add_joint("f", "free_flyer").add_body("box", "f", 1, inertia=I)
    b.add_shape("box", "box", (1, 1, 1), radius=0.1, contype=2, conaffinity=1)
    return b.finish()


def test_shapes():
    contacts = dyn.geometry_contacts(("half_space", ()), at(0, 0, 0), ("box", (2, 2, 2)), at(0, 0, 0.99))
    assert len(contacts) == 4 and len({c.feature for c in contacts}) == 4
    for c in contacts:
        assert c.distance == pytest.approx(-0.01)
        np.testing.assert_allclose(np.abs(c.position), [1, 1, 0.005], atol=1e-12)
    hit = dyn.geometry_ray(("sphere", 1), at(0, 0, 0), (0, 0, 5), (0, 0, -1))
    assert hit.t == pytest.approx(4) and hit.normal[2] == pytest.approx(1)
    assert dyn.geometry_ray(("sphere", 1), at(0, 0, 0), (0, 0, 5), (0, 1, 0)) is None
    near = dyn.geometry_closest_point(("capsule", (0.5, 2)), at(0, 0, 0), (2, 0, 0.3))
    assert near.distance == pytest.approx(1.5) and near.unique
    impact = dyn.geometry_sweep(("sphere", 1), at(0, 0, 5), (0, 0, -1, 0, 0, 0), ("half_space", ()), at(0, 0, 0), None, 10)
    assert impact.status is SweepStatus.HIT and impact.time == pytest.approx(4)
    with pytest.raises(dyn.ArgumentError, match="margin"):
        dyn.geometry_contacts(("sphere", 1), at(0, 0, 0), ("sphere", 1), at(0, 0, 0), -1)


def test_a_scene():
    m = scene()
    assert (m.shapes[1].radius, m.shapes[1].contype, m.shapes[1].conaffinity) == (0.1, 2, 1)
    d, q = m.data(), np.array([0, 0, 0.595, 0, 0, 0, 1.0])
    d.set_pair(None, True)  # they overlap in the neutral configuration
    contacts = d.contacts(q)
    assert len(contacts) == 4 and all(c.distance == pytest.approx(-0.005) and c.pair == 0 for c in contacts)
    smooth = d.smooth_distances(0.01)
    assert (smooth.distances[0] == pytest.approx(-0.005 - 0.01 * np.log(4)) and smooth.points.tolist() == [4]
            and smooth.gradients.shape == (1, 6))
    rays = d.rays([(0, 0, 5), (9, 0, 5), (0, 0, 5)], [(0, 0, -1), (0, 0, -1), (0, 0, 1)], q)
    np.testing.assert_allclose(rays.t, [5 - 1.195, 5, np.inf], atol=1e-9)
    assert rays.shapes.tolist() == [1, 0, -1] and rays.normals.shape == (3, 3)
    assert d.rays([(0, 0, 5)], [(0, 0, -1)], mask=1).shapes.tolist() == [0]
    d.set_shape_masks(1, 2, 2)
    assert d.shape_masks(1) == (2, 2) and d.pair_reason(0) is PairReason.MASK and not d.contacts()


def test_broad_phase():
    rng = np.random.default_rng(1)
    lower = rng.uniform(0, 1, (50, 3))
    upper = lower + 0.2
    b = dyn.BroadPhase(50, margin=0.01)
    for k in range(50):
        assert b.insert(lower[k], upper[k]) == k
    meet = np.all((lower[:, None] <= upper[None]) & (lower[None] <= upper[:, None]), axis=2)
    assert b.pairs().tolist() == np.argwhere(np.triu(meet, 1)).tolist()
    assert b.query(lower[3], upper[3]).tolist() == np.flatnonzero(meet[3]).tolist()
    assert 3 in b.ray(lower[3] - 1, (1.1, 1.1, 1.1))
    b.update(0, (5, 5, 5), (6, 6, 6))
    b.remove(1)
    assert not np.isin(b.pairs(), [0, 1]).any()
    with pytest.raises(dyn.ArgumentError, match="no box 1"):
        b.remove(1)
