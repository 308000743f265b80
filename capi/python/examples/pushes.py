"""Finds how hard a quadruped that stands may be pushed: 128 simulations in one call.

    python pushes.py

Each begins standing, with another speed of the trunk in another direction, as after a kick. The servos hold the stance. Half of
the robots have masses and friction that differ from those of the file.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

SCENE = Path(__file__).resolve().parents[3] / "models" / "scenes" / "go2_stands.xml"
N, SECONDS, FASTEST = 64, 1.0, 3.0  # of each kind of robot; s; m/s


def survivors(model: dyn.Model, speed: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Which of the robots stand at the end."""
    begin = dyn.Simulation(model, "standing")
    v = np.zeros((len(speed), model.nv))
    v[:, 0], v[:, 1] = speed * np.cos(angle), speed * np.sin(angle)
    records = round(SECONDS / 0.02)
    control = np.tile(begin.ctrl, (records, 1))
    every = round(0.02 / begin.dt)
    r = dyn.batch.rollout(model, begin.q, v, control=control, every=every, dt=begin.dt, sensors={"com": "com"})
    return r.sensors["com"][:, -1, 2] > 0.2


def main() -> int:
    model = dyn.load(SCENE)
    random = np.random.default_rng(1)
    speed, angle = random.uniform(0, FASTEST, N), random.uniform(-np.pi, np.pi, N)
    stands = {"of the file": survivors(model, speed, angle),
              "that differ": np.concatenate([survivors(dyn.vary(model, k, mass=0.2, contact_friction=(0.4, 1.0)), s, a)
                                             for k, (s, a) in enumerate(zip(np.split(speed, 8), np.split(angle, 8)))])}
    for kind, up in stands.items():
        slow, fast = up[speed < FASTEST / 2].mean(), up[speed >= FASTEST / 2].mean()
        print(f"robots {kind}: {slow:.0%} stand after a kick of less than {FASTEST / 2:g} m/s, {fast:.0%} after a faster one; the "
              f"fastest that one withstood was {speed[up].max():.1f} m/s")
    return 0 if stands["of the file"][speed < 0.3].all() else 1


if __name__ == "__main__":
    sys.exit(main())
