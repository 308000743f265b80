"""Inverse kinematics of an arm: the loop that textbooks show, written out, and dyn's own, from the same 1000 random starts.

    python inverse_kinematics.py [STARTS]

The loop: e = log(target^-1 X) is the hand's error in the hand's own axes, so the Jacobian beside it is the LOCAL one (an error
in one frame and a Jacobian in another is the usual reason why such a loop wanders off). Steps are damped least squares, taken on
the manifold by integrate. It knows no limits and starts once; d.ik keeps the limits, adapts its damping, and starts again where
it gets nowhere.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import libdyn as dyn
from libdyn import ik

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"
HAND, EXACT = "panda_hand", 1e-6  # m, rad


def by_hand(model: dyn.Model, data: dyn.Data, target: dyn.Placement, q: np.ndarray, steps: int = 200,
            damping: float = 1e-6) -> tuple[np.ndarray, bool]:
    """q of a damped Gauss-Newton loop, and whether the hand is there."""
    for _ in range(steps):
        data.forward_kinematics(q)
        X = data.frame_placement(HAND)
        e = (target.inverse() @ X).log()
        if np.abs(e).max() < EXACT:
            return q, True
        J = data.frame_jacobian(HAND, "local")
        q = model.integrate(q, -J.T @ np.linalg.solve(J @ J.T + damping * np.eye(6), e))
    return q, False


def main(starts: int = 1000) -> None:
    model = dyn.load(PANDA, base="fixed")
    data = model.data()
    met, within, solved = 0, 0, 0
    iterations: list[int] = []
    for k in range(starts):
        data.forward_kinematics(model.random(2 * k))  # a pose that some q reaches
        target = data.frame_placement(HAND)
        start = model.random(2 * k + 1)
        q, there = by_hand(model, data, target, start)
        met += there
        within += there and bool(np.all((model.lower_limit <= q) & (q <= model.upper_limit)))
        answer = data.ik([ik.pose(HAND, target)], start)
        if answer.converged:
            solved += 1
            iterations.append(answer.iterations)
            data.forward_kinematics(answer.q)
            X = data.frame_placement(HAND)
            assert np.linalg.norm(X.translation - target.translation) < 1.01 * EXACT, "ik said that the hand is there"
            assert np.linalg.norm(X.rotation - target.rotation) < 2 * EXACT
            assert np.all((model.lower_limit <= answer.q) & (answer.q <= model.upper_limit)), "ik keeps the limits"
    print(f"{starts} poses of {HAND} that can be reached, each from a random start, within {EXACT:g} m and rad:")
    print(f"the loop by hand met {met}, of which {within} lie within the joint limits")
    print(f"dyn's ik met {solved}, all within the limits, in {np.median(iterations):g} iterations (median)")
    assert solved >= 0.99 * starts and within < solved, "restarts and limits are what the loop lacks"


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
