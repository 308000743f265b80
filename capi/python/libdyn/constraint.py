"""Constraints: loops, contacts, limits, and what Data computes under them.

    for foot in ("FL_foot", "FR_foot", "RL_foot", "RR_foot"):
        d.add_constraint(dyn.constraint.point(foot))
    ddq, forces = d.constrained_dynamics(q, v, tau)

first and second name frames (second None: the world) or joints; placements are where the constraint is in them. stiffness and
damping are Baumgarte's gains (1/s^2, 1/s), restitution that of impulses.
"""

from __future__ import annotations

import ctypes
from ctypes import addressof, byref, c_int
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import address, checked, numbers
from .arrays import placement as twelve
from .choices import member
from .enums import ConstraintReason, ConstraintType, JointType, RowVerdict
from .errors import ArgumentError
from .handles import DataHandle, ModelHandle
from .library import check, lib

if TYPE_CHECKING:
    from .arrays import Numbers
    from .enums import JointTypeLike

_outputs = abi.outputs_of(abi.ConstrainedOutput)
_BETWEEN_JOINTS = (ConstraintType.COUPLING, ConstraintType.LIMIT, ConstraintType.FRICTION)


class Constraint(NamedTuple):
    """A constraint: made by point, frame, connect, weld, distance, loop, coupling, limit and friction."""

    type: ConstraintType
    first: str | int
    second: str | int | None
    values: dict[str, Any]
    """Fields of dynConstraint."""


def _make(type: ConstraintType, first: Any, second: Any, placement1: Any = None, placement2: Any = None,
          **values: Any) -> Constraint:
    for key, x in (("placement1", placement1), ("placement2", placement2)):
        if x is not None:
            values[key] = twelve(x, key).tolist()
    return Constraint(type, first, second, values)


def point(first: Any, second: Any = None, **more: Any) -> Constraint:
    """Contact of a point of first: 3 rows, the force in second's axes. more: placement1, placement2, stiffness, damping,
    restitution, here as in the others."""
    return _make(ConstraintType.POINT, first, second, **more)


def frame(first: Any, second: Any = None, **more: Any) -> Constraint:
    """Contact of a face of first: 6 rows, [force; moment] in second's axes."""
    return _make(ConstraintType.FRAME, first, second, **more)


def connect(first: Any, second: Any = None, **more: Any) -> Constraint:
    """Two points are one: 3 rows."""
    return _make(ConstraintType.CONNECT, first, second, **more)


def weld(first: Any, second: Any = None, **more: Any) -> Constraint:
    """Two frames are one: 6 rows."""
    return _make(ConstraintType.WELD, first, second, **more)


def distance(first: Any, second: Any, length: float, **more: Any) -> Constraint:
    """Two points are length (m) apart: 1 row."""
    return _make(ConstraintType.DISTANCE, first, second, length=length, **more)


def loop(joint_type: JointTypeLike, first: Any, second: Any = None, axis: Any = None, axis2: Any = None, pitch: float = 0.0,
         **more: Any) -> Constraint:
    """first moves as the child of such a joint in second: 6 - nv rows."""
    values: dict[str, Any] = {"joint_type": int(member(JointType, joint_type, "joint_type")), "pitch": pitch, **more}
    for key, x in (("axis", axis), ("axis2", axis2)):
        if x is not None:
            values[key] = checked(x, (3,), key).tolist()
    return _make(ConstraintType.LOOP, first, second, **values)


def coupling(first: Any, second: Any, coefficients: Any = (0.0, 1.0), **more: Any) -> Constraint:
    """q_first = c0 + c1 q_second + c2 q_second^2 + ..., up to the fourth power: 1 row."""
    c = np.zeros(5)
    given = numbers(coefficients, "coefficients").reshape(-1)
    if given.size > 5:
        raise ArgumentError(f"coefficients has {given.size} numbers, but a coupling has at most 5.")
    c[: given.size] = given
    return _make(ConstraintType.COUPLING, first, second, coefficients=c.tolist(), **more)


def limit(first: Any, **more: Any) -> Constraint:
    """A joint stays within its limits: 1 row."""
    return _make(ConstraintType.LIMIT, first, None, **more)


def friction(first: Any, force: float, **more: Any) -> Constraint:
    """Dry friction in a joint, at most force (N m or N): 1 row."""
    return _make(ConstraintType.FRICTION, first, None, force=force, **more)


