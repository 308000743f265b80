"""Batches and rollouts."""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_char_p, c_double, c_int, c_int32, c_int64, c_uint32, c_void_p

from .common import STATUS, Grown, i, p, ref


class BatchArrays(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("frame", c_int32), ("joint", c_int32), ("reference", c_int), ("q", c_void_p), ("v", c_void_p),
        ("a", c_void_p), ("tau", c_void_p), ("b", c_void_p), ("fext", c_void_p), ("q1", c_void_p), ("dt", c_double), ("integrator", c_int), ("out", c_void_p * 4),
        ("status", c_void_p),
    ]  # fmt: skip


class AlgorithmInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("inputs", c_char_p), ("outputs", c_int32), ("output", c_char_p * 4),
        ("rows", c_int32 * 4), ("cols", c_int32 * 4), ("pages", c_int32 * 4),
    ]  # fmt: skip


PROGRESS = CFUNCTYPE(c_int, c_void_p, c_int64, c_int64)


class Rollout(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("steps", c_int32), ("every", c_int32), ("contact_capacity", c_int32), ("sensors", c_int32), ("reserved", c_int32),
        ("stepping", c_void_p), ("sensor", c_void_p), ("sensor_frame", c_void_p), ("states", c_void_p), ("q0", c_void_p), ("v0", c_void_p),
        ("tau", c_void_p), ("control", c_void_p), ("q", c_void_p), ("v", c_void_p), ("sensor_data", c_void_p), ("contacts", c_void_p),
        ("contact_count", c_void_p), ("final_states", c_void_p), ("status", c_void_p), ("progress", PROGRESS), ("context", c_void_p),
    ]  # fmt: skip


SIGNATURES: dict[str, tuple] = {
    "dyn_batch_new": (STATUS, [p, c_uint32, i, ref]),
    "dyn_batch_free": (None, [p]),
    "dyn_batch_set_effects": (STATUS, [p, i, c_uint32]),
    "dyn_batch_arrays_init": (None, [ref]),
    "dyn_batch_run": (STATUS, [p, i, c_int64, ref]),
    "dyn_algorithm_info": (STATUS, [p, i, ref]),
    # rollouts
    "dyn_sensor_size": (i, [i]),
    "dyn_rollout_init": (None, [ref]),
    "dyn_batch_rollout": (STATUS, [p, c_int64, ref]),
}  # fmt: skip
