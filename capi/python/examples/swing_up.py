"""A small DDP: the torques that swing a double pendulum up, by the derivatives of forward dynamics.

    python swing_up.py

States x = (q, v), steps v+ = v + h aba(q, v, u), q+ = q (+) h v+. Differential dynamic programming (its Gauss-Newton form) needs
the derivatives A = dx+/dx, B = dx+/du of each step; they follow from aba_derivatives. Deviations of q live on the tangent space:
model.difference.
"""

from __future__ import annotations

from pathlib import Path
from typing import Tuple

import numpy as np

import libdyn as dyn

PENDULUM = Path(__file__).resolve().parents[3] / "models" / "robots" / "double_pendulum.urdf"
STEPS, H, EFFORT, ARRIVAL = 100, 0.02, 1e-3, 100.0  # -, s, weights of u^2 and of the end


State = Tuple[np.ndarray, np.ndarray]  # q, v; of gains k, K


class Problem:
    def __init__(self) -> None:
        self.model = dyn.load(PENDULUM, base="fixed")
        self.data = self.model.data()
        self.data.set_effects(())
        self.start, self.goal = self.model.neutral(), np.array([np.pi, 0.0])

    def step(self, q: np.ndarray, v: np.ndarray, u: np.ndarray) -> State:
        v = v + H * self.data.aba(q, v, u)
        return self.model.integrate(q, H * v), v

    def derivatives(self, q: np.ndarray, v: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A, B: of a step by (q, v) and u."""
        a_q, a_v, a_u = self.data.aba_derivatives(q, v, u)
        one = np.eye(self.model.nv)
        v_x, v_u = np.hstack([H * a_q, one + H * a_v]), H * a_u
        # q+ = q (+) w with w = h v+: its derivatives by q and by w
        q_q, q_w = self.model.integrate_jacobians(q, H * (v + H * self.data.aba(q, v, u)))
        q_x = np.hstack([q_q, 0 * one]) + H * q_w @ v_x
        return np.vstack([q_x, v_x]), np.vstack([H * q_w @ v_u, v_u])

    def roll(self, u: np.ndarray) -> list[State]:
        path = [(self.start, np.zeros(self.model.nv))]
        for k in range(STEPS):
            path.append(self.step(*path[-1], u[k]))
        return path

    def away(self, x: State) -> np.ndarray:
        return np.concatenate([self.model.difference(self.goal, x[0]), x[1]])

    def cost(self, path: list[State], u: np.ndarray) -> float:
        return float(H * EFFORT * np.sum(u**2) / 2 + ARRIVAL * np.sum(self.away(path[-1]) ** 2) / 2)

    def improve(self, path: list[State], u: np.ndarray, damping: float) -> list[State]:
        """Feed-forward k and feedback K of every step, from the last to the first."""
        nv = self.model.nv
        V_x, V_xx = ARRIVAL * self.away(path[-1]), ARRIVAL * np.eye(2 * nv)
        gains: list[State] = []
        for (q, v), u_k in zip(reversed(path[:-1]), reversed(u)):
            A, B = self.derivatives(q, v, u_k)
            Q_x, Q_u = A.T @ V_x, H * EFFORT * u_k + B.T @ V_x
            Q_xx, Q_ux, Q_uu = A.T @ V_xx @ A, B.T @ V_xx @ A, H * EFFORT * np.eye(nv) + B.T @ V_xx @ B
            inverse = np.linalg.inv(Q_uu + damping * np.eye(nv))
            k, K = -inverse @ Q_u, -inverse @ Q_ux
            V_x = Q_x + K.T @ Q_uu @ k + K.T @ Q_u + Q_ux.T @ k
            V_xx = Q_xx + K.T @ Q_uu @ K + K.T @ Q_ux + Q_ux.T @ K
            gains.append((k, K))
        return gains[::-1]

    def follow(self, path: list[State], u: np.ndarray, gains: list[State],
               share: float) -> tuple[list[State], np.ndarray]:
        """The path with the gains applied to what it deviates from the old one."""
        new = [path[0]]
        controls: list[np.ndarray] = []
        for (q, v), u_k, (k, K) in zip(path, u, gains):
            deviation = np.concatenate([self.model.difference(q, new[-1][0]), new[-1][1] - v])
            controls.append(u_k + share * k + K @ deviation)
            new.append(self.step(*new[-1], controls[-1]))
        return new, np.array(controls)


def check_derivatives(problem: Problem) -> None:
    """A and B beside central differences."""
    model, random = problem.model, np.random.default_rng(0)
    q, v, u, h = model.random(1), random.standard_normal(model.nv), random.standard_normal(model.nv), 1e-5
    A, B = problem.derivatives(q, v, u)
    for j, column in enumerate(np.hstack([A, B]).T):
        e = h * np.eye(3 * model.nv)[j].reshape(3, -1)
        (q1, v1), (q0, v0) = (problem.step(model.integrate(q, s * e[0]), v + s * e[1], u + s * e[2]) for s in (1, -1))
        difference = np.concatenate([model.difference(q0, q1), v1 - v0]) / (2 * h)
        assert np.abs(difference - column).max() < 1e-8, "the differences' own error is about 1e-10"


def main() -> list[State]:
    problem = Problem()
    check_derivatives(problem)
    u = np.zeros((STEPS, problem.model.nv))
    path = problem.roll(u)
    cost = problem.cost(path, u)
    print(f"a double pendulum hangs; {STEPS} steps of {H} s to swing it up; cost of doing nothing {cost:.4g}")
    damping, iterations = 1e-3, 0
    while iterations < 200 and damping < 1e6:
        iterations += 1
        gains = problem.improve(path, u, damping)
        for share in (1.0, 0.5, 0.25, 0.1):
            new, controls = problem.follow(path, u, gains, share)
            value = problem.cost(new, controls)
            if np.isfinite(value) and value < cost:
                break
        else:
            damping *= 10
            continue
        gain, path, u, cost, damping = cost - value, new, controls, value, max(damping / 5, 1e-9)
        if gain < 1e-9 * cost:
            break
    q, v = path[-1]
    off = np.abs(problem.away(path[-1])).max()
    print(f"after {iterations} iterations cost {cost:.4g}, largest torque {np.abs(u).max():.3g} N m")
    print(f"it ends upright within {off:.2g} (rad, rad/s): q = {np.round(q, 4)}, v = {np.round(v, 4)}")
    assert off < 1e-2 and cost < 10, "it stands upright"

    # the same torques in the simulator: its semi-implicit Euler is the step above
    robot = problem.model.data()
    robot.set_effects(())
    for pair in range(problem.model.npairs):
        robot.set_pair(pair, False)
    robot.set_step_options("semi_implicit_euler", H)
    robot.set_state(problem.start, np.zeros(problem.model.nv))
    for torques in u:
        robot.set_state(tau=torques)
        robot.step()
    apart = max(np.abs(problem.model.difference(q, robot.q)).max(), np.abs(robot.v - v).max())
    print(f"the simulator under the same torques ends {apart:.1g} from there")
    assert apart < 1e-9
    return path


if __name__ == "__main__":
    main()