def structure(c: Any, find: Any = None) -> abi.Constraint:
    """As dyn.h takes it. find(what, name): an id."""
    if not isinstance(c, Constraint):
        kinds = ", ".join(kind.name.lower() for kind in ConstraintType if kind)
        raise ArgumentError(f"{c!r} is no constraint of dyn.constraint: {kinds}.")
    out = abi.initialized(abi.Constraint, int(c.type))
    for key, x in c.values.items():
        if key not in _FIELDS:
            raise ArgumentError(f"a constraint has no {key!r}: it has {', '.join(sorted(_FIELDS))}.")
        if isinstance(x, list):
            getattr(out, key)[:] = x
        else:
            setattr(out, key, x)
    if find:
        what = "joint" if c.type in _BETWEEN_JOINTS else "frame"
        out.first = find(what, c.first)
        out.second = 0 if c.second is None else find(what, c.second)
    return out


_FIELDS = {name for name, *_ in abi.Constraint._fields_} - {"struct_size", "type", "first", "second"}


class Result(NamedTuple):
    """End of a problem with constraints."""

    reason: ConstraintReason
    rows: int
    rank: int
    iterations: int
    residual: float
    contradiction: float
    condition: float
    regularisation: float

    @property
    def solved(self) -> bool:
        return self.reason == ConstraintReason.CONVERGED


class Constrained(NamedTuple):
    """ddq (nv,) and the forces of the rows."""

    ddq: Numbers
    forces: Numbers


class InverseDynamics(NamedTuple):
    """tau (nv,) and the forces of the rows that give an acceleration."""

    tau: Numbers
    forces: Numbers


class Impulse(NamedTuple):
    """Velocity (nv,) after an impact and the impulses of the rows."""

    v: Numbers
    impulses: Numbers


class Projection(NamedTuple):
    """q and v that satisfy the constraints."""

    q: Numbers
    v: Numbers
    result: Result


class Terms(NamedTuple):
    """Enabled rows: C, J (rows, nv), J v, and drift, their acceleration at ddq = 0."""

    C: Numbers
    J: Numbers
    Jv: Numbers
    drift: Numbers


class ConstrainedDerivatives(NamedTuple):
    """On the tangent space: (nv, nv) each of ddq, (rows, nv) each of the forces. Of impulses: of v_plus, without those by tau."""

    ddq_dq: Numbers
    ddq_dv: Numbers
    ddq_dtau: Numbers
    lambda_dq: Numbers
    lambda_dv: Numbers
    lambda_dtau: Numbers


class Row(NamedTuple):
    """Diagnosis of a row."""

    constraint: str
    """Its name; of a spare slot "slot 3"."""
    row: int
    verdict: RowVerdict
    share: float
    error: float


class Report(NamedTuple):
    """Constraint diagnostics: rank, condition, and every row."""

    rank: int
    redundant: int
    contradictory: int
    condition: float
    error: float
    contradiction: float
    rows: list[Row]


def _result(r: abi.ConstraintResult) -> Result:
    return Result(ConstraintReason(r.reason), r.rows, r.rank, r.iterations, r.residual, r.contradiction, r.condition,
                  r.regularisation)


class ModelConstraints(ModelHandle):
    """The part of Model that knows its constraints."""

    @property
    def nconstraints(self) -> int:
        """The model's own constraints: they are in the first slots of a data."""
        return lib.dyn_model_nconstraints(self._m)

    @property
    def contact_capacity(self) -> int:
        """Contact points that a step has room for."""
        return lib.dyn_model_contact_capacity(self._m)

    @property
    def nconstraint_slots(self) -> int:
        """nconstraints and the spare ones."""
        return lib.dyn_model_nconstraint_slots(self._m)

    @property
    def constraint_names(self) -> list[str]:
        return [lib.dyn_model_constraint_name(self._m, k).decode() for k in range(self.nconstraints)]

    def constraint_id(self, name: str) -> int:
        """Number of a constraint of the model."""
        return self._id(lib.dyn_model_constraint_id(self._m, name.encode()))

    def constraint(self, constraint: str | int) -> abi.Constraint:
        """The fields of dynConstraint."""
        out = abi.Constraint()
        id = self.constraint_id(constraint) if isinstance(constraint, str) else constraint
        check(lib.dyn_model_constraint_info(self._m, id, byref(out)))
        return out


