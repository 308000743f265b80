"""A method of Batch for each of the library's algorithms. What they look like is in batch_methods.pyi, written by `python -m libdyn.stubs`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from .algorithms import ALGORITHMS, OPTIONAL, Algorithm
from .errors import BusyError


def description(algorithm: Algorithm) -> str:
    of_the_model = {"integrate": "q (+) v of N states, (N, nq)", "difference": "q1 (-) q of N pairs, (N, nv)"}
    if algorithm.name in of_the_model:
        return f"{of_the_model[algorithm.name]}: Model.{algorithm.name} for each."
    if algorithm.name == "step":
        return "q and v of N states a step of dt seconds later, under tau."
    more = " b is lambda." if algorithm.name == "rnea_second_order_product" else ""
    return f"{', '.join(algorithm.outputs)} of N states: Data.{algorithm.name} for each.{more}"


def _method(algorithm: Algorithm) -> Callable[..., Any]:
    P = inspect.Parameter
    parameters = [P(name, P.POSITIONAL_OR_KEYWORD, default=None if name in OPTIONAL else P.empty) for name in algorithm.inputs]
    arguments = inspect.Signature(parameters)
    size, absent = len(parameters), (None,) * len(parameters)
    needed = sum(p.default is P.empty for p in parameters)

    def call(self, *given, only=None, out=None, status=None, **named):
        if not named and needed <= len(given) <= size:
            given += absent[len(given) :]
        else:
            bound = arguments.bind(*given, **named)
            bound.apply_defaults()
            given = bound.args
        if not self._lock.acquire(False):
            raise BusyError("another thread is using this batch: give each thread its own.")
        try:
            return self._compute(algorithm, given, only, out, status)
        finally:
            self._lock.release()

    keywords = [P(name, P.KEYWORD_ONLY, default=None) for name in ("only", "out", "status")]
    call.__name__, call.__qualname__ = algorithm.name, f"Batch.{algorithm.name}"
    call.__signature__ = inspect.Signature([P("self", P.POSITIONAL_ONLY), *parameters, *keywords])
    call.__doc__ = description(algorithm)
    return call


class Algorithms:
    """The part of Batch that has the algorithms."""


for _algorithm in ALGORITHMS.values():
    setattr(Algorithms, _algorithm.name, _method(_algorithm))
