"""The contact problem with friction on a given Delassus matrix, and its form for other solvers.

    solution = dyn.contact_solve(G, g, friction=[0.5, 0.5])     # contacts of three rows (t1, t2, n)
    solution.impulse, solution.velocity, solution.report.residual

Rows: equalities, then boxes, then contacts; see dyn.h for the conditions. A ContactSolver keeps its workspace for many problems.
"""

from __future__ import annotations

from ctypes import byref, c_double, c_void_p
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import Owner, address, checked, numbers
from .enums import ContactSolverType, ContactStatus
from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Integers, Numbers
    from .enums import ContactSolverTypeLike


class ContactReport(NamedTuple):
    """Report of a contact solver. Residuals are the largest over rows or contacts, in the caller's units."""

    status: ContactStatus
    iterations: int
    newton_steps: int
    factorizations: int
    worst: int
    """Row of the largest residual; -1: no rows."""
    residual: float
    """Relative, independent of units: what the tolerance is compared with."""
    primal: float
    dual: float
    complementarity: float
    natural_map: float
    signorini: float
    dissipation: float
    energy: float
    """Work of the impulses."""
    restitution_scale: float
    """1, or the factor on all coefficients of restitution that keeps energy from growing."""

    @property
    def converged(self) -> bool:
        return self.status == ContactStatus.CONVERGED


class ContactSolution(NamedTuple):
    impulse: Numbers
    """(rows,): lambda."""
    velocity: Numbers
    """(rows,): (G + diag(compliance)) lambda + g + bias."""
    report: ContactReport


class ConeQp(NamedTuple):
    """min x'Hx / 2 + g'x over lower <= A x <= upper, matrices in CSC: (values, rows, columns), as scipy.sparse.csc_array takes
    them."""

    H: tuple[Numbers, Integers, Integers]
    g: Numbers
    A: tuple[Numbers, Integers, Integers]
    lower: Numbers
    upper: Numbers

    def dense(self) -> tuple[Numbers, Numbers]:
        """H and A as arrays."""
        out = []
        for (values, rows, columns), m in ((self.H, len(self.g)), (self.A, len(self.lower))):
            M = np.zeros((m, len(self.g)))
            M[rows, np.repeat(np.arange(len(self.g)), np.diff(columns))] = values
            out.append(M)
        return out[0], out[1]


class _Problem:
    """A dynContactProblem with the arrays it points to."""

    def __init__(self, G, g, friction=(), torsion=None, rolling=None, contact_rows=None, equalities=0, lower=(), upper=(),
                 compliance=None, bias=None, restitution=None, v_minus=None):  # fmt: skip
        self.c = abi.initialized(abi.ContactProblem)
        g = numbers(g, "g")
        if g.ndim != 1:
            raise SizeError(f"g has shape {g.shape}, but must be a vector.")
        friction = np.atleast_1d(numbers(friction, "friction"))
        self.n, contacts, boxes = g.size, friction.size, np.size(lower)
        kinds = None if contact_rows is None else np.ascontiguousarray(contact_rows, np.int32)
        if kinds is not None and kinds.shape != (contacts,):
            raise SizeError(f"contact_rows has shape {kinds.shape}, but must have shape {(contacts,)}, one for each coefficient "
                            "of friction.")
        rows = int(equalities) + boxes + (3 * contacts if kinds is None else int(kinds.sum()))
        if rows != self.n:
            raise SizeError(f"g has {self.n} rows, but {equalities} equalities, {boxes} boxes and {contacts} contacts have "
                            f"{rows}.")
        self.c.equalities, self.c.boxes, self.c.contacts = int(equalities), boxes, contacts
        shapes = {"friction": contacts, "torsion": contacts, "rolling": contacts, "restitution": contacts, "lower": boxes,
                  "upper": boxes}
        given = dict(g=g, friction=friction, torsion=torsion, rolling=rolling, compliance=compliance, bias=bias,
                     restitution=restitution, v_minus=v_minus, lower=lower, upper=upper)  # fmt: skip
        self.keep: list[Any] = [kinds]
        for name, x in given.items():
            a = None if x is None else checked(np.atleast_1d(numbers(x, name)), (shapes.get(name, rows),), name)
            self.keep.append(a)
            setattr(self.c, name, address(a) if a is not None and a.size else None)
        matrix = None if G is None else checked(G, (rows, rows), "G")
        self.keep.append(matrix)
        self.c.G, self.c.contact_rows = address(matrix), address(kinds)


def _report(r: abi.ContactReport) -> ContactReport:
    values = [getattr(r, name) for name in ContactReport._fields]
    return ContactReport(ContactStatus(values[0]), *values[1:])


