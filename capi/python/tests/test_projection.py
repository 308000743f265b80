"""Projection of q and v onto constraints: nearness, linkages stretched flat, saddles, singular poses."""

import numpy as np
import pytest
from linkages import closed, four_bar, rod

import libdyn as dyn
from libdyn import constraint as dc


def test_projection_is_near_in_either_metric():
    for weigh in (True, False):
        m = four_bar(crank=0.7, coupler=1.2, rocker=0.9)
        d, p = closed(m, weigh=weigh)
        assert p.result.solved and p.result.residual <= 1e-12
        t = d.constraint_terms(p.q, p.v)
        assert abs(t.C).max() <= 1e-12 and abs(t.Jv).max() < 1e-12
    M = d.crba(p.q)
    v = np.array([0.3, -1, 2.0])
    for weigh, W in ((True, M), (False, np.eye(3))):
        w = d.project(p.q, v, weigh=weigh).v
        J = d.constraint_terms(p.q, w).J
        move = W @ (v - w)  # in the range of J'
        assert abs(move - J.T @ np.linalg.lstsq(J.T, move, rcond=None)[0]).max() < 1e-10


def arm(lengths, target, **more):
    """Rods in the plane whose tip is held at a point."""
    b, parent, tip = dyn.Builder("arm"), None, None
    for k, length in enumerate(lengths):
        rod(b, f"j{k}", parent, tip, length)
        parent, tip = f"j{k}", (length, 0, 0)
    b.add_frame("tip", parent, tip)
    b.add_constraint("wall", dc.loop("revolute", "tip", None, axis=(0, 0, 1), placement2=(*target, 0), **more))
    return b.finish()


@pytest.mark.parametrize("weigh", [True, False])
def test_projection_onto_linkages_stretched_flat(weigh):
    """J loses rank at the solution: an arm that just reaches the wall, from many starts; and one that cannot quite ends stretched
    towards it."""
    far = 1.5 * np.array([np.cos(0.4), np.sin(0.4)])
    for lengths in ((1.0, 0.5), (0.5, 1.0), (0.6, 0.5, 0.4)):
        d = arm(lengths, far).data()
        for seed in range(10):
            p = d.project(np.random.default_rng(seed).uniform(-1, 1, len(lengths)), weigh=weigh)
            assert p.result.solved and p.result.residual <= 1e-12, (lengths, seed, p.result)
            np.testing.assert_allclose(np.exp(1j * p.q), np.exp([0.4j] + [0] * (len(lengths) - 1)),
                                       atol=1e-5)  # errors of q are roots of those of C
        d = arm(lengths, 1.01 * far).data()
        p = d.project(np.random.default_rng(1).uniform(-1, 1, len(lengths)), weigh=weigh)
        near = 1e-6 if len(lengths) == 2 else 1e-2  # of three it gets there more slowly, and says so
        assert (p.result.reason == dyn.ConstraintReason.CONTRADICTORY
                or (len(lengths) == 3 and p.result.reason == dyn.ConstraintReason.MAX_ITERATIONS))
        np.testing.assert_allclose(p.result.residual, 0.015 * np.cos(0.4), rtol=near)
        np.testing.assert_allclose(np.exp(1j * p.q), np.exp([0.4j] + [0] * (len(lengths) - 1)), atol=10 * near)


@pytest.mark.parametrize("weigh", [True, False])
def test_projection_from_a_saddle(weigh):
    """Stretched flat along the line to a nearer target no small step makes the error less; beside it one does."""
    for target, q in (((0.9, 0), (0, 0)), ((0.9, 0), (np.pi, 0)), ((1.2, 0), (0, np.pi))):
        d = arm((1.0, 0.5), target).data()
        p = d.project(np.array(q, float), weigh=weigh)
        assert p.result.solved, p.result
        assert abs(d.constraint_terms(p.q, np.zeros(2)).C).max() <= 1e-12


def test_projection_of_a_parallel_four_bar_in_its_singular_pose():
    m = four_bar()
    d = m.data()
    flat = np.array([0, 0, np.pi])
    assert d.project(flat).result.solved
    for seed in range(20):
        for size in (1e-6, 1e-3, 0.1):
            p = d.project(flat + size * np.random.default_rng(seed).normal(size=3))
            assert p.result.solved and p.result.residual <= 1e-12, (seed, size, p.result)
            assert abs(p.q - flat).max() < 5 * size ** 0.5
