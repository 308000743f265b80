"""Crocoddyl: action models over libdyn's dynamics and steps (package crocoddyl; the page doors names versions that work).

    from libdyn.doors import crocoddyl as door
    running = crocoddyl.IntegratedActionModelEuler(door.DifferentialAction(model, residual), dt)
    running = door.StepAction(model, residual, dt)           # through contacts
    problem = crocoddyl.ShootingProblem(x0, [running] * n, terminal)

The cost is |r|^2 / 2, its Hessian that of Gauss and Newton. residual(q, v, u) returns r and its derivatives on tangent spaces,
by (q, v), (n, 2 nv), and by u, (n, nu). In a terminal node u is None, and the last one is not read. tau = actuation @ u.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import crocoddyl  # type: ignore[import-not-found, unused-ignore]
import numpy as np

from ..arrays import checked
from .function import Function

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..arrays import Numbers
    from ..enums import IntegratorLike
    from ..model import Model

    Cost = Callable[[Numbers, Numbers, Any], tuple[Numbers, Numbers, Any]]


class State(crocoddyl.StateAbstract):  # type: ignore[misc, unused-ignore]
    """x = (q, v) of a model; differences are (q1 (-) q0, v1 - v0)."""

    def __init__(self, model: Model):
        super().__init__(model.nq + model.nv, 2 * model.nv)
        self.model = model

    def split(self, x: Any) -> tuple[Numbers, Numbers]:
        return x[: self.model.nq], x[self.model.nq :]

    def zero(self) -> Numbers:
        return np.concatenate([self.model.neutral(), np.zeros(self.model.nv)])

    def rand(self) -> Numbers:
        return np.concatenate([self.model.random(), np.random.uniform(-1, 1, self.model.nv)])

    def diff(self, x0: Any, x1: Any) -> Numbers:
        (q0, v0), (q1, v1) = self.split(x0), self.split(x1)
        return np.concatenate([self.model.difference(q0, q1), v1 - v0])

    def integrate(self, x: Any, dx: Any) -> Numbers:
        q, v = self.split(x)
        nv = self.model.nv
        return np.concatenate([self.model.integrate(q, dx[:nv]), v + dx[nv:]])

    def _chosen(self, pair: Any, one: float, firstsecond: Any) -> Any:
        """Jacobians by the first and the second argument, of the blocks of q and `one` of v: both, or the one asked for."""
        nv, made = self.model.nv, []
        for block, sign in zip(pair, (one, 1.0)):
            J = sign * np.eye(2 * nv)
            J[:nv, :nv] = block
            made += [J]
        return made if firstsecond == crocoddyl.Jcomponent.both else made[firstsecond == crocoddyl.Jcomponent.second]

    def Jdiff(self, x0: Any, x1: Any, firstsecond: Any = crocoddyl.Jcomponent.both) -> Any:
        return self._chosen(self.model.difference_jacobians(self.split(x0)[0], self.split(x1)[0]), -1.0, firstsecond)

    def Jintegrate(self, x: Any, dx: Any, firstsecond: Any = crocoddyl.Jcomponent.both) -> Any:
        return self._chosen(self.model.integrate_jacobians(self.split(x)[0], dx[: self.model.nv]), 1.0, firstsecond)

    def JintegrateTransport(self, x: Any, dx: Any, J: Any, firstsecond: Any) -> Any:
        return self.Jintegrate(x, dx, firstsecond) @ J


def _actuation(model: Model, actuation: ArrayLike | None) -> Numbers:
    """(nv, nu); None: every degree of freedom has a motor."""
    if actuation is None:
        return np.eye(model.nv)
    matrix = np.asarray(actuation, np.float64)
    return checked(matrix, (model.nv, matrix.shape[-1] if matrix.ndim else 0), "actuation")


class _Cost:
    """What both kinds of action have: state, actuation, cost."""

    f: Function
    residual: Cost
    actuation: Numbers

    def _open(self: Any, f: Function, residual: Cost, actuation: Numbers) -> None:
        self.f, self.residual, self.actuation = f, residual, actuation

    def _inputs(self: Any, x: Any, u: Any) -> list[Numbers]:
        """q, v, tau; where u is None, tau is zero."""
        return [*self.state.split(x), self.actuation @ (np.zeros(self.nu) if u is None else u)]

    def _cost(self: Any, data: Any, x: Any, u: Any) -> None:
        r = self.residual(*self.state.split(x), u)[0]
        data.cost = r @ r / 2

    def _cost_derivatives(self: Any, data: Any, x: Any, u: Any) -> None:
        r, by_x, by_u = self.residual(*self.state.split(x), u)
        data.Lx, data.Lxx = by_x.T @ r, by_x.T @ by_x
        if u is not None:
            data.Lu, data.Luu, data.Lxu = by_u.T @ r, by_u.T @ by_u, by_x.T @ by_u


class DifferentialAction(_Cost, crocoddyl.DifferentialActionModelAbstract):  # type: ignore[misc, unused-ignore]
    """Forward dynamics in continuous time, without contacts: aba."""

    def __init__(self, model: Model, residual: Cost, actuation: ArrayLike | None = None):
        matrix = _actuation(model, actuation)
        crocoddyl.DifferentialActionModelAbstract.__init__(self, State(model), matrix.shape[1])
        self._open(Function(model, "aba", threads=1), residual, matrix)

    def calc(self, data: Any, x: Any, u: Any = None) -> None:
        if u is not None:
            data.xout = self.f(*self._inputs(x, u))[0]
        self._cost(data, x, u)

    def calcDiff(self, data: Any, x: Any, u: Any = None) -> None:
        if u is not None:
            by_q, by_v, by_tau = self.f.tangents(*self._inputs(x, u))[1][0]
            data.Fx, data.Fu = np.concatenate([by_q, by_v], -1), by_tau @ self.actuation
        self._cost_derivatives(data, x, u)


class StepAction(_Cost, crocoddyl.ActionModelAbstract):  # type: ignore[misc, unused-ignore]
    """A step of dt with its contacts: dyn_step_derivatives."""

    def __init__(self, model: Model, residual: Cost, dt: float | None = None, integrator: IntegratorLike | None = None,
                 actuation: ArrayLike | None = None):
        matrix = _actuation(model, actuation)
        crocoddyl.ActionModelAbstract.__init__(self, State(model), matrix.shape[1])
        self._open(Function(model, "step", dt=dt, integrator=integrator), residual, matrix)

    def _inputs(self, x: Any, u: Any) -> list[Numbers]:
        return [*super()._inputs(x, u), *([np.zeros(self.f.model.nu)] if self.f.model.nu else [])]

    def calc(self, data: Any, x: Any, u: Any = None) -> None:
        data.xnext = x if u is None else np.concatenate(self.f(*self._inputs(x, u)))
        self._cost(data, x, u)

    def calcDiff(self, data: Any, x: Any, u: Any = None) -> None:
        if u is not None:
            J = self.f.tangents(*self._inputs(x, u))[1]
            by_q, by_v, by_tau = (np.concatenate([by[k] for by in J]) for k in range(3))
            data.Fx, data.Fu = np.concatenate([by_q, by_v], -1), by_tau @ self.actuation
        self._cost_derivatives(data, x, u)
