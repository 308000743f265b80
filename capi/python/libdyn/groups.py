"""The functions of libdyn.spatial: dyn_so3_... and dyn_se3_... of dyn.h, over arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from typing import Literal

    Numbers = NDArray[np.float64]
    Side = Literal["right", "left"]


def rows(x: ArrayLike, size: int, name: str) -> Numbers:
    """x as float64, (..., size)."""
    a = np.asarray(x, np.float64)
    if a.ndim < 1 or a.shape[-1] != size:
        raise SizeError(f"{name} has shape {a.shape}, but must have shape (..., {size}).")
    return a


def matrices(x: ArrayLike, size: int, name: str) -> Numbers:
    """x as float64, (..., size, size)."""
    a = np.asarray(x, np.float64)
    if a.ndim < 2 or a.shape[-2:] != (size, size):
        raise SizeError(f"{name} has shape {a.shape}, but must have shape (..., {size}, {size}).")
    return a


def _columns(R: ArrayLike, name: str = "R") -> Numbers:
    """(..., 9): column by column, as dyn.h has rotations."""
    a = matrices(R, 3, name)
    return np.swapaxes(a, -1, -2).reshape(*a.shape[:-2], 9)


def _square(x: Numbers, size: int) -> Numbers:
    """The matrices of (..., size * size), without a copy."""
    return np.swapaxes(x.reshape(*x.shape[:-1], size, size), -1, -2)


def _placements(placement: Any) -> Numbers:
    """(..., 12), as dyn.h has them, of a Placement or (R, p)."""
    R, p = _columns(placement[0], "rotation"), rows(placement[1], 3, "translation")
    lead = np.broadcast_shapes(R.shape[:-1], p.shape[:-1])
    return np.concatenate([np.broadcast_to(R, (*lead, 9)), np.broadcast_to(p, (*lead, 3))], -1)


def pair(x: Numbers) -> tuple[Numbers, Numbers]:
    """(R, p) of (..., 12), without a copy."""
    return _square(x[..., :9], 3), x[..., 9:]


def _each(function: Any, size: int, *inputs: Numbers, options: tuple[int, ...] = ()) -> Numbers:
    """(..., size): a function of dyn.h on every element of arrays whose last axis is an element's numbers."""
    lead = np.broadcast_shapes(*(x.shape[:-1] for x in inputs))
    arrays = [np.ascontiguousarray(np.broadcast_to(x, (*lead, x.shape[-1]))) for x in inputs]
    out = np.empty((*lead, size))
    check(function(math.prod(lead), *(x.ctypes.data for x in arrays), *options, out.ctypes.data))
    return out


def _left(side: str) -> tuple[int]:
    if side not in ("right", "left"):
        raise ArgumentError(f"side is {side!r}, but must be 'right' or 'left'.")
    return (int(side == "left"),)


def skew(v: ArrayLike) -> Numbers:
    """[v]x, (..., 3, 3): skew(v) @ x is v x x."""
    x, y, z = np.moveaxis(rows(v, 3, "v"), -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)


def quaternion_to_matrix(quaternion: ArrayLike) -> Numbers:
    """The rotation of a quaternion (x, y, z, w) of any norm but zero."""
    return _square(_each(lib.dyn_so3_from_quaternion, 9, rows(quaternion, 4, "quaternion")), 3)


def matrix_to_quaternion(R: ArrayLike) -> Numbers:
    """The quaternion (x, y, z, w) of a rotation, w >= 0."""
    return _each(lib.dyn_so3_to_quaternion, 4, _columns(R))


def rpy_to_matrix(rpy: ArrayLike) -> Numbers:
    """The rotation of roll, pitch and yaw about fixed axes, Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
    return _square(_each(lib.dyn_so3_from_rpy, 9, rows(rpy, 3, "rpy")), 3)


def matrix_to_rpy(R: ArrayLike) -> Numbers:
    """Roll, pitch and yaw, pitch in [-pi/2, pi/2]; at its ends roll is 0."""
    return _each(lib.dyn_so3_to_rpy, 3, _columns(R))


def exp3(w: ArrayLike) -> Numbers:
    """The rotation by |w| about w."""
    return _square(_each(lib.dyn_so3_exp, 9, rows(w, 3, "w")), 3)


def log3(R: ArrayLike) -> Numbers:
    """The rotation vector of a rotation, of norm 0 to pi."""
    return _each(lib.dyn_so3_log, 3, _columns(R))


def Jexp3(w: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of exp3, (..., 3, 3)."""
    return _square(_each(lib.dyn_so3_jexp, 9, rows(w, 3, "w"), options=_left(side)), 3)


def Jlog3(R: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of log3 at a rotation, (..., 3, 3): the inverse of Jexp3(log3(R))."""
    return _square(_each(lib.dyn_so3_jlog, 9, _columns(R), options=_left(side)), 3)


def interpolate(R0: ArrayLike, R1: ArrayLike, u: ArrayLike) -> Numbers:
    """R0 exp3(u log3(R0^T R1)): the shorter way from R0 (u = 0) to R1 (u = 1), at constant speed. u: (...)."""
    inputs = _columns(R0, "R0"), _columns(R1, "R1"), np.asarray(u, np.float64)[..., None]
    return _square(_each(lib.dyn_so3_interpolate, 9, *inputs), 3)


def exp6_pair(twist: ArrayLike) -> tuple[Numbers, Numbers]:
    """(R, p) of exp6."""
    return pair(_each(lib.dyn_se3_exp, 12, rows(twist, 6, "twist")))


def log6(placement: Any) -> Numbers:
    """The twist [linear; angular] whose exp6 is a placement (or (R, p)), (..., 6)."""
    return _each(lib.dyn_se3_log, 6, _placements(placement))


def Jexp6(twist: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of exp6, (..., 6, 6)."""
    return _square(_each(lib.dyn_se3_jexp, 36, rows(twist, 6, "twist"), options=_left(side)), 6)


def Jlog6(placement: Any, side: Side = "right") -> Numbers:
    """Jacobian of log6 at a placement, (..., 6, 6): the inverse of Jexp6(log6(placement))."""
    return _square(_each(lib.dyn_se3_jlog, 36, _placements(placement), options=_left(side)), 6)


def adjoint(placement: Any) -> Numbers:
    """(..., 6, 6): of motions in B those in A."""
    return _square(_each(lib.dyn_se3_adjoint, 36, _placements(placement)), 6)


def interpolated_pair(X0: Any, X1: Any, u: ArrayLike) -> tuple[Numbers, Numbers]:
    """(R, p) at u between two placements, at a constant velocity in the body's axes."""
    inputs = _placements(X0), _placements(X1), np.asarray(u, np.float64)[..., None]
    return pair(_each(lib.dyn_se3_interpolate, 12, *inputs))
