"""Steps in time: integrators, and steps whose lengths follow from an accuracy."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from ctypes import addressof, byref, c_int, c_int32, create_string_buffer, sizeof
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import address, checked
from .choices import member, text, whole
from .contact import Contact, to_contact
from .enums import ContactMode, ContactModel, ContactSolverType, DerivativeMethod, Integrator, StepParameterType
from .errors import ArgumentError, ContactWarning
from .guard import nested
from .handles import DataHandle
from .library import check, fail, lib
from .material import Material

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .data import Data
    from .enums import ContactModelLike, ContactSolverTypeLike, DerivativeMethodLike, IntegratorLike

_INTEGRATORS: dict[Any, int] = {key: int(i) for i in Integrator for key in (i, i.name, i.name.lower())}
_step = lib.dyn_step
_LOOK_EVERY = 64  # steps: reading the report at each would cost as much as the step of a small robot


class StepReport(NamedTuple):
    """Report of the last step or advance."""

    steps: int
    rejected: int
    """Steps tried whose error was too large."""
    evaluations: int
    """Evaluations of forward dynamics."""
    time: float
    """Seconds advanced."""
    smallest_dt: float
    error_estimate: float
    """Sum of the estimated errors of the steps; 0 from integrators that have none."""
    contacts: int
    """Most contact points in a step."""
    rows: int
    """Most rows that acted in a step."""
    islands: int
    """Most groups of bodies that rows join, in a step."""
    dropped: int
    """Contact points beyond the room for them, the shallowest, in all steps."""
    iterations: int
    """Iterations of the contact solver, its Newton steps included."""
    residual: float
    """Largest of the contact solver."""
    penetration: float
    """m, largest depth at the beginning of a step, of what is awake."""
    sleeping: int
    """Islands that slept in the last step."""
    unsolved: int
    """Islands whose residual stayed above the tolerance, in all steps: iterations or time were not enough, or equalities
    contradict one another."""


class ErrorBar(NamedTuple):
    """Bounds on the error of a state, by a run with finer steps."""

    q: float
    """Of the largest entry of difference, m or rad."""
    v: float
    lost: bool
    """Motion has amplified errors to a tenth of a rad, or of the model's length, and more: the bounds say nothing."""


class ErrorLedger(NamedTuple):
    """Changes of energy (J) and momentum by the steps of the last call, by source, and the unexplained rest."""

    steps: int
    energy_change: float
    """Kinetic and potential, springs included."""
    applied: float
    """Work of tau."""
    actuators: float
    wrenches: float
    """Work of wrenches and of gravity compensation."""
    damping: float
    friction: float
    """Work of the joints' dry friction."""
    fluid: float
    contact_normal: float
    """Along the contacts' normals, impacts included."""
    contact_friction: float
    limits: float
    """Work of limits and dry friction rows."""
    constraints: float
    correction: float
    """Work of the correction of overlaps and drift, which moves q alone."""
    energy_defect: float
    """energy_change less all of these: the steps' error."""
    momentum_defect: Numbers
    """(3,): N s, change of linear momentum less the impulses from outside; zero where anything but a free flyer joins a tree to
    the world."""
    constraint_drift: float
    """m, rad: largest error of an equality row at the beginning of a step."""
    cone: float
    """N: largest of |f_t| - mu f_n over contacts, at least 0."""
    complementarity: float
    """W: largest |f_n (c_n + bias)| over contacts."""


class ContactForce(NamedTuple):
    """A contact point of the last step, and what it exerts."""

    contact: Contact
    force_on_b: Numbers
    """(3,): N, world, mean over the step; the opposite on shape A."""
    moment_on_b: Numbers
    """(3,): N m, world: of torsion and rolling."""


class StepDerivatives(NamedTuple):
    """Derivatives of a step on the tangent space, with x = (q, v), and the step's result."""

    A: Numbers
    """(2 nv, 2 nv): by x."""
    B: Numbers
    """(2 nv, nv): by tau."""
    B_control: Numbers
    """(2 nv, nu): by controls."""
    q: Numbers
    """(nq,): the next configuration."""
    v: Numbers
    """(nv,): the next velocity."""
    contacts: list[ContactForce]
    """Contact points of the step."""
    modes: list[ContactMode]
    degenerate: list[bool]
    """Contacts whose mode is not strictly held."""
    method: DerivativeMethod
    """ANALYTIC or CENTRAL_DIFFERENCES."""
    reason: str
    """Why ANALYTIC does not cover the step."""
    degenerate_count: int
    """Contacts, limits and actuators whose mode is not strictly held."""
    P: Numbers
    """(2 nv, np): by the numbers of the parameters."""


