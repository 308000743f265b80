"""Distances, contacts, rays, the broad phase."""

from __future__ import annotations

from ctypes import Structure, c_double, c_int, c_int32, c_int64, c_uint32, c_uint64, c_void_p

from .common import STATUS, Grown, d, i, p, ref


class Distance(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("status", c_int), ("unique", c_int32), ("iterations", c_int32), ("method", c_int),
        ("distance", c_double), ("residual", c_double), ("normal", c_double * 3), ("point_a", c_double * 3), ("point_b", c_double * 3),
    ]  # fmt: skip


class DistanceOptions(Grown):
    _fields_ = [("struct_size", c_uint32), ("method", c_int), ("tolerance", c_double)]


class Geometry(Grown):
    _fields_ = [("struct_size", c_uint32), ("type", c_int), ("size", c_double * 3), ("radius", c_double), ("surface", c_void_p)]


class Contact(Structure):
    _fields_ = [
        ("pair", c_int32), ("shape_a", c_int32), ("shape_b", c_int32), ("reserved", c_int32), ("feature", c_uint64),
        ("distance", c_double), ("position", c_double * 3), ("normal", c_double * 3),
    ]  # fmt: skip


class RayHit(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("shape", c_int32), ("t", c_double), ("position", c_double * 3), ("normal", c_double * 3),
    ]  # fmt: skip


class ClosestPoint(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("unique", c_int32), ("distance", c_double), ("point", c_double * 3), ("normal", c_double * 3),
    ]  # fmt: skip


class Impact(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("status", c_int), ("time", c_double), ("distance", c_double), ("normal", c_double * 3),
        ("point_a", c_double * 3), ("point_b", c_double * 3),
    ]  # fmt: skip


SIGNATURES: dict[str, tuple] = {
    # simulation
    "dyn_geometry_init": (None, [ref]),
    "dyn_distance_options_init": (None, [ref]),
    "dyn_geometry_distance": (STATUS, [ref, p, ref, p, ref, ref]),
    "dyn_model_npairs": (i, [p]),
    "dyn_model_pair": (STATUS, [p, i, ref, ref, ref]),
    "dyn_data_set_pair": (STATUS, [p, p, i, i]),
    "dyn_data_pair": (STATUS, [p, p, i, ref]),
    "dyn_distances": (STATUS, [p, p, p, p]),
    "dyn_pair_distance": (STATUS, [p, p, i, ref]),
    "dyn_distance_gradients": (STATUS, [p, p, p]),
    "dyn_collisions": (STATUS, [p, p, p, d, p, i, ref]),
    # contacts, rays, the broad phase
    "dyn_data_set_shape_masks": (STATUS, [p, p, i, c_uint32, c_uint32]),
    "dyn_data_shape_masks": (STATUS, [p, p, i, ref, ref]),
    "dyn_geometry_contacts": (STATUS, [ref, p, ref, p, d, d, ref, ref]),
    "dyn_contacts": (STATUS, [p, p, p, d, ref, i, ref]),
    "dyn_smooth_distances": (STATUS, [p, p, p, d, p, p, p]),
    "dyn_geometry_ray": (STATUS, [ref, p, p, p, ref]),
    "dyn_rays": (STATUS, [p, p, p, p, p, i, d, c_uint32, p, p, p]),
    "dyn_geometry_closest_point": (STATUS, [ref, p, p, ref]),
    "dyn_geometry_sweep": (STATUS, [ref, p, p, ref, p, p, d, d, ref]),
    "dyn_broad_phase_new": (STATUS, [i, c_int64, d, ref]),
    "dyn_broad_phase_free": (None, [p]),
    "dyn_broad_phase_insert": (STATUS, [p, p, p, ref]),
    "dyn_broad_phase_update": (STATUS, [p, i, p, p]),
    "dyn_broad_phase_remove": (STATUS, [p, i]),
    "dyn_broad_phase_pairs": (STATUS, [p, p, c_int64, ref]),
    "dyn_broad_phase_query": (STATUS, [p, p, p, p, i, ref]),
    "dyn_broad_phase_ray": (STATUS, [p, p, p, d, p, i, ref]),
}  # fmt: skip
