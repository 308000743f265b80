"""What all doors open: a function of libdyn, its inputs and outputs, values and Jacobians of many states at once.

    aba              (q, v, tau) -> ddq
    rnea             (q, v, a) -> tau
    frame_placement  q -> placement (12): the rotation column by column, then the position, in the world
    step             (q, v, tau[, control]) -> q_next, v_next; control where the model has actuators

Derivatives are by the numbers of q (libdyn.doors.tangent). step is solved as dyn_step_derivatives does it, contacts to 1e-12,
and begins without forces of an earlier step: it depends on its arguments alone.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from ctypes import byref, sizeof
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import abi
from ..arrays import address, numbers
from ..enums import Part
from ..errors import ArgumentError, ModelError, SizeError
from ..library import check, lib
from ..model import Model
from .tangent import tangent_map_inverse, tangent_map_product

if TYPE_CHECKING:
    from ..arrays import Numbers
    from ..batch import Batch
    from ..data import Data
    from ..enums import IntegratorLike

NAMES = ("aba", "rnea", "frame_placement", "step")
PARTS = {"aba": Part.FORWARD_DERIVATIVES, "rnea": Part.INVERSE_DERIVATIVES | Part.MASS, "frame_placement": Part.JACOBIANS,
         "step": Part.SIMULATION | Part.STEP_DERIVATIVES}


class Variable(NamedTuple):
    """An input or output."""

    name: str
    size: int
    tangent: int
    """Size of its tangent space."""


class Function:
    """A function of a model: see this module. Arrays have any axes in front, the same for all inputs."""

    model: Model
    name: str
    inputs: list[Variable]
    outputs: list[Variable]
    data: Data
    batch: Batch

    def __init__(self, model: Model, name: str, *, frame: str | int | None = None, dt: float | None = None,
                 integrator: IntegratorLike | None = None, threads: int | None = None):
        if name not in NAMES:
            raise ArgumentError(f"name is {name!r}, but must be one of {', '.join(NAMES)}.")
        if (frame is None) == (name == "frame_placement"):
            wanted = "is needed" if frame is None else "belongs to frame_placement"
            raise ArgumentError(f"{name}: frame is {frame!r}, but {wanted}.")
        if name != "step" and not (dt is integrator is None):
            raise ArgumentError(f"{name}: dt and integrator belong to step.")
        if not model.nv:
            raise ModelError(f"model {model.name!r} has no joint that moves.")
        self.model, self.name = model, name
        self.frame: int = -1 if frame is None else model._frame(frame)
        q, v = Variable("q", model.nq, model.nv), Variable("v", model.nv, model.nv)
        self.inputs, self.outputs = [q, v], []
        if name == "step":
            self.inputs += [Variable("tau", model.nv, model.nv)]
            self.inputs += [Variable("control", model.nu, model.nu)] if model.nu else []
            self.outputs += [q._replace(name="q_next"), v._replace(name="v_next")]
            self.data = model.data(PARTS[name])
            self.data.set_step_options(integrator, dt)
        elif name == "frame_placement":
            self.inputs, self.outputs = [q], [Variable("placement", 12, 6)]
        else:
            self.inputs += [Variable("tau" if name == "aba" else "a", model.nv, model.nv)]
            self.outputs += [Variable("ddq" if name == "aba" else "tau", model.nv, model.nv)]
        if name != "step":
            self.batch = model.batch(threads, PARTS[name])
        self._lock = threading.Lock()

    def __repr__(self) -> str:
        inputs, outputs = (", ".join(f"{x.name}[{x.size}]" for x in group) for group in (self.inputs, self.outputs))
        return f"<{self.name} of {self.model.name!r}: ({inputs}) -> {outputs}>"

    def lift(self, output: int, y: Any, dy: Any, xp: Any = np) -> Any:
        """The change of an output's numbers for a change dy on its tangent space."""
        if self.outputs[output].name == "placement":
            columns = [y[..., k : k + 3] for k in (0, 3, 6)]
            return xp.concatenate([*(xp.cross(dy[..., 3:], c) for c in columns), dy[..., :3]], -1)
        return tangent_map_product(self.model, y, dy, xp) if self.outputs[output].name == "q_next" else dy

    def __call__(self, *x: Any) -> tuple[Numbers, ...]:
        """Outputs."""
        lead, rows = self._rows(x)
        with self._lock:
            y = self._steps(rows)[0] if self.name == "step" else [self._values(rows)]
        return tuple(o.reshape(*lead, -1) for o in y)

    def tangents(self, *x: Any) -> tuple[tuple[Numbers, ...], list[list[Numbers]]]:
        """Outputs, and J on tangent spaces: J[o][i] is the derivative of output o by input i, (..., rows, columns)."""
        lead, rows = self._rows(x)
        with self._lock:
            if self.name == "step":
                y, J = self._steps(rows, True)
            else:
                y, J = [self._values(rows)], [self._derivatives(rows)]
        return tuple(o.reshape(*lead, -1) for o in y), [[j.reshape(*lead, *j.shape[1:]) for j in by] for by in J]

    def jacobians(self, *x: Any) -> tuple[tuple[Numbers, ...], list[list[Numbers]]]:
        """Outputs, and J by numbers: J[o][i] is the derivative of output o by input i, (..., size of o, size of i)."""
        y, J = self.tangents(*x)
        inverse = tangent_map_inverse(self.model, np.asarray(x[0], np.float64))
        by_numbers = [[by[0] @ inverse, *by[1:]] for by in J]
        rows = [value[..., None, :] for value in y]
        return y, [[self.lift(o, rows[o], j.swapaxes(-1, -2)).swapaxes(-1, -2) for j in by] for o, by in enumerate(by_numbers)]

    def check(self, shapes: Sequence[tuple[int, ...]]) -> None:
        """Refuses inputs of other shapes."""
        if len(shapes) != len(self.inputs):
            raise SizeError(f"{self.name} takes {', '.join(i.name for i in self.inputs)}, but {len(shapes)} arrays are given.")
        lead = tuple(shapes[0][:-1])
        for shape, i in zip(shapes, self.inputs):
            if tuple(shape) != (*lead, i.size):
                raise SizeError(f"{i.name} has shape {tuple(shape)}, but must have shape {(*lead, i.size)} of model "
                                f"{self.model.name!r}.")

    def _rows(self, x: tuple[Any, ...]) -> tuple[tuple[int, ...], list[Numbers]]:
        """Axes in front, and the inputs as (N, size)."""
        arrays = [numbers(a, i.name) for a, i in zip(x, self.inputs)]
        self.check([np.shape(a) for a in (*arrays, *x[len(arrays) :])])
        return arrays[0].shape[:-1], [np.ascontiguousarray(a).reshape(-1, i.size) for a, i in zip(arrays, self.inputs)]

    def _values(self, x: list[Numbers]) -> Numbers:
        if self.name == "frame_placement":
            R, p = self.batch.frame_placement(self.frame, x[0])
            return np.concatenate([R.swapaxes(-1, -2).reshape(-1, 9), p], -1)
        return self.batch.aba(*x) if self.name == "aba" else self.batch.rnea(*x)

    def _derivatives(self, x: list[Numbers]) -> list[Numbers]:
        """Derivatives on tangent spaces, by each input."""
        if self.name == "frame_placement":
            return [self.batch.frame_jacobian(self.frame, x[0], reference="local_world_aligned")]
        if self.name == "aba":
            return list(self.batch.aba_derivatives(*x))
        return [*self.batch.rnea_derivatives(*x), self.batch.crba(x[0])]

    def _steps(self, x: list[Numbers], derivatives: bool = False) -> tuple[list[Numbers], list[list[Numbers]]]:
        """Next states, and their derivatives on tangent spaces by output and input."""
        nv, n, data = self.model.nv, len(x[0]), self.data
        y = [np.empty((n, o.size)) for o in self.outputs]
        columns = [np.empty((n if derivatives else 0, k, 2 * nv)) for k in (2 * nv, nv, self.model.nu)]
        out = abi.StepDerivatives()
        lib.dyn_step_derivatives_init(byref(out), sizeof(out))
        for k, state in enumerate(zip(*x)):
            data.set_state(*state[:2], tau=state[2])
            if len(state) > 3:
                data.set_control(state[3])
            out.q, out.v = address(y[0][k]), address(y[1][k])
            if derivatives:
                out.A, out.B, out.B_control = (address(c[k]) for c in columns)
            check(lib.dyn_step_derivatives(data._m, data._d, None, byref(out)))
        A, B, B_control = (c.swapaxes(-1, -2) for c in columns)
        by = [A[..., :nv], A[..., nv:], B, *([B_control] if self.model.nu else [])]
        return y, [[j[:, rows] for j in by] for rows in (slice(nv), slice(nv, None))]