class _Parameters:
    """(type, index) pairs as dynStepDerivatives takes them, and their numbers."""

    _SIZES = {StepParameterType.INERTIA: 10, StepParameterType.GRAVITY: 3}

    def __init__(self, named: Sequence[Any]):
        pairs = [(x, 0) if isinstance(x, (str, int)) else tuple(x) for x in named]
        if any(len(pair) != 2 for pair in pairs):
            raise ArgumentError(f"parameters is {named!r}, but must be types or (type, index) pairs.")
        types = [member(StepParameterType, kind, "parameters") for kind, _ in pairs]
        self.types = (c_int * len(pairs))(*types)
        self.index = (c_int32 * len(pairs))(*(whole(index, "index of a parameter") for _, index in pairs))
        self.size = sum(self._SIZES.get(kind, 1) for kind in types)

    def put(self, out: Any) -> None:
        out.parameters, out.parameter_index, out.parameter_count = addressof(self.types), addressof(self.index), len(self.types)


def fill_stepping(options: abi.StepOptions, integrator: Any, solver: Any, contact_model: Any = None, **numbers: Any) -> None:
    """Sets the arguments of Data.set_step_options that are not None."""
    if integrator is not None:
        kind = _INTEGRATORS.get(integrator)
        options.integrator = member(Integrator, integrator, "integrator") if kind is None else kind
    if solver is not None:
        options.solver = member(ContactSolverType, solver, "solver")
    if contact_model is not None:
        options.contact_model = member(ContactModel, contact_model, "contact_model")
    for name, x in numbers.items():
        if x is not None:
            try:
                setattr(options, name, whole(x, name) if isinstance(getattr(options, name), int) else x)
            except TypeError:
                raise ArgumentError(f"{name} is {x!r}, but must be a number.") from None


def _contact_force(f: Any) -> ContactForce:
    return ContactForce(to_contact(f.contact), np.array(f.force_on_b), np.array(f.moment_on_b))


