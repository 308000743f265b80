"""JAX: functions of a model under jit, vmap, jvp and grad (package jax, in double precision).

    jax.config.update("jax_enable_x64", True)
    from libdyn.doors import jax as door
    aba = door.function(model, "aba")                        # (q, v, tau) -> ddq
    jax.jit(jax.vmap(jax.grad(lambda q, v, tau: aba(q, v, tau) @ w)))(q, v, tau)

Arrays may have axes in front; vmap adds one. All states of a call go to libdyn's batch at once, which takes them on its threads.
By a C++ compiler calls go through JAX's foreign function interface; without one they are callbacks into Python. Derivatives are
exact, of first order.
"""

from __future__ import annotations

import ctypes
import itertools
import shutil
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import jax  # type: ignore[import-not-found, unused-ignore]
import jax.numpy as jnp  # type: ignore[import-not-found, unused-ignore]
import numpy as np

from ..batch import processors
from ..enums import Algorithm
from ..errors import ArgumentError
from .compiled import compiler, shared_library
from .function import PARTS, Function
from .tangent import tangent_map_inverse_product

if TYPE_CHECKING:
    from ..model import Model

_kept: list[Any] = []  # functions: programs that JAX compiled hold addresses of their batches


@cache
def _registered() -> None:
    """Compiles and registers the handlers, once in a process."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "jax_ffi.cpp"
        shutil.copy(Path(__file__).with_name("native") / source.name, source)
        library = ctypes.CDLL(str(shared_library(source, "c++", "-std=c++17", "-w", f"-I{jax.ffi.include_dir()}")))
    _kept.append(library)
    for name in ("libdyn_run", "libdyn_step"):
        jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(getattr(library, name)), platform="cpu")


class _Calls:
    """Outputs, and derivatives on tangent spaces, by one call for all states."""

    def __init__(self, f: Function, threads: int | None):
        self.f = f
        _registered()
        if f.name == "step":
            options = f.data.step_options
            self.data = [f.model.data(PARTS["step"]) for _ in range(threads or processors())]
            for data in self.data:
                data.set_step_options(options.integrator, options.dt)
        _kept.append(self)

    def values(self, *x: Any) -> list[Any]:
        return self._call(self.f.name, [(o.size,) for o in self.f.outputs], x)

    def tangents(self, *x: Any) -> tuple[list[Any], list[list[Any]]]:
        f, nv = self.f, self.f.model.nv
        if f.name == "step":
            sizes = [(o.size,) for o in f.outputs] + [(k, 2 * nv) for k in (2 * nv, nv, f.model.nu) if k]
            q, v, *columns = self._call("step", sizes, x)
            A, *rest = (jnp.swapaxes(j, -1, -2) for j in columns)
            by = [A[..., :nv], A[..., nv:], *rest]
            return [q, v], [[j[..., rows, :] for j in by] for rows in (slice(nv), slice(nv, None))]
        if f.name == "frame_placement":
            J = self._call("frame_jacobian", [(nv, 6)], x)
        elif f.name == "aba":
            J = self._call("aba_derivatives", [(nv, nv)] * 3, x)
        else:
            J = [*self._call("rnea_derivatives", [(nv, nv)] * 2, x), *self._call("crba", [(nv, nv)], x[:1])]
        return self.values(*x), [[jnp.swapaxes(j, -1, -2) for j in J]]

    def _call(self, algorithm: str, sizes: list[tuple[int, ...]], x: tuple[Any, ...]) -> list[Any]:
        """sizes: of results for one state, as they lie in memory."""
        results = [jax.ShapeDtypeStruct((*x[0].shape[:-1], *size), np.float64) for size in sizes]
        if self.f.name == "step":
            attributes = {"model": np.int64(self.f.model._m), "data": np.array([d._d for d in self.data], np.int64)}
            return jax.ffi.ffi_call("libdyn_step", results, vmap_method="broadcast_all")(*x, **attributes)
        attributes = {"batch": self.f.batch._b, "algorithm": Algorithm[algorithm.upper()], "frame": self.f.frame}
        attributes = {name: np.int64(value) for name, value in attributes.items()}
        return jax.ffi.ffi_call("libdyn_run", results, vmap_method="broadcast_all")(*x, **attributes)


class _Callbacks:
    """The same through Python."""

    def __init__(self, f: Function):
        self.f = f

    def values(self, *x: Any) -> list[Any]:
        return self._call(lambda *x: list(self.f(*x)), [(o.size,) for o in self.f.outputs], x)

    def tangents(self, *x: Any) -> tuple[list[Any], list[list[Any]]]:
        def flat(*x: Any) -> list[np.ndarray]:
            y, J = self.f.tangents(*x)
            return [*y, *itertools.chain(*J)]

        inputs, outputs = self.f.inputs, self.f.outputs
        sizes = [(o.size,) for o in outputs] + [(o.tangent, i.tangent) for o in outputs for i in inputs]
        results = self._call(flat, sizes, x)
        J = results[len(outputs) :]
        return results[: len(outputs)], [J[k : k + len(inputs)] for k in range(0, len(J), len(inputs))]

    def _call(self, python: Callable[..., Any], sizes: list[tuple[int, ...]], x: tuple[Any, ...]) -> list[Any]:
        results = [jax.ShapeDtypeStruct((*x[0].shape[:-1], *size), np.float64) for size in sizes]
        return jax.pure_callback(lambda *x: python(*map(np.asarray, x)), results, *x, vmap_method="broadcast_all")


def function(model: Model, name: str, *, method: Literal["auto", "compiled", "callback"] = "auto", threads: int | None = None,
             **options: Any) -> Callable[..., Any]:
    """A function of a model on JAX's arrays. It returns an array, or a tuple where there are several outputs.

    method   "compiled": by the foreign function interface; "callback": into Python; "auto": the first, where a compiler is
    threads  of a call; None: as many as this process has processors
    options  frame, dt, integrator: see libdyn.doors.function
    """
    if method not in ("auto", "compiled", "callback"):
        raise ArgumentError(f"method is {method!r}, but must be 'auto', 'compiled' or 'callback'.")
    if not jax.config.jax_enable_x64:
        raise ArgumentError('libdyn computes with doubles: call jax.config.update("jax_enable_x64", True) first.')
    f = Function(model, name, threads=threads, **options)
    compiled = method == "compiled" or (method == "auto" and compiler("c++") is not None)
    calls = _Calls(f, threads) if compiled else _Callbacks(f)

    @jax.custom_jvp
    def outputs(*x: Any) -> tuple[Any, ...]:
        return tuple(calls.values(*x))

    @outputs.defjvp
    def _derivative(x: Any, dx: Any) -> Any:
        y, J = calls.tangents(*x)
        dx = [tangent_map_inverse_product(model, x[0], dx[0], jnp), *dx[1:]]
        moved = [sum(jnp.einsum("...ij,...j->...i", j, d) for j, d in zip(by, dx)) for by in J]
        return tuple(y), tuple(f.lift(o, y[o], dy, jnp) for o, dy in enumerate(moved))

    def call(*x: Any) -> Any:
        x = tuple(jnp.asarray(a, jnp.float64) for a in x)
        f.check([a.shape for a in x])
        y = outputs(*x)
        return y if len(y) > 1 else y[0]

    call.__name__, call.__doc__ = name, repr(f)
    return call
