"""The functions of libdyn.spatial on arrays.

Sources: Murray, Li, Sastry 1994, 2.3; Barfoot 2017, 7.1. Coefficients whose closed forms cancel at small angles are series there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ArgumentError, SizeError

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


def _sign(side: str) -> float:
    if side not in ("right", "left"):
        raise ArgumentError(f"side is {side!r}, but must be 'right' or 'left'.")
    return 1.0 if side == "right" else -1.0


def _series(x: Numbers, first: float, ratio: Callable[[int], float], degree: int) -> Numbers:
    """Sum over k of (-x)^k c_k with c_0 = first and c_(k+1) / c_k = ratio(k)."""
    c = [first]
    for k in range(degree):
        c.append(-c[-1] * ratio(k))
    out = np.full_like(x, c[-1])
    for value in reversed(c[:-1]):
        out = out * x + value
    return out


def _sinc(h: Numbers) -> Numbers:
    """sin h / h."""
    safe = np.where(h == 0, 1.0, h)
    return np.where(h == 0, 1.0, np.sin(safe) / safe)


def _coefficients(w: Numbers) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """t^2, sin t / t, (1 - cos t) / t^2, (t - sin t) / t^3 of t = |w|, each (..., 1)."""
    t2 = np.sum(w * w, axis=-1, keepdims=True)
    h = np.sqrt(t2) * 0.5
    sinc = _sinc(h)
    a = sinc * np.cos(h)
    small = np.minimum(t2, 1.0)
    series = _series(small, 1 / 6, lambda k: 1 / ((2 * k + 4) * (2 * k + 5)), 9)
    c = np.where(t2 < 1, series, (1 - a) / np.where(t2 < 1, 1.0, t2))
    return t2, a, sinc * sinc * 0.5, c


def _log_coefficient(t2: Numbers) -> Numbers:
    """(1 - h cot h) / t^2 with h = t / 2."""
    small = np.minimum(t2, 1.0) * 0.25
    series = _series(small, 1 / 3, lambda k: 1 / ((2 * k + 2) * (2 * k + 5)), 7) / (4 * _sinc(np.sqrt(small)))
    large = np.where(t2 < 1, 1.0, t2)
    h = np.sqrt(large) * 0.5
    return np.where(t2 < 1, series, (1 - h / np.tan(h)) / large)


def skew(v: ArrayLike) -> Numbers:
    """[v]x, (..., 3, 3): skew(v) @ x is v x x."""
    x, y, z = np.moveaxis(rows(v, 3, "v"), -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)


def quaternion_to_matrix(quaternion: ArrayLike) -> Numbers:
    """The rotation of a quaternion (x, y, z, w) of any norm but zero."""
    q = rows(quaternion, 4, "quaternion")
    n = np.linalg.norm(q, axis=-1, keepdims=True)
    if not np.all(n > 0):
        raise ArgumentError("quaternion is zero or not a number, which is no rotation.")
    x, y, z, w = np.moveaxis(q / n, -1, 0)
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1),
    ], -2)  # fmt: skip


def matrix_to_quaternion(R: ArrayLike) -> Numbers:
    """The quaternion (x, y, z, w) of a rotation, w >= 0."""
    m = matrices(R, 3, "R")
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    x, y, z = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    xy, xz, yz = m[..., 1, 0] + m[..., 0, 1], m[..., 2, 0] + m[..., 0, 2], m[..., 2, 1] + m[..., 1, 2]
    candidates = np.stack([
        np.stack([1 + xx - yy - zz, xy, xz, x], -1), np.stack([xy, 1 + yy - zz - xx, yz, y], -1),
        np.stack([xz, yz, 1 + zz - xx - yy, z], -1), np.stack([x, y, z, 1 + xx + yy + zz], -1),
    ], -2)  # fmt: skip
    largest = np.argmax(np.diagonal(candidates, axis1=-2, axis2=-1), axis=-1)  # Shepperd 1978
    q = np.take_along_axis(candidates, largest[..., None, None], -2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    out: Numbers = np.where(q[..., 3:] < 0, -q, q)
    return out


def rpy_to_matrix(rpy: ArrayLike) -> Numbers:
    """The rotation of roll, pitch and yaw about fixed axes, Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
    angles = rows(rpy, 3, "rpy")
    (cr, cp, cy), (sr, sp, sy) = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    return np.stack([
        np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], -1),
        np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], -1),
        np.stack([-sp, cp * sr, cp * cr], -1),
    ], -2)  # fmt: skip


def matrix_to_rpy(R: ArrayLike) -> Numbers:
    """Roll, pitch and yaw, pitch in [-pi/2, pi/2]; at its ends roll is 0."""
    m = matrices(R, 3, "R")
    level = np.hypot(m[..., 0, 0], m[..., 1, 0])
    pitch = np.arctan2(-m[..., 2, 0], level)
    locked = level < 1e-12
    roll = np.where(locked, 0.0, np.arctan2(m[..., 2, 1], m[..., 2, 2]))
    yaw = np.where(locked, np.arctan2(-m[..., 0, 1], m[..., 1, 1]), np.arctan2(m[..., 1, 0], m[..., 0, 0]))
    return np.stack([roll, pitch, yaw], -1)


