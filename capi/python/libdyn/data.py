"""What a robot is doing: Data, its state and its fields."""

from __future__ import annotations

import weakref
from ctypes import byref, c_uint32, c_void_p
from typing import Any, Callable, NamedTuple

import numpy as np

from . import abi
from .actuator import Driving
from .arrays import Owner, address, result, slot, view
from .centroidal import CentroidalDynamics
from .choices import mask, text
from .collision import CollisionQueries
from .constraint import ConstraintCalls
from .contact import ContactQueries
from .derivatives import Derivatives
from .dynamics import Dynamics
from .enums import Effect, Part
from .errors import ArgumentError, UnknownNameError
from .field_properties import STATE, Fields
from .fields import SHAPES
from .identification import Regressors
from .ik import InverseKinematics
from .kinematics import Kinematics
from .library import check, fail, last_error, lib
from .model import Model
from .simulation import Stepping

_data_array = lib.dyn_data_array
_set_state = lib.dyn_data_set_state


class EffectPlan(NamedTuple):
    """One effect of a data's steps."""

    present: int
    """How many joints, pairs, constraints, actuators, links may have it."""
    acting: int
    """Not 0: it acts; of contact and constraints how many pairs are tested, slots enabled."""
    bytes: int
    """Of the data's memory, for it alone."""


class Data(
    Kinematics, Dynamics, Derivatives, CentroidalDynamics, Regressors, InverseKinematics, CollisionQueries, ContactQueries, ConstraintCalls, Driving,
    Stepping, Fields,  # fields last: a method of the same name stays, and Data.field(name) reaches the field
):  # fmt: skip
    """What the robot is doing: every buffer, for one thread at a time. From Model.data().

    A call with q, v, a or tau sets the state that data holds; None uses what is held. Methods return new arrays.
    Fields (d.q, d.M, d.com, ...: dir(d), help(dyn.Data.M)) are read-only views of the library's memory that follow the
    data and keep it alive; one that was not computed for the current state raises dyn.StaleError naming the call to make.
    """

    def __init__(self, model: Model, parts: Any = Part.ALL, memory: Any = None):
        self.model = model
        """The robot."""
        self._m = model._m
        out = c_void_p()
        bits = mask(Part, parts, "parts")
        if memory is None:
            check(lib.dyn_data_new(self._m, bits, byref(out)))
        else:
            try:
                memory = np.frombuffer(memory, np.uint8)
            except (TypeError, ValueError) as error:
                raise ArgumentError(f"memory is not a contiguous buffer: {error}.") from None
            if not memory.flags.writeable:
                raise ArgumentError("memory is read-only, but data is placed in it.")
            check(lib.dyn_data_init(self._m, bits, address(memory), memory.size, byref(out)))
        self._d = out.value
        self._owner = Owner(self._d, lib.dyn_data_free, (model._owner, memory))
        self.parts = Part(bits or Part.ALL)
        """The groups of buffers that this data has."""
        self._views: dict[int, np.ndarray | None] = {}
        self._array = abi.Array()
        self._array_ref = byref(self._array)

        nv, ref = model.nv, weakref.ref(model)
        self._q = slot((model.nq,), "q", ref)
        self._v = slot((nv,), "v", ref)
        self._a = slot((nv,), "a", ref)
        self._tau = slot((nv,), "tau", ref)
        self._fext_in: Callable | None = None
        self._three, self._six, self._twelve = result((3,)), result((6,)), result((12,))
        self._three_nv, self._six_nv = result((3, nv)), result((6, nv))

    def __repr__(self) -> str:
        names = [name.lower() for name, p in Part.__members__.items() if p in self.parts and p != Part.ALL]
        parts = "all parts" if self.parts == Part.ALL else "parts " + ", ".join(names)
        return f"<dyn.Data of {self.model.name!r}: nq {self.model.nq}, nv {self.model.nv}, {parts}>"

    def _repr_html_(self) -> str:
        from .html import data

        return data(self)

    def _fext(self, fext: Any) -> int | None:
        if fext is None:
            return None
        if self._fext_in is None:
            self._fext_in = slot((6, self.model.njoints), "fext", weakref.ref(self.model))
        return self._fext_in(fext)

    def _result(self, status: int, field: int) -> np.ndarray:
        """A copy of what a call has left in data."""
        if status:
            fail(status)
        found = self._views.get(field)
        if found is None:
            found = self.field(field)
        return found.copy("F")

    # ------------------------------------------------------------------------------------------- state and fields

    def set_state(self, q: Any = None, v: Any = None, a: Any = None, tau: Any = None) -> None:
        """Sets what is given of the state: q (nq,), v, a, tau (nv,). set_state(**json.load(file)) reads a state file."""
        status = _set_state(self._m, self._d, self._q(q), self._v(v), self._a(a), self._tau(tau))
        if status:
            fail(status)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Copies of the state: {"q", "v", "a", "tau"}, as set_state takes it."""
        return {name: self.field(field).copy() for field, name in STATE.items()}

    def plan(self) -> dict[str, EffectPlan]:
        """What a step of this data takes into account, by name."""
        out, info = {}, abi.EffectInfo()
        for k in range(lib.dyn_effect_count()):
            check(lib.dyn_data_effect_info(self._m, self._d, k, byref(info)))
            out[info.name.decode()] = EffectPlan(info.present, info.acting, info.bytes)
        return out

    def set_effects(self, effects: Any, joint: str | int = 0) -> None:
        """Switches the effects of a joint, or of all, to those given: dyn.Effect members or names, as "damping", ("armature",
        "springs"), "all" or (). New data: armature, limits, actuators, held weights and the medium, which but for armature act in steps alone."""
        check(lib.dyn_data_set_effects(self._m, self._d, self.model._joint(joint), mask(Effect, effects, "effects")))

    def warm_up(self) -> None:
        """Touches what later calls would be the first to touch: no call waits for a page of memory. Once in each thread with a deadline."""
        check(lib.dyn_data_warm_up(self._m, self._d))

    def effects(self, joint: str | int = 0) -> Effect:
        """Those that are on at a joint; without one, those that act at some joint."""
        out = c_uint32()
        check(lib.dyn_data_effects(self._m, self._d, self.model._joint(joint), byref(out)))
        return Effect(out.value)

    def field(self, field: str | int) -> Any:
        """A field by name or id: a read-only view of the library's memory (a number for a scalar)."""
        if not isinstance(field, int):
            id = lib.dyn_field_id(text(field, "field"))
            if id < 0:
                raise UnknownNameError(last_error())
            field = id
        status = _data_array(self._m, self._d, field, self._array_ref)
        if status:
            fail(status)
        found = self._views.get(field)
        if found is None:
            a = self._array
            dims = SHAPES[field]  # "nv", "nv x 1": a vector, "6 x nv": a matrix, "1 x 1": a number
            found = view(a.data, a.rows, a.cols if len(dims) == 2 else None, tuple(a.stride), self._owner)
            self._views[field] = found = found if dims else found.reshape(())
        return found if found.ndim else float(found)
