"""dyn.h in ctypes: the structures and the signature of every function. Pointers to numbers are plain addresses."""

from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_ssize_t, c_uint32, c_uint64, c_void_p

MAJOR = 1  # of the interface this package was written for


class Grown(Structure):
    """A structure that begins with its own size, so that it may grow."""

    def __init__(self, **values):
        super().__init__(**values)
        self.struct_size = ctypes.sizeof(self)


class Array(Grown):
    _fields_ = [("struct_size", c_uint32), ("rows", c_int32), ("cols", c_int32), ("stride", c_ssize_t * 2), ("data", c_void_p)]


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


class Material(Structure):
    _fields_ = [
        ("friction", c_double), ("torsion", c_double), ("rolling", c_double), ("restitution", c_double), ("stiffness", c_double),
        ("damping", c_double), ("surface_velocity", c_double * 3),
    ]  # fmt: skip


class ShapeInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("type", c_int), ("role", c_int), ("frame", c_int32),
        ("placement", c_double * 12), ("size", c_double * 3), ("mesh", c_char_p),
        ("radius", c_double), ("contype", c_uint32), ("conaffinity", c_uint32), ("material", Material),
    ]  # fmt: skip


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


class Constraint(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("type", c_int), ("first", c_int32), ("second", c_int32), ("placement1", c_double * 12),
        ("placement2", c_double * 12), ("joint_type", c_int), ("axis", c_double * 3), ("axis2", c_double * 3), ("pitch", c_double),
        ("length", c_double), ("coefficients", c_double * 5), ("force", c_double), ("stiffness", c_double), ("damping", c_double),
        ("restitution", c_double), ("enabled", c_int32), ("reserved", c_int32),
    ]  # fmt: skip


class EffectInfo(Grown):
    _fields_ = [("struct_size", c_uint32), ("name", c_char_p), ("present", c_int32), ("acting", c_int32), ("bytes", c_uint64)]


class Actuator(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("type", c_int), ("joint", c_int32), ("component", c_int32), ("gear", c_double), ("kp", c_double),
        ("kv", c_double), ("gain", c_double), ("bias", c_double * 3), ("time_constant", c_double), ("control_range", c_double * 2),
        ("force_range", c_double * 2), ("idx_u", c_int32), ("controls", c_int32),
    ]  # fmt: skip


class ConstraintOptions(Grown):
    _fields_ = [("struct_size", c_uint32), ("max_iterations", c_int32), ("regularisation", c_double), ("tolerance", c_double)]


class ConstraintResult(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("reason", c_int), ("rows", c_int32), ("rank", c_int32), ("iterations", c_int32),
        ("residual", c_double), ("contradiction", c_double), ("condition", c_double), ("regularisation", c_double),
    ]  # fmt: skip


class ProjectOptions(Grown):
    _fields_ = [("struct_size", c_uint32), ("max_iterations", c_int32), ("weigh", c_int32), ("tolerance", c_double)]


class ConstraintDerivatives(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("ddq_dq", c_void_p), ("ddq_dv", c_void_p), ("ddq_dtau", c_void_p), ("lambda_dq", c_void_p),
        ("lambda_dv", c_void_p), ("lambda_dtau", c_void_p),
    ]  # fmt: skip


class RowReport(Structure):
    _fields_ = [("slot", c_int32), ("row", c_int32), ("verdict", c_int), ("share", c_double), ("error", c_double)]


class ConstraintReport(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("rows", c_int32), ("rank", c_int32), ("redundant", c_int32), ("contradictory", c_int32),
        ("condition", c_double), ("smallest", c_double), ("largest", c_double), ("error", c_double), ("contradiction", c_double),
    ]  # fmt: skip


class StateLayout(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("convention", c_int), ("joints", POINTER(c_char_p)), ("joints_count", c_size_t),
        ("idx_q", c_void_p), ("idx_v", c_void_p), ("nq", c_int32), ("nv", c_int32), ("continuous", c_int),
        ("child_frame", c_char_p),
    ]  # fmt: skip


class FieldInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("shape", c_char_p), ("unit", c_char_p), ("frame", c_char_p),
        ("producer", c_char_p), ("sentence", c_char_p), ("part", c_uint32), ("reserved", c_int32),
    ]  # fmt: skip


class BatchArrays(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("frame", c_int32), ("joint", c_int32), ("reference", c_int), ("q", c_void_p), ("v", c_void_p),
        ("a", c_void_p), ("tau", c_void_p), ("b", c_void_p), ("fext", c_void_p), ("q1", c_void_p), ("dt", c_double), ("integrator", c_int), ("out", c_void_p * 4),
        ("status", c_void_p),
    ]  # fmt: skip


class BatchInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("inputs", c_char_p), ("outputs", c_int32), ("output", c_char_p * 4),
        ("rows", c_int32 * 4), ("cols", c_int32 * 4), ("pages", c_int32 * 4),
    ]  # fmt: skip


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


class StepOptions(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("integrator", c_int), ("dt", c_double), ("accuracy", c_double), ("solver", c_int),
        ("max_iterations", c_int32), ("tolerance", c_double), ("sleep_speed", c_double), ("sleep_time", c_double),
        ("visit_sleepers", c_int32), ("ledger", c_int32), ("time_budget", c_double),
    ]  # fmt: skip


class StepReport(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("steps", c_int64), ("rejected", c_int64), ("evaluations", c_int64), ("time", c_double),
        ("smallest_dt", c_double), ("error_estimate", c_double), ("contacts", c_int32), ("rows", c_int32), ("islands", c_int32),
        ("dropped", c_int32), ("iterations", c_int64), ("residual", c_double), ("penetration", c_double),
        ("sleeping", c_int32), ("unsolved", c_int32),
    ]  # fmt: skip


class ErrorLedger(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("steps", c_int64), ("energy_change", c_double), ("applied", c_double), ("actuators", c_double),
        ("wrenches", c_double), ("damping", c_double), ("friction", c_double), ("fluid", c_double), ("contact_normal", c_double),
        ("contact_friction", c_double), ("limits", c_double), ("constraints", c_double), ("correction", c_double),
        ("energy_defect", c_double), ("momentum_defect", c_double * 3), ("constraint_drift", c_double), ("cone", c_double),
        ("complementarity", c_double),
    ]  # fmt: skip


class ContactForce(Structure):
    _fields_ = [("contact", Contact), ("force_on_b", c_double * 3), ("moment_on_b", c_double * 3)]


class ContactProblem(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("equalities", c_int32), ("boxes", c_int32), ("contacts", c_int32), ("contact_rows", c_void_p),
        ("G", c_void_p), ("G_stride", c_int32), ("reserved", c_int32), ("g", c_void_p), ("lower", c_void_p), ("upper", c_void_p),
        ("friction", c_void_p), ("torsion", c_void_p), ("rolling", c_void_p), ("compliance", c_void_p), ("bias", c_void_p),
        ("restitution", c_void_p), ("v_minus", c_void_p),
    ]  # fmt: skip


class ContactOptions(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("solver", c_int), ("max_iterations", c_int32), ("warm_start", c_int32), ("tolerance", c_double),
        ("time_budget", c_double), ("relaxation", c_double), ("newton", c_int32), ("reserved", c_int32),
    ]  # fmt: skip


class ContactReport(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("status", c_int), ("iterations", c_int32), ("newton_steps", c_int32), ("factorizations", c_int32),
        ("worst", c_int32), ("residual", c_double), ("primal", c_double), ("dual", c_double), ("complementarity", c_double),
        ("natural_map", c_double), ("signorini", c_double), ("dissipation", c_double), ("energy", c_double),
        ("restitution_scale", c_double),
    ]  # fmt: skip


class Qp(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("n", c_int32), ("m", c_int32), ("H_nonzeros", c_int32), ("A_nonzeros", c_int32),
        ("reserved", c_int32), ("H_columns", c_void_p), ("H_rows", c_void_p), ("A_columns", c_void_p), ("A_rows", c_void_p),
        ("H", c_void_p), ("g", c_void_p), ("A", c_void_p), ("lower", c_void_p), ("upper", c_void_p),
    ]  # fmt: skip


