"""The contact problem."""

from __future__ import annotations

from ctypes import c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p

from .common import STATUS, Grown, d, i, p, ref


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


SIGNATURES: dict[str, tuple] = {
    "dyn_contact_problem_init": (None, [ref]),
    "dyn_contact_options_init": (None, [ref]),
    "dyn_contact_solver_new": (STATUS, [i, ref]),
    "dyn_contact_solver_size": (c_size_t, [i]),
    "dyn_contact_solver_init": (STATUS, [i, p, c_size_t, ref]),
    "dyn_contact_solver_free": (None, [p]),
    "dyn_contact_solver_solve": (STATUS, [p, ref, ref, p, p, ref]),
    "dyn_contact_solver_residuals": (STATUS, [p, ref, p, ref]),
    "dyn_contact_compliance": (STATUS, [d, d, d, d, ref, ref]),
    "dyn_contact_compliance_hertz": (STATUS, [d, d, d, d, d, ref, ref]),
    "dyn_contact_problem_qp": (STATUS, [ref, i, i, ref]),
}  # fmt: skip
