"""Collision and distance."""

import numpy as np
import pytest

import libdyn as dyn
from libdyn import DistanceStatus, PairReason

I = np.eye(3)


def at(x, y, z):
    return (I, (x, y, z))


def test_shapes():
    d = dyn.geometry_distance(("box", (2, 2, 2)), at(0, 0, 0), ("sphere", 0.5), at(0, 0, 3))
    assert d.distance == pytest.approx(1.5) and d.status is DistanceStatus.SEPARATED and d.unique
    np.testing.assert_allclose([d.normal, d.point_a, d.point_b], [[0, 0, 1], [0, 0, 1], [0, 0, 2.5]], atol=1e-12)
    d = dyn.geometry_distance(("cylinder", (0.5, 2), 0.1), at(0, 0, 0), ("capsule", (0.3, 1)), at(0.7, 0, 0))
    assert d.distance == pytest.approx(-0.2) and d.status is DistanceStatus.PENETRATING
    assert (dyn.geometry_distance(("half_space", ()), at(0, 0, 0), ("ellipsoid", (1, 2, 3)), at(0, 0, 5)).distance
            == pytest.approx(2))


@pytest.mark.parametrize(
    "shape, error",
    [
        (("blob", 1), dyn.ArgumentError),
        (("mesh", 1), dyn.UnsupportedError),
        (("box", (1, 2, -3)), dyn.InvalidRobotError),
        (("box", (1, 2, 3, 4)), dyn.SizeError),
        (("sphere", np.nan), dyn.NonFiniteError),
        (("sphere", 1, -1), dyn.InvalidRobotError),
    ],
)
def test_shapes_that_cannot_be(shape, error):
    with pytest.raises(error):
        dyn.geometry_distance(shape, at(0, 0, 0), ("sphere", 1), at(0, 0, 0))


def test_shapes_of_a_builder():
    b = dyn.Builder("pair").add_joint("a", "prismatic").add_body("la", "a", 1).add_shape("la", "box", (1, 1, 1))
    b.add_joint("b", "prismatic", axis=(1, 0, 0)).add_body("lb", "b",
                                                           1).add_shape("lb", "sphere", 0.5, (I, (0, 0, 3)), name="ball")
    m = b.finish()
    assert [s.name for s in m.shapes] == ["", "ball"] and m.npairs == 1
    assert m.data().compute_distances([0.25, 0])[0] == pytest.approx(3 - 0.5 - 0.5 - 0.25)
    with pytest.raises(dyn.InvalidRobotError, match="'lb'"):
        b.add_shape("lb", "sphere", -1)
    with pytest.raises(dyn.UnknownNameError, match="nobody"):
        b.add_shape("nobody", "sphere", 1)


def test_a_robot(go2, state):
    d, q = go2.data(), state[0]
    assert go2.npairs == len(go2.pairs) > 100 and all(p.reason is PairReason.TESTED for p in go2.pairs)
    distances = d.compute_distances(q)
    found = d.pair_distance(7)
    assert found.distance == distances[7] == d.field("distances")[7]
    np.testing.assert_allclose(found.point_b - found.point_a, found.distance * found.normal, atol=1e-9)
    assert d.collisions(margin=0.1).tolist() == np.flatnonzero(distances <= 0.1).tolist()

    gradients, h = d.distance_gradients(), 1e-6
    smooth = [k for k in range(go2.npairs) if d.pair_distance(k).unique]
    for k in range(6, go2.nv):
        step = np.eye(go2.nv)[k] * h
        numeric = (d.compute_distances(go2.integrate(q, step)) - d.compute_distances(go2.integrate(q, -step))) / (2 * h)
        assert np.mean(np.abs(numeric - gradients[:, k])[smooth] < 1e-6) > 0.95  # but for kinks

    d.set_pair(7, False)
    assert d.compute_distances(q)[7] == np.inf and d.pair_reason(7) is PairReason.OFF
    with pytest.raises(dyn.ArgumentError):
        d.pair_distance(7)
    d.set_pair(None, True)
    np.testing.assert_array_equal(d.compute_distances(q), distances)
    with pytest.raises(dyn.ArgumentError):
        d.pair_distance(go2.npairs)
