"""A quadruped that topples onto its joints: few contacts that jam and slide, the hardest small problems of contact."""

from __future__ import annotations

import numpy as np

import libdyn as dyn


def quadruped():
    legs = "".join(
        f'<body pos="{x} {y} 0"><joint axis="0 1 0" range="-100 100" damping=".5" armature=".01"/>'
        '<geom type="capsule" size=".02" fromto="0 0 0 0 0 -.2" mass=".3"/>'
        '<body pos="0 0 -.2"><joint axis="0 1 0" range="-150 150" damping=".5" armature=".01"/>'
        '<geom type="capsule" size=".02" fromto="0 0 0 0 0 -.2" mass=".2"/></body></body>'
        for x in (-0.2, 0.2) for y in (-0.12, 0.12))
    trunk = f'<body pos="0 0 .35"><freejoint/><geom type="box" size=".25 .1 .05" mass="8"/>{legs}</body>'
    return f'<mujoco><worldbody><geom type="plane" size="5 5 1"/>{trunk}</worldbody></mujoco>'


def test_steps_of_a_toppling_quadruped_are_solved():
    m = dyn.load_string(quadruped())
    unsolved, residuals, energy = 0, [], []
    for start in range(4):  # pushed aside
        d = m.data()
        d.set_state(m.configuration("qpos0"), np.r_[0.05 * start, 0, 0, 0, 0.05 * start, np.zeros(m.nv - 5)])
        for _ in range(2000):
            d.step(0.002)
            unsolved += d.step_report.unsolved
            residuals.append(d.step_report.residual)
        energy.append(d.energy().kinetic)
    assert unsolved <= 60  # of 8,000; without the smoothing method 400 of the first 6,000
    assert np.quantile(residuals, 0.999) < 0.005
    assert max(residuals) < 0.5  # one of 8,000, which rounding chooses
    assert max(energy) < 1e-20  # J: it rests
