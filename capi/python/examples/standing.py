"""Whole-body inverse dynamics of a standing quadruped: torques and contact forces for an acceleration of the trunk.

    python standing.py [ROBOT.urdf]

M a + h = S'tau + sum J_k'f_k. For given q, v and a wanted the six rows of the base hold no motor: J_b'f = (M a + h)_b =: w must
come from the feet, f_k in its friction cone. Four feet have twelve forces for six rows: the least ones that do it solve the quadratic
program
    min |J_b'f - w|^2 / 2 + epsilon |f|^2 / 2   over the cones
which dyn.contact_problem_qp gives with pyramids in the cones (here for daqp, if it is installed), and dyn.contact_solve with the
cones themselves: G = J_b J_b' + epsilon I, g = -J_b w. As long as no foot slides both are the same minimum. Then tau is what is
left of the other rows.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import libdyn as dyn

GO2 = Path(__file__).resolve().parents[3] / "models" / "robots" / "go2.urdf"
FEET = ("FL_foot", "FR_foot", "RL_foot", "RR_foot")
MU, EPSILON = 0.6, 1e-6


class Answer(NamedTuple):
    tau: np.ndarray
    forces: np.ndarray  # (feet, 3), world axes, N
    missing: np.ndarray  # (6,), what the feet cannot provide
    qp: np.ndarray | None  # the forces by the quadratic program


def standing(model):
    """q with bent legs, feet below the hips."""
    q = model.neutral()
    for leg in ("FL", "FR", "RL", "RR"):
        for joint, angle in (("hip", 0.0), ("thigh", 0.8), ("calf", -1.6)):
            q[model.joint(f"{leg}_{joint}_joint").idx_q] = angle
    return q


def qp_forces(G, g):
    """The same by a solver of quadratic programs, or None when there is none."""
    try:
        import daqp
    except ImportError:
        return None
    qp = dyn.contact_problem_qp(G, g, friction=np.full(len(FEET), MU), facets=32)
    H, A = qp.dense()
    big = 1e30
    x, _, flag, _ = daqp.solve(H, qp.g, A, np.minimum(qp.upper, big), np.maximum(qp.lower, -big),
                               np.zeros(len(qp.lower), np.int32))
    return np.array(x).reshape(-1, 3) if flag == 1 else None


def inverse_dynamics(model, data, q, v, a, tolerance=1e-13, epsilon=EPSILON, weights=np.ones(6)):
    data.forward_kinematics(q, v)
    J = np.vstack([data.frame_jacobian(foot, reference=dyn.LOCAL_WORLD_ALIGNED)[:3] for foot in FEET])
    need = data.rnea(q, v, a)  # M a + h
    J_b, w = J[:, :6] * weights, need[:6] * weights  # what matters more where the feet cannot provide all
    G, g = J_b @ J_b.T + epsilon * np.eye(len(J)), -J_b @ w
    solution = dyn.contact_solve((G + G.T) / 2, g, friction=np.full(len(FEET), MU), tolerance=tolerance)
    if not solution.report.converged:
        raise RuntimeError(f"no forces were found: {solution.report}")
    f = solution.impulse
    return Answer((need - J.T @ f)[6:], f.reshape(-1, 3), need[:6] - J[:, :6].T @ f, qp_forces(G, g))


def main(path=GO2):
    model = dyn.load(path, base="floating")
    data, q, v = model.data(), standing(model), np.zeros(model.nv)
    for name, push in (("standing", (0, 0, 0)), ("1 m/s^2 forward", (1, 0, 0)), ("1 m/s^2 to the left", (0, 1, 0)),
                       ("2 m/s^2 up", (0, 0, 2))):
        a = np.zeros(model.nv)
        a[:3] = push
        answer = inverse_dynamics(model, data, q, v, a)
        share = np.linalg.norm(answer.forces[:, :2], axis=1) / (MU * answer.forces[:, 2])
        print(f"{name}: vertical forces {answer.forces[:, 2].round(2)} N, share of the cone {share.max():.2f}, largest torque "
              f"{abs(answer.tau).max():.2f} N m")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
