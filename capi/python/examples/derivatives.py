"""Derivatives of inverse dynamics: analytic, and by differences at every step length. Time, and error: the V-curve.

    python derivatives.py [ROBOT.urdf BASE]

A difference of length e errs by e^2 (what the curve bends) plus u / e (what rounding leaves of a difference of near numbers, u =
1e-16 relative), so that no e is good: central differences get 10 of 16 digits at best. The analytic derivatives have no e. On a
floating base and wherever nq and nv differ, steps of q are taken by integrate.
"""

import sys
import time
from pathlib import Path

import numpy as np

import libdyn as dyn

GO2 = Path(__file__).resolve().parents[3] / "models" / "robots" / "go2.urdf"


def central(model, data, q, v, a, e):
    """dtau/dq column by column, in 2 nv calls."""
    out = np.empty((model.nv, model.nv))
    for j, step in enumerate(e * np.eye(model.nv)):
        out[:, j] = (data.rnea(model.integrate(q, step), v, a) - data.rnea(model.integrate(q, -step), v, a)) / (2 * e)
    return out


def least_time(call, repeat=20):
    best = np.inf
    for _ in range(repeat):
        began = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - began)
    return best


def main(path=GO2, base="floating"):
    model = dyn.load(path, base=base)
    data, random = model.data(), np.random.default_rng(1)
    q, v, a = model.random(1), random.standard_normal(model.nv), random.standard_normal(model.nv)
    exact = data.rnea_derivatives(q, v, a)
    assert np.abs(data.M.copy() - data.crba(q)).max() < 1e-13, "dtau/da is M, which the call leaves in data"
    size = np.abs(exact.dtau_dq).max()
    print(f"{model.name}: dtau/dq, {model.nv} x {model.nv}, entries up to {size:.3g}")
    print("step length   error of central differences, relative")
    errors = {}
    for e in (float(f"1e{k}") for k in range(-12, 0)):
        errors[e] = np.abs(central(model, data, q, v, a, e) - exact.dtau_dq).max() / size
        print(f"{e:11.0e}   {errors[e]:.1e}")
    best = min(errors, key=errors.get)
    print(f"best: {errors[best]:.1e} at {best:.0e}")
    assert errors[best] < 1e-8 and 1e-7 < best < 1e-3, "the analytic derivatives are what differences tend to"
    assert errors[1e-12] > 100 * errors[best] and errors[1e-1] > 100 * errors[best], "a V: both ends are bad"
    assert 50 < errors[1e-2] / errors[1e-3] < 200, "right of the dip the error falls with the square of the step"

    rnea, analytic = least_time(lambda: data.rnea(q, v, a)), least_time(lambda: data.rnea_derivatives(q, v, a))
    differences = least_time(lambda: central(model, data, q, v, a, best))
    print(f"time in Python: rnea {1e6 * rnea:.3g} us; analytic by q, v and a {1e6 * analytic:.3g} us; differences by q alone "
          f"{1e6 * differences:.3g} us")


if __name__ == "__main__":
    main(*sys.argv[1:])
