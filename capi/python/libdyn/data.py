"""What a robot is doing: Data."""

from __future__ import annotations

from ctypes import byref, c_uint32, c_void_p
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi, html
from .actuator import Actuation
from .arrays import address
from .choices import mask
from .collision import CollisionQueries
from .constraint import ConstraintCalls
from .contact import ContactQueries
from .enums import Effect, Part
from .errors import ArgumentError, PartError
from .evaluation import Evaluation
from .guard import guarded
from .ik import InverseKinematics
from .library import check, lib
from .mocap import MocapCalls
from .sensor import SensorCalls
from .simulation import SimulationCalls
from .tendon import TendonCalls

if TYPE_CHECKING:
    from .enums import EffectLike, PartLike
    from .model import Model


class EffectPlan(NamedTuple):
    """One effect of a data's steps."""

    present: int
    """Number of joints, pairs, constraints, actuators, tendons or links that may have it."""
    acting: int
    """Not 0: it acts; of contact and constraints how many pairs are tested, slots enabled."""
    bytes: int
    """Bytes of the data's memory for it alone."""


class Data(
    Evaluation, InverseKinematics, CollisionQueries, ContactQueries, ConstraintCalls, Actuation, SimulationCalls, TendonCalls,
    MocapCalls, SensorCalls,
):
    """What the robot is doing: every buffer, for one thread at a time. From Model.data().

    Fields are properties: d.q, d.M, d.com, d.Minv. They are read-only views of the library's memory that follow the data
    and keep it alive. A field that was not computed for the current state raises dyn.StaleError, which names the call to make.
    Methods have the names of the C functions without dyn_: d.rnea, d.crba, d.minv. Where a field has that name, the method
    is compute_<name>: d.compute_com(q) computes the field d.com. Methods return new arrays.
    A call with q, v, a or tau sets the state that data holds; None uses what is held.
    fext holds external forces [force; moment] on each joint's body, in the joint's frame, (6, njoints); column 0 is ignored.
    """

    model: Model

    def __init__(self, model: Model, parts: PartLike = Part.ALL, memory: Any = None):
        out, bits = c_void_p(), mask(Part, parts, "parts")
        if memory is None:
            check(lib.dyn_data_new(model._m, bits, byref(out)))
        else:
            try:
                memory = np.frombuffer(memory, np.uint8)
            except (TypeError, ValueError) as error:
                raise ArgumentError(f"memory is not a contiguous buffer: {error}.") from None
            if not memory.flags.writeable:
                raise ArgumentError("memory is read-only, but data is placed in it.")
            check(lib.dyn_data_init(model._m, bits, address(memory), memory.size, byref(out)))
        super().__init__(model, out.value or 0, memory)
        self.parts: Part = Part(bits or Part.ALL)
        """The groups of buffers that this data has."""

    def __repr__(self) -> str:
        names = [name.lower() for name, p in Part.__members__.items() if p in self.parts and p != Part.ALL]
        parts = "all parts" if self.parts == Part.ALL else "parts " + ", ".join(names)
        return f"<dyn.Data of {self.model.name!r}: nq {self.model.nq}, nv {self.model.nv}, {parts}>"

    def _repr_html_(self) -> str:
        return html.data(self)

    def copy(self) -> Data:
        """A data of its own in the same state, with the same settings. What was computed is not copied."""
        other = Data(self.model, self.parts)
        check(lib.dyn_data_copy(self._m, other._d, self._d))
        other._settings, other._wrenches = dict(self._settings), dict(self._wrenches)
        return other

    def __copy__(self) -> Data:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Data:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (self.model, self.parts, *self._contents())

    def _contents(self) -> tuple[Any, ...]:
        """State, options of steps, settings, wrenches."""
        try:
            state: Any = self.save_state()
            options = self.step_options
            stepping = {name: getattr(options, name) for name, *_ in options._fields_[1:]}
        except PartError:  # it makes no steps
            state, stepping = self.state, {}
        return state, stepping, dict(self._settings), dict(self._wrenches)

    def plan(self) -> dict[str, EffectPlan]:
        """Returns the effects of this data's steps, by name."""
        out, info = {}, abi.EffectInfo()
        for k in range(lib.dyn_effect_count()):
            check(lib.dyn_data_effect_info(self._m, self._d, k, byref(info)))
            out[info.name.decode()] = EffectPlan(info.present, info.acting, info.bytes)
        return out

    def set_effects(self, effects: EffectLike, joint: str | int = 0) -> None:
        """Switches the effects of a joint, or of all, to those given: dyn.Effect members or names, as "damping", ("armature",
        "springs"), "all", "default" or (). Those of new data are "default": steps apply all effects that the model states
        ("as_stated"), and algorithms called alone apply armature."""
        check(lib.dyn_data_set_effects(self._m, self._d, self.model._joint(joint), mask(Effect, effects, "effects")))

    def warm_up(self) -> None:
        """Touches what later calls would be the first to touch: no call waits for a page of memory. Once in each thread with a
        deadline."""
        check(lib.dyn_data_warm_up(self._m, self._d))

    def effects(self, joint: str | int = 0) -> Effect:
        """Returns the effects that are on at a joint; without one, those that act in steps at some joint."""
        out = c_uint32()
        check(lib.dyn_data_effects(self._m, self._d, self.model._joint(joint), byref(out)))
        return Effect(out.value)


def adopted(state: bytes, data: Data) -> bytes:
    """A saved state of an equal model, for this data: the second number of a state is its model's."""
    return state[:8] + data.save_state()[8:16] + state[16:]


def restored(model: Model, parts: Part, state: Any, stepping: dict[str, Any], settings: dict[Any, Any],
             wrenches: dict[Any, Any]) -> Data:
    """The data that Data._contents describes."""
    data = Data(model, parts)
    if stepping:
        options = data.step_options
        for name, x in stepping.items():
            setattr(options, name, x)
        check(lib.dyn_data_set_step_options(data._m, data._d, byref(options)))
    for (method, _), arguments in settings.items():
        getattr(data, method)(*arguments)
    for (frame, point, reference), wrench in wrenches.items():
        data.apply_wrench(frame, wrench, None if point is None else np.frombuffer(point), reference)
    if isinstance(state, bytes):
        data.restore_state(adopted(state, data))
    else:
        data.set_state(**state)
    return data


guarded(Data)
