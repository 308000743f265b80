"""The library's description of its interface: enumerations, structures and functions of dyn.h, each with its comment."""

from __future__ import annotations

import json
from ctypes import c_char_p
from typing import Any

from .native import lib

lib.dyn_interface_json.restype = c_char_p
INTERFACE: dict[str, Any] = json.loads(lib.dyn_interface_json())
"""{"enums", "structs", "functions", ...}: see dyn_interface_json in dyn.h."""

FUNCTIONS: dict[str, dict[str, Any]] = {function["name"]: function for function in INTERFACE["functions"]}
"""Every function: its parameters, what it returns, and its comment."""


def public_name(enum: dict[str, Any]) -> str:
    """Name of an enumeration in Python: of dynJointType JointType, of the bits DYN_PART_... Part."""
    return enum["prefix"][4:-1].title().replace("_", "") if enum["bits"] else enum["name"][3:]
