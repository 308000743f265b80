"""An arm that floats: torques against its weight, and inverse dynamics that forward dynamics undoes.

    python gravity_compensation.py [ROBOT.urdf]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"


def main(path: str | Path = PANDA) -> None:
    model = dyn.load(path, base="fixed")
    data, zero = model.data(), np.zeros(model.nv)
    print(f"{model.name}: {model.total_mass:.3g} kg, {model.nv} degrees of freedom")

    # at rest, inverse dynamics is gravity: the same numbers, not nearly the same
    for seed in range(5):
        q = model.random(seed)
        assert np.array_equal(data.rnea(q, zero, zero), data.gravity_torque(q))
    print("rnea(q, 0, 0) is gravity(q), bit for bit, at 5 configurations")

    # the torques of a wanted acceleration give that acceleration, and M a + h is the same torque
    worst, eps = 0.0, np.finfo(float).eps
    for seed in range(5):
        random = np.random.default_rng(seed)
        q, v, a = model.random(seed), random.standard_normal(model.nv), random.standard_normal(model.nv)
        tau = data.rnea(q, v, a)
        M, error = data.crba(q), np.abs(data.aba(q, v, tau) - a).max()
        assert error < 50 * eps * np.linalg.cond(M), "rounding of the torques, times what the inverse of M makes of it"
        assert np.abs(M @ a + data.compute_nle(q, v) - tau).max() < 50 * eps * np.abs(tau).max()
        worst = max(worst, error)
    print(f"aba(q, v, rnea(q, v, a)) is a, within {worst:.1g}")

    # in simulation: nothing holds the arm but these torques, computed again every millisecond
    home = model.integrate(model.neutral(), 0.3 * np.ones(model.nv))
    for held in (True, False):
        robot = model.data()
        robot.set_effects(())  # no friction that could hide a wrong torque
        for pair in range(model.npairs):
            robot.set_pair(pair, False)
        robot.set_state(home)
        robot.set_step_options("rk4", 1e-3)
        for _ in range(1000):
            robot.set_state(tau=data.gravity_torque(robot.q) if held else zero)
            robot.step()
        moved = np.abs(model.difference(home, robot.q)).max()
        print(f"after 1 s {'with gravity compensation' if held else 'without'} it moved {moved:.2g} rad")
        assert (moved < 1e-9) if held else (moved > 0.5)


if __name__ == "__main__":
    main(*sys.argv[1:])
