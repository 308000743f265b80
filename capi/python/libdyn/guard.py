"""One thread at a time in a Data, and what its settings are, so that copies and pickles have them.

Taking the only element of a list is one operation of the interpreter: whoever finds the list empty is a second thread, or a
method that another one of the same thread calls.
"""

from __future__ import annotations

import copy
import functools
import inspect
from collections.abc import Callable, Iterator
from threading import get_ident
from types import CodeType
from typing import Any

from .errors import BusyError

SETTINGS: dict[str, tuple[str, Any]] = {
    "set_effects": ("joint", 0), "set_gravity": ("", None), "set_pair": ("pair", None), "set_shape_material": ("shape", None),
    "set_shape_masks": ("shape", None), "set_constraint": ("slot", ...), "set_constraint_enabled": ("slot", ...),
    "anchor_constraint": ("slot", ...),
}  # fmt: skip
"""Methods that set what is no part of the state, the argument that says of what, and its value that stands for all."""


def nested(data: Any) -> list[int]:
    """What a call gives back that was made within another one of this thread: nothing. Another thread is refused."""
    if data._holder != get_ident():
        raise BusyError("another thread is using this data: give each thread its own, from Model.data() or copy.copy(data).")
    return []


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _held(f: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(f)
    def call(self: Any, *args: Any, **named: Any) -> Any:
        free = self._free
        try:
            free.pop()
        except IndexError:
            nested(self)
            return f(self, *args, **named)
        self._holder = get_ident()
        try:
            return f(self, *args, **named)
        finally:
            self._holder = 0
            free.append(0)

    return call


def _recorded(f: Callable[..., Any]) -> Callable[..., Any]:
    name, parameters = f.__name__, list(inspect.signature(f).parameters.values())[1:]
    subject, all_of_them = SETTINGS[name]
    place = next((k for k, p in enumerate(parameters) if p.name == subject), None)

    @functools.wraps(f)
    def call(self: Any, *args: Any, **named: Any) -> Any:
        out = f(self, *args, **named)
        given = args + tuple(named.get(p.name, p.default) for p in parameters[len(args) :])
        if name == "anchor_constraint" and given[1] is None:
            given = given[0], self.q
        of = None if place is None else given[place]
        for key in [k for k in self._settings if k[0] == name and (k[1] == of or of == all_of_them)]:
            del self._settings[key]  # what comes last is done last
        self._settings[name, of] = tuple(copy.copy(x) for x in given)
        return out

    return call


def guarded(cls: type) -> None:
    """Makes every method and property of a class that reaches the library hold the data, but those that do so themselves."""
    reaches = {"_d", "_q", "_v", "_a", "_tau", "_fext"}

    def wrapped(f: Any) -> Any:
        names = set(_names(f.__code__)) if hasattr(f, "__code__") else set()
        if "_free" in names or not names & reaches:
            return f
        return _held(_recorded(f) if f.__name__ in SETTINGS else f)

    for name in {name for base in cls.__mro__[:-1] for name in vars(base) if not name.startswith("_")}:
        found = inspect.getattr_static(cls, name)
        if isinstance(found, property):
            get, put = (part and wrapped(part) for part in (found.fget, found.fset))
            if (get, put) != (found.fget, found.fset):
                setattr(cls, name, property(get, put, None, found.__doc__))
        elif inspect.isfunction(found):
            made = wrapped(found)
            if made is not found:
                setattr(cls, name, made)
