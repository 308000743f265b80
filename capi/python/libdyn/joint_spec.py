"""Structures of joints for Builder: the members of dynJointSpec."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import addressof, byref
from typing import TYPE_CHECKING, Any

import numpy as np

from . import abi
from .arrays import address, checked, numbers
from .arrays import placement as twelve
from .choices import member, text
from .enums import JointType
from .errors import ArgumentError
from .interface import INTERFACE
from .library import check, lib
from .messages import in_python

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_PART_KEYS = ("type", "placement", "axis", "axis2", "pitch")
_MEMBERS = next(s for s in INTERFACE["structs"] if s["name"] == "dynJointSpec")["fields"]
ARRAYS: dict[str, str] = {m["name"]: m["doc"][:2] for m in _MEMBERS if m["type"] == "const double*"}
"""Values that are a number for each coordinate: "nq" of positions, "nv" of velocities."""
SCALARS: set[str] = {m["name"] for m in _MEMBERS if m["type"] == "double" and "length" not in m} - set(_PART_KEYS)
"""Values that are one number."""
VALUES: dict[str, str] = {m["name"]: in_python(m["doc"]) for m in _MEMBERS if m["name"] in ARRAYS or m["name"] in SCALARS}
"""The sentence of each value."""


def sizes(spec: Any, parts: Sequence[Any] = ()) -> dict[str, int]:
    """nq and nv of a joint. The library is given addresses, so lengths are checked here."""
    if spec.type == JointType.COMPOSITE:
        each = [sizes(p) for p in parts]
        return {n: sum(one[n] for one in each) for n in ("nq", "nv")}
    info = abi.JointTypeInfo()
    check(lib.dyn_joint_type_info(spec.type, byref(info)))
    return {"nq": info.nq, "nv": info.nv}


def joint_spec(
    name: str, type: Any, parent: str | None = None, placement: Any = None, axis: ArrayLike | None = None,
    axis2: ArrayLike | None = None, pitch: float | None = None, mimic: str | None = None, parts: Sequence[Mapping[str, Any]] = (),
    **values: Any,
) -> tuple[Any, list[Any]]:  # fmt: skip
    """The structure of a joint, and what must live as long."""
    keep: list[Any] = []
    spec = _geometry(type, placement, axis, axis2, pitch, f"joint {name!r}")
    spec.name = text(name, "name")
    spec.parent = None if parent is None else text(parent, "parent")
    spec.mimic = None if mimic is None else text(mimic, "mimic")
    built = [_part(p, f"joint {name!r}: part {i}") for i, p in enumerate(parts)]
    size = sizes(spec, built)
    for key, value in values.items():
        if key not in VALUES:
            raise TypeError(f"joint {name!r}: there is no value {key!r}: choose from {', '.join(VALUES)}.")
        if value is None:
            continue
        if key in SCALARS:
            setattr(spec, key, value)
        else:
            keep.append(checked(np.atleast_1d(numbers(value, key)), (size[ARRAYS[key]],), f"joint {name!r}: {key}"))
            setattr(spec, key, address(keep[-1]))
    if built:
        keep.append((abi.JointSpec * len(built))(*built))
        spec.parts, spec.parts_count = addressof(keep[-1]), len(built)
    return spec, keep


def _geometry(type: Any, placement: Any, axis: Any, axis2: Any, pitch: float | None, what: str) -> Any:
    spec = abi.initialized(abi.JointSpec)
    spec.type = member(JointType, type, f"{what}: type")
    if placement is not None:
        spec.placement[:] = twelve(placement, f"{what}: placement").tolist()
    if axis is not None:
        spec.axis[:] = checked(axis, (3,), f"{what}: axis").tolist()
    if axis2 is not None:
        spec.axis2[:] = checked(axis2, (3,), f"{what}: axis2").tolist()
    if pitch is not None:
        spec.pitch = pitch
    return spec


def _part(part: Mapping[str, Any], what: str) -> Any:
    unknown = set(part) - set(_PART_KEYS)
    if unknown or "type" not in part:
        wrong = f"unknown {sorted(unknown)}" if unknown else "no type"
        raise ArgumentError(f"{what}: {wrong}; the keys are {', '.join(_PART_KEYS)}.")
    return _geometry(*[part.get(key) for key in _PART_KEYS], what)
