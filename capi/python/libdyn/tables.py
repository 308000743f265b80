"""Tables of the library: the quantities that data holds, and the algorithms."""

from __future__ import annotations

from ctypes import byref
from itertools import count
from typing import Any, NamedTuple

from . import abi
from .enums import Part
from .native import lib


class FieldInfo(NamedTuple):
    """A quantity that data holds, as the library describes it."""

    id: int
    name: str
    shape: str
    unit: str
    frame: str
    producer: str
    """The C function that computes it; "" for the state."""
    sentence: str
    part: Part


def _fields() -> dict[str, FieldInfo]:
    fields = {}
    for id in range(lib.dyn_field_count()):
        info = abi.FieldInfo()
        lib.dyn_field_info(id, byref(info))
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

OPTIONAL = {"v", "a", "tau", "fext", "reference", "integrator"}
"""Inputs of a batch that need not be given."""


class AlgorithmInfo(NamedTuple):
    """An algorithm, as the library describes it."""

    id: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    dimensions: tuple[int, ...]
    """Dimensions of each output of one state: 0 a number, 1 a vector, 2 a matrix, 3 a tensor."""

    @property
    def of_placements(self) -> bool:
        """Its output is one dyn.Placement, or many."""
        return self.outputs[0].startswith("placement")

    def shapes(self, model: Any) -> list[tuple[int, ...]]:
        """Shapes of its outputs for a model, as they lie in memory: the last index is the row."""
        info = abi.AlgorithmInfo()
        lib.dyn_algorithm_info(model._m, self.id, byref(info))
        sizes = [(info.pages[k], info.cols[k], info.rows[k]) for k in range(len(self.outputs))]
        return [size[3 - n :] for size, n in zip(sizes, self.dimensions)]


def _algorithms() -> dict[str, AlgorithmInfo]:
    rows, info = {}, abi.AlgorithmInfo()
    for id in count():
        if lib.dyn_algorithm_info(None, id, byref(info)):
            return rows
        inputs = sorted(info.inputs.decode().split(), key=lambda name: (name in OPTIONAL, name in ("reference", "integrator")))
        outputs = [info.output[k].decode() for k in range(info.outputs)]
        dimensions = [
            3 if info.pages[k] != 1 else 2 if info.cols[k] != 1 else int(info.rows[k] != 1) for k in range(info.outputs)
        ]
        rows[info.name.decode()] = AlgorithmInfo(id, info.name.decode(), tuple(inputs), tuple(outputs), tuple(dimensions))


ALGORITHMS: dict[str, AlgorithmInfo] = _algorithms()
"""Every algorithm of the loaded library, by name."""