def exp3(w: ArrayLike) -> Numbers:
    """The rotation by |w| about w."""
    w = rows(w, 3, "w")
    h = np.linalg.norm(w, axis=-1, keepdims=True) * 0.5
    return quaternion_to_matrix(np.concatenate([w * (0.5 * _sinc(h)), np.cos(h)], -1))


def log3(R: ArrayLike) -> Numbers:
    """The rotation vector of a rotation, of norm 0 to pi."""
    q = matrix_to_quaternion(R)
    v, w = q[..., :3], q[..., 3:]
    n = np.linalg.norm(v, axis=-1, keepdims=True)
    tiny = n < 1e-9 * w
    factor = np.where(tiny, 2 / np.where(tiny, w, 1.0), 2 * np.arctan2(n, w) / np.where(tiny, 1.0, n))
    return v * factor


def _times(c: Numbers) -> Numbers:
    return c[..., None]  # (..., 1) to (..., 1, 1)


def Jexp3(w: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of exp3, (..., 3, 3)."""
    w = _sign(side) * rows(w, 3, "w")
    _, _, b, c = _coefficients(w)
    W = skew(w)
    return np.eye(3) - _times(b) * W + _times(c) * (W @ W)


def _inverse_Jexp3(w: Numbers) -> Numbers:
    W = skew(w)
    return np.eye(3) + 0.5 * W + _times(_log_coefficient(np.sum(w * w, axis=-1, keepdims=True))) * (W @ W)


def Jlog3(R: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of log3 at a rotation, (..., 3, 3): the inverse of Jexp3(log3(R))."""
    return _inverse_Jexp3(_sign(side) * log3(R))


def exp6_pair(twist: ArrayLike) -> tuple[Numbers, Numbers]:
    """(R, p) of exp6."""
    m = rows(twist, 6, "twist")
    v, w = m[..., :3], m[..., 3:]
    _, _, b, c = _coefficients(w)
    wv = np.cross(w, v)
    return exp3(w), v + wv * b + np.cross(w, wv) * c


def log6(placement: Any) -> Numbers:
    """The twist [linear; angular] whose exp6 is a placement (or (R, p)), (..., 6)."""
    R, p = matrices(placement[0], 3, "rotation"), rows(placement[1], 3, "translation")
    w = log3(R)
    wp = np.cross(w, p)
    k = _log_coefficient(np.sum(w * w, axis=-1, keepdims=True))
    return np.concatenate([p - wp * 0.5 + np.cross(w, wp) * k, w], -1)


def _block(v: Numbers, w: Numbers) -> Numbers:
    """The linear-angular block of the right Jacobian of exp6 (Barfoot 2017, 7.86, arguments negated)."""
    t2, a, b, c = _coefficients(w)
    small, large = np.minimum(t2, 4.0), np.where(t2 < 4, 4.0, t2)
    co = 1 - b * t2  # cos t
    d = np.where(t2 < 4, _series(small, 1 / 24, lambda k: 1 / ((2 * k + 5) * (2 * k + 6)), 14),
                 (t2 + 2 * co - 2) / (2 * large * large))
    f = np.where(t2 < 4, _series(small, 1 / 120, lambda k: (k + 2) / ((k + 1) * (2 * k + 6) * (2 * k + 7)), 14),
                 (2 - 3 * a + co) / (2 * large * large))
    W, P = skew(-w), skew(-v)
    WP, PW = W @ P, P @ W
    WPW = WP @ W
    return (0.5 * P + _times(c) * (WP + PW + WPW) + _times(d) * (W @ WP + PW @ W - 3 * WPW)
            + _times(f) * (WPW @ W + W @ WPW))


def _blocks(J: Numbers, Q: Numbers) -> Numbers:
    out = np.zeros((*J.shape[:-2], 6, 6))
    out[..., :3, :3] = out[..., 3:, 3:] = J
    out[..., :3, 3:] = Q
    return out


def Jexp6(twist: ArrayLike, side: Side = "right") -> Numbers:
    """Jacobian of exp6, (..., 6, 6)."""
    m = _sign(side) * rows(twist, 6, "twist")
    return _blocks(Jexp3(m[..., 3:]), _block(m[..., :3], m[..., 3:]))


def Jlog6(placement: Any, side: Side = "right") -> Numbers:
    """Jacobian of log6 at a placement, (..., 6, 6): the inverse of Jexp6(log6(placement))."""
    m = _sign(side) * log6(placement)
    J = _inverse_Jexp3(m[..., 3:])
    return _blocks(J, -J @ _block(m[..., :3], m[..., 3:]) @ J)


def interpolate(R0: ArrayLike, R1: ArrayLike, u: ArrayLike) -> Numbers:
    """R0 exp3(u log3(R0^T R1)): the shorter way from R0 (u = 0) to R1 (u = 1), at constant speed. u: (...)."""
    R = matrices(R0, 3, "R0")
    w = log3(np.swapaxes(R, -1, -2) @ matrices(R1, 3, "R1"))
    return R @ exp3(np.asarray(u, np.float64)[..., None] * w)
