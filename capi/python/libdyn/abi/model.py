"""Models: loaded, described, saved."""

from __future__ import annotations

from ctypes import CFUNCTYPE, POINTER, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

from .common import STATUS, Grown, Material, d, i, p, ref, s


class LoadOptions(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("base", c_int), ("strict", c_int32), ("cos_sin", c_int32),
        ("package_dirs", POINTER(c_char_p)), ("package_dirs_count", c_size_t), ("gravity", c_double * 3), ("srdf", c_char_p),
        ("meshes", c_int), ("constraint_slots", c_int32), ("contact_capacity", c_int32), ("confined", c_int32),
    ]  # fmt: skip


class ReportEntry(Grown):
    _fields_ = [("struct_size", c_uint32), ("level", c_int), ("line", c_int32), ("message", c_char_p)]


class JointInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("parent", c_int32), ("idx_q", c_int32),
        ("idx_v", c_int32), ("nq", c_int32), ("nv", c_int32), ("mimic_leader", c_int32), ("mimic_ratio", c_double),
        ("mimic_offset", c_double), ("axis", c_double * 3), ("axis2", c_double * 3), ("pitch", c_double),
        ("placement", c_double * 12),
    ]  # fmt: skip


class FrameInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("joint", c_int32), ("placement", c_double * 12),
        ("mass", c_double), ("com", c_double * 3), ("inertia", c_double * 9),
    ]  # fmt: skip


class ShapeInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("role", c_int), ("frame", c_int32),
        ("placement", c_double * 12), ("size", c_double * 3), ("mesh", c_char_p),
        ("radius", c_double), ("contype", c_uint32), ("conaffinity", c_uint32), ("material", Material),
    ]  # fmt: skip


class StateLayout(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("convention", c_int), ("joints", POINTER(c_char_p)), ("joints_count", c_size_t),
        ("idx_q", c_void_p), ("idx_v", c_void_p), ("nq", c_int32), ("nv", c_int32), ("continuous", c_int),
        ("child_frame", c_char_p),
    ]  # fmt: skip


SAVE_REPORT = CFUNCTYPE(None, c_void_p, c_int, c_char_p)  # dynSaveReport

SIGNATURES: dict[str, tuple] = {
    "dyn_status_name": (s, [i]),
    "dyn_last_error": (s, []),
    "dyn_version": (s, []),
    "dyn_build_info": (s, []),
    # loading
    "dyn_load_options_init": (None, [ref]),
    "dyn_model_load": (STATUS, [s, ref, ref]),
    "dyn_model_load_string": (STATUS, [s, ref, ref]),
    "dyn_model_free": (None, [p]),
    # saving
    "dyn_model_save": (STATUS, [p, s, i, p, p]),
    "dyn_model_save_memory": (STATUS, [p, i, i, p, p, p, c_size_t, ref]),
    "dyn_model_image": (STATUS, [p, c_uint32, p, c_size_t, ref]),
    "dyn_model_from_buffer": (STATUS, [p, c_size_t, ref]),
    "dyn_model_report_count": (i, [p]),
    "dyn_model_report_entry": (STATUS, [p, i, ref]),
    # model
    "dyn_model_nq": (i, [p]),
    "dyn_model_nv": (i, [p]),
    "dyn_model_njoints": (i, [p]),
    "dyn_model_nframes": (i, [p]),
    "dyn_model_nbodies": (i, [p]),
    "dyn_model_size": (c_size_t, [p]),
    "dyn_model_name": (s, [p]),
    "dyn_model_joint_name": (s, [p, i]),
    "dyn_model_frame_name": (s, [p, i]),
    "dyn_model_joint_id": (i, [p, s]),
    "dyn_model_frame_id": (i, [p, s]),
    "dyn_model_frame_id_of_type": (i, [p, s, i]),
    "dyn_model_joint_info": (STATUS, [p, i, ref]),
    "dyn_model_frame_info": (STATUS, [p, i, ref]),
    "dyn_model_nshapes": (i, [p]),
    "dyn_model_shape_info": (STATUS, [p, i, ref]),
    "dyn_model_shape_rgba": (STATUS, [p, i, p]),
    "dyn_model_shape_mesh": (STATUS, [p, i, ref]),
    "dyn_model_ndisabled_pairs": (i, [p]),
    "dyn_model_disabled_pair": (STATUS, [p, i, ref, ref, ref]),
    "dyn_model_array": (p, [p, i]),
    "dyn_model_total_mass": (d, [p]),
    "dyn_model_nconfigurations": (i, [p]),
    "dyn_model_configuration_name": (s, [p, i]),
    "dyn_model_configuration": (STATUS, [p, s, p]),
    "dyn_model_q_permutation": (STATUS, [p, POINTER(c_char_p), c_size_t, p, p]),
    "dyn_model_nactuators": (i, [p]),
    "dyn_model_nu": (i, [p]),
    "dyn_model_actuator_name": (s, [p, i]),
    "dyn_model_actuator_id": (i, [p, s]),
    "dyn_model_actuator_info": (STATUS, [p, i, ref]),
    # configurations
    "dyn_integrate": (STATUS, [p, p, p, p]),
    "dyn_difference": (STATUS, [p, p, p, p]),
    "dyn_interpolate": (STATUS, [p, p, p, d, p]),
    "dyn_configuration_distance": (STATUS, [p, p, p, p]),
    "dyn_configuration_neutral": (STATUS, [p, p]),
    "dyn_configuration_random": (STATUS, [p, c_uint64, p, p, p]),
    "dyn_configuration_normalize": (STATUS, [p, p]),
    "dyn_configuration_is_normalized": (STATUS, [p, p, d, p]),
    "dyn_integrate_jacobians": (STATUS, [p, p, p, p, p]),
    "dyn_difference_jacobians": (STATUS, [p, p, p, p, p]),
    # other libraries' states
    "dyn_state_layout_init": (None, [ref]),
    "dyn_state_layout_sizes": (STATUS, [p, ref, ref, ref]),
    "dyn_state_layout_convert": (STATUS, [p, ref, i, p, p, p, p, p, p, p, p]),
}  # fmt: skip
