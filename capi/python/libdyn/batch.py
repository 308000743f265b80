"""Every algorithm over arrays of states, and simulations of many: Batch, rollout."""

from __future__ import annotations

import os
import threading
from ctypes import addressof, byref, c_double, c_void_p
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import abi
from .arrays import F64, Owner, address, checked, numbers, of_placements, to_placements
from .batch_methods import Algorithms
from .choices import mask, member
from .enums import Effect, Integrator, Part, Reference
from .errors import ArgumentError, SizeError
from .library import check, fail, lib
from .results import RESULTS, memory_address, turned
from .rollout import CONTACT, Rollout, Rollouts
from .tables import ALGORITHMS, AlgorithmInfo

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .enums import EffectLike, PartLike
    from .model import Model

_run = lib.dyn_batch_run
_first = c_double.from_buffer
_empty = np.empty


def processors() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _count(q: Any) -> int:
    """Number of states."""
    try:
        return len(q)
    except TypeError:
        raise ArgumentError(f"q is {q!r}, but must be an array of shape (N, nq).") from None


def _columns(memory: Numbers) -> Numbers:
    """Matrices that lie in memory column after column, as (..., rows, cols). Its own inverse."""
    return memory.swapaxes(-1, -2)


def _turned(name: str, array: Numbers) -> Numbers:
    """An output as it lies in memory, as it is returned. Its own inverse."""
    return turned(name, array) if array.ndim > 2 else array


class _Plan:
    """An algorithm for one model: the shapes of inputs (None: an index or an option) and outputs, as they lie in memory."""

    def __init__(self, model: Model, algorithm: AlgorithmInfo):
        nv = (model.nv,)
        rows = {"q": (model.nq,), "q1": (model.nq,), "v": nv, "a": nv, "tau": nv, "b": nv, "fext": (model.njoints, 6)}
        self.id = algorithm.id
        self._inputs = [(name, rows.get(name)) for name in algorithm.inputs]
        self.first = next(k for k, (_, row) in enumerate(self._inputs) if row)  # q, mostly: it says how many states there are
        self._outputs = [(k, name, shape) for k, (name, shape) in enumerate(zip(algorithm.outputs, algorithm.shapes(model)))]
        self.matrix = algorithm.dimensions[0] == 2
        self.type = RESULTS.get(algorithm.name)
        self.placements = algorithm.of_placements
        # one output, no tensor, and no input that is not a row or must not be absent
        rows_or_zeros = {"q", "v", "a", "tau", "fext"} >= set(algorithm.inputs)
        self.simple = algorithm.dimensions in ((0,), (1,), (2,)) and rows_or_zeros and not self.placements
        self.of(1)

    def of(self, n: int) -> None:
        """The shapes for n states."""
        self.n = n
        self.inputs = [(name, row and (n, *row)) for name, row in self._inputs]
        self.outputs = [(k, name, (n, *row)) for k, name, row in self._outputs]
        # what _quick takes: fext lies otherwise in memory
        self.quick = [(name, None if name == "fext" else shape) for name, shape in self.inputs] if self.simple else None


