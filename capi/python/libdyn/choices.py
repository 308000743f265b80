"""Arguments as the library takes them: members and masks of enumerations, strings; and back."""

from __future__ import annotations

import difflib
import operator
from collections.abc import Iterable
from typing import Any, TypeVar

from .enums import Reference
from .errors import ArgumentError
from .library import fail

E = TypeVar("E")


def member(enum: type[E], value: Any, what: str) -> E:
    """A member of an enumeration from itself, its name in either case, or its number."""
    if isinstance(value, str):
        found = enum.__members__.get(value.upper())  # type: ignore[attr-defined]
        if found is not None:
            return found
    else:
        try:
            return enum(operator.index(value))  # type: ignore[call-arg]
        except (TypeError, ValueError):
            pass
    raise ArgumentError(f"{what} is {value!r}, but {_allowed(enum, value)}.")


_MANY = 24
"""Names that a message lists at most."""


def _allowed(enum: Any, value: Any) -> str:
    names = list(enum.__members__)
    near = difflib.get_close_matches(value.upper(), names, n=1) if isinstance(value, str) else []
    known = f"must be one of {', '.join(names)}" if len(names) <= _MANY else f"must be a member of dyn.{enum.__name__}"
    return known + (f"; did you mean {near[0].lower()!r}?" if near else "")


_REFERENCES: dict[Any, int] = {key: int(r) for r in Reference for key in (r, r.name, r.name.lower())}


def reference(value: Any) -> int:
    """A dyn.Reference, most often by its name."""
    try:
        found = _REFERENCES.get(value)
    except TypeError:  # an array, as of who gives q here
        found = None
    return member(Reference, value, "reference") if found is None else found


def kind(enum: Any, value: int) -> Any:
    """A member; the bare number when a newer library knows more of them."""
    return enum(value) if value in enum._value2member_map_ else value


def mask(flag: type[E], value: Any, what: str) -> int:
    """A bit mask from a member, a number, a name, or several of them."""
    if isinstance(value, str):
        return int(member(flag, value, what))  # type: ignore[call-overload]
    if isinstance(value, Iterable) and not isinstance(value, int):
        bits = 0
        for one in value:
            bits |= mask(flag, one, what)
        return bits
    try:
        bits = operator.index(value)
    except TypeError:
        raise ArgumentError(f"{what} is {value!r}, but must be a mask of {flag.__name__}.") from None
    if not 0 <= bits < 1 << 32:
        raise ArgumentError(f"{what} is {bits}, but must be a mask of {flag.__name__}, 0 to 2^32 - 1.")
    return bits


def whole(x: Any, what: str, least: int = -(2**31), bits: int = 31) -> int:
    """An integer of 32 bits, or of others and a sign: ctypes would cut a longer one."""
    try:
        number = operator.index(x)
    except TypeError:
        raise ArgumentError(f"{what} is {x!r}, but must be an integer.") from None
    if not least <= number < 2**bits:
        raise ArgumentError(f"{what} is {number}, but must be from {least} to 2^{bits} - 1.")
    return number


def text(s: str, what: str) -> bytes:
    if not isinstance(s, str):
        raise ArgumentError(f"{what} is {s!r}, but must be a string.")
    if "\0" in s:
        raise ArgumentError(f"{what} holds a zero character: {s!r}.")
    return s.encode("utf-8", "surrogateescape")


def string(s: bytes | None) -> str:
    return "" if s is None else s.decode("utf-8", "surrogateescape")


def size(n: int) -> int:
    """A count that the library returned; negative: it failed."""
    if n < 0:
        fail(2)
    return n
