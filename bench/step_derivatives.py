#!/usr/bin/env python3
"""Derivatives of a step beside MuJoCo's mjd_transitionFD, in one interleaved run on one core.

    python bench/step_derivatives.py [--passes 30] [ROBOT ...]

Robots with position servos stand on a floor; the arm does not touch it. MuJoCo reads the model as libdyn saves it. Steps of 2 ms.
libdyn: A, B and B_control, analytic and by central differences, and a VJP. MuJoCo: A and B, centred. Prints a table in Markdown: the time of
the function in C, ratios of times from Python, contacts, and those that are degenerate: a contact at rest neither overlaps nor has
a gap. Needs the package mujoco.
"""

import argparse
import tempfile
from ctypes import byref, sizeof
from pathlib import Path

import mujoco
import numpy as np

from libdyn import abi
from libdyn.library import lib
from rollout import DT, ROBOTS, dyn, scene, timed

EPSILON = 1e-6


class Standing:
    """A robot after 1.2 s under its servos, in both libraries."""

    def __init__(self, name):
        m, q, stance = scene(name)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.xml"
            m.save(path)
            self.m, self.mm = m, mujoco.MjModel.from_xml_path(str(path))
        self.mm.opt.timestep = DT
        self.d, self.md = self.m.data(), mujoco.MjData(self.mm)
        x = m.to_peer("mujoco", q, np.zeros(m.nv))
        self.d.set_step_options(dt=DT)
        self.d.set_state(q)
        self.d.set_control(stance)
        self.d.advance(1.2)
        self.md.qpos, self.md.ctrl = x.q, stance
        for _ in range(round(1.2 / DT)):
            mujoco.mj_step(self.mm, self.md)
        n, nu = self.mm.nv, self.mm.nu
        self.A, self.B = np.empty((2 * n + self.mm.na, 2 * n + self.mm.na)), np.empty((2 * n + self.mm.na, nu))

    def step(self):
        state = self.d.save_state()
        self.d.step()
        self.d.restore_state(state)

    def call(self, product=False):
        """dyn_step_derivatives with its arguments, for matrices or a VJP that are kept."""
        nv, nu = self.m.nv, self.m.nu
        out = abi.StepDerivatives()
        lib.dyn_step_derivatives_init(byref(out), sizeof(out))
        if product:
            kept = [np.ones(2 * nv), np.empty(3 * nv + nu)]
            out.cotangents, out.vjp, out.cotangent_count = kept[0].ctypes.data, kept[1].ctypes.data, 1
        else:
            kept = [np.empty((2 * nv, k), order="F") for k in (2 * nv, nv, nu)]
            out.A, out.B, out.B_control = (x.ctypes.data for x in kept)
        return lambda: (lib.dyn_step_derivatives(self.d._m, self.d._d, None, byref(out)), kept)[0]

    def theirs(self):
        mujoco.mjd_transitionFD(self.mm, self.md, EPSILON, 1, self.A, self.B, None, None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--passes", type=int, default=30)
    parser.add_argument("robots", nargs="*", metavar="ROBOT")
    o = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}; the least time of {o.passes} interleaved calls each.\n")
    print("| robot | contacts | degenerate | us in C | VJP, us in C | analytic / MuJoCo | central / MuJoCo | analytic / step | method |\n|---|"
          + "---:|" * 7 + "---|")  # fmt: skip
    for name in o.robots or ROBOTS:
        s, times = Standing(name), {}
        call, product = s.call(), s.call(product=True)
        for _ in range(o.passes):
            timed("C", times, call), timed("VJP", times, product)
            ours = timed("ours", times, s.d.step_derivatives)
            timed("central", times, lambda: s.d.step_derivatives("central_differences"))
            timed("theirs", times, s.theirs), timed("step", times, s.step)
        print(f"| {name} | {len(ours.contacts)} | {ours.degenerate_count} | {1e6 * times['C']:.1f} | {1e6 * times['VJP']:.1f} | {times['ours'] / times['theirs']:.3f} | "
              f"{times['central'] / times['theirs']:.2f} | {times['ours'] / times['step']:.1f} | {ours.method.name.lower()} {ours.reason} |")  # fmt: skip


if __name__ == "__main__":
    main()