class SimulationCalls(DataHandle):
    """The part of Data that moves it in time."""

    _steps = 0  # made by step()
    _dropped = False  # the warning was given

    def set_step_options(
        self,
        integrator: IntegratorLike | None = None,
        dt: float | None = None,
        accuracy: float | None = None,
        *,
        solver: ContactSolverTypeLike | None = None,
        tolerance: float | None = None,
        max_iterations: int | None = None,
        sleep_speed: float | None = None,
        sleep_time: float | None = None,
        visit_sleepers: bool | None = None,
        ledger: bool | None = None,
        time_budget: float | None = None,
        contact_model: ContactModelLike | None = None,
    ) -> None:
        """Sets how step and advance go. None leaves a value as it is.

        integrator      method of a step
        dt              s, length of a step
        accuracy        advance alone: its steps have lengths with errors that add up to at most this; 0: steps of dt
        solver          contact solver; it ends at the residual tolerance, after max_iterations, or after time_budget (s a step;
                        0: no limit)
        tolerance       0: 1e-4 of the largest velocity, 1e-9 with accuracy
        max_iterations  of each island, over all that the solver tries; 0: 100, or 1200 with tolerance or accuracy
        sleep_speed     m/s, rad/s, with the effect SLEEPING: an island sleeps after sleep_time (s) below this speed
        visit_sleepers  steps compute islands that sleep, too
        ledger          steps keep the error ledger; data needs the part ENERGY
        contact_model   "rigid", or "as_file": contacts, limits and equalities give way by the MJCF file's solref and solimp, for
                        comparisons with MuJoCo; in Euler steps of dt
        """
        options = self.step_options
        fill_stepping(
            options, integrator, dt=dt, accuracy=accuracy, solver=solver, tolerance=tolerance, max_iterations=max_iterations,
            sleep_speed=sleep_speed, sleep_time=sleep_time, visit_sleepers=visit_sleepers, ledger=ledger, time_budget=time_budget,
            contact_model=contact_model,
        )  # fmt: skip
        check(lib.dyn_data_set_step_options(self._m, self._d, byref(options)))

    @property
    def step_options(self) -> abi.StepOptions:
        """The options that steps have: see set_step_options."""
        options = abi.StepOptions()
        check(lib.dyn_data_step_options(self._m, self._d, byref(options)))
        return options

    def reset(self, configuration: str | None = None) -> None:
        """Sets q, v, a, tau, controls, activations and time to those of a named configuration, or to those of new data."""
        check(lib.dyn_data_reset(self._m, self._d, None if configuration is None else text(configuration, "configuration")))

    def step(self, dt: float | None = None, integrator: IntegratorLike | None = None) -> None:
        """Advances q, v and the time by one step under the held tau. dt and integrator are kept (set_step_options)."""
        if dt is not None or integrator is not None:
            self.set_step_options(integrator, dt)
        free = self._free
        try:
            free.pop()
        except IndexError:
            free = nested(self)
        try:
            status = _step(self._m, self._d)
            if status:
                fail(status)
        finally:
            free.append(0)
        self._steps += 1
        if not self._steps % _LOOK_EVERY:
            self._warn_of_dropped(3)

    def step_derivatives(
        self,
        method: DerivativeMethodLike = "auto",
        *,
        epsilon: float = 1e-6,
        margin: float = 1e-6,
        parameters: Sequence[Any] = (),
    ) -> StepDerivatives:
        """Derivatives of the step that step() would make, and its result. The state stays as it is.

        method      "auto": analytic where it covers the step, else central differences of the step
        epsilon     change of each coordinate in central differences
        margin      a contact's mode is degenerate within it of its end: m, m/s, and share of the largest force
        parameters  by which P is: dyn.StepParameterType or (type, index) each
        """
        n, nv, nu, room = self.model.nq, self.model.nv, self.model.nu, max(self.model.contact_capacity, 1)
        by = _Parameters(parameters)
        A, B, B_control, P = (np.empty((2 * nv, k), order="F") for k in (2 * nv, nv, nu, by.size))
        q, v = np.empty(n), np.empty(nv)
        contacts, modes, degenerate = (abi.ContactForce * room)(), (c_int * room)(), (c_int32 * room)()
        report = abi.StepDerivativeReport()
        out = abi.StepDerivatives()
        for name, x in {"A": A, "B": B, "B_control": B_control, "q": q, "v": v, "P": P}.items():
            setattr(out, name, address(x))
        out.capacity, out.contacts, out.modes = room, addressof(contacts), addressof(modes)
        out.degenerate, out.report = addressof(degenerate), addressof(report)
        self._differentiate(out, by, method, epsilon, margin)
        count = report.contacts
        return StepDerivatives(
            A, B, B_control, q, v, [_contact_force(f) for f in contacts[:count]], [ContactMode(k) for k in modes[:count]],
            [bool(k) for k in degenerate[:count]], DerivativeMethod(report.method), report.reason.decode(), report.degenerate, P,
        )  # fmt: skip

    def step_jvp(
        self,
        tangents: ArrayLike,
        parameters: Sequence[Any] = (),
        method: DerivativeMethodLike = "auto",
        *,
        epsilon: float = 1e-6,
        margin: float = 1e-6,
    ) -> Numbers:
        """Change of the next state (q, v) along changes of the inputs: [A B B_control P] tangents, without these matrices.

        tangents  changes of q, v, tau, controls and the parameters, one after another; or columns of them
        """
        return self._product("tangents", tangents, "jvp", parameters, method, epsilon, margin)

    def step_vjp(
        self,
        cotangents: ArrayLike,
        parameters: Sequence[Any] = (),
        method: DerivativeMethodLike = "auto",
        *,
        epsilon: float = 1e-6,
        margin: float = 1e-6,
    ) -> Numbers:
        """Gradients by the inputs from gradients by the next state (q, v): the transpose of step_jvp.

        cotangents  2 nv numbers, or columns of them
        """
        return self._product("cotangents", cotangents, "vjp", parameters, method, epsilon, margin)

    def _product(
        self, name: str, vectors: ArrayLike, result: str, parameters: Sequence[Any], method: Any, epsilon: float, margin: float
    ) -> Numbers:
        by, nv = _Parameters(parameters), self.model.nv
        sizes = {"tangents": 3 * nv + self.model.nu + by.size, "cotangents": 2 * nv}
        rows = sizes[name]
        x = checked(vectors, (rows, *np.shape(vectors)[1:2]), name)
        y = np.empty((sum(sizes.values()) - rows, *x.shape[1:]), order="F")
        out = abi.StepDerivatives()
        setattr(out, name, address(x)), setattr(out, result, address(y))
        setattr(out, name[:-1] + "_count", x.shape[1] if x.ndim > 1 else 1)
        self._differentiate(out, by, method, epsilon, margin)
        return y

    def _differentiate(self, out: Any, by: _Parameters, method: Any, epsilon: float, margin: float) -> None:
        options = abi.StepDerivativeOptions()
        lib.dyn_step_derivative_options_init(byref(options), sizeof(options))
        options.method, options.epsilon, options.margin = member(DerivativeMethod, method, "method"), epsilon, margin
        by.put(out)
        check(lib.dyn_step_derivatives(self._m, self._d, byref(options), byref(out)))

    def advance(self, duration: float) -> StepReport:
        """Makes the steps that duration (s) takes, and says how many."""
        check(lib.dyn_advance(self._m, self._d, duration))
        self._warn_of_dropped(4)
        return self.step_report

    def _warn_of_dropped(self, stacklevel: int) -> None:
        """Warns once when a step had no room for all its contact points."""
        if self._dropped or not self.step_report.dropped:
            return
        self._dropped = True
        message = f"{self.step_report.dropped} contact points had no room and were left out, the shallowest: raise contact_capacity"
        warnings.warn(f"{self.model.name}: {message}", ContactWarning, stacklevel=stacklevel)

    @property
    def step_report(self) -> StepReport:
        """Report of the last step or advance."""
        r = abi.StepReport()
        check(lib.dyn_data_step_report(self._m, self._d, byref(r)))
        return StepReport(*(getattr(r, name) for name in StepReport._fields))

    def error_bar(self, finer: Data) -> ErrorBar:
        """Bounds on the error of this state, by that of finer, which began like it, was driven alike, and is at the same time, with
        at most half the dt or half the accuracy.

            finer = data.copy()
            finer.set_step_options(dt=5e-4)
            data.advance(1.0), finer.advance(1.0)
            bar = data.error_bar(finer)
        """
        bar = abi.ErrorBar()
        check(lib.dyn_data_error_bar(self._m, self._d, finer._d, byref(bar)))
        return ErrorBar(bar.q, bar.v, bool(bar.lost))

    @property
    def ledger(self) -> ErrorLedger:
        """Energy and momentum by source in the last step or advance; needs set_step_options(ledger=True)."""
        x = abi.ErrorLedger()
        check(lib.dyn_data_ledger(self._m, self._d, byref(x)))
        values = {name: getattr(x, name) for name in ErrorLedger._fields}
        return ErrorLedger(**values | {"momentum_defect": np.array(x.momentum_defect)})

    def step_contacts(self) -> list[ContactForce]:
        """Contact points of the last step with their forces, by pairs."""
        room, count = 64, c_int()
        while True:
            out = (abi.ContactForce * room)()
            check(lib.dyn_data_step_contacts(self._m, self._d, out, room, byref(count)))
            if count.value <= room:
                return [_contact_force(f) for f in out[: count.value]]
            room = count.value

    def save_state(self) -> bytes:
        """The state: q, v, a, tau, the time, and the contacts that the next step begins from."""
        n = lib.dyn_model_state_size(self._m)
        out = create_string_buffer(n)
        check(lib.dyn_data_save_state(self._m, self._d, out, n))
        return out.raw

    def restore_state(self, state: bytes) -> None:
        """Brings back a state of the same model that save gave: steps go on from it bit for bit."""
        check(lib.dyn_data_restore_state(self._m, self._d, bytes(state), len(state)))

    def set_shape_material(self, shape: int | None, material: Material) -> None:
        """Sets the material of a collision shape (None: all) in this data."""
        check(lib.dyn_data_set_shape_material(self._m, self._d, -1 if shape is None else shape, byref(material.structure())))

    def shape_material(self, shape: int) -> Material:
        """Returns the material of a collision shape in this data."""
        out = abi.Material()
        check(lib.dyn_data_shape_material(self._m, self._d, shape, byref(out)))
        return Material.of(out)
