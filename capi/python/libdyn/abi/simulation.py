"""Steps, actuators, what acts from outside."""

from __future__ import annotations

from ctypes import Structure, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32

from .collision import Contact
from .common import STATUS, Grown, d, i, p, ref


class Actuator(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("type", c_int), ("joint", c_int32), ("component", c_int32), ("gear", c_double), ("kp", c_double),
        ("kv", c_double), ("gain", c_double), ("bias", c_double * 3), ("time_constant", c_double), ("control_range", c_double * 2),
        ("force_range", c_double * 2), ("idx_u", c_int32), ("controls", c_int32),
        ("act_range", c_double * 2), ("integrates", c_int32), ("idx_act", c_int32),
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


SIGNATURES: dict[str, tuple] = {
    "dyn_actuator_init": (None, [ref, i]),
    "dyn_data_set_control": (STATUS, [p, p, p]),
    "dyn_data_apply_wrench": (STATUS, [p, p, i, p, p, i]),
    "dyn_data_clear_wrenches": (STATUS, [p, p]),
    "dyn_data_set_gravity": (STATUS, [p, p, p]),
    "dyn_step_options_init": (None, [ref]),
    "dyn_data_set_step_options": (STATUS, [p, p, ref]),
    "dyn_data_step_options": (STATUS, [p, p, ref]),
    "dyn_step": (STATUS, [p, p]),
    "dyn_model_state_size": (c_size_t, [p]),
    "dyn_data_save_state": (STATUS, [p, p, ref, c_size_t]),
    "dyn_data_restore_state": (STATUS, [p, p, ref, c_size_t]),
    "dyn_data_ledger": (STATUS, [p, p, ref]),
    "dyn_data_step_contacts": (STATUS, [p, p, ref, i, ref]),
    "dyn_data_set_shape_material": (STATUS, [p, p, i, ref]),
    "dyn_data_shape_material": (STATUS, [p, p, i, ref]),
    "dyn_advance": (STATUS, [p, p, d]),
    "dyn_data_step_report": (STATUS, [p, p, ref]),
}  # fmt: skip
