"""SciPy: a step's derivatives as linear operators, and residuals with Jacobians for scipy.optimize (package scipy).

    from libdyn.doors import scipy as door
    A, B, B_control = door.step_operators(data)             # A @ dx, A.T @ y, B @ dtau
    r = door.Residual(model, "frame_placement", [q0], target=placement, frame="hand")
    solution = scipy.optimize.least_squares(r.fun, r.zero, r.jac)
    q = r.inputs(solution.x)[0]
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, aslinearoperator  # type: ignore[import-untyped, import-not-found, unused-ignore]

from ..arrays import checked
from ..errors import ArgumentError
from .function import Function

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..arrays import Numbers
    from ..data import Data
    from ..model import Model


def step_operators(data: Data, **options: Any) -> tuple[LinearOperator, LinearOperator, LinearOperator]:
    """A, B and B_control of data.step_derivatives(**options), on tangent spaces. matvec is a JVP, rmatvec a VJP."""
    x = data.step_derivatives(**options)
    A, B, B_control = map(aslinearoperator, (x.A, x.B, x.B_control))
    return A, B, B_control


class Residual:
    """fun(z) = weight (f(inputs(z)) - target) and its Jacobian.

    z moves the inputs named in `over` from `start`, on their tangent spaces: q = start (+) z. zero is the z of the start.

    start    the inputs of f
    over     names of the inputs that z moves, in this order
    target   the outputs of f, one after another
    weight   of each number of the outputs, or one for all
    options  frame, dt, integrator: see libdyn.doors.function
    """

    def __init__(self, model: Model, name: str, start: Sequence[ArrayLike], target: ArrayLike, over: Sequence[str] = ("q",),
                 weight: ArrayLike = 1.0, **options: Any):
        self.f: Function = Function(model, name, threads=1, **options)
        f = self.f
        f.check([np.shape(x) for x in start])
        names = [i.name for i in f.inputs]
        if isinstance(over, str) or not over or len(set(over)) < len(over) or not set(over) <= set(names):
            raise ArgumentError(f"over is {over!r}, but must be some of {names}, each once.")
        self.start: list[Numbers] = [checked(x, (i.size,), i.name) for x, i in zip(start, f.inputs)]
        self.over: list[int] = [names.index(name) for name in over]
        size = sum(o.size for o in f.outputs)
        self.target: Numbers = checked(target, (size,), "target")
        self.weight: Numbers = checked(np.broadcast_to(weight, (size,)) if np.ndim(weight) == 0 else weight, (size,), "weight")
        self.zero: Numbers = np.zeros(sum(f.inputs[k].tangent for k in self.over))

    def _parts(self, z: ArrayLike) -> list[Numbers]:
        z = checked(z, self.zero.shape, "z")
        return np.split(z, np.cumsum([self.f.inputs[k].tangent for k in self.over])[:-1])

    def inputs(self, z: ArrayLike) -> list[Numbers]:
        """The inputs of f at z."""
        x = list(self.start)
        for k, part in zip(self.over, self._parts(z)):
            x[k] = self.f.model.integrate(x[k], part) if k == 0 else x[k] + part
        return x

    def fun(self, z: ArrayLike) -> Numbers:
        return self.weight * (np.concatenate(self.f(*self.inputs(z))) - self.target)

    def jac(self, z: ArrayLike) -> Numbers:
        y, J = self.f.tangents(*self.inputs(z))
        out = []
        for o, by in enumerate(J):
            columns = [by[k] for k in self.over]
            for n, (k, part) in enumerate(zip(self.over, self._parts(z))):
                if k == 0:
                    columns[n] = columns[n] @ self.f.model.integrate_jacobians(self.start[0], part)[1]
            out += [self.f.lift(o, y[o][None], np.concatenate(columns, -1).T).T]
        return self.weight[:, None] * np.concatenate(out)
