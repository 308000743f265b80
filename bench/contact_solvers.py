#!/usr/bin/env python3
"""Contact solvers: residual against time, beside Pinocchio's ADMM and PGS on the same problems.

    DYN_LIBRARY=build/release/lib python3 bench/contact_solvers.py [--repeat N] [--markdown]

Every problem is a Delassus matrix, a free velocity and coefficients of friction. The residual is the same function for all
(dyn_contact_solver_residuals: relative, independent of units); each solver is run for tolerances 1e-4 to 1e-10 and the time of
the first run that reaches a residual counts: the least of many runs, of the call alone (Pinocchio: its own timer in the solver;
libdyn: the call with all its checks of inputs). Without the wheel pin libdyn's columns alone are printed.
"""

import argparse
import sys
import time
from ctypes import byref, sizeof
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "capi" / "python"))

import libdyn as dyn
from libdyn import abi
from libdyn.arrays import address
from libdyn.contact_solver import _Problem
from libdyn.library import lib

try:
    import pinocchio as pin
except ImportError:
    pin = None

TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
DT = 1e-3


def rigid(masses, contacts, mu, v=None):
    """Free bodies of masses with inertia of a 0.2 m cube; contacts: (body, below or -1, point on the body, point below)."""
    dof = 6 * len(masses)
    J = np.zeros((3 * len(contacts), dof))
    for k, (a, b, p, r) in enumerate(contacts):
        for body, point, sign in ((a, p, 1), (b, r, -1)):
            if body >= 0:
                x, y, z = point
                J[3 * k : 3 * k + 3, 6 * body : 6 * body + 6] += sign * np.c_[np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]]
    minv = np.concatenate([[1 / m] * 3 + [6 / (m * 0.04)] * 3 for m in masses])
    v = np.zeros(dof) if v is None else np.array(v, float)
    v[2::6] -= 9.81 * DT
    G = J @ (minv[:, None] * J.T)
    return (G + G.T) / 2, J @ v, np.full(len(contacts), mu)


