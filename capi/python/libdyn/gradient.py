"""The gradient of a motion: its steps are differentiated backwards, from checkpoints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .arrays import checked
from .choices import whole
from .errors import UnsupportedError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .data import Data
    from .enums import DerivativeMethodLike


class RolloutGradient(NamedTuple):
    """Gradient of a number that depends on the states of a motion."""

    x: Numbers
    """(2 nv,): by the first state (q, v), on its tangent space."""
    tau: Numbers
    """(steps, nv)"""
    control: Numbers
    """(steps, nu)"""
    parameters: Numbers
    """(np,)"""


def rollout_vjp(
    data: Data,
    steps: int,
    cotangents: ArrayLike,
    *,
    taus: ArrayLike | None = None,
    controls: ArrayLike | None = None,
    parameters: Sequence[Any] = (),
    every: int | None = None,
    method: DerivativeMethodLike = "auto",
) -> RolloutGradient:
    """Gradient of a motion of some steps that begins in the state of the data. The data keeps that state.

    cotangents  gradient by the last state (q, v), (2 nv,), or by the state after each step, (steps, 2 nv)
    taus        (steps, nv); None: tau stays as it is
    controls    (steps, nu); None: they stay as they are
    parameters  dyn.StepParameterType or (type, index) each
    every       steps from a checkpoint to the next; None: the root of steps. Memory: steps / every + every states
                (dyn_model_state_size bytes each). Each step is made twice, and differentiated once.
    method      of each step's derivatives

    Derivatives are those of steps whose contacts are solved to 1e-12: set_step_options(tolerance=1e-12) makes such steps.
    """
    m, n = data.model, whole(steps, "steps", 1)
    between = math.isqrt(n - 1) + 1 if every is None else whole(every, "every", 1)
    if data.act.size:
        raise UnsupportedError("rollout_vjp: activations of actuators are no part of the state of step derivatives.")
    last = np.ndim(cotangents) == 1
    y = checked(cotangents, (2 * m.nv,) if last else (n, 2 * m.nv), "cotangents")
    inputs = [
        (None if x is None else checked(x, (n, size), name), put)
        for x, size, name, put in (
            (taus, m.nv, "taus", lambda tau: data.set_state(tau=tau)), (controls, m.nu, "controls", data.set_control))
    ]  # fmt: skip
    given = [(x, put) for x, put in inputs if x is not None]

    def states(first: int, end: int, keep: int) -> list[bytes]:
        """Makes the steps from first to end; returns each keep-th state before a step, with its inputs."""
        out = []
        for k in range(first, end):
            for x, put in given:
                put(x[k])
            if (k - first) % keep == 0:
                out.append(data.save_state())
            data.step()
        return out

    begin = data.save_state()
    by_x, by_inputs, by_parameters = np.zeros(2 * m.nv), np.empty((n, m.nv + m.nu)), 0.0
    try:
        checkpoints = states(0, n, between)
        while checkpoints:
            data.restore_state(checkpoints.pop())
            first = len(checkpoints) * between
            end = min(first + between, n)
            for k, state in reversed(list(enumerate(states(first, end, 1), first))):
                by_x += y if last and k == n - 1 else 0 if last else y[k]
                data.restore_state(state)
                by_x, by_inputs[k], more = np.split(data.step_vjp(by_x, parameters, method), (2 * m.nv, 3 * m.nv + m.nu))
                by_parameters = by_parameters + more
    finally:
        data.restore_state(begin)
    return RolloutGradient(by_x, by_inputs[:, : m.nv], by_inputs[:, m.nv :], np.asarray(by_parameters))
