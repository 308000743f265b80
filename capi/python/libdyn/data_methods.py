"""A method of Data for each of the library's algorithms that works on data.

A method is written out, as dataclasses write theirs. Arguments become addresses; the library fills a buffer, and its copy is
returned.
"""

from __future__ import annotations

import linecache
from math import prod
from typing import Any, Callable

import numpy as np

from . import abi
from .arrays import checked, to_placement, to_placements
from .choices import reference
from .guard import nested
from .handles import DataHandle
from .interface import FUNCTIONS, INTERFACE
from .library import fail, lib
from .messages import in_python
from .results import RESULTS, memory_address, turned
from .tables import ALGORITHMS, FIELDS, AlgorithmInfo

ADDRESSES = {
    "model": "self._m", "data": "self._d", "q": "self._q(q)", "v": "self._v(v)", "a": "self._a(a)", "tau": "self._tau(tau)",
    "fext": "self._fext(fext)", "lambda": "_vector(self, lam)", "frame": "self.model._frame(frame)",
    "joint": "self.model._joint(joint)", "reference": "_reference(reference)",
}  # fmt: skip
"""Argument of each parameter in C."""
PARAMETERS = {"frame": "frame", "joint": "joint", "lambda": "lam", "reference": "reference='local'"}
PARAMETERS.update((name, f"{name}=None") for name in ("q", "v", "a", "tau", "fext"))
"""Each parameter in Python; those without a default come first."""
FIRST_ALONE = {"com", "centroidal_map"}
"""Algorithms that return their first output alone; the others are fields."""


LARGE = 1 << 16
"""Numbers of an output beyond which no buffer is kept: the library then fills what is returned."""


def method_name(algorithm: str) -> str:
    """compute_com where com is a field."""
    return f"compute_{algorithm}" if algorithm in FIELDS else algorithm


def parameters(algorithm: AlgorithmInfo) -> tuple[list[str], int] | None:
    """Names of the inputs in C, the data's among them, and how many outputs follow; None: it is no call on data."""
    function = FUNCTIONS.get(f"dyn_{algorithm.name}")
    if function is None:
        return None
    together = gathered(function)
    outputs = [p for p in function["parameters"] if p["type"] == "double*" or (p["type"] == "double" and "length" in p)]
    names = [p["name"] for p in function["parameters"] if p not in outputs][: -1 if together else None]
    outputs = outputs or together
    return ((names, len(outputs)) if names[:2] == ["model", "data"] and len(outputs) == len(algorithm.outputs)
            and ADDRESSES.keys() >= set(names) else None)


def gathered(function: dict[str, Any]) -> list[dict[str, Any]]:
    """The pointers in `out`, where outputs stand in a structure."""
    last = function["parameters"][-1]
    if last["name"] != "out" or not last["type"].startswith("const dyn"):
        return []
    fields = next(s["fields"] for s in INTERFACE["structs"] if f"const {s['name']}*" == last["type"])[1:]
    return fields if all(field["type"] == "double*" for field in fields) else []


def signature(names: list[str]) -> list[str]:
    return sorted((PARAMETERS[name] for name in names[2:]), key=lambda p: ("=" in p, p.startswith("reference")))


def _vector(data: DataHandle, lam: Any) -> int:
    data._kept = checked(lam, (data.model.nv,), "lam")
    return memory_address(data._kept)


def _outputs(data: DataHandle, algorithm: str) -> list[tuple[Callable[..., Any], int | None]]:
    """For each output of an algorithm: a function that returns it (given the order "F"), and the address that the library
    fills."""
    info, made = ALGORITHMS[algorithm], []
    shapes = info.shapes(data.model)
    small = max(map(prod, shapes)) <= LARGE
    for name, n, shape in zip(info.outputs, info.dimensions, shapes):
        memory = np.empty(shape)
        array = turned(name, memory) if n > 1 and not info.of_placements else memory
        copy: Callable[..., Any] = array.copy if small else lambda _, array=array: array
        made += [(array.item if n == 0 else copy, memory_address(memory))]
    if algorithm in FIRST_ALONE:
        made[1:] = [(made[0][0], None)] * len(made[1:])
    if small:
        data._outputs[algorithm] = made
    return made


def _method(algorithm: AlgorithmInfo, names: list[str], outputs: int) -> Callable[..., Any]:
    addresses = [f"p{k}" for k in range(outputs)]
    function, together = FUNCTIONS[f"dyn_{algorithm.name}"], None
    if gathered(function):
        together = abi.outputs_of(getattr(abi, function["parameters"][-1]["type"].removeprefix("const dyn").removesuffix("*")))
        addresses = [f"_together({', '.join(addresses)})"]
    arguments = [ADDRESSES[name] for name in names] + addresses
    values = [f"t{k}('F')" if n else f"t{k}()" for k, n in enumerate(algorithm.dimensions)]
    value = values[0] if outputs == 1 or algorithm.name in FIRST_ALONE else f"_Result({', '.join(values)})"
    if algorithm.of_placements:
        value = f"{'_placement' if algorithm.dimensions[0] == 1 else '_placements'}(t0('C'))"
    name = method_name(algorithm.name)
    lines = [
        f"def {name}({', '.join(['self', *signature(names)])}):",
        "    free = self._free",
        "    try:",
        "        free.pop()",
        "    except IndexError:",
        "        free = _nested(self)",
        "    try:",
        f"        {', '.join(f'(t{k}, p{k})' for k in range(outputs))}, = self._outputs.get({algorithm.name!r}) or _outputs(self, "
        f"{algorithm.name!r})",
        f"        status = _call({', '.join(arguments)})",
        "        if status:",
        "            _fail(status)",
        f"        return {value}",
        "    finally:",
        "        free.append(0)",
    ]
    source, file = "\n".join(lines) + "\n", f"<libdyn.Data.{name}>"
    linecache.cache[file] = len(source), None, source.splitlines(True), file  # for tracebacks
    known: dict[str, Any] = {
        "_call": getattr(lib, f"dyn_{algorithm.name}"), "_outputs": _outputs, "_fail": fail,
        "_Result": RESULTS.get(algorithm.name), "_vector": _vector, "_reference": reference, "_placement": to_placement,
        "_placements": to_placements, "_together": together, "_nested": nested,
    }  # fmt: skip
    exec(compile(source, file, "exec"), known)
    method = known[name]
    method.__module__, method.__qualname__ = __name__, f"Data.{name}"
    method.__doc__ = description(algorithm)
    return method


def description(algorithm: AlgorithmInfo) -> str:
    """Outputs of an algorithm, and the library's comment."""
    first = algorithm.outputs[:1] if algorithm.name in FIRST_ALONE else algorithm.outputs
    return f"Returns {', '.join(first)}. {in_python(FUNCTIONS['dyn_' + algorithm.name]['doc'])}"


class Algorithms(DataHandle):
    """The part of Data that has the algorithms."""


for _algorithm in ALGORITHMS.values():
    _found = parameters(_algorithm)
    if _found:
        setattr(Algorithms, method_name(_algorithm.name), _method(_algorithm, *_found))