def stack(masses, mu=0.7, push=0.0):
    corners = [(x, y) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    contacts = [(b, b - 1, (x, y, -0.1), (x, y, 0.1)) for b in range(len(masses)) for x, y in corners]
    v = np.zeros(6 * len(masses))
    v[-6] = push
    return rigid(masses, contacts, mu, v)


def feet(n, copies=1, push=0.0):
    angle = 2 * np.pi * (np.arange(n) + 0.5) / n
    return rigid([12.0], [(0, -1, (0.3 * np.cos(t), 0.3 * np.sin(t), -0.3), None) for t in angle for _ in range(copies)], 0.5,
                 [push, push / 3, 0, 0, 0, 0])


def random(contacts, dof, mu, seed):
    rng = np.random.default_rng(seed)
    J = rng.standard_normal((3 * contacts, dof))
    return (J @ J.T + (J @ J.T).T) / 2, J @ rng.standard_normal(dof), np.full(contacts, mu)


PROBLEMS = {
    "4 feet standing": feet(4), "4 feet sliding": feet(4, push=0.02), "4 feet, each contact 10 times, sliding": feet(4, 10, 0.02),
    "random, 10 contacts": random(10, 36, 0.5, 1), "random, 30 contacts": random(30, 100, 0.5, 2),
    "2 cubes 1:1, pushed": stack([1, 1], push=0.004), "2 cubes 1:1000": stack([1, 1e3]), "2 cubes 1:1e6": stack([1, 1e6]),
    "10 cubes": stack([1.0] * 10), "10 cubes, pushed": stack([1.0] * 10, push=0.004),
}  # fmt: skip


class Ours:
    def __init__(self, name, G, g, mu):
        self.problem, self.name = _Problem(G, g, friction=mu), name
        self.solver, self.args = dyn.ContactSolver(len(g)), (G, g, mu)
        self.impulse, self.report, self.options = np.zeros(len(g)), abi.ContactReport(), abi.ContactOptions()
        lib.dyn_contact_options_init(byref(self.options), sizeof(self.options))
        self.options.solver = dyn.ContactSolverType[name.upper()]

    def __call__(self, tolerance, iterations):
        self.options.tolerance, self.options.max_iterations = tolerance, iterations
        p, o, r, x = byref(self.problem.c), byref(self.options), byref(self.report), address(self.impulse)
        start = time.perf_counter()
        lib.dyn_contact_solver_solve(self.solver._s, p, o, x, None, r)
        return time.perf_counter() - start, self.impulse


class Pinocchio:
    def __init__(self, name, G, g, mu):
        model = pin.Model()
        joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
        data = model.createData()
        pin.forwardKinematics(model, data, pin.neutral(model))
        self.models, self.datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        for m in mu:
            contact = pin.PointContactConstraintModel(model, joint, pin.SE3.Identity())
            contact.set = pin.CoulombFrictionCone(float(m))
            self.models.append(pin.ConstraintModel(contact))
        for m in self.models:
            d = m.createData()
            m.calc(model, data, d)
            self.datas.append(d)
        kind = {"admm": "ADMM", "pgs": "PGS"}[name]
        self.solver = getattr(pin, f"{kind}ConstraintSolver")(len(g))
        self.settings, self.result = getattr(pin, f"{kind}SolverSettings")(), getattr(pin, f"{kind}SolverResult")()
        self.settings.measure_timings = True
        self.G, self.g = G, g

    def __call__(self, tolerance, iterations):
        s = self.settings
        scale = np.abs(self.g).max()
        s.absolute_feasibility_tol = s.absolute_complementarity_tol = tolerance * scale
        s.relative_feasibility_tol = s.relative_complementarity_tol = 0.0
        s.max_iterations = iterations
        self.solver.reset()
        self.result.reset()
        delassus = pin.DelassusOperatorDense(self.G)
        start = time.perf_counter()
        self.solver.solve(delassus, self.g, self.models, self.datas, s, self.result)
        wall = time.perf_counter() - start
        inner = self.solver.getElapsedTime() * 1e-6
        return min(wall, inner) if inner > 0 else wall, np.array(self.result.retrieveConstraintImpulses())


def ladder(make, name, problem, repeat):
    """{target: (seconds, iterations are the solver's own)}: of the cheapest tolerance that reaches the target."""
    G, g, mu = problem
    run, judge, best = make(name, G, g, mu), dyn.ContactSolver(len(g)), {}
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12):
        _, x = run(tolerance, 20000 if name == "pgs" else 2000)
        residual = judge.residuals(G, g, x, friction=mu).residual if np.isfinite(x).all() else np.inf
        wanted = [t for t in TARGETS if residual <= t and t not in best]
        if wanted:
            count = repeat if len(g) < 100 else max(3, repeat // 10)
            seconds = min(run(tolerance, 20000 if name == "pgs" else 2000)[0] for _ in range(count))
            best.update({t: seconds for t in wanted})
        if len(best) == len(TARGETS):
            break
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--repeat", type=int, default=200)
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    columns = [("pgs", Ours, "pgs"), ("admm", Ours, "admm"), ("newton", Ours, "newton")]
    if pin:
        columns += [("Pinocchio PGS", Pinocchio, "pgs"), ("Pinocchio ADMM", Pinocchio, "admm")]
    print("microseconds to a residual; -: not reached\n")
    print("| problem | residual | " + " | ".join(c[0] for c in columns) + " |\n|---|---|" + "---:|" * len(columns))
    for title, problem in PROBLEMS.items():
        if args.only not in title:
            continue
        found = [ladder(make, name, problem, args.repeat) for _, make, name in columns]
        for t in TARGETS:
            print(f"| {title} | {t:.0e} | " + " | ".join(f"{1e6 * f[t]:.1f}" if t in f else "-" for f in found) + " |",
                  flush=True)


if __name__ == "__main__":
    main()
