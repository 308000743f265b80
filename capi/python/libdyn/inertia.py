"""Inertial parameters of a body: pi = [m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz], c its centre of mass, I its inertia about the
frame's origin; their pseudo-inertia (4, 4), and their log-Cholesky parameters, every value of which is a body that can exist."""

from __future__ import annotations

from ctypes import byref, c_int
from typing import TYPE_CHECKING

import numpy as np

from .arrays import address, checked
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers


def _convert(call, x: ArrayLike, shape: tuple[int, ...], name: str, out: tuple[int, ...]) -> Numbers:
    x, result = checked(x, shape, name), np.empty(out, order="F")
    check(call(address(x), address(result)))
    return result


def pseudo_inertia_from_parameters(pi: ArrayLike) -> Numbers:
    """J = [S h; h^T m], (4, 4), h = m c, S = tr(I) / 2 1 - I: linear in pi."""
    return _convert(lib.dyn_pseudo_inertia_from_parameters, pi, (10,), "pi", (4, 4))


def parameters_from_pseudo_inertia(J: ArrayLike) -> Numbers:
    """pi, (10,), of a symmetric J."""
    return _convert(lib.dyn_parameters_from_pseudo_inertia, J, (4, 4), "J", (10,))


def log_cholesky_from_parameters(pi: ArrayLike) -> Numbers:
    """theta = [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3]; dyn.InvalidRobotError when no body has these parameters."""
    return _convert(lib.dyn_log_cholesky_from_parameters, pi, (10,), "pi", (10,))


def parameters_from_log_cholesky(theta: ArrayLike) -> Numbers:
    """pi, (10,), of any theta."""
    return _convert(lib.dyn_parameters_from_log_cholesky, theta, (10,), "theta", (10,))


def log_cholesky_jacobian(theta: ArrayLike) -> Numbers:
    """d pi / d theta, (10, 10)."""
    return _convert(lib.dyn_log_cholesky_jacobian, theta, (10,), "theta", (10, 10))


def is_physically_consistent(pi: ArrayLike) -> bool:
    """Returns whether a positive density has these parameters: J is positive definite."""
    pi, out = checked(pi, (10,), "pi"), c_int()
    check(lib.dyn_is_physically_consistent(address(pi), byref(out)))
    return bool(out.value)


def body_regressor(velocity: ArrayLike, acceleration: ArrayLike) -> Numbers:
    """Y, (6, 10): Y pi is the force that moves a body; its spatial velocity and acceleration (less gravity), in its frame."""
    velocity, acceleration = checked(velocity, (6,), "velocity"), checked(acceleration, (6,), "acceleration")
    Y = np.empty((6, 10), order="F")
    check(lib.dyn_body_regressor(address(velocity), address(acceleration), address(Y)))
    return Y
