"""Outputs of algorithms: arrays turned from their layout in memory, and named tuples of several."""

from __future__ import annotations

import ctypes
from collections import namedtuple
from typing import Any

import numpy as np

from .tables import ALGORITHMS


def turned(name: str, array: np.ndarray) -> np.ndarray:
    """An output as it lies in memory, as it is returned; its last two axes are (column, row) in memory. Its own inverse."""
    if name == "H":
        return array.swapaxes(-1, -3)  # [:, :, k] is the k-th matrix
    return array.swapaxes(-1, -2)


# Named tuples of several outputs: RneaDerivatives(dtau_dq, dtau_dv), ...
RESULTS: dict[str, Any] = {}
"""The named tuple of each algorithm with several outputs, by the algorithm's name."""
for _a in ALGORITHMS.values():
    if len(_a.outputs) > 1:
        RESULTS[_a.name] = namedtuple(_a.name.title().replace("_", ""), _a.outputs, module=__name__)
        globals()[RESULTS[_a.name].__name__] = RESULTS[_a.name]

_first = ctypes.c_double.from_buffer


def memory_address(a: np.ndarray) -> int | None:
    """Address of a contiguous array. The first way takes a quarter of the time, but wants one that may be written."""
    try:
        return ctypes.addressof(_first(a))
    except (TypeError, ValueError):
        return a.ctypes.data
