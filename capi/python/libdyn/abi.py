"""dyn.h in ctypes: its structures and the signature of every function, made from the library's own description.

abi.JointInfo stands for dynJointInfo. Pointers to numbers, structures and handles are plain addresses.
"""

from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_int, c_void_p
from typing import Any

from .interface import FUNCTIONS, INTERFACE
from .native import lib

_TYPES: dict[str, Any] = {
    "void": None, "int": c_int, "double": ctypes.c_double, "size_t": ctypes.c_size_t, "ptrdiff_t": ctypes.c_ssize_t,
    "int32_t": ctypes.c_int32, "uint32_t": ctypes.c_uint32, "int64_t": ctypes.c_int64, "uint64_t": ctypes.c_uint64,
    "const char*": c_char_p, "const char* const*": POINTER(c_char_p),
}  # fmt: skip
_TYPES.update((enum["name"], c_int) for enum in INTERFACE["enums"])
_TYPES.update((alias["name"], _TYPES[alias["type"]]) for alias in INTERFACE["types"])
_TYPES.update((callback["name"], c_void_p) for callback in INTERFACE["callbacks"])


def _plain(name: str) -> Any:
    return _TYPES[name] if name in _TYPES or not name.endswith("*") else c_void_p


def _member(declared: dict[str, Any]) -> Any:
    """Type of a structure's field: a number, an address, an array, or a function."""
    if "returns" in declared:
        return _function(declared)
    found = _plain(declared["type"])
    for n in reversed(declared.get("length", ())):
        found = found * n
    return found


def _argument(declared: dict[str, Any]) -> Any:
    return c_void_p if "length" in declared or "returns" in declared else _plain(declared["type"])


def _function(declared: dict[str, Any]) -> Any:
    return CFUNCTYPE(_plain(declared["returns"]), *map(_argument, declared["parameters"]))


class Sized(Structure):
    """A structure that begins with its own size, so that it may grow."""

    def __init__(self, **values: Any):
        super().__init__(**values)
        self.struct_size = ctypes.sizeof(self)


def _structure(declared: dict[str, Any]) -> type[Structure]:
    fields = [(field["name"], _member(field)) for field in declared["fields"]]
    base = Sized if fields[0][0] == "struct_size" else Structure
    return type(declared["name"][3:], (base,), {"__module__": __name__, "__doc__": declared["doc"], "_fields_": fields})


for _declared in INTERFACE["structs"]:
    _TYPES[_declared["name"]] = globals()[_declared["name"][3:]] = _structure(_declared)
for _declared in INTERFACE["callbacks"]:
    globals()[_declared["name"][3:]] = _function(_declared)
for _name, _declared in FUNCTIONS.items():
    _found = getattr(lib, _name)
    _found.restype, _found.argtypes = _plain(_declared["returns"]), [_argument(p) for p in _declared["parameters"]]

_INITIALIZERS = {f["parameters"][0]["type"]: f for name, f in FUNCTIONS.items()
                 if name.endswith("_init") and f["returns"] == "void"}


def initialized(structure: Any, *arguments: Any) -> Any:
    """A structure with the library's defaults."""
    made, function = structure(), _INITIALIZERS[f"dyn{structure.__name__}*"]
    size = [ctypes.sizeof(made)] if [p["name"] for p in function["parameters"]][1:2] == ["struct_size"] else []
    getattr(lib, function["name"])(ctypes.byref(made), *size, *arguments)
    return made


def outputs_of(structure: Any) -> Any:
    """A function that puts addresses into a structure of pointers, in its order, and returns a reference to it."""
    names = [name for name, _ in structure._fields_[1:]]

    def outputs(*addresses: Any) -> Any:
        made = structure()
        for name, x in zip(names, addresses):
            setattr(made, name, x)
        return ctypes.byref(made)

    return outputs
