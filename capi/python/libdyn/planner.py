"""Optimal control: inputs of N steps that minimise costs within bounds.

    planner = model.planner(50, "control")
    plan = planner.solve(data, [dyn.PlanCost("state", weight=0.1, terminal=100.0), dyn.PlanCost("input", weight=1e-2)])
    plan.q, plan.v, plan.u, plan.K, plan.status
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import addressof, byref, c_void_p, cast, sizeof
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import Owner, address, checked, numbers
from .choices import member, whole
from .enums import DerivativeMethod, PlanCostType, PlanInput, PlanStatus
from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .data import Data
    from .enums import DerivativeMethodLike, PlanCostTypeLike, PlanInputLike
    from .model import Model


@dataclass
class PlanCost:
    """weight / 2 times the sum of weights[i] e[i]^2 at each knot."""

    type: PlanCostTypeLike
    """"state": q and v; "input"; "frame_position", "frame_orientation", "frame_placement", "com"."""
    weight: float = 1.0
    """Of knots 0 to N - 1."""
    terminal: float | None = None
    """Of knot N; None: weight."""
    reference: ArrayLike | None = None
    """One for all knots, or a row for each; q and v side by side, 9 or 12 numbers by columns. None: neutral, zero, identity."""
    weights: ArrayLike | None = None
    """Of the components of the error; None: 1."""
    knot_weights: ArrayLike | None = None
    """(N + 1,): factors on weight and terminal."""
    frame: str | int | None = None
    """Of costs of frames."""


class PlanPoint(NamedTuple):
    """A knot as a function for other costs sees it. It returns the cost, and adds derivatives to the arrays."""

    knot: int
    data: Data
    q: Numbers
    v: Numbers
    u: Numbers | None
    """None at knot N."""
    l_x: Numbers | None
    """(2 nv,): by q and v on the tangent space; None: the cost alone is asked for, as in all below."""
    l_u: Numbers | None
    l_xx: Numbers | None
    l_ux: Numbers | None
    """(inputs, 2 nv)"""
    l_uu: Numbers | None


class Plan(NamedTuple):
    """A plan of N steps. The best input at a state x near knot k's is u[k] + K[k] (x (-) x[k]), clamped to its bounds."""

    q: Numbers
    """(N + 1, nq)"""
    v: Numbers
    """(N + 1, nv)"""
    u: Numbers
    """(N, nv) or (N, nu)"""
    K: Numbers
    """(N, inputs, 2 nv)"""
    gaps: Numbers
    """(N, 2 nv): the step from knot k minus knot k + 1; zero: the states are a motion."""
    status: PlanStatus
    iterations: int
    """Backward passes."""
    knot: int
    """Whose step failed; -1: none."""
    cost: float
    gap: float
    """Largest component of a gap."""
    bound_violation: float
    expected_decrease: float
    """Of the cost, by the quadratic model of the last iteration."""
    regularisation: float
    """To go on with."""
    step_length: float
    """Of the last iteration, 0 to 1."""
    steps: int
    """Steps made, derivatives not counted."""
    analytic: int
    """Derivatives of steps by implicit differentiation."""
    differences: int
    """Derivatives of steps by central differences."""

    @property
    def converged(self) -> bool:
        return self.status == PlanStatus.CONVERGED


