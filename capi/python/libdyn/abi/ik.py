"""Inverse kinematics."""

from __future__ import annotations

from ctypes import c_double, c_int, c_int32, c_uint32, c_uint64, c_void_p

from .common import STATUS, Grown, i, p, ref


class IkTask(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("type", c_int), ("frame", c_int32), ("priority", c_int32), ("target", c_double * 12),
        ("posture", c_void_p), ("weight", c_double), ("weights", c_void_p),
    ]  # fmt: skip


class IkOptions(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("max_iterations", c_int32), ("restarts", c_int32), ("seed", c_uint64),
        ("tolerance_linear", c_double), ("tolerance_angular", c_double), ("limits", c_int32), ("lower", c_void_p),
        ("upper", c_void_p),
    ]  # fmt: skip


class IkResult(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("reason", c_int), ("iterations", c_int32), ("restarts", c_int32), ("joint", c_int32),
        ("residual_linear", c_double), ("residual_angular", c_double), ("cost", c_double), ("optimality", c_double),
    ]  # fmt: skip


SIGNATURES: dict[str, tuple] = {
    "dyn_ik_task_init": (None, [ref]),
    "dyn_ik_options_init": (None, [ref]),
    "dyn_ik": (STATUS, [p, p, p, ref, i, ref, p, p, ref]),
}  # fmt: skip
