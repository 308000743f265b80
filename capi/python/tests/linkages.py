"""Robots under constraints, and dense solutions to compare with: for the tests of constraints."""

import numpy as np
from conftest import MODELS

import libdyn as dyn
from libdyn import constraint as dc

FEET = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")


def go2(**options):
    m = dyn.load(MODELS / "robots" / "go2.urdf", base="floating", **options)
    d = m.data()
    for foot in FEET:
        d.add_constraint(dc.point(foot))
    return m, d


def rod(b, name, parent, placement, length, type="revolute", axis=(0, 0, 1), mass=1.0, **more):
    """A joint and a slender rod along x."""
    b.add_joint(name, type, parent, placement, axis=axis, **more)
    b.add_body(name + "_rod", name, mass=mass, com=(length / 2, 0, 0),
               inertia=np.diag([1e-3, mass * length**2 / 12, mass * length**2 / 12]))


def four_bar(crank=1.0, coupler=1.0, rocker=1.0, ground=1.0, kind="loop", copies=1, **more):
    """Three rods in the plane, closed at the ground by a hinge, `copies` times."""
    b = dyn.Builder("four_bar")
    rod(b, "a", None, None, crank)
    rod(b, "b", "a", (crank, 0, 0), coupler)
    rod(b, "c", "b", (coupler, 0, 0), rocker)
    b.add_frame("tip", "c", (rocker, 0, 0))
    for k in range(copies):
        if kind == "loop":
            c = dc.loop("revolute", "tip", None, axis=(0, 0, 1), placement2=(ground, 0, 0), **more)
        else:
            c = getattr(dc, kind)("tip", None, placement2=(ground, 0, 0), **more)
        b.add_constraint(f"pin{k}", c)
    return b.finish()


def closed(m, seed=1, **options):
    d = m.data()
    q = np.array([1.0, -0.9, -1.2]) + 0.1 * np.random.default_rng(seed).normal(size=3) if m.nv == 3 else m.random(seed=seed)
    v = np.random.default_rng(seed).normal(size=m.nv)
    return d, d.project(q, v, **options)


def kkt(d, q, v, tau, gains=(0, 0), redundant=False):
    """ddq and J' lambda of the dense system."""
    t = d.constraint_terms(q, v)
    M, h = d.crba(q), d.compute_nle(q, v)
    b = -t.drift - gains[0] * t.C - gains[1] * t.Jv
    L = np.linalg.cholesky(M)
    A = np.linalg.solve(L, t.J.T)
    free = np.linalg.solve(M, tau - h)
    forces = np.linalg.lstsq(A.T @ A, b - t.J @ free, rcond=1e-11)[0] if redundant else np.linalg.solve(A.T @ A, b - t.J @ free)
    return free + np.linalg.solve(M, t.J.T @ forces), t.J.T @ forces


def random_state(m, seed):
    g = np.random.default_rng(seed)
    return m.random(seed=seed), g.normal(size=m.nv), g.normal(size=m.nv)


LOOPS = {"revolute": 5, "prismatic": 5, "helical": 5, "cylindrical": 4, "universal": 4, "spherical": 3, "planar": 3,
         "translation": 3}


def arms(constraint):
    """Two arms on a moving base, with what ties their ends."""
    b = dyn.Builder("arms")
    b.add_joint("base", "free_flyer").add_body("trunk", "base", mass=3, inertia=np.diag([0.2, 0.3, 0.4]))
    g = np.random.default_rng(5)
    for side, y in (("l", 0.3), ("r", -0.3)):
        parent, at = "base", (0.1, y, 0.2)
        for k, (type, axis) in enumerate((("revolute", (0, 0, 1)), ("revolute", (0, 1, 0)), ("spherical", (0, 0, 1)),
                                          ("prismatic", (1, 0.2, 0)), ("continuous", (1, 0, 0)))):
            b.add_joint(f"{side}{k}", type, parent, at, axis=axis)
            b.add_body(f"{side}{k}_link", f"{side}{k}", mass=1, com=g.normal(size=3) * 0.1, inertia=np.diag([0.1, 0.12, 0.15]))
            parent, at = f"{side}{k}", (0.3, 0.05, -0.1)
        Q, _ = np.linalg.qr(g.normal(size=(3, 3)))
        b.add_frame(f"{side}_end", parent, (Q * np.linalg.det(Q), (0.2, 0.1, 0)))
    if constraint is not None:
        b.add_constraint("tie", constraint)
    return b.finish()


GAINS = dict(stiffness=30.0, damping=7.0)
TIES = {f"loop {k}": dc.loop(k, "l_end", "r_end", axis=(0.2, 0.3, 1), axis2=(3.0, -2.0, 0.0), pitch=0.2, **GAINS) for k in LOOPS}
TIES |= {
    "point": dc.point("l_end", **GAINS),
    "frame": dc.frame("l_end", None, placement2=(0.3, 0.2, 0.1), **GAINS),
    "connect": dc.connect("l_end", "r_end", placement1=(0.1, 0, 0), **GAINS),
    "weld": dc.weld("l_end", "r_end", **GAINS),
    "distance": dc.distance("l_end", "r_end", 0.4, **GAINS),
    "coupling": dc.coupling("l0", "r3", (0.1, 0.5, -0.3, 0.2, 0.05), **GAINS),
    "friction": dc.friction("l0", 1e-3, damping=5.0),
}


def differences(f, n):
    """Extrapolated central differences, a column for each direction."""
    out = []
    for k in range(n):
        e = np.zeros(n)
        e[k] = 1.0
        D = lambda h: (f(h * e) - f(-h * e)) / (2 * h)
        h = 2e-3
        out.append((64 * D(h / 4) - 20 * D(h / 2) + D(h)) / 45)
    return np.array(out).T
