"""Identifies a robot's inertial parameters from its motion and torques.

    python identification.py [ROBOT.urdf]

tau = Y(q, v, a) pi + armature a is linear in the parameters pi (ten a body), so that torques measured along a rich motion give pi
by least squares. Not all of pi moves the torques: what they determine are the base parameters, the part of pi in the row space of
the stacked regressor. Least squares finds that part, but its bodies need not exist (negative masses ...). So the bodies are
fitted again in log-Cholesky parameters theta, every value of which is a body that can exist, by Levenberg-Marquardt from a rough
guess.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Callable

import numpy as np

import libdyn as dyn

PANDA = Path(__file__).resolve().parents[3] / "models" / "robots" / "panda.urdf"


def motion(model: dyn.Model, seed: int, samples: int = 400, seconds: float = 10.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a along a sum of sines within the limits of a fixed-base robot."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, seconds, samples)[:, None]
    lower, upper = np.maximum(model.lower_limit, -2), np.minimum(model.upper_limit, 2)
    q, v, a = (np.zeros((samples, model.nv)) for _ in range(3))
    for harmonic in range(1, 6):
        w = 2 * np.pi * harmonic / seconds
        amplitude = rng.uniform(0.3, 1, model.nv) * (upper - lower) / 10
        phase = rng.uniform(0, 2 * np.pi, model.nv)
        q += amplitude * np.sin(w * t + phase)
        v += amplitude * np.cos(w * t + phase) * w
        a -= amplitude * np.sin(w * t + phase) * w**2
    return q + (lower + upper) / 2, v, a


def measure(model: dyn.Model, data: dyn.Data, seed: int, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """The stacked regressor W of a motion, and the torques that were measured less those of the armature."""
    q, v, a = motion(model, seed)
    rng = np.random.default_rng(seed + 1)
    W = np.vstack([data.joint_torque_regressor(*x) for x in zip(q, v, a)])
    tau = np.concatenate([data.rnea(*x) - model.armature * x[2] for x in zip(q, v, a)])
    return W, tau + noise * rng.standard_normal(tau.size)


def base_parameters(W: np.ndarray, tolerance: float = 1e-9) -> np.ndarray:
    """Orthonormal rows B: B @ pi is what the torques of this motion determine."""
    _, s, Vt = np.linalg.svd(W, full_matrices=False)
    return np.asarray(Vt[s > tolerance * s[0]])


def each_body(convert: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    return np.concatenate([convert(body) for body in x.reshape(-1, 10)])


def fit_consistent(W: np.ndarray, tau: np.ndarray, guess: np.ndarray, steps: int = 100) -> np.ndarray:
    """Levenberg-Marquardt from the guess to the pi of bodies that can exist that minimises |W pi - tau|."""
    Q, R = np.linalg.qr(W)
    y = Q.T @ tau  # |W pi - tau| but for a constant is |R pi - y|
    theta = each_body(dyn.log_cholesky_from_parameters, guess)
    residual, damping = y - R @ guess, 1e-3
    for _ in range(steps):
        J = np.hstack([R[:, k : k + 10] @ dyn.log_cholesky_jacobian(theta[k : k + 10]) for k in range(0, theta.size, 10)])
        A = np.vstack([J, np.sqrt(damping) * np.eye(theta.size)])
        trial = theta + np.linalg.lstsq(A, np.concatenate([residual, np.zeros(theta.size)]), rcond=None)[0]
        trial_residual = y - R @ each_body(dyn.parameters_from_log_cholesky, trial)
        better = np.linalg.norm(trial_residual) < np.linalg.norm(residual)
        damping *= 0.3 if better else 5
        if better:
            theta, residual = trial, trial_residual
    return each_body(dyn.parameters_from_log_cholesky, theta)


def identify(path: str | Path = PANDA, noise: float = 0.05) -> dict[str, Any]:
    """Figures of one identification; noise in N m."""
    model = dyn.load(path, base="fixed")
    data = model.data(parts=dyn.Part.INVERSE | dyn.Part.REGRESSOR)
    pi = model.inertial_parameters()
    W, tau = measure(model, data, seed=1, noise=noise)
    B = base_parameters(W)
    W_new, tau_new = measure(model, data, seed=2, noise=0)  # another motion, to predict

    # a rough guess: all that the maker's data sheet says is wrong by up to a half
    rng = np.random.default_rng(3)
    guess = each_body(dyn.log_cholesky_from_parameters, pi) + rng.uniform(-0.25, 0.25, pi.size)
    guess = each_body(dyn.parameters_from_log_cholesky, guess)

    least_squares = np.linalg.lstsq(W, tau, rcond=1e-9)[0]
    consistent = fit_consistent(W, tau, guess)
    robot = dyn.with_inertial_parameters(model, consistent)  # the result, put back into the robot
    again = np.concatenate([robot.data().rnea(*x) - robot.armature * x[2] for x in zip(*motion(robot, seed=2))])
    assert np.abs(again - W_new @ consistent).max() < 1e-9 * np.abs(tau_new).max(), "it moves as was identified"
    found = {"guess": guess, "least squares": least_squares, "consistent": consistent}
    figures: dict[str, Any] = {"parameters": pi.size, "base parameters": len(B)}
    for name, x in found.items():
        figures[name] = {
            "base error": np.linalg.norm(B @ (x - pi)) / np.linalg.norm(B @ pi),
            "prediction error": np.linalg.norm(W_new @ x - tau_new) / np.linalg.norm(tau_new),
            "bodies that can exist": sum(dyn.is_physically_consistent(body) for body in x.reshape(-1, 10)),
        }
    return figures


if __name__ == "__main__":
    figures = identify(sys.argv[1] if len(sys.argv) > 1 else PANDA)
    print(f"{figures.pop('parameters')} parameters, of which torques determine {figures.pop('base parameters')}")
    for name, row in figures.items():
        print(f"{name:14}", "  ".join(f"{key} {value:.3g}" for key, value in row.items()))