class ContactSolver:
    """Workspace for contact problems of at most max_rows rows. One thread at a time."""

    def __init__(self, max_rows: int, memory: Numbers | None = None):
        """memory: a contiguous array of ContactSolver.bytes(max_rows) bytes, aligned to 64, to work in; None: the library's
        own."""
        out = c_void_p()
        if memory is None:
            check(lib.dyn_contact_solver_new(max_rows, byref(out)))
        else:
            check(lib.dyn_contact_solver_init(max_rows, address(memory), memory.nbytes, byref(out)))
        self._owner, self._s = Owner(out.value, lib.dyn_contact_solver_free, memory), out.value

    @staticmethod
    def bytes(max_rows: int) -> int:
        """Memory of a workspace."""
        return lib.dyn_contact_solver_size(max_rows)

    def solve(
        self,
        G: ArrayLike,
        g: ArrayLike,
        *,
        solver: ContactSolverTypeLike = "admm",
        tolerance: float = 1e-10,
        max_iterations: int = 1000,
        time_budget: float = 0.0,
        relaxation: float = 0.0,
        newton: bool = True,
        warm_start: ArrayLike | None = None,
        **problem: Any,
    ) -> ContactSolution:
        """Impulses of the problem G, g with friction, torsion, rolling, contact_rows, equalities, lower, upper, compliance, bias,
        restitution, v_minus by name. solver: "pgs", "admm" or "newton"; warm_start: a guess of the impulses."""
        p = _Problem(G, g, **problem)
        options = abi.initialized(abi.ContactOptions)
        try:
            options.solver = ContactSolverType[solver.upper()]
        except (KeyError, AttributeError):
            raise ArgumentError(f"solver is {solver!r}: choose from pgs, admm, newton.") from None
        options.tolerance, options.max_iterations, options.time_budget = tolerance, max_iterations, time_budget
        options.relaxation, options.newton, options.warm_start = relaxation, newton, warm_start is not None
        impulse = np.zeros(p.n) if warm_start is None else checked(warm_start, (p.n,), "warm_start").copy()
        velocity, report = np.zeros(p.n), abi.ContactReport()
        check(lib.dyn_contact_solver_solve(self._s, byref(p.c), byref(options), address(impulse), address(velocity),
                                           byref(report)))
        return ContactSolution(impulse, velocity, _report(report))

    def residuals(self, G: ArrayLike, g: ArrayLike, impulse: ArrayLike, **problem: Any) -> ContactReport:
        """Residuals and energy of given impulses."""
        p, report = _Problem(G, g, **problem), abi.ContactReport()
        x = checked(impulse, (p.n,), "impulse")
        check(lib.dyn_contact_solver_residuals(self._s, byref(p.c), address(x), byref(report)))
        return _report(report)


def contact_solve(G: ArrayLike, g: ArrayLike, **arguments: Any) -> ContactSolution:
    """ContactSolver.solve with a workspace for this problem alone."""
    return ContactSolver(max(1, np.size(g))).solve(G, g, **arguments)


def contact_problem_qp(G: ArrayLike | None, g: ArrayLike, *, facets: int = 8, inscribed: bool = True, **problem: Any) -> ConeQp:
    """Returns the problem as a quadratic program, cones as pyramids of `facets` facets (0: second-order cones). Without G only A,
    lower and upper hold."""
    p, q = _Problem(G, g, **problem), abi.Qp()
    check(lib.dyn_contact_problem_qp(byref(p.c), facets, inscribed, byref(q)))
    n, m, nH, nA = q.n, q.m, q.H_nonzeros, q.A_nonzeros
    integers = {"H_columns": n + 1, "H_rows": nH, "A_columns": n + 1, "A_rows": nA}
    floats = {"H": nH, "g": n, "A": nA, "lower": m, "upper": m}
    arrays = {k: np.zeros(s, np.int32) for k, s in integers.items()} | {k: np.zeros(s) for k, s in floats.items()}
    for name, a in arrays.items():
        setattr(q, name, address(a))
    check(lib.dyn_contact_problem_qp(byref(p.c), facets, inscribed, byref(q)))
    H, A = ((arrays[x], arrays[f"{x}_rows"], arrays[f"{x}_columns"]) for x in "HA")
    return ConeQp(H, arrays["g"], A, arrays["lower"], arrays["upper"])


def contact_compliance(dt: float, stiffness: float = 0.0, damping: float = 0.0, gap: float = 0.0) -> tuple[float, float]:
    """(compliance, bias) of a row that is a spring (N/m) and a damper (N s/m), for impulses; gap (m) below zero: depth."""
    R, b = c_double(), c_double()
    check(lib.dyn_contact_compliance(stiffness, damping, dt, gap, byref(R), byref(b)))
    return R.value, b.value


def contact_compliance_hertz(dt: float, frequency: float, damping_ratio: float, mass: float,
                             gap: float = 0.0) -> tuple[float, float]:
    """The same from a frequency (Hz) and a damping ratio at an effective mass (kg)."""
    k, d = c_double(), c_double()
    check(lib.dyn_contact_stiffness_hertz(frequency, damping_ratio, mass, byref(k), byref(d)))
    return contact_compliance(dt, k.value, d.value, gap)