class ConstraintCalls(DataHandle):
    """The part of Data that works under constraints."""

    constraint_result: Result | None = None
    """Result of the last call that solved for constraint forces."""

    def _slot(self, slot: str | int) -> int:
        return self.model.constraint_id(slot) if isinstance(slot, str) else slot

    def set_constraint(self, slot: str | int, constraint: Constraint | None) -> None:
        """Puts a constraint into a slot, or empties it. Slots of the model's own constraints may be given by name."""
        find = lambda what, x: self.model._joint(x) if what == "joint" else self.model._frame(x)
        s = None if constraint is None else byref(structure(constraint, find))
        check(lib.dyn_data_set_constraint(self._m, self._d, self._slot(slot), s))

    def constraint(self, slot: str | int) -> abi.Constraint:
        """Returns the constraint in a slot, of type NONE when the slot is empty."""
        out = abi.Constraint()
        check(lib.dyn_data_constraint(self._m, self._d, self._slot(slot), byref(out)))
        return out

    def add_constraint(self, constraint: Constraint) -> int:
        """Puts a constraint into the first empty slot; returns its number."""
        for slot in range(self.model.nconstraint_slots):
            if self.constraint(slot).type == ConstraintType.NONE:
                self.set_constraint(slot, constraint)
                return slot
        raise ArgumentError(f"all {self.model.nconstraint_slots} slots are full: load the model with more constraint_slots, or "
                            "empty one.")

    def set_constraint_enabled(self, slot: str | int, enabled: bool = True) -> None:
        """Switches a slot on or off."""
        check(lib.dyn_data_set_constraint_enabled(self._m, self._d, self._slot(slot), bool(enabled)))

    def anchor_constraint(self, slot: str | int, q: Any = None) -> None:
        """Moves placement2 so that the constraint holds at q."""
        check(lib.dyn_data_anchor_constraint(self._m, self._d, self._slot(slot), self._q(q)))

    def constraint_rows(self, slot: str | int | None = None) -> slice:
        """Rows of a slot among those that are enabled, or of all."""
        first, rows = c_int(), c_int()
        check(lib.dyn_data_constraint_rows(self._m, self._d, -1 if slot is None else self._slot(slot), byref(first), byref(rows)))
        return slice(first.value, first.value + rows.value)

    def _nrows(self) -> int:
        return self.constraint_rows().stop

    def _options(self, max_iterations: int | None, regularisation: float, tolerance: float | None) -> Any:
        options = abi.initialized(abi.ConstraintOptions)
        options.regularisation = regularisation
        if max_iterations is not None:
            options.max_iterations = max_iterations
        if tolerance is not None:
            options.tolerance = tolerance
        return byref(options)

    def constraint_terms(self, q: Any = None, v: Any = None) -> Terms:
        """C, J, J v and drift of the enabled rows."""
        n = self._nrows()
        out = np.empty(n), np.empty((n, self.model.nv), order="F"), np.empty(n), np.empty(n)
        check(lib.dyn_constraint_terms(self._m, self._d, self._q(q), self._v(v), *map(address, out)))
        return Terms(*out)

    def constrained_dynamics(
        self, q: Any = None, v: Any = None, tau: Any = None, fext: Any = None, *, max_iterations: int | None = None,
        regularisation: float = 0.0, tolerance: float | None = None,
    ) -> Constrained:  # fmt: skip
        """Forward dynamics under the constraints: (ddq, forces). How it went: constraint_result."""
        ddq, forces, result = np.empty(self.model.nv), np.empty(self._nrows()), abi.ConstraintResult()
        options = self._options(max_iterations, regularisation, tolerance)
        check(lib.dyn_constrained_dynamics(self._m, self._d, self._q(q), self._v(v), self._tau(tau), self._fext(fext), options,
                                           _outputs(address(ddq), None, address(forces), addressof(result))))  # fmt: skip
        self.constraint_result = _result(result)
        return Constrained(ddq, forces)

    def constrained_inverse_dynamics(self, q: Any = None, v: Any = None, a: Any = None, fext: Any = None, *,
                                     actuated: Any = None) -> InverseDynamics:
        """tau and the least forces that give the acceleration a. actuated: (nv,) of bool; None: all but a floating base."""
        tau, forces, result = np.empty(self.model.nv), np.empty(self._nrows()), abi.ConstraintResult()
        driven = None
        if actuated is not None:
            driven = np.ascontiguousarray(np.asarray(actuated, bool), np.int32)
            if driven.shape != (self.model.nv,):
                raise ArgumentError(f"actuated has shape {driven.shape}, but must have shape {(self.model.nv,)}.")
        check(lib.dyn_constrained_inverse_dynamics(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext),
                                                   address(driven), _outputs(None, address(tau), address(forces),
                                                                             addressof(result))))  # fmt: skip
        self.constraint_result = _result(result)
        return InverseDynamics(tau, forces)

    def constraint_impulse(
        self, q: Any = None, v: Any = None, *, max_iterations: int | None = None, regularisation: float = 0.0,
        tolerance: float | None = None
    ) -> Impulse:
        """Impact: the velocity after it, and the impulses."""
        out, impulses, result = np.empty(self.model.nv), np.empty(self._nrows()), abi.ConstraintResult()
        options = self._options(max_iterations, regularisation, tolerance)
        check(lib.dyn_constraint_impulse(self._m, self._d, self._q(q), self._v(v), options, address(out), address(impulses),
                                         byref(result)))
        self.constraint_result = _result(result)
        return Impulse(out, impulses)

    def project(self, q: Any = None, v: Any = None, *, weigh: bool = True, tolerance: float = 1e-12,
                max_iterations: int = 100) -> Projection:
        """q and v near those given that satisfy the constraints; weigh: near in kinetic energy, else in the coordinates."""
        options = abi.initialized(abi.ProjectOptions)
        options.weigh, options.tolerance, options.max_iterations = bool(weigh), tolerance, max_iterations
        q_out, v_out, result = np.empty(self.model.nq), np.empty(self.model.nv), abi.ConstraintResult()
        check(lib.dyn_project(self._m, self._d, self._q(q), self._v(v), byref(options), address(q_out), address(v_out),
                              byref(result)))
        self.constraint_result = _result(result)
        return Projection(q_out, v_out, self.constraint_result)

    def delassus(self, q: Any = None) -> Numbers:
        """J M^-1 J', (rows, rows)."""
        n = self._nrows()
        out = np.empty((n, n), order="F")
        check(lib.dyn_delassus(self._m, self._d, self._q(q), address(out)))
        return out

    def delassus_factor(self, q: Any = None) -> tuple[Numbers, Numbers]:
        """Y (nv, rows) and D (nv,): the Delassus matrix is Y' diag(D) Y."""
        Y, D = np.empty((self.model.nv, self._nrows()), order="F"), np.empty(self.model.nv)
        check(lib.dyn_delassus_factor(self._m, self._d, self._q(q), address(Y), address(D)))
        return Y, D

    def delassus_times(self, x: Any, q: Any = None) -> Numbers:
        """The Delassus matrix times x, without forming it."""
        out = np.empty(self._nrows())
        check(lib.dyn_delassus_times(self._m, self._d, self._q(q), address(checked(x, out.shape, "x")), address(out)))
        return out

    def delassus_solve(self, x: Any, mu: float = 0.0, q: Any = None) -> Numbers:
        """(G + mu 1)^-1 x."""
        out = np.empty(self._nrows())
        check(lib.dyn_delassus_solve(self._m, self._d, self._q(q), mu, address(checked(x, out.shape, "x")), address(out)))
        return out

    def _derivatives(self, call: Any, with_tau: bool) -> ConstrainedDerivatives:
        n, nv = self._nrows(), self.model.nv
        out = [np.zeros((nv, nv), order="F") for _ in range(3)] + [np.zeros((n, nv), order="F") for _ in range(3)]
        s, result = abi.ConstraintDerivatives(), abi.ConstraintResult()
        for name, x in zip(ConstrainedDerivatives._fields, out):
            if with_tau or not name.endswith("tau"):
                setattr(s, name, address(x))
        s.result = addressof(result)
        check(call(byref(s)))
        self.constraint_result = _result(result)
        return ConstrainedDerivatives(*out)

    def constrained_dynamics_derivatives(self, q: Any = None, v: Any = None, tau: Any = None,
                                         fext: Any = None) -> ConstrainedDerivatives:
        """Derivatives of constrained_dynamics by q, v, tau."""
        q, v, tau, fext = self._q(q), self._v(v), self._tau(tau), self._fext(fext)
        return self._derivatives(
            lambda s: lib.dyn_constrained_dynamics_derivatives(self._m, self._d, q, v, tau, fext, None, s), True
        )

    def constraint_impulse_derivatives(self, q: Any = None, v: Any = None) -> ConstrainedDerivatives:
        """Derivatives of constraint_impulse by q and v; those by tau are zero."""
        q, v = self._q(q), self._v(v)
        return self._derivatives(lambda s: lib.dyn_constraint_impulse_derivatives(self._m, self._d, q, v, None, s), False)

    def constraint_report(self, q: Any = None) -> Report:
        """Returns constraint diagnostics: rank, condition, and by name the redundant and contradictory rows."""
        n = self._nrows()
        rows, report = (abi.RowReport * max(n, 1))(), abi.ConstraintReport()
        check(lib.dyn_constraint_report(self._m, self._d, self._q(q), byref(report), ctypes.addressof(rows), n))
        names = self.model.constraint_names
        name = lambda k: names[k] if k < len(names) else f"slot {k}"
        return Report(report.rank, report.redundant, report.contradictory, report.condition, report.error, report.contradiction,
                      [Row(name(r.slot), r.row, RowVerdict(r.verdict), r.share, r.error) for r in rows[:n]])  # fmt: skip


__all__ = [
    "Constrained", "ConstrainedDerivatives", "Constraint", "ConstraintReason", "ConstraintType", "Impulse", "InverseDynamics",
    "Projection", "Report", "Result", "Row", "RowVerdict", "Terms", "connect", "coupling", "distance", "frame", "friction",
    "limit", "loop", "point", "weld",
]  # fmt: skip
