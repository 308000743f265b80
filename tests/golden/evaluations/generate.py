#!/usr/bin/env python3
"""Writes dop853.json: how many evaluations scipy's DOP853 takes for which error on the smooth problems of bench/accuracy, for
capi/python/tests/test_evaluations.py.

    pip install mujoco scipy mpmath && python tests/golden/evaluations/generate.py

Accelerations are MuJoCo's (of the four-bars: of their one angle; of the squeezer: MuJoCo's M, forces and Jacobians, with
multipliers by numpy).
The reference is DOP853 at its tightest, or the closed form. Errors are the largest distance of a marker at the end.
"""

import json
import math
import sys
from pathlib import Path

import mujoco
import numpy as np
from scipy.integrate import solve_ivp

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "bench/accuracy"))
import problems  # noqa: E402
import run_mujoco  # noqa: E402

TOLERANCES = [10.0**-e for e in np.arange(3, 13.6, 0.25)]


def at_end(motion, duration, tolerance):
    done = solve_ivp(motion, (0, duration), motion.start(), "DOP853", rtol=max(tolerance, 2.3e-14), atol=tolerance)
    return int(done.nfev), motion.places(done.y[:, -1])


class OneAngle:
    """n four-bars: A th'' = B sin th, th from the upright."""

    def __init__(self, n):
        self.n, self.ratio = n, (math.fsum(((n + 1) / 2, n)) * problems.G) / ((n + 1) / 3 + n)

    def start(self):
        return np.array([0.0, 1.0])

    def __call__(self, t, y):
        return np.array([y[1], self.ratio * math.sin(y[0])])

    def places(self, y):
        return np.array([[k + math.sin(y[0]), math.cos(y[0]), 0] for k in range(self.n + 1)])


class Closed(run_mujoco.Motion):
    """MuJoCo's tree, closed by rigid points: M a + J' f = forces, J a = -J' v."""

    def __init__(self, problem):
        super().__init__(problem)
        m = self.scene.model
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EQUALITY
        self.sites = [[m.site(f"loop{k}{side}").id for side in "ab"] for k in range(len(problem.loops))]

    def __call__(self, t, y):
        m, d = self.scene.model, self.scene.data
        rate = super().__call__(t, y)
        n = m.nv
        M, J, drift, jac, acc = np.zeros((n, n)), [], [], np.zeros((2, 3, n)), np.zeros((2, 6))
        mujoco.mj_fullM(m, d, M)
        free = M @ d.qacc
        d.qacc[:] = 0
        mujoco.mj_rnePostConstraint(m, d)
        for pair in self.sites:
            for k, site in enumerate(pair):
                mujoco.mj_jacSite(m, d, jac[k], None, site)
                mujoco.mj_objectAcceleration(m, d, mujoco.mjtObj.mjOBJ_SITE, site, acc[k], 0)
            J.append((jac[0] - jac[1])[:2]), drift.append((acc[0] - acc[1])[3:5])  # in the plane
        J, drift = np.vstack(J), np.concatenate(drift)
        scale = 1 / np.sqrt(np.diag(M))
        rows = len(J)
        K = np.block([[M * np.outer(scale, scale), (J * scale).T], [J * scale, np.zeros((rows, rows))]])
        a = np.linalg.solve(K, np.concatenate([free * scale, -drift]))[:n] * scale
        return np.concatenate([rate[:m.nq], a])


def figures(problem, motion, reference=None):
    reference = at_end(motion, problem.duration, 1e-15)[1] if reference is None else reference
    counts = []
    for tolerance in TOLERANCES:
        n, places = at_end(motion, problem.duration, tolerance)
        counts.append([n, float(np.max(np.linalg.norm(places - reference, axis=1)))])
    return {"name": f"{problem.name}, {problem.duration:g} s", "mjcf": problem.mjcf, "duration": problem.duration, "q": problem.q,
            "v": problem.v, "tau": problem.tau, "markers": problem.markers, "reference": reference.tolist(), "dop853": counts}


def lasting(problem, duration):
    problem.duration = duration
    return problem


def main():
    out = []
    for problem in (problems.pendulum(), lasting(problems.pendulum(), 100), problems.double_pendulum(),
                    lasting(problems.double_pendulum(), 20), problems.box(), problems.heavy_top(), problems.planar_chain()):
        out.append(figures(problem, run_mujoco.Motion(problem), problem.exact(problem.duration) if problem.exact else None))
    bars, n = lasting(problems.four_bars(4), 5), 4
    out.append(figures(bars, OneAngle(n), bars.exact(5)))
    squeezer = problems.squeezer()
    out.append(figures(squeezer, Closed(squeezer)))
    for f in out:
        print(f["name"], [x for x in f["dop853"] if 1e-10 < x[1] < 1e-8])
    (HERE / "dop853.json").write_text(json.dumps({"made with": f"mujoco {mujoco.__version__}", "problems": out}, indent=1) + "\n")


if __name__ == "__main__":
    main()
