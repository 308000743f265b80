"""What batches compute, as the library describes it."""

from __future__ import annotations

from ctypes import byref
from itertools import count
from typing import NamedTuple

from . import abi
from .library import lib

OPTIONAL = {"v", "a", "tau", "fext", "reference", "integrator"}
"""Inputs that need not be given."""


class Algorithm(NamedTuple):
    """What a batch computes, as the library describes it."""

    id: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dimensions: tuple[int, ...]
    """Of each output of one state: 0 a number, 1 a vector, 2 a matrix, 3 a tensor."""


def _algorithms() -> dict[str, Algorithm]:
    rows, info = {}, abi.AlgorithmInfo()
    for id in count():
        if lib.dyn_algorithm_info(None, id, byref(info)):
            return rows
        inputs = sorted(info.inputs.decode().split(), key=lambda name: (name in OPTIONAL, name in ("reference", "integrator")))
        outputs = [info.output[k].decode() for k in range(info.outputs)]
        dimensions = [
            3 if info.pages[k] != 1 else 2 if info.cols[k] != 1 else int(info.rows[k] != 1) for k in range(info.outputs)
        ]
        rows[info.name.decode()] = Algorithm(id, info.name.decode(), tuple(inputs), tuple(outputs), tuple(dimensions))


ALGORITHMS: dict[str, Algorithm] = _algorithms()
"""Every algorithm of the loaded library, by name."""