class Batch(Algorithms, Rollouts):
    """Every algorithm over N states with several threads: arrays in, arrays out. From Model.batch().

        batch = model.batch(threads=4)
        tau = batch.rnea(q, v, a)        # (N, nq), (N, nv), (N, nv) -> (N, nv)

    Methods are those of Data with an axis N in front; q is always given; v, a, tau, fext that are not given are zeros. Several
    outputs come as a named tuple. The bits of row k depend on row k alone: not on N, threads or other rows. Each also takes

        only    the name of one output, which is then computed and returned alone
        out     an array (or a tuple of them) that the method returned before, to be filled and returned again: memory for large
                results costs more than they do
        status  an int32 array (N,), filled with the dyn.Status of every state: those that fail raise nothing, and their rows are
                NaN. Without it the first state that fails raises, named in the message.
        mocap   (N, nmocaps, 12), or (nmocaps, 12) for all: placements of mocap bodies; None: the initial ones
        exact   True: the bits of Data. By default small models take several states side by side, which rounds otherwise (1e-14)

    Arrays that are float64 and contiguous are read in place. A batch belongs to one thread at a time.
    """

    def __init__(self, model: Model, threads: int | None = None, parts: PartLike = Part.ALL):
        self.model = model
        """The robot."""
        if threads is None:
            threads = processors()
        if not isinstance(threads, int) or abs(threads) >= 2**31:
            raise ArgumentError(f"threads is {threads!r}, but must be a number of threads.")
        handle = c_void_p()
        check(lib.dyn_batch_new(model._m, mask(Part, parts, "parts"), threads, byref(handle)))
        self._b = handle.value
        self._owner = Owner(self._b, lib.dyn_batch_free, model._owner)
        self.threads = threads
        """The caller's included."""
        self._lock = threading.Lock()
        self._arrays = abi.initialized(abi.BatchArrays)
        self._exact = False
        self._arrays_ref = byref(self._arrays)
        self._out = self._arrays.out
        self._plans: dict[int, _Plan] = {}

    def __repr__(self) -> str:
        return f"<dyn.Batch of {self.model.name!r}: {self.threads} threads>"

    def set_effects(self, effects: EffectLike, joint: str | int = 0) -> None:
        """Data.set_effects of all threads."""
        check(lib.dyn_batch_set_effects(self._b, self.model._joint(joint), mask(Effect, effects, "effects")))

    def _input(self, name: str, shape: tuple[int, ...], x: Any) -> Numbers:
        """x, state after state in memory."""
        a = x if type(x) is np.ndarray and x.dtype == F64 else numbers(x, name)
        memory = _columns(a) if len(shape) == a.ndim == 3 else a
        if memory.shape != shape:
            expected = ", ".join(map(str, ("N" if name == "q" else shape[0], *shape[:0:-1])))
            raise SizeError(f"{name} has shape {a.shape}, but must have shape ({expected}) of model {self.model.name!r}.")
        return np.ascontiguousarray(memory)

    def _option(self, name: str, x: Any) -> None:
        if name == "reference":
            self._arrays.reference = Reference.LOCAL if x is None else member(Reference, x, name)
        elif name == "integrator":
            self._arrays.integrator = Integrator.SEMI_IMPLICIT_EULER if x is None else member(Integrator, x, name)
        elif name == "dt":
            self._arrays.dt = float(checked(x, (), "dt"))
        elif name == "frame":
            self._arrays.frame = self.model._frame(x)
        else:
            self._arrays.joint = self.model._joint(x)

    def _output(self, name: str, given: Any, shape: tuple[int, ...], turn: bool) -> Numbers:
        memory = _turned(name, given) if turn and isinstance(given, np.ndarray) and given.ndim == len(shape) else given
        if type(memory) is not np.ndarray or memory.dtype != F64 or memory.shape != shape or not memory.flags.carray:
            raise SizeError(f"out: {name} is not an array as this method returns it for {shape[0]} states.")
        return memory

    def _status(self, status: Any, n: int) -> int | None:
        if type(status) is not np.ndarray or status.dtype != np.int32 or status.shape != (n,) or not status.flags.carray:
            raise SizeError(f"status must be a contiguous array of int32, of shape ({n},).")
        status.fill(0)
        return address(status)

    def _mocap_rows(self, mocap: Any, q: Any) -> Numbers:
        x = numbers(mocap, "mocap")
        n, shape = len(q) if type(q) is np.ndarray and q.ndim else _count(q), (self.model.nmocaps, 12)
        if x.shape not in ((n, *shape), shape):
            raise SizeError(f"mocap has shape {x.shape}, but must have shape {(n, *shape)} or {shape} of model {self.model.name!r}.")
        return np.ascontiguousarray(np.broadcast_to(x, (n, *shape)))

    def _quick(self, plan: _Plan, given: tuple[Any, ...], out: Any) -> Numbers | None:
        """Sets the addresses of arrays that all lie in memory as the library reads them, with one output: what most calls are.

        Returns what is to be filled. None: they have to be looked at one by one.
        """
        arrays = self._arrays
        try:
            for (name, shape), x in zip(plan.quick, given):
                if x is None:
                    setattr(arrays, name, None)
                elif type(x) is np.ndarray and x.dtype is F64 and x.shape == shape:
                    setattr(arrays, name, addressof(_first(x)))
                else:
                    return None
            if out is None:
                memory = _empty(plan.outputs[0][2])
            else:
                memory = out if out.ndim < 3 else _columns(out)
                if type(memory) is not np.ndarray or memory.dtype is not F64 or memory.shape != plan.outputs[0][2]:
                    return None
            self._out[0] = addressof(_first(memory))
        except (TypeError, ValueError, AttributeError):  # not contiguous, read-only; out is no array
            return None
        arrays.status = None
        return memory

    def _compute(self, algorithm: AlgorithmInfo, given: tuple[Any, ...], only: str | None, out: Any, status: Any) -> Any:
        plan = self._plans.get(algorithm.id)
        if plan is None:
            plan = self._plans[algorithm.id] = _Plan(self.model, algorithm)
        x = given[plan.first]
        n = len(x) if type(x) is np.ndarray and x.ndim else _count(x)
        if n != plan.n:
            plan.of(n)
        if only is status is None and plan.quick:
            memory = self._quick(plan, given, out)
            if memory is not None:
                failed = _run(self._b, plan.id, n, self._arrays_ref)
                if failed:
                    fail(failed)
                return _columns(memory) if plan.matrix else memory

        arrays, keep = self._arrays, []
        for (name, shape), x in zip(plan.inputs, given):
            if shape is None:
                self._option(name, x)
            elif x is not None:
                if type(x) is not np.ndarray or x.dtype is not F64 or x.shape != shape or not x.flags.c_contiguous or name == "fext":
                    x = self._input(name, shape, x)
                    keep.append(x)
                setattr(arrays, name, memory_address(x))
            elif name in ("b", "q1"):
                raise ArgumentError(f"{name} is None, but is needed of every state.")
            else:
                setattr(arrays, name, None)

        outputs = plan.outputs
        if only is not None:
            outputs = [o for o in outputs if o[1] == only]
            if not outputs:
                raise ArgumentError(f"only is {only!r}, but must be one of {', '.join(algorithm.outputs)}.")
            self._out[:] = (None,) * 4
        if out is not None:
            if plan.placements:
                out = (of_placements(out),)
            elif not isinstance(out, tuple):
                out = (out,)
            if len(out) != len(outputs):
                raise SizeError(f"out has {len(out)} arrays, but this method fills {len(outputs)}.")
        results = []
        for k, name, shape in outputs:
            memory = np.empty(shape) if out is None else self._output(name, out[len(results)], shape, not plan.placements)
            self._out[k] = memory_address(memory)
            results.append(memory)
        if status is None:
            arrays.status = None
        else:
            arrays.status = self._status(status, n)
            for memory in results:
                memory.fill(np.nan)

        failed = _run(self._b, algorithm.id, n, self._arrays_ref)
        if failed and (status is None or not status.any()):
            fail(failed)
        if plan.placements:
            return to_placements(results[0])
        results = [_turned(name, memory) for (_, name, _), memory in zip(outputs, results)]
        return results[0] if len(results) == 1 else plan.type(*results)


def rollout(
    model: Model,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    *,
    effects: EffectLike | None = None,
    threads: int | None = None,
    engine: Literal["threads", "ray"] = "threads",
    **arguments: Any,
) -> Rollout:
    """Rollouts of a model: what Batch.rollout does, with its arguments.

    effects  as in Data.set_effects; None: those of new data
    threads  of this process; None: as many as it has processors
    engine   "threads": here. "ray": by the workers of Ray (package ray), with the arguments of dyn.cluster.rollout
    """
    if engine == "ray":
        from . import cluster

        return cluster.rollout(model, q0, v0, effects=effects, **arguments)
    if engine != "threads":
        raise ArgumentError(f"engine is {engine!r}, but must be 'threads' or 'ray'.")
    batch = model.batch(threads, Part.ALL)
    if effects is not None:
        batch.set_effects(effects)
    return batch.rollout(q0, v0, **arguments)


__all__ = ["ALGORITHMS", "CONTACT", "AlgorithmInfo", "Batch", "Rollout", "rollout"]
