"""Meshes."""

from __future__ import annotations

from ctypes import POINTER, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p

from .common import STATUS, Grown, d, i, p, ref, s


class MeshOptions(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("scale", c_double * 3), ("weld_tolerance", c_double), ("up_z", c_int32),
        ("package_dirs", POINTER(c_char_p)), ("package_dirs_count", c_size_t), ("relative_to", c_char_p),
    ]  # fmt: skip


class MeshInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("vertices", c_int32), ("triangles", c_int32), ("welded", c_int64), ("degenerate", c_int64),
        ("duplicates", c_int64), ("skipped", c_int64), ("lower", c_double * 3), ("upper", c_double * 3), ("area", c_double),
        ("components", c_int32), ("open_edges", c_int32), ("flipped_edges", c_int32), ("nonmanifold_edges", c_int32), ("closed", c_int32),
        ("orientation", c_int32), ("volume", c_double), ("com", c_double * 3), ("inertia", c_double * 9), ("hull_status", c_int),
        ("hull_volume", c_double), ("hull_volume_ratio", c_double), ("hull_depth", c_double), ("convex", c_int32), ("reserved", c_int32),
    ]  # fmt: skip


class MeshArrays(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("vertices", c_void_p), ("triangles", c_void_p), ("vertex_count", c_size_t),
        ("triangle_count", c_size_t), ("face_count", c_size_t), ("planes", c_void_p), ("face_start", c_void_p),
        ("face_corners", c_void_p), ("neighbour_start", c_void_p), ("neighbours", c_void_p),
    ]  # fmt: skip


SIGNATURES: dict[str, tuple] = {
    "dyn_mesh_options_init": (None, [ref]),
    "dyn_mesh_load": (STATUS, [s, ref, ref]),
    "dyn_mesh_from_arrays": (STATUS, [p, c_size_t, p, c_size_t, ref]),
    "dyn_mesh_free": (None, [p]),
    "dyn_mesh_info": (STATUS, [p, ref]),
    "dyn_mesh_arrays": (STATUS, [p, ref]),
    "dyn_mesh_rgb": (STATUS, [p, p]),
    "dyn_mesh_hull": (STATUS, [p, ref]),
    "dyn_mesh_from_height_field": (STATUS, [p, i, i, d, d, d, ref]),
}  # fmt: skip
