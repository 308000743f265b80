"""Configurations: steps on the manifold, differences, random ones."""

from __future__ import annotations

import operator
import secrets
import threading
import weakref
from collections.abc import Mapping
from ctypes import byref, c_double, c_int
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import address, checked, numbers, result, slot
from .describe import Description
from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from .arrays import Numbers

_integrate, _difference, _interpolate = lib.dyn_integrate, lib.dyn_difference, lib.dyn_interpolate


class Scratch(threading.local):
    """Inputs and outputs of the configuration functions: a model is shared by threads, so each has its own."""

    q: Callable[[Any], int | None]
    q0: Callable[[Any], int | None]
    q1: Callable[[Any], int | None]
    lower: Callable[[Any], int | None]
    upper: Callable[[Any], int | None]
    v: Callable[[Any], int | None]
    nq: tuple[Numbers, int | None]
    nv: tuple[Numbers, int | None]

    def __init__(self, model: weakref.ref[Any], nq: int, nv: int):
        self.q, self.q0, self.q1 = (slot((nq,), name, model) for name in ("q", "q0", "q1"))
        self.lower, self.upper = slot((nq,), "lower", model), slot((nq,), "upper", model)
        self.v = slot((nv,), "v", model)
        self.nq, self.nv = result((nq,)), result((nv,))


class Configurations(Description):
    """The part of Model that moves on its configuration manifold."""

    def __init__(self, handle: int, buffer: Any = None):
        super().__init__(handle, buffer)
        self._scratch = Scratch(weakref.ref(self), self.nq, self.nv)

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Numbers:
        """q (+) v, (nq,): where q gets to with the constant velocity v in one second; pass v * dt."""
        s = self._scratch
        out, start = s.nq
        check(_integrate(self._m, s.q(q), s.v(v), start))
        return out.copy()

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Numbers:
        """q1 (-) q0, (nv,): the v with integrate(q0, v) = q1. Shortest rotation."""
        s = self._scratch
        out, start = s.nv
        check(_difference(self._m, s.q0(q0), s.q1(q1), start))
        return out.copy()

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, u: float) -> Numbers:
        """q0 (+) u (q1 (-) q0), (nq,)."""
        s = self._scratch
        out, start = s.nq
        check(_interpolate(self._m, s.q0(q0), s.q1(q1), u, start))
        return out.copy()

    def distance(self, q0: ArrayLike, q1: ArrayLike) -> float:
        """Norm of difference(q0, q1)."""
        s, out = self._scratch, c_double()
        check(lib.dyn_configuration_distance(self._m, s.q0(q0), s.q1(q1), byref(out)))
        return out.value

    def neutral(self) -> Numbers:
        """The neutral configuration, (nq,)."""
        out, start = self._scratch.nq
        check(lib.dyn_configuration_neutral(self._m, start))
        return out.copy()

    def random(self, seed: int | None = None, lower: ArrayLike | None = None, upper: ArrayLike | None = None) -> Numbers:
        """A random configuration, (nq,), uniform between lower and upper (default: the model's limits; what is infinite
        there is drawn from [-1, 1], angles from [-pi, pi]). The same seed gives the same q; None draws a seed."""
        seed = secrets.randbits(64) if seed is None else operator.index(seed)
        if not 0 <= seed < 1 << 64:
            raise ArgumentError(f"seed is {seed}, but must be from 0 to 2^64 - 1.")
        s = self._scratch
        out, start = s.nq
        check(lib.dyn_configuration_random(self._m, seed, s.lower(lower), s.upper(upper), start))
        return out.copy()

    def normalize(self, q: ArrayLike) -> Numbers:
        """A copy of q, (nq,), with unit quaternions and (cos, sin) pairs."""
        q = np.array(self._named(q, "q") if isinstance(q, Mapping) else checked(q, (self.nq,), "q"))
        check(lib.dyn_configuration_normalize(self._m, address(q)))
        return q

    def is_normalized(self, q: ArrayLike, tolerance: float = 1e-9) -> bool:
        """Returns whether every quaternion and (cos, sin) pair has norm 1 within tolerance."""
        out = c_int()
        check(lib.dyn_configuration_is_normalized(self._m, self._scratch.q(q), tolerance, byref(out)))
        return bool(out.value)

    def integrate_jacobians(self, q: ArrayLike, v: ArrayLike) -> tuple[Numbers, Numbers]:
        """(d/dq, d/dv) of integrate(q, v) on tangent spaces, (nv, nv) each."""
        s, dq, dv = self._scratch, np.empty((self.nv, self.nv), order="F"), np.empty((self.nv, self.nv), order="F")
        check(lib.dyn_integrate_jacobians(self._m, s.q(q), s.v(v), address(dq), address(dv)))
        return dq, dv

    def difference_jacobians(self, q0: ArrayLike, q1: ArrayLike) -> tuple[Numbers, Numbers]:
        """(d/dq0, d/dq1) of difference(q0, q1), (nv, nv) each."""
        s, d0, d1 = self._scratch, np.empty((self.nv, self.nv), order="F"), np.empty((self.nv, self.nv), order="F")
        check(lib.dyn_difference_jacobians(self._m, s.q0(q0), s.q1(q1), address(d0), address(d1)))
        return d0, d1

    def _named(self, values: Mapping[str, Any], what: str) -> Numbers:
        """A vector from {joint name: numbers}; what is not named is neutral or zero."""
        position = what not in ("v", "a", "tau")
        out = self.neutral() if position else np.zeros(self.nv)
        for name, value in values.items():
            info = self.joint(name)
            first, n = (info.idx_q, info.nq) if position else (info.idx_v, info.nv)
            if info.mimic_leader >= 0:
                leader = self.joint_name(info.mimic_leader)
                raise ArgumentError(f"{what}: joint {name!r} follows {leader!r} and has no numbers of its own: set {leader!r}.")
            given = np.atleast_1d(numbers(value, f"{what}[{name!r}]"))
            if given.shape != (n,):
                raise SizeError(f"{what}[{name!r}] has shape {given.shape}, but must have shape ({n},).")
            out[first : first + n] = given
        return out
