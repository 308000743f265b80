"""Building models."""

from __future__ import annotations

from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p

from .common import STATUS, Grown, Material, d, i, p, ref, s


class JointSpec(Grown):
    pass


JointSpec._fields_ = [
    ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("parent", c_char_p), ("placement", c_double * 12),
    ("axis", c_double * 3), ("axis2", c_double * 3), ("pitch", c_double), ("lower", c_void_p), ("upper", c_void_p),
    ("velocity", c_void_p), ("effort", c_void_p), ("armature", c_void_p), ("damping", c_void_p), ("friction", c_void_p),
    ("stiffness", c_void_p), ("spring_reference", c_void_p), ("rotor_inertia", c_double), ("gear_ratio", c_double), ("mimic", c_char_p), ("mimic_ratio", c_double),
    ("mimic_offset", c_double), ("parts", POINTER(JointSpec)), ("parts_count", c_size_t),
]  # fmt: skip


class ShapeSpec(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("role", c_int), ("body", c_char_p),
        ("placement", c_double * 12), ("size", c_double * 3), ("mesh", c_char_p),
        ("radius", c_double), ("contype", c_uint32), ("conaffinity", c_uint32), ("surface", c_void_p),
        ("material", Material),
    ]  # fmt: skip


SIGNATURES: dict[str, tuple] = {
    "dyn_joint_spec_init": (None, [ref]),
    "dyn_builder_new": (STATUS, [s, ref]),
    "dyn_builder_free": (None, [p]),
    "dyn_builder_set_gravity": (STATUS, [p, p]),
    "dyn_shape_spec_init": (None, [ref]),
    "dyn_builder_add_shape": (STATUS, [p, ref]),
    "dyn_builder_set_shape_rgba": (STATUS, [p, p]),
    "dyn_builder_add_joint": (STATUS, [p, ref]),
    "dyn_builder_add_body": (STATUS, [p, s, s, p, d, p, p]),
    "dyn_builder_add_frame": (STATUS, [p, s, s, p, i]),
    "dyn_builder_add_configuration": (STATUS, [p, s, p, c_size_t]),
    "dyn_builder_from_model": (STATUS, [p, ref]),
    "dyn_builder_lock": (STATUS, [p, POINTER(c_char_p), c_size_t, p, c_size_t]),
    "dyn_builder_attach": (STATUS, [p, p, s, ref]),
    "dyn_builder_keep_subtree": (STATUS, [p, s]),
    "dyn_builder_remove_subtree": (STATUS, [p, s]),
    "dyn_builder_finish": (STATUS, [p, ref]),
    "dyn_builder_add_actuator": (STATUS, [p, s, ref, s]),
    "dyn_builder_set_gravity_compensation": (STATUS, [p, s, d]),
    "dyn_builder_set_medium": (STATUS, [p, d, d, p]),
    "dyn_builder_add_pair": (STATUS, [p, s, s, ref]),
    "dyn_builder_add_constraint": (STATUS, [p, s, ref, s, s]),
    "dyn_builder_set_constraint_slots": (STATUS, [p, i]),
    "dyn_builder_set_contact_capacity": (STATUS, [p, i]),
}  # fmt: skip