class Planner:
    """Keeps a plan of N steps of a model: Model.planner makes it. One thread at a time."""

    model: Model
    knots: int
    input: PlanInput

    def __init__(self, model: Model, knots: int, input: PlanInputLike = "control"):
        out = c_void_p()
        self.model, self.knots, self.input = model, whole(knots, "knots"), PlanInput(member(PlanInput, input, "input"))
        check(lib.dyn_planner_new(model._m, self.knots, self.input, byref(out)))
        self._owner, self._p = Owner(out.value, lib.dyn_planner_free, model), out.value
        self.inputs: int = model.nv if self.input == PlanInput.TAU else model.nu

    def set_guess(self, q: ArrayLike | None = None, v: ArrayLike | None = None, u: ArrayLike | None = None) -> None:
        """Sets the guess of the next solve: u (N, inputs), zero if None; q (N + 1, nq) and v (N + 1, nv), which need not be a
        motion, or neither: the motion by u."""
        shapes = {"q": (self.knots + 1, self.model.nq), "v": (self.knots + 1, self.model.nv), "u": (self.knots, self.inputs)}
        given = {name: None if x is None else np.ascontiguousarray(checked(x, shapes[name], name))
                 for name, x in {"q": q, "v": v, "u": u}.items()}  # fmt: skip
        check(lib.dyn_planner_set_guess(self._p, self.model._m, *map(address, given.values())))

    def shift(self, knots: int = 1) -> None:
        """Moves the plan to the front, for the next sample of time. Its end is repeated."""
        check(lib.dyn_planner_shift(self._p, whole(knots, "knots")))

    def solve(
        self,
        data: Data,
        costs: Sequence[PlanCost] = (),
        *,
        function: Callable[[PlanPoint], float] | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        max_iterations: int = 100,
        tolerance: float = 1e-9,
        gap_tolerance: float = 1e-8,
        regularisation: float = 0.0,
        max_regularisation: float = 1e9,
        method: DerivativeMethodLike = "auto",
        epsilon: float = 1e-6,
        margin: float = 1e-6,
        steps: int = 1,
    ) -> Plan:
        """Lowers the cost from the guess, or from the last plan. The plan begins at the data's q and v; the data keeps its state.

        function          adds other costs: see PlanPoint
        lower, upper      bounds of the inputs; None: ranges of controls; effort limits, and no tau on free flyers
        max_iterations    1: an iteration a call, as in model predictive control
        tolerance         converged if an iteration would lower the cost by less than tolerance (1 + |cost|)
        gap_tolerance     and no gap is larger
        regularisation    share of the diagonal of the inputs' Hessian that is added to it at first
        method, epsilon, margin  of derivatives of steps: see Data.step_derivatives
        steps             of dt from a knot to the next
        """
        keep: list[Any] = []
        problem, options, out, report = abi.PlanProblem(), abi.PlanOptions(), abi.PlanOutput(), abi.PlanReport()
        for x, init in ((problem, lib.dyn_plan_problem_init), (options, lib.dyn_plan_options_init),
                        (out, lib.dyn_plan_output_init)):
            init(byref(x), sizeof(x))
        array = (abi.PlanCost * max(len(costs), 1))()
        for cost, c in zip(costs, array):
            self._fill(c, cost, keep)
        problem.costs, problem.cost_count = addressof(array), len(costs)
        for name, bound in (("lower", lower), ("upper", upper)):
            keep.append(None if bound is None else checked(bound, (self.inputs,), name))
            setattr(problem, name, address(keep[-1]))
        errors: list[BaseException] = []
        if function is not None:
            problem.function = type(problem.function)(self._callback(data, function, errors))
        options.max_iterations, options.steps = whole(max_iterations, "max_iterations"), whole(steps, "steps")
        options.tolerance, options.gap_tolerance, options.epsilon, options.margin = tolerance, gap_tolerance, epsilon, margin
        options.regularisation, options.max_regularisation = regularisation, max_regularisation
        options.method = member(DerivativeMethod, method, "method")
        N, n = self.knots, 2 * self.model.nv
        arrays = {"q": (N + 1, self.model.nq), "v": (N + 1, self.model.nv), "u": (N, self.inputs), "K": (N, n, self.inputs),
                  "gaps": (N, n)}  # fmt: skip
        results = {name: np.empty(shape) for name, shape in arrays.items()}
        for name, x in results.items():
            setattr(out, name, address(x))
        out.report = addressof(report)
        status = lib.dyn_planner_solve(self._p, self.model._m, data._d, byref(problem), byref(options), byref(out))
        if errors:
            raise errors[0]
        check(status)
        results["K"] = results["K"].transpose(0, 2, 1)
        values = [getattr(report, name) for name in Plan._fields[5:]]
        return Plan(*results.values(), PlanStatus(values[0]), *values[1:])

    def _fill(self, c: Any, cost: PlanCost, keep: list[Any]) -> None:
        lib.dyn_plan_cost_init(byref(c), sizeof(c))
        kind = member(PlanCostType, cost.type, "type")
        c.type, c.weight, c.terminal_weight = kind, cost.weight, cost.weight if cost.terminal is None else cost.terminal
        if cost.frame is not None:
            c.frame = self.model.frame_id(cost.frame) if isinstance(cost.frame, str) else cost.frame
        nq, nv = self.model.nq, self.model.nv
        size = {PlanCostType.STATE: nq + nv, PlanCostType.INPUT: self.inputs, PlanCostType.FRAME_ORIENTATION: 9,
                PlanCostType.FRAME_PLACEMENT: 12}.get(kind, 3)  # fmt: skip
        errors = {PlanCostType.STATE: 2 * nv, PlanCostType.INPUT: self.inputs, PlanCostType.FRAME_PLACEMENT: 6}.get(kind, 3)
        knots = self.knots if kind == PlanCostType.INPUT else self.knots + 1
        if cost.reference is not None:
            x = numbers(cost.reference, "reference")
            if x.shape not in ((size,), (knots, size)):
                raise SizeError(f"reference has shape {x.shape}, but must have shape {(size,)} or {(knots, size)}.")
            c.reference_stride = size if x.ndim == 2 else 0
            keep.append(np.ascontiguousarray(x))
            c.reference = address(keep[-1])
        for name, x, shape in (("weights", cost.weights, errors), ("knot_weights", cost.knot_weights, self.knots + 1)):
            keep.append(None if x is None else checked(x, (shape,), name))
            setattr(c, name, address(keep[-1]))

    def _callback(self, data: Data, function: Callable[[PlanPoint], float], errors: list[BaseException]) -> Any:
        nq, nv, n = self.model.nq, self.model.nv, 2 * self.model.nv

        def view(start: int | None, *shape: int) -> Any:
            if not start:
                return None
            size = int(np.prod(shape))
            memory = (abi.ctypes.c_double * size).from_address(start)
            return np.frombuffer(memory, np.float64, size).reshape(shape, order="F")

        def call(_context: Any, at: int) -> int:
            x = cast(at, abi.ctypes.POINTER(abi.PlanPoint)).contents
            r = x.inputs
            try:
                point = PlanPoint(x.knot, data, view(x.q, nq), view(x.v, nv), view(x.u, r), view(x.l_x, n), view(x.l_u, r),
                                  view(x.l_xx, n, n), view(x.l_ux, r, n), view(x.l_uu, r, r))  # fmt: skip
                cost = function(point)
                if cost is None:
                    raise ArgumentError("function returned None, but must return the cost.")
                abi.ctypes.c_double.from_address(x.cost).value += float(cost)
            except BaseException as error:  # of the caller's function: raised again after the call
                errors.append(error)
                return 1
            return 0

        return call
