"""The quantities that data holds, as the library describes them."""

from __future__ import annotations

from ctypes import byref
from typing import NamedTuple

from . import abi
from .enums import Part
from .library import check, lib


class FieldInfo(NamedTuple):
    """A quantity that data holds, as the library describes it."""

    id: int
    name: str
    shape: str
    unit: str
    frame: str
    producer: str
    """The call that computes it; "" for the state."""
    sentence: str
    part: Part


def _fields() -> dict[str, FieldInfo]:
    fields = {}
    for id in range(lib.dyn_field_count()):
        info = abi.FieldInfo()
        check(lib.dyn_field_info(id, byref(info)))
        words = [(s or b"").decode() for s in (info.name, info.shape, info.unit, info.frame, info.producer, info.sentence)]
        fields[words[0]] = FieldInfo(id, *words, Part(info.part))
    return fields


FIELDS: dict[str, FieldInfo] = _fields()
"""Every field of the loaded library, by name."""

SHAPES: dict[int, list[str]] = {}
"""Dimensions of each field that are not 1: none, a number; one, a vector."""
for _f in FIELDS.values():
    _dims = _f.shape.replace("scalar", "1").split(" x ")
    SHAPES[_f.id] = [] if set(_dims) == {"1"} else _dims[:1] if _dims[1:] in ([], ["1"]) else _dims

ID = {name: info.id for name, info in FIELDS.items()}
