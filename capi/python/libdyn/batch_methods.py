"""A method of Batch for each of the library's algorithms."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from .arrays import address
from .errors import BusyError
from .messages import in_python
from .tables import ALGORITHMS, OPTIONAL, AlgorithmInfo


def description(algorithm: AlgorithmInfo) -> str:
    """Text of help() for a method."""
    return f"Returns {', '.join(algorithm.outputs)} of N states: {in_python('dyn_' + algorithm.name)} for each."


def _method(algorithm: AlgorithmInfo) -> Callable[..., Any]:
    P = inspect.Parameter
    parameters = [P(name, P.POSITIONAL_OR_KEYWORD, default=None if name in OPTIONAL else P.empty) for name in algorithm.inputs]
    arguments = inspect.Signature(parameters)
    size, absent = len(parameters), (None,) * len(parameters)
    needed = sum(p.default is P.empty for p in parameters)
    state = algorithm.inputs.index("q")

    def call(self, *given, only=None, out=None, status=None, exact=False, mocap=None, **named):
        if not named and needed <= len(given) <= size:
            given += absent[len(given) :]
        else:
            bound = arguments.bind(*given, **named)
            bound.apply_defaults()
            given = bound.args
        if not self._lock.acquire(False):
            raise BusyError("another thread is using this batch: give each thread its own.")
        try:
            if exact is not self._exact:
                self._exact = self._arrays.exact = bool(exact)
            if mocap is None:
                return self._compute(algorithm, given, only, out, status)
            placements = self._mocap_rows(mocap, given[state])
            self._arrays.mocap = address(placements)
            try:
                return self._compute(algorithm, given, only, out, status)
            finally:
                self._arrays.mocap = None
        finally:
            self._lock.release()

    keywords = [P(name, P.KEYWORD_ONLY, default=None) for name in ("only", "out", "status")]
    keywords += [P("exact", P.KEYWORD_ONLY, default=False), P("mocap", P.KEYWORD_ONLY, default=None)]
    call.__name__, call.__qualname__ = algorithm.name, f"Batch.{algorithm.name}"
    call.__signature__ = inspect.Signature([P("self", P.POSITIONAL_ONLY), *parameters, *keywords])
    call.__doc__ = description(algorithm)
    return call


class Algorithms:
    """The part of Batch that has the algorithms."""


for _algorithm in ALGORITHMS.values():
    setattr(Algorithms, _algorithm.name, _method(_algorithm))
