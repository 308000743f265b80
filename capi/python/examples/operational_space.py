"""Operational space control: an arm's hand follows a circle by forces on the hand, and keeps its attitude.

    python operational_space.py [PAGE.html]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import libdyn as dyn
from libdyn import Placement

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"
HAND, RADIUS, DURATION = "panda_hand", 0.1, 4.0  # m, s: of two rounds
STIFFNESS, DAMPING = 400.0, 40.0  # 1/s^2, 1/s: of the error of the hand


def main(page: str | None = None) -> dyn.Recording:
    bent = {f"panda_joint{k}": x for k, x in zip(range(1, 8), (0, -0.5, 0, -2.2, 0, 1.8, 0.8))}
    sim = dyn.Simulation(PANDA, bent, base="fixed", effects=())
    terms = sim.model.data()
    home = sim.q.copy()
    terms.forward_kinematics(home)
    start = terms.frame_placement(HAND)
    errors: list[float] = []

    def goal(t: float) -> Placement:
        """The hand's placement on the circle, from rest to rest."""
        s = np.clip(t / DURATION, 0, 1)
        angle = 4 * np.pi * s * s * (3 - 2 * s)
        return Placement(start.rotation, start.translation + RADIUS * np.array([0, np.sin(angle), 1 - np.cos(angle)]))

    def twist(t: float) -> np.ndarray:
        """Its velocity, in its own axes."""
        return (goal(t).inverse() @ goal(t + sim.dt)).log() / sim.dt

    def controller(sim: dyn.Simulation) -> np.ndarray:
        q, v = sim.q, sim.v
        M, h = terms.crba(q), terms.compute_nle(q, v)
        J, hand = terms.frame_jacobian(HAND), terms.frame_placement(HAND)
        error = (hand.inverse() @ goal(sim.time)).log()  # a twist in the hand's axes
        errors.append(float(np.linalg.norm(error)))
        t = sim.time
        wanted = STIFFNESS * error + DAMPING * (twist(t) - J @ v) + (twist(t + sim.dt) - twist(t)) / sim.dt
        inverse = np.linalg.inv(M)
        inertia = np.linalg.inv(J @ inverse @ J.T + 1e-6 * np.eye(6))
        rest = M @ (40 * (home - q) - 12 * v)  # what is left keeps the elbow
        tau: np.ndarray = J.T @ inertia @ wanted + rest - J.T @ (inertia @ (J @ (inverse @ rest))) + h
        return tau

    with sim.record() as recording:
        sim.run(DURATION, controller)
    print(f"{len(errors)} steps; the hand was at most {1e3 * max(errors):.2g} mm and mrad off, at the end {1e3 * errors[-1]:.2g}")
    assert max(errors) < 0.01
    print(f"largest torque {np.abs(recording.tau).max():.0f} N m")
    if page:
        recording.to_html(page)
        print(f"open {page}")
    return recording


if __name__ == "__main__":
    main(*sys.argv[1:])
