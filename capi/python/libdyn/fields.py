"""The fields of data: a property for each, and the state, which can be set."""

from __future__ import annotations

import keyword
from ctypes import byref
from typing import TYPE_CHECKING, Any, NoReturn

from . import abi
from .arrays import view
from .choices import text
from .errors import StaleError, UnknownNameError
from .guard import nested
from .handles import DataHandle
from .library import fail, last_error, lib
from .messages import in_python
from .tables import FIELDS, SHAPES, FieldInfo

if TYPE_CHECKING:
    from .arrays import Numbers

STATE = {"q": "q", "v": "v", "a": "a", "tau_applied": "tau"}  # field: argument of Data.set_state

_data_array = lib.dyn_data_array
_set_state = lib.dyn_data_set_state


_SET = {
    "q": "data.q = x", "v": "data.v = x", "a": "data.a = x", "ctrl": "data.ctrl = x, or Simulation.step(ctrl=x)",
    "tau_applied": "data.tau_applied = x, or Simulation.step(tau=x)", "world_gravity": "data.set_gravity(x)",
    "mocap": "data.set_mocap(name, translation, rotation)",
}  # fmt: skip
_TAU = ("tau is the result of Data.rnea. Forces that act in steps are tau_applied: write data.tau_applied = x, or "
        "Simulation.step(tau=x).")


def _hint(name: str) -> str:
    if name == "tau":
        return f"data.tau is a view of the library's memory, which cannot be written. {_TAU}"
    return f"data.{name} is a view of the library's memory, which cannot be written: " + (
        f"write {_SET[name]}." if name in _SET else "it follows from the state. Change a copy, data." + name + ".copy().")


HINTS = [_hint(info.name) for info in sorted(FIELDS.values(), key=lambda info: info.id)]
"""What an assignment into the array of a field says, by id."""


def _refuse(status: int, field: int) -> NoReturn:
    if field == FIELDS["tau"].id and status == StaleError.status:
        raise StaleError(f"{last_error()}. {_TAU}", status)
    fail(status)


class Fields(DataHandle):
    """The part of Data that has the fields."""

    def __init__(self, model: Any, handle: int, keep: Any):
        super().__init__(model, handle, keep)
        self._views: dict[int, Numbers] = {}
        self._array = abi.Array()
        self._array_ref = byref(self._array)

    def set_state(self, q: Any = None, v: Any = None, a: Any = None, tau: Any = None) -> None:
        """Sets what is given of the state: q (nq,), v, a, tau (nv,). set_state(**json.load(file)) reads a state file."""
        free = self._free
        try:
            free.pop()
        except IndexError:
            free = nested(self)
        try:
            status = _set_state(self._m, self._d, self._q(q), self._v(v), self._a(a), self._tau(tau))
            if status:
                fail(status)
        finally:
            free.append(0)

    @property
    def state(self) -> dict[str, Numbers]:
        """Copies of the state: {"q", "v", "a", "tau"}, as set_state takes it."""
        return {name: self.field(field).copy() for field, name in STATE.items()}

    def field(self, field: str | int) -> Any:
        """A field by name or id: a read-only view of the library's memory (a number for a scalar)."""
        if not isinstance(field, int):
            id = lib.dyn_field_id(text(field, "field"))
            if id < 0:
                raise UnknownNameError(last_error())
            field = id
        free = self._free
        try:
            free.pop()
        except IndexError:
            free = nested(self)
        try:
            status = _data_array(self._m, self._d, field, self._array_ref)
            if status:
                _refuse(status, field)
            found = self._views.get(field)
            if found is None:
                a = self._array
                dims = SHAPES[field]  # "nv", "nv x 1": a vector, "6 x nv": a matrix, "1 x 1": a number
                found = view(a.data, a.rows, a.cols if len(dims) == 2 else None, tuple(a.stride), self._owner, HINTS[field])
                self._views[field] = found = found if dims else found.reshape(())
            return found if found.ndim else float(found)
        finally:
            free.append(0)


def description(info: FieldInfo) -> str:
    """Text of help() for a field."""
    origin = f" Computed by {in_python(info.producer)}." if info.producer else ""
    return f"{info.sentence} ({info.shape}; {info.unit or 'no unit'}; frame: {info.frame or 'none'}.){origin}"


def attribute(name: str) -> str:
    """The property of a field: lambda_ of the field lambda, which is a word of Python's."""
    return f"{name}_" if keyword.iskeyword(name) else name


def _property(info: FieldInfo) -> property:
    def get(self: Fields) -> Any:
        return self.field(id)

    def put(self: Fields, value: Any) -> None:
        if name in STATE:
            self.set_state(**{STATE[name]: value})
        elif name == "ctrl":
            self.set_control(value)  # type: ignore[attr-defined]  # of Data (actuator.py)
        else:
            raise AttributeError(HINTS[id])

    id, name = info.id, info.name
    return property(get, put, doc=description(info))


for _info in FIELDS.values():
    for _name in {_info.name, attribute(_info.name)}:
        setattr(Fields, _name, _property(_info))
