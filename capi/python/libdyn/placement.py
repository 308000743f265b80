"""Placements: the group SE(3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, NoReturn, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import groups
from .errors import SizeError

if TYPE_CHECKING:
    Numbers = NDArray[np.float64]

_NO_SUM = "placements have no sum, product or difference: A @ B composes them, A.inverse() inverts, A.translation + p moves."


class _Pair(NamedTuple):
    rotation: Numbers
    """(3, 3)"""
    translation: Numbers
    """(3,), m"""


class Placement(_Pair):
    """A pose X_AB: p_A = rotation @ p_B + translation. Of many frames: one more axis, in front.

        X_AC = X_AB @ X_BC                     # composes
        p_A = X_AB @ p_B                       # points, (..., 3)
        X_BA = X_AB.inverse()
        v_A = X_AB.act_motion(v_B)             # [linear; angular], (..., 6); of columns: X_AB.adjoint @ J
    """

    __slots__ = ()
    __array_ufunc__ = None  # numpy leaves operators to the methods below

    @classmethod
    def identity(cls) -> Placement:
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Placement:
        """Of homogeneous matrices, (..., 4, 4)."""
        m = groups.matrices(matrix, 4, "matrix")
        if not np.array_equal(m[..., 3, :], np.broadcast_to((0.0, 0.0, 0.0, 1.0), m[..., 3, :].shape)):
            raise SizeError("matrix: the last row of a placement must be 0 0 0 1.")
        return cls(m[..., :3, :3].copy(), m[..., :3, 3].copy())

    @classmethod
    def from_quaternion(cls, quaternion: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Placement:
        """Of quaternions (x, y, z, w) of any norm but zero."""
        return cls(groups.quaternion_to_matrix(quaternion), groups.rows(translation, 3, "translation"))

    @classmethod
    def from_rpy(cls, rpy: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Placement:
        """Of roll, pitch and yaw about fixed axes, as in URDF."""
        return cls(groups.rpy_to_matrix(rpy), groups.rows(translation, 3, "translation"))

    @classmethod
    def exp(cls, twist: ArrayLike) -> Placement:
        """exp6 of twists [linear; angular]."""
        return cls(*groups.exp6_pair(twist))

    @property
    def matrix(self) -> Numbers:
        """Homogeneous, (4, 4)."""
        out = np.zeros((*self.translation.shape[:-1], 4, 4))
        out[..., :3, :3] = self.rotation
        out[..., :3, 3] = self.translation
        out[..., 3, 3] = 1.0
        return out

    @property
    def quaternion(self) -> Numbers:
        """(x, y, z, w), w >= 0."""
        return groups.matrix_to_quaternion(self.rotation)

    @property
    def rpy(self) -> Numbers:
        """Roll, pitch and yaw about fixed axes."""
        return groups.matrix_to_rpy(self.rotation)

    @property
    def adjoint(self) -> Numbers:
        """(6, 6): of motions [linear; angular] in B those in A."""
        return groups.adjoint(self)

    def log(self) -> Numbers:
        """log6: the twist [linear; angular], (6,)."""
        return groups.log6(self)

    def inverse(self) -> Placement:
        """X_BA."""
        R = np.swapaxes(self.rotation, -1, -2)
        return Placement(R, -_turned(R, np.asarray(self.translation)))

    def act(self, points: ArrayLike) -> Numbers:
        """Points in B, (..., 3), in A."""
        return _turned(self.rotation, groups.rows(points, 3, "points")) + self.translation

    def act_motion(self, motions: ArrayLike) -> Numbers:
        """Motions [linear; angular] in B, (..., 6), in A."""
        m = groups.rows(motions, 6, "motions")
        linear, angular = _turned(self.rotation, m[..., :3]), _turned(self.rotation, m[..., 3:])
        return np.concatenate([linear + np.cross(self.translation, angular), angular], -1)

    def act_force(self, forces: ArrayLike) -> Numbers:
        """Forces [force; moment] in B, (..., 6), in A."""
        f = groups.rows(forces, 6, "forces")
        force, moment = _turned(self.rotation, f[..., :3]), _turned(self.rotation, f[..., 3:])
        return np.concatenate([force, moment + np.cross(self.translation, force)], -1)

    def act_inertia(self, inertias: ArrayLike) -> Numbers:
        """Spatial inertias in B, (..., 6, 6), in A: momentum = inertia @ motion."""
        X = self.inverse().adjoint
        return np.swapaxes(X, -1, -2) @ groups.matrices(inertias, 6, "inertias") @ X

    def interpolate(self, other: Placement, u: ArrayLike) -> Placement:
        """This one at u = 0, the other at u = 1, with a constant body velocity between: one placement for each number of u."""
        return Placement(*groups.interpolated_pair(self, other, u))

    def is_close(self, other: Placement, tolerance: float = 1e-9) -> bool:
        """Whether no number of the two differs by more than tolerance."""
        return all(bool(np.all(np.abs(np.asarray(a) - b) <= tolerance)) for a, b in zip(self, other))

    @overload
    def __matmul__(self, other: Placement) -> Placement: ...
    @overload
    def __matmul__(self, other: ArrayLike) -> Numbers: ...
    def __matmul__(self, other: Any) -> Any:
        if isinstance(other, Placement):
            return Placement(self.rotation @ other.rotation, self.act(other.translation))
        if np.shape(other)[-1:] == (3,):
            return self.act(other)
        raise TypeError(f"@ takes a Placement or points (..., 3), but its right side has shape {np.shape(other)}: make a "
                        "Placement of a 4 x 4 matrix by Placement.from_matrix; act_motion and act_force take 6 numbers.")

    def __rmatmul__(self, other: Any) -> NoReturn:
        raise TypeError("the left side of @ must be a Placement: Placement.from_matrix makes one, placement.matrix is an array.")

    __add__: Any
    __radd__: Any
    __sub__: Any
    __rsub__: Any
    __mul__: Any
    __rmul__: Any

    def _no_sum(self, other: Any) -> NoReturn:
        raise TypeError(_NO_SUM)

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = _no_sum

    def __eq__(self, other: object) -> bool:
        return isinstance(other, tuple) and len(other) == 2 and all(map(np.array_equal, self, other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__: ClassVar[None] = None  # type: ignore[assignment]


def _turned(R: Any, x: Numbers) -> Numbers:
    out: Numbers = (R @ x[..., None])[..., 0]
    return out