SAVE_REPORT = CFUNCTYPE(None, c_void_p, c_int, c_char_p)  # dynSaveReport

_p, _s, _i, _d = c_void_p, c_char_p, c_int, c_double
_ref = _p  # of a structure or a handle that the call writes: byref() or an address

# name: (result, arguments). "status" is a dynStatus.
STATUS = c_int
SIGNATURES: dict[str, tuple] = {
    "dyn_status_name": (_s, [_i]),
    "dyn_last_error": (_s, []),
    "dyn_version": (_s, []),
    "dyn_build_info": (_s, []),
    # loading
    "dyn_load_options_init": (None, [_ref]),
    "dyn_model_load": (STATUS, [_s, _ref, _ref]),
    "dyn_model_load_string": (STATUS, [_s, _ref, _ref]),
    "dyn_model_free": (None, [_p]),
    # saving
    "dyn_model_save": (STATUS, [_p, _s, _i, _p, _p]),
    "dyn_model_save_memory": (STATUS, [_p, _i, _i, _p, _p, _p, c_size_t, _ref]),
    "dyn_model_image": (STATUS, [_p, c_uint32, _p, c_size_t, _ref]),
    "dyn_model_from_buffer": (STATUS, [_p, c_size_t, _ref]),
    "dyn_report_count": (_i, [_p]),
    "dyn_report_entry": (STATUS, [_p, _i, _ref]),
    # model
    "dyn_nq": (_i, [_p]),
    "dyn_nv": (_i, [_p]),
    "dyn_njoints": (_i, [_p]),
    "dyn_nframes": (_i, [_p]),
    "dyn_nbodies": (_i, [_p]),
    "dyn_model_size": (c_size_t, [_p]),
    "dyn_model_name": (_s, [_p]),
    "dyn_joint_name": (_s, [_p, _i]),
    "dyn_frame_name": (_s, [_p, _i]),
    "dyn_joint_id": (_i, [_p, _s]),
    "dyn_frame_id": (_i, [_p, _s]),
    "dyn_frame_id_of_type": (_i, [_p, _s, _i]),
    "dyn_joint_info": (STATUS, [_p, _i, _ref]),
    "dyn_frame_info": (STATUS, [_p, _i, _ref]),
    "dyn_nshapes": (_i, [_p]),
    "dyn_shape_info": (STATUS, [_p, _i, _ref]),
    "dyn_shape_mesh": (STATUS, [_p, _i, _ref]),
    "dyn_mesh_height_field": (STATUS, [_p, _i, _i, _d, _d, _d, _ref]),
    "dyn_ndisabled_pairs": (_i, [_p]),
    "dyn_disabled_pair": (STATUS, [_p, _i, _ref, _ref, _ref]),
    "dyn_model_array": (_p, [_p, _i]),
    "dyn_total_mass": (_d, [_p]),
    "dyn_nconfigurations": (_i, [_p]),
    "dyn_configuration_name": (_s, [_p, _i]),
    "dyn_configuration": (STATUS, [_p, _s, _p]),
    "dyn_q_permutation": (STATUS, [_p, POINTER(c_char_p), c_size_t, _p, _p]),
    # builder
    "dyn_joint_spec_init": (None, [_ref]),
    "dyn_builder_new": (STATUS, [_s, _ref]),
    "dyn_builder_free": (None, [_p]),
    "dyn_builder_gravity": (STATUS, [_p, _p]),
    "dyn_shape_spec_init": (None, [_ref]),
    "dyn_builder_shape": (STATUS, [_p, _ref]),
    "dyn_builder_joint": (STATUS, [_p, _ref]),
    "dyn_builder_body": (STATUS, [_p, _s, _s, _p, _d, _p, _p]),
    "dyn_builder_frame": (STATUS, [_p, _s, _s, _p, _i]),
    "dyn_builder_configuration": (STATUS, [_p, _s, _p, c_size_t]),
    "dyn_builder_from_model": (STATUS, [_p, _ref]),
    "dyn_builder_lock": (STATUS, [_p, POINTER(c_char_p), c_size_t, _p, c_size_t]),
    "dyn_builder_attach": (STATUS, [_p, _p, _s, _ref]),
    "dyn_builder_subtree": (STATUS, [_p, _s]),
    "dyn_builder_remove": (STATUS, [_p, _s]),
    "dyn_builder_finish": (STATUS, [_p, _ref]),
    # constraints
    "dyn_constraint_init": (None, [_ref, _i]),
    "dyn_builder_constraint": (STATUS, [_p, _s, _ref, _s, _s]),
    "dyn_builder_constraint_slots": (STATUS, [_p, _i]),
    "dyn_builder_contact_capacity": (STATUS, [_p, _i]),
    "dyn_contact_capacity": (_i, [_p]),
    "dyn_nconstraints": (_i, [_p]),
    "dyn_nconstraint_slots": (_i, [_p]),
    "dyn_constraint_name": (_s, [_p, _i]),
    "dyn_constraint_id": (_i, [_p, _s]),
    "dyn_constraint_info": (STATUS, [_p, _i, _ref]),
    "dyn_constraint_set": (STATUS, [_p, _p, _i, _ref]),
    "dyn_constraint_get": (STATUS, [_p, _p, _i, _ref]),
    "dyn_constraint_enable": (STATUS, [_p, _p, _i, _i]),
    "dyn_constraint_anchor": (STATUS, [_p, _p, _i, _p]),
    "dyn_constraint_rows": (STATUS, [_p, _p, _i, _ref, _ref]),
    "dyn_constraint_terms": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p]),
    "dyn_constraint_options_init": (None, [_ref]),
    "dyn_constrained_dynamics": (STATUS, [_p, _p, _p, _p, _p, _p, _ref, _p, _p, _ref]),
    "dyn_constrained_inverse_dynamics": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p, _p, _ref]),
    "dyn_constraint_impulse": (STATUS, [_p, _p, _p, _p, _ref, _p, _p, _ref]),
    "dyn_project_options_init": (None, [_ref]),
    "dyn_project": (STATUS, [_p, _p, _p, _p, _ref, _p, _p, _ref]),
    "dyn_delassus": (STATUS, [_p, _p, _p, _p]),
    "dyn_delassus_factor": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_delassus_times": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_delassus_solve": (STATUS, [_p, _p, _p, c_double, _p, _p]),
    "dyn_constrained_dynamics_derivatives": (STATUS, [_p, _p, _p, _p, _p, _p, _ref, _ref, _ref]),
    "dyn_constraint_impulse_derivatives": (STATUS, [_p, _p, _p, _p, _ref, _ref, _ref]),
    "dyn_constraint_report": (STATUS, [_p, _p, _p, _ref, _p, _i]),
    # data
    "dyn_data_new": (STATUS, [_p, c_uint32, _ref]),
    "dyn_data_size": (c_size_t, [_p, c_uint32]),
    "dyn_data_init": (STATUS, [_p, c_uint32, _p, c_size_t, _ref]),
    "dyn_data_free": (None, [_p]),
    "dyn_warmup": (STATUS, [_p, _p]),
    "dyn_data_set_state": (STATUS, [_p, _p, _p, _p, _p, _p]),
    "dyn_data_set_effects": (STATUS, [_p, _p, _i, c_uint32]),
    "dyn_data_effects": (STATUS, [_p, _p, _i, _ref]),
    "dyn_nfields": (_i, []),
    "dyn_field_info": (STATUS, [c_int32, _ref]),
    "dyn_field_id": (c_int32, [_s]),
    "dyn_data_array": (STATUS, [_p, _p, c_int32, _ref]),
    # kinematics
    "dyn_forward_kinematics": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_frame_placement": (STATUS, [_p, _p, _i, _p]),
    "dyn_frame_placements": (STATUS, [_p, _p, _p]),
    "dyn_frame_velocity": (STATUS, [_p, _p, _i, _i, _p]),
    "dyn_frame_acceleration": (STATUS, [_p, _p, _i, _i, _p]),
    "dyn_frame_classical_acceleration": (STATUS, [_p, _p, _i, _i, _p]),
    "dyn_joint_jacobians": (STATUS, [_p, _p, _p, _p]),
    "dyn_joint_jacobians_time_variation": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_frame_jacobian": (STATUS, [_p, _p, _i, _i, _p]),
    "dyn_frame_jacobian_time_variation": (STATUS, [_p, _p, _i, _i, _p]),
    "dyn_frame_velocity_derivatives": (STATUS, [_p, _p, _i, _i, _p, _p]),
    "dyn_frame_acceleration_derivatives": (STATUS, [_p, _p, _i, _i, _p, _p, _p]),
    "dyn_frame_classical_acceleration_derivatives": (STATUS, [_p, _p, _i, _i, _p, _p, _p]),
    "dyn_frame_kinematic_hessian": (STATUS, [_p, _p, _i, _i, _p]),
    # centre of mass
    "dyn_center_of_mass": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p]),
    "dyn_center_of_mass_jacobian": (STATUS, [_p, _p, _p, _p]),
    "dyn_center_of_mass_velocity_derivatives": (STATUS, [_p, _p, _p, _p, _p, _p]),
    "dyn_subtree_center_of_mass": (STATUS, [_p, _p, _i, _p, _p]),
    "dyn_subtree_center_of_mass_jacobian": (STATUS, [_p, _p, _i, _p]),
    # dynamics
    "dyn_rnea": (STATUS, [_p, _p, _p, _p, _p, _p, _p]),
    "dyn_nonlinear_effects": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_gravity": (STATUS, [_p, _p, _p, _p]),
    "dyn_static_torque": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_coriolis_matrix": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_aba": (STATUS, [_p, _p, _p, _p, _p, _p, _p]),
    "dyn_crba": (STATUS, [_p, _p, _p, _p]),
    "dyn_factorize": (STATUS, [_p, _p]),
    "dyn_solve": (STATUS, [_p, _p, _p, _i, _p]),
    "dyn_minverse": (STATUS, [_p, _p, _p, _p]),
    "dyn_rnea_derivatives": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p]),
    "dyn_aba_derivatives": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p, _p]),
    "dyn_gravity_derivatives": (STATUS, [_p, _p, _p, _p]),
    "dyn_static_torque_derivatives": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_rnea_second_order_product": (STATUS, [_p] * 11),
    "dyn_rnea_second_order_derivatives": (STATUS, [_p] * 10),
    "dyn_energy": (STATUS, [_p, _p, _p, _p, _p, _p]),
    "dyn_kinetic_energy": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_potential_energy": (STATUS, [_p, _p, _p, _p]),
    "dyn_all_terms": (STATUS, [_p, _p, c_uint32, _p, _p, _ref]),
    # centroidal
    "dyn_centroidal_map": (STATUS, [_p, _p, _p, _p, _p, _p, _p]),
    "dyn_centroidal_map_time_variation": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_centroidal_momentum": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_centroidal_momentum_rate": (STATUS, [_p, _p, _p, _p, _p, _p]),
    "dyn_centroidal_derivatives": (STATUS, [_p, _p, _p, _p, _p, _p, _p, _p, _p]),
    # identification
    "dyn_inertial_parameters": (STATUS, [_p, _p]),
    "dyn_joint_torque_regressor": (STATUS, [_p, _p, _p, _p, _p, _p]),
    "dyn_static_regressor": (STATUS, [_p, _p, _p, _p]),
    "dyn_kinetic_energy_regressor": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_potential_energy_regressor": (STATUS, [_p, _p, _p, _p]),
    "dyn_joint_body_regressor": (STATUS, [_p, _p, _i, _p]),
    "dyn_frame_body_regressor": (STATUS, [_p, _p, _i, _p]),
    "dyn_body_regressor": (STATUS, [_p, _p, _p]),
    "dyn_pseudo_inertia_from_parameters": (STATUS, [_p, _p]),
    "dyn_parameters_from_pseudo_inertia": (STATUS, [_p, _p]),
    "dyn_log_cholesky_from_parameters": (STATUS, [_p, _p]),
    "dyn_parameters_from_log_cholesky": (STATUS, [_p, _p]),
    "dyn_log_cholesky_jacobian": (STATUS, [_p, _p]),
    "dyn_is_physically_consistent": (STATUS, [_p, _ref]),
    # configurations
    "dyn_integrate": (STATUS, [_p, _p, _p, _p]),
    "dyn_difference": (STATUS, [_p, _p, _p, _p]),
    "dyn_interpolate": (STATUS, [_p, _p, _p, _d, _p]),
    "dyn_distance": (STATUS, [_p, _p, _p, _p]),
    "dyn_neutral": (STATUS, [_p, _p]),
    "dyn_random": (STATUS, [_p, c_uint64, _p, _p, _p]),
    "dyn_normalize": (STATUS, [_p, _p]),
    "dyn_is_normalized": (STATUS, [_p, _p, _d, _p]),
    "dyn_integrate_jacobians": (STATUS, [_p, _p, _p, _p, _p]),
    "dyn_difference_jacobians": (STATUS, [_p, _p, _p, _p, _p]),
    # other libraries' states
    "dyn_state_layout_init": (None, [_ref]),
    "dyn_state_layout_sizes": (STATUS, [_p, _ref, _ref, _ref]),
    "dyn_convert_state": (STATUS, [_p, _ref, _i, _p, _p, _p, _p, _p, _p, _p, _p]),
    # inverse kinematics
    "dyn_ik_task_init": (None, [_ref]),
    "dyn_ik_options_init": (None, [_ref]),
    "dyn_ik": (STATUS, [_p, _p, _p, _ref, _i, _ref, _p, _p, _ref]),
    # simulation
    "dyn_geometry_init": (None, [_ref]),
    "dyn_distance_options_init": (None, [_ref]),
    "dyn_shape_distance": (STATUS, [_ref, _p, _ref, _p, _ref, _ref]),
    "dyn_npairs": (_i, [_p]),
    "dyn_pair": (STATUS, [_p, _i, _ref, _ref, _ref]),
    "dyn_data_set_pair": (STATUS, [_p, _p, _i, _i]),
    "dyn_data_pair": (STATUS, [_p, _p, _i, _ref]),
    "dyn_distances": (STATUS, [_p, _p, _p, _p]),
    "dyn_pair_distance": (STATUS, [_p, _p, _i, _ref]),
    "dyn_distance_gradients": (STATUS, [_p, _p, _p]),
    "dyn_collisions": (STATUS, [_p, _p, _p, _d, _p, _i, _ref]),
    # contacts, rays, the broad phase
    "dyn_data_set_shape_masks": (STATUS, [_p, _p, _i, c_uint32, c_uint32]),
    "dyn_data_shape_masks": (STATUS, [_p, _p, _i, _ref, _ref]),
    "dyn_shape_contacts": (STATUS, [_ref, _p, _ref, _p, _d, _d, _ref, _ref]),
    "dyn_contacts": (STATUS, [_p, _p, _p, _d, _ref, _i, _ref]),
    "dyn_smooth_distances": (STATUS, [_p, _p, _p, _d, _p, _p, _p]),
    "dyn_shape_ray": (STATUS, [_ref, _p, _p, _p, _ref]),
    "dyn_rays": (STATUS, [_p, _p, _p, _p, _p, _i, _d, c_uint32, _p, _p, _p]),
    "dyn_shape_closest_point": (STATUS, [_ref, _p, _p, _ref]),
    "dyn_shape_sweep": (STATUS, [_ref, _p, _p, _ref, _p, _p, _d, _d, _ref]),
    "dyn_broad_phase_new": (STATUS, [_i, c_int64, _d, _ref]),
    "dyn_broad_phase_free": (None, [_p]),
    "dyn_broad_phase_insert": (STATUS, [_p, _p, _p, _ref]),
    "dyn_broad_phase_update": (STATUS, [_p, _i, _p, _p]),
    "dyn_broad_phase_remove": (STATUS, [_p, _i]),
    "dyn_broad_phase_pairs": (STATUS, [_p, _p, c_int64, _ref]),
    "dyn_broad_phase_query": (STATUS, [_p, _p, _p, _p, _i, _ref]),
    "dyn_broad_phase_ray": (STATUS, [_p, _p, _p, _d, _p, _i, _ref]),
    # the contact problem
    "dyn_contact_problem_init": (None, [_ref]),
    "dyn_contact_options_init": (None, [_ref]),
    "dyn_contact_solver_new": (STATUS, [_i, _ref]),
    "dyn_contact_solver_size": (c_size_t, [_i]),
    "dyn_contact_solver_init": (STATUS, [_i, _p, c_size_t, _ref]),
    "dyn_contact_solver_free": (None, [_p]),
    "dyn_contact_solve": (STATUS, [_p, _ref, _ref, _p, _p, _ref]),
    "dyn_contact_residuals": (STATUS, [_p, _ref, _p, _ref]),
    "dyn_contact_compliance": (STATUS, [_d, _d, _d, _d, _ref, _ref]),
    "dyn_contact_compliance_hertz": (STATUS, [_d, _d, _d, _d, _d, _ref, _ref]),
    "dyn_friction_cone_qp": (STATUS, [_ref, _i, _i, _ref]),
    "dyn_neffects": (_i, []),
    "dyn_effect_info": (STATUS, [_p, _p, _i, _ref]),
    "dyn_actuator_init": (None, [_ref, _i]),
    "dyn_builder_actuator": (STATUS, [_p, _s, _ref, _s]),
    "dyn_builder_gravity_compensation": (STATUS, [_p, _s, _d]),
    "dyn_builder_medium": (STATUS, [_p, _d, _d, _p]),
    "dyn_builder_pair": (STATUS, [_p, _s, _s, _ref]),
    "dyn_nactuators": (_i, [_p]),
    "dyn_nu": (_i, [_p]),
    "dyn_actuator_name": (_s, [_p, _i]),
    "dyn_actuator_id": (_i, [_p, _s]),
    "dyn_actuator_info": (STATUS, [_p, _i, _ref]),
    "dyn_data_set_control": (STATUS, [_p, _p, _p]),
    "dyn_data_apply_wrench": (STATUS, [_p, _p, _i, _p, _p, _i]),
    "dyn_data_clear_wrenches": (STATUS, [_p, _p]),
    "dyn_data_set_gravity": (STATUS, [_p, _p, _p]),
    "dyn_step_options_init": (None, [_ref]),
    "dyn_data_set_step_options": (STATUS, [_p, _p, _ref]),
    "dyn_data_step_options": (STATUS, [_p, _p, _ref]),
    "dyn_step": (STATUS, [_p, _p]),
    "dyn_state_size": (c_size_t, [_p]),
    "dyn_state_save": (STATUS, [_p, _p, _ref, c_size_t]),
    "dyn_state_restore": (STATUS, [_p, _p, _ref, c_size_t]),
    "dyn_data_ledger": (STATUS, [_p, _p, _ref]),
    "dyn_step_contacts": (STATUS, [_p, _p, _ref, _i, _ref]),
    "dyn_data_set_shape_material": (STATUS, [_p, _p, _i, _ref]),
    "dyn_data_shape_material": (STATUS, [_p, _p, _i, _ref]),
    "dyn_advance": (STATUS, [_p, _p, _d]),
    "dyn_data_step_report": (STATUS, [_p, _p, _ref]),
    # meshes
    "dyn_mesh_options_init": (None, [_ref]),
    "dyn_mesh_load": (STATUS, [_s, _ref, _ref]),
    "dyn_mesh_from_arrays": (STATUS, [_p, c_size_t, _p, c_size_t, _ref]),
    "dyn_mesh_free": (None, [_p]),
    "dyn_mesh_info": (STATUS, [_p, _ref]),
    "dyn_mesh_arrays": (STATUS, [_p, _ref]),
    "dyn_mesh_hull": (STATUS, [_p, _ref]),
    # batches
    "dyn_batch_new": (STATUS, [_p, c_uint32, _i, _ref]),
    "dyn_batch_free": (None, [_p]),
    "dyn_batch_set_effects": (STATUS, [_p, _i, c_uint32]),
    "dyn_batch_arrays_init": (None, [_ref]),
    "dyn_batch_run": (STATUS, [_p, _i, c_int64, _ref]),
    "dyn_batch_info": (STATUS, [_p, _i, _ref]),
}  # fmt: skip
