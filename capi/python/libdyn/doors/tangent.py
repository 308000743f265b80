"""The tangent map: derivatives by the numbers of q (quaternions, cosines) from those along velocities, and back.

dq = T(q) v is the rate of q at the velocity v. T is (nq, nv). Its left inverse T+ gives the velocity of a change dq. With
y = f(q), the derivative by the numbers of q is dy/dq = (df/dv) T+, where df/dv is along q (+) v, as libdyn has it. That is
exact for quaternions of any norm, because libdyn divides the norm out: T+ q = 0. Where q is an output, rows take T.

Arrays may have axes in front. xp is the namespace of the arrays: numpy, jax.numpy.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..enums import JointType
from ..errors import UnsupportedError
from ..model import Model


class Block(NamedTuple):
    """Coordinates side by side, of one kind."""

    kind: str
    """"euclidean", "circle" (cos, sin), "rotation" (a quaternion), "free" (position and quaternion)."""
    q: slice
    v: slice


_KINDS = {JointType.SPHERICAL: "rotation", JointType.FREE_FLYER: "free", JointType.REVOLUTE_UNBOUNDED: "circle"}


def blocks(model: Model) -> list[Block]:
    """The blocks of q. Euclidean ones are as long as they can be."""
    out: list[Block] = []
    for joint in sorted((j for j in model.joints if j.nv), key=lambda j: j.idx_v):
        kind = _KINDS.get(joint.type, "euclidean")
        if kind == "euclidean" and joint.nq != joint.nv:
            raise UnsupportedError(f"joint {joint.name!r} of model {model.name!r} is a composite with quaternions or cosines, of "
                                   "which there is no tangent map: use joints in a row.")
        q, v = slice(joint.idx_q, joint.idx_q + joint.nq), slice(joint.idx_v, joint.idx_v + joint.nv)
        if out and kind == out[-1].kind == "euclidean":
            q, v = slice(out[-1].q.start, q.stop), slice(out.pop().v.start, v.stop)
        out.append(Block(kind, q, v))
    return out


def _times(xp: Any, a: Any, b: Any) -> Any:
    """Vector part of the product of quaternions (x, y, z, w), and its scalar part."""
    aw, bw, a, b = a[..., 3:], b[..., 3:], a[..., :3], b[..., :3]
    return aw * b + bw * a + xp.cross(a, b), aw * bw - xp.sum(a * b, -1, keepdims=True)


def _rotated(xp: Any, quaternion: Any, x: Any) -> Any:
    """R x. The norm of the quaternion is divided out."""
    u, w = quaternion[..., :3], quaternion[..., 3:]
    t = 2 * xp.cross(u, x) / xp.sum(quaternion * quaternion, -1, keepdims=True)
    return x + w * t + xp.cross(u, t)


def _conjugate(xp: Any, x: Any) -> Any:
    return xp.concatenate([-x[..., :3], x[..., 3:]], -1)


def _rate(xp: Any, kind: str, q: Any, v: Any) -> Any:
    if kind == "circle":
        return xp.concatenate([-q[..., 1:] * v, q[..., :1] * v], -1)
    if kind == "rotation":
        vector, scalar = _times(xp, q, xp.concatenate([v, xp.zeros_like(v[..., :1])], -1))
        return xp.concatenate([vector, scalar], -1) / 2
    if kind == "free":
        return xp.concatenate([_rotated(xp, q[..., 3:], v[..., :3]), _rate(xp, "rotation", q[..., 3:], v[..., 3:])], -1)
    return v


def _velocity(xp: Any, kind: str, q: Any, dq: Any) -> Any:
    if kind == "circle":
        return (q[..., :1] * dq[..., 1:] - q[..., 1:] * dq[..., :1]) / xp.sum(q * q, -1, keepdims=True)
    if kind == "rotation":
        return 2 * _times(xp, _conjugate(xp, q), dq)[0] / xp.sum(q * q, -1, keepdims=True)
    if kind == "free":
        back = _rotated(xp, _conjugate(xp, q[..., 3:]), dq[..., :3])
        return xp.concatenate([back, _velocity(xp, "rotation", q[..., 3:], dq[..., 3:])], -1)
    return dq


def _by_blocks(model: Model, act: Any, q: Any, x: Any, of_q: bool, xp: Any) -> Any:
    """act on each block of q and of x, which has the numbers of q or those of v."""
    lead = np.broadcast_shapes(q.shape[:-1], x.shape[:-1])
    q, x = xp.broadcast_to(q, (*lead, model.nq)), xp.broadcast_to(x, (*lead, model.nq if of_q else model.nv))
    return xp.concatenate([act(xp, b.kind, q[..., b.q], x[..., b.q if of_q else b.v]) for b in blocks(model)], -1)


def tangent_map_product(model: Model, q: Any, v: Any, xp: Any = np) -> Any:
    """T(q) v, (..., nq): the rate of q at the velocity v."""
    return v if model.nq == model.nv else _by_blocks(model, _rate, q, v, False, xp)


def tangent_map_inverse_product(model: Model, q: Any, dq: Any, xp: Any = np) -> Any:
    """T+(q) dq, (..., nv): the velocity of a change dq of q."""
    return dq if model.nq == model.nv else _by_blocks(model, _velocity, q, dq, True, xp)


def tangent_map(model: Model, q: Any, xp: Any = np) -> Any:
    """T(q), (..., nq, nv)."""
    rows = xp.broadcast_to(xp.eye(model.nv), (*q.shape[:-1], model.nv, model.nv))
    return xp.swapaxes(tangent_map_product(model, q[..., None, :], rows, xp), -1, -2)


def tangent_map_inverse(model: Model, q: Any, xp: Any = np) -> Any:
    """T+(q), (..., nv, nq): T+ T is the identity."""
    rows = xp.broadcast_to(xp.eye(model.nq), (*q.shape[:-1], model.nq, model.nq))
    return xp.swapaxes(tangent_map_inverse_product(model, q[..., None, :], rows, xp), -1, -2)
