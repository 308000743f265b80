"""Constraints."""

from __future__ import annotations

from ctypes import Structure, c_double, c_int, c_int32, c_uint32, c_void_p

from .common import STATUS, Grown, i, p, ref, s


class Constraint(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("type", c_int), ("first", c_int32), ("second", c_int32), ("placement1", c_double * 12),
        ("placement2", c_double * 12), ("joint_type", c_int), ("axis", c_double * 3), ("axis2", c_double * 3), ("pitch", c_double),
        ("length", c_double), ("coefficients", c_double * 5), ("force", c_double), ("stiffness", c_double), ("damping", c_double),
        ("restitution", c_double), ("enabled", c_int32), ("reserved", c_int32),
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


SIGNATURES: dict[str, tuple] = {
    "dyn_constraint_init": (None, [ref, i]),
    "dyn_model_contact_capacity": (i, [p]),
    "dyn_model_nconstraints": (i, [p]),
    "dyn_model_nconstraint_slots": (i, [p]),
    "dyn_model_constraint_name": (s, [p, i]),
    "dyn_model_constraint_id": (i, [p, s]),
    "dyn_model_constraint_info": (STATUS, [p, i, ref]),
    "dyn_data_set_constraint": (STATUS, [p, p, i, ref]),
    "dyn_data_constraint": (STATUS, [p, p, i, ref]),
    "dyn_data_set_constraint_enabled": (STATUS, [p, p, i, i]),
    "dyn_data_anchor_constraint": (STATUS, [p, p, i, p]),
    "dyn_data_constraint_rows": (STATUS, [p, p, i, ref, ref]),
    "dyn_constraint_terms": (STATUS, [p, p, p, p, p, p, p, p]),
    "dyn_constraint_options_init": (None, [ref]),
    "dyn_constrained_dynamics": (STATUS, [p, p, p, p, p, p, ref, p, p, ref]),
    "dyn_constrained_inverse_dynamics": (STATUS, [p, p, p, p, p, p, p, p, p, ref]),
    "dyn_constraint_impulse": (STATUS, [p, p, p, p, ref, p, p, ref]),
    "dyn_project_options_init": (None, [ref]),
    "dyn_project": (STATUS, [p, p, p, p, ref, p, p, ref]),
    "dyn_delassus": (STATUS, [p, p, p, p]),
    "dyn_delassus_factor": (STATUS, [p, p, p, p, p]),
    "dyn_delassus_times": (STATUS, [p, p, p, p, p]),
    "dyn_delassus_solve": (STATUS, [p, p, p, c_double, p, p]),
    "dyn_constrained_dynamics_derivatives": (STATUS, [p, p, p, p, p, p, ref, ref, ref]),
    "dyn_constraint_impulse_derivatives": (STATUS, [p, p, p, p, ref, ref, ref]),
    "dyn_constraint_report": (STATUS, [p, p, p, ref, p, i]),
}  # fmt: skip
