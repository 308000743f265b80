"""Rollouts: many simulations of one model at once."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from ctypes import byref
from typing import TYPE_CHECKING, Any, Callable, NamedTuple

import numpy as np

from . import abi
from .arrays import address, numbers
from .choices import member, whole
from .enums import SensorType, Status
from .errors import ArgumentError, SizeError
from .library import fail, lib
from .simulation import fill_stepping

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Integers, Numbers
    from .enums import ContactModelLike, ContactSolverTypeLike, IntegratorLike
    from .model import Model

Sensors = Mapping[str, Any]
"""{name: dyn.SensorType or its name, or (that, frame)}, as {"imu": ("imu", "base"), "com": "com"}."""


def _contact_type() -> np.dtype:
    inner, outer = abi.Contact, abi.ContactForce
    names = ["pair", "shape_a", "shape_b", "feature", "distance", "position", "normal", "force_on_b", "moment_on_b"]
    formats = ["i4", "i4", "i4", "u8", "f8", "3f8", "3f8", "3f8", "3f8"]
    offsets = [getattr(inner, n).offset for n in names[:7]] + [outer.force_on_b.offset, outer.moment_on_b.offset]
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ctypes.sizeof(outer)})


CONTACT = _contact_type()
"""A record of Rollout.contacts: dyn.Contact, and the force and the moment on shape B."""


class Rollout(NamedTuple):
    """Records of rollouts: N simulations, R records of each."""

    q: Numbers
    """(N, R, nq)."""
    v: Numbers
    """(N, R, nv)."""
    sensors: dict[str, Numbers]
    """An array (N, R, size) by name: see dyn.SensorType."""
    contacts: np.ndarray | None
    """(N, R, capacity), of type CONTACT, if asked for; the first contact_count of them hold."""
    contact_count: Integers | None
    """(N, R), how many contact points there were: more than the capacity may."""
    states: np.ndarray | None
    """(N, bytes), if asked for: what goes on from here as `states`, bit for bit, with the same model."""
    status: Integers
    """(N,), a dyn.Status each: records of one that failed are NaN from then on."""


DRIVEN = ("control", "tau", "mocap")
DIMENSIONS = {"q0": 2, "v0": 2, **dict.fromkeys(DRIVEN, 3)}
"""With a row for each simulation."""


def given_arrays(model: Model, **arrays: Any) -> dict[str, Numbers]:
    """Those that are not None, as numbers; placements of mocap bodies one behind another."""
    given = {name: numbers(x, name) for name, x in arrays.items() if x is not None}
    if "mocap" in given:
        x, shape = given["mocap"], (model.nmocaps, 12)
        if x.ndim not in (3, 4) or x.shape[-2:] != shape:
            raise SizeError(f"mocap has shape {x.shape}, but must have shape (N, R, {shape[0]}, 12), or (R, ...) for all simulations.")
        given["mocap"] = x.reshape(*x.shape[:-2], 12 * shape[0])
    return given


class Plan:
    """Sizes of a rollout: what is not said follows from the arrays that are given."""

    model: Model
    steps: int | None
    every: int
    n: int | None

    def __init__(self, model: Model, given: dict[str, Numbers], states: Any, n: int | None, steps: int | None, every: int,
                 models: Sequence[Model] | None = None):
        self.model, self.steps, self.every, self.n = model, steps, every, n
        if not isinstance(every, (int, np.integer)) or not 1 <= every < 2**31:
            raise ArgumentError(f"every is {every!r}, but must be a number of steps, from 1 to 2^31 - 1.")
        self.steps, self.n = None if steps is None else whole(steps, "steps", 1), None if n is None else whole(n, "n", 0)
        driven = [(name, x) for name, x in given.items() if name in DRIVEN]
        for name, x in driven:
            if x.ndim not in (2, 3):
                raise SizeError(f"{name} has shape {x.shape}, but must have shape (N, R, {self.width(name)}), or (R, ...) for "
                                "all simulations.")
            self.agree("steps", x.shape[-2] * every, f"the {x.shape[-2]} records of {name}")
        for name, x in [*given.items(), ("states", states)]:
            if x is not None and x.ndim == DIMENSIONS.get(name, 2):
                self.agree("n", len(x), f"the shape of {name}")
        if models is not None:
            self.agree("n", len(models), "the number of models")
        if self.steps is None:
            raise ArgumentError("steps is needed: nothing that is given says how many records there are.")
        if self.n is None:
            self.n = 1
        if self.steps < 1 or self.steps % every:
            raise ArgumentError(f"steps is {self.steps}, but must be at least 1 and a multiple of every, {every}.")
        self.records: int = self.steps // every

    def agree(self, name: str, value: int, why: str) -> None:
        said = getattr(self, name)
        if said is not None and said != value:
            raise SizeError(f"{name} is {said}, but {why} says {value}.")
        setattr(self, name, value)

    def width(self, name: str) -> int:
        return {"q0": self.model.nq, "control": self.model.nu, "mocap": 12 * self.model.nmocaps}.get(name, self.model.nv)

    def shaped(self, name: str, x: Any) -> tuple[int, ...]:
        """The shape of x with a row for each simulation; x may have one row for all."""
        shape = (self.n, self.records, self.width(name)) if name in DRIVEN else (self.n, self.width(name))
        if x.shape not in (shape, shape[1:]):
            raise SizeError(f"{name} has shape {x.shape}, but must have shape {shape} or {shape[1:]} of model "
                            f"{self.model.name!r}.")
        return shape

    def rows(self, name: str, x: Any) -> Numbers:
        """x for all simulations, contiguous."""
        return np.ascontiguousarray(np.broadcast_to(x, self.shaped(name, x)))


def _sensors(model: Model, sensors: Sensors | None) -> tuple[Integers, Integers, dict[str, int]]:
    """Types, frames, and the size of each by name."""
    types, frames, sizes = [], [], {}
    for name, what in (sensors or {}).items():
        kind, frame = what if isinstance(what, (tuple, list)) and len(what) == 2 else (what, None)
        kind = member(SensorType, kind, f"sensors[{name!r}]")
        if frame is None and kind not in (SensorType.COM, SensorType.ENERGY):
            raise ArgumentError(f"sensors[{name!r}] needs a frame: give ({kind.name.lower()!r}, frame).")
        if isinstance(frame, str) and kind == SensorType.FORCE:
            frame = model.frame_id(frame, "body")
        types.append(kind)
        frames.append(0 if frame is None else model._frame(frame))
        sizes[name] = lib.dyn_sensor_size(kind)
    return np.array(types, np.int32), np.array(frames, np.int32), sizes


_PROGRESS: Any = dict(abi.Rollout._fields_)["progress"]


class _Progress:
    """The caller's function as the library calls it; what it raises (a key pressed, too) ends the rollout and is raised again
    after it."""

    def __init__(self, told: Callable[[int, int], Any] | None):
        self.told, self.error = told, None
        self.pointer = _PROGRESS(self.call)

    def call(self, _: Any, steps: int, of: int) -> int:
        try:
            return int(self.told is not None and self.told(steps, of) is False)
        except BaseException as error:
            self.error = error
            return 1


class Rollouts:
    """The part of Batch that simulates."""

    def rollout(
        self,
        q0: ArrayLike | None = None,
        v0: ArrayLike | None = None,
        *,
        control: ArrayLike | None = None,
        tau: ArrayLike | None = None,
        mocap: ArrayLike | None = None,
        models: Sequence[Model] | None = None,
        steps: int | None = None,
        every: int = 1,
        n: int | None = None,
        dt: float | None = None,
        integrator: IntegratorLike | None = None,
        solver: ContactSolverTypeLike | None = None,
        tolerance: float | None = None,
        max_iterations: int | None = None,
        contact_model: ContactModelLike | None = None,
        sensors: Sensors | None = None,
        model_sensors: bool = False,
        sensor_noise: int | None = None,
        sensor_delays: bool = False,
        contacts: int = 0,
        states: np.ndarray | None = None,
        keep_states: bool = False,
        strict: bool = True,
        progress: Callable[[int, int], Any] | None = None,
    ) -> Rollout:
        """N simulations of `steps` steps of dt (None: of the model's file, else 1e-3 s). Simulation k is bit for bit what a Data
        does, whatever the number of threads.

        q0, v0      (N, nq), (N, nv), or one row for all: where they begin; as new data
        states      (N, bytes), Rollout.states of an earlier call: they go on from there
        control     (N, R, nu), or (R, nu) for all: for actuators, each row held for `every` steps; R = steps / every
        tau         (N, R, nv), or (R, nv): generalised forces, N m or N, in the same way
        mocap       (N, R, nmocaps, 12), or (R, nmocaps, 12): placements of mocap bodies, set in the same way
        models      N models of their own, as dyn.vary makes them: of other masses, frictions, gains; states are then of these
        every       steps between records
        n, steps    where no array says them
        integrator, solver, tolerance, max_iterations, contact_model  as in Data.set_step_options
        sensors     {name: type or (type, frame)}: see dyn.SensorType
        model_sensors  record the model's own sensors, too, by their names; accelerations are the mean ones of the last step
        sensor_noise   a seed: those have noise, of simulation k with the seed plus k, of record r with the count r
        sensor_delays  those are as old as their delays, rounded to steps
        contacts    contact points to record, of the last step before each record, the rest is counted
        keep_states whether to return what a later call goes on from
        strict      the first simulation that fails raises, after all have ended; False: Rollout.status says it
        progress    called with (steps made, steps in all) about every 10 ms by this thread; False from it, an exception in it, or
                    Ctrl-C ends all: dyn.CancelledError, or that exception
        """
        model = self.model
        given = given_arrays(model, q0=q0, v0=v0, control=control, tau=tau, mocap=mocap)
        size = lib.dyn_model_state_size(model._m)
        if states is not None and (
            not isinstance(states, np.ndarray) or states.dtype != np.uint8 or states.ndim != 2 or states.shape[1] != size
        ):
            raise SizeError(f"states must be what a rollout of this model left: uint8, of shape (N, {size}).")
        plan = Plan(model, given, states, n, steps, every, models)
        N, R = plan.n, plan.records
        types, frames, sizes = _sensors(model, sensors)
        if not isinstance(contacts, (int, np.integer)) or contacts < 0:
            raise ArgumentError(f"contacts is {contacts!r}, but must be a number of contact points.")

        stepping, x = model.step_options, abi.initialized(abi.Rollout)
        fill_stepping(stepping, integrator, solver, dt=dt, tolerance=tolerance, max_iterations=max_iterations,
                      contact_model=contact_model)
        x.steps, x.every, x.sensors, x.contact_capacity = plan.steps, every, len(types), contacts
        x.stepping, x.sensor, x.sensor_frame = ctypes.addressof(stepping), address(types), address(frames)
        keep = {name: plan.rows(name, value) for name, value in given.items()}
        if states is not None:
            keep["states"] = np.ascontiguousarray(states)
        empty = np.empty if strict else lambda shape: np.full(shape, np.nan)
        out = {"q": empty((N, R, model.nq)), "v": empty((N, R, model.nv)), "status": np.zeros(N, np.int32)}
        if sizes:
            out["sensor_data"] = empty((N, R, sum(sizes.values())))
        if model_sensors:
            out["model_sensors"] = empty((N, R, model.nsensordata))
            x.sensor_noise, x.sensor_seed, x.sensor_delays = sensor_noise is not None, sensor_noise or 0, sensor_delays
        if contacts:
            out["contacts"], out["contact_count"] = np.zeros((N, R, contacts), CONTACT), np.zeros((N, R), np.int32)
        if keep_states:
            out["final_states"] = np.zeros((N, size), np.uint8)
        for name, array in (keep | out).items():
            setattr(x, name, address(array))
        if models is not None:
            own = (ctypes.c_void_p * plan.n)(*[each._m for each in models])
            x.models = ctypes.addressof(own)
        told = _Progress(progress)
        x.progress = told.pointer

        status = lib.dyn_batch_rollout(self._b, N, byref(x))
        if told.error is not None:
            raise told.error
        failed = out["status"].any()
        if status and (strict or not failed or status == Status.ERROR_CANCELLED):
            fail(status)
        ends = np.cumsum([0, *sizes.values()])
        data = {name: out["sensor_data"][..., a:b] for name, a, b in zip(sizes, ends, ends[1:])}
        if model_sensors:
            data |= {str(s.name): out["model_sensors"][..., s.idx : s.idx + s.size] for s in model.sensors}
        return Rollout(out["q"], out["v"], data, out.get("contacts"), out.get("contact_count"), out.get("final_states"),
                       out["status"])
