"""Rotations, SO(3), and placements, SE(3): exponentials, logarithms, Jacobians, quaternions and angles, over arrays of them.

Leading axes are those of an array: a rotation vector (..., 3), a matrix (..., 3, 3), a twist (..., 6) = [linear; angular], a
quaternion (..., 4) = (x, y, z, w). Names and sides are Pinocchio's: exp6(m + dm) = exp6(m) @ exp6(Jexp6(m) dm) with the right
Jacobian, and exp6(Jexp6(m, "left") dm) @ exp6(m) with the left one.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from .groups import (
    Jexp3,
    Jexp6,
    Jlog3,
    Jlog6,
    exp3,
    interpolate,
    log3,
    log6,
    matrix_to_quaternion,
    matrix_to_rpy,
    quaternion_to_matrix,
    rpy_to_matrix,
    skew,
)
from .placement import Placement

__all__ = [
    "Jexp3", "Jexp6", "Jlog3", "Jlog6", "exp3", "exp6", "interpolate", "log3", "log6", "matrix_to_quaternion", "matrix_to_rpy",
    "quaternion_to_matrix", "rpy_to_matrix", "skew",
]  # fmt: skip


def exp6(twist: ArrayLike) -> Placement:
    """The placement after one second of a constant velocity [linear; angular] in the body's axes."""
    return Placement.exp(twist)
