"""Data, and what is computed of a state."""

from __future__ import annotations

from ctypes import c_char_p, c_int32, c_size_t, c_uint32, c_uint64

from .common import STATUS, Grown, i, p, ref, s


class FieldInfo(Grown):
    _fields_ = [
        ("struct_size", c_uint32), ("name", c_char_p), ("shape", c_char_p), ("unit", c_char_p), ("frame", c_char_p),
        ("producer", c_char_p), ("sentence", c_char_p), ("part", c_uint32), ("reserved", c_int32),
    ]  # fmt: skip


class EffectInfo(Grown):
    _fields_ = [("struct_size", c_uint32), ("name", c_char_p), ("present", c_int32), ("acting", c_int32), ("bytes", c_uint64)]


SIGNATURES: dict[str, tuple] = {
    # data
    "dyn_data_new": (STATUS, [p, c_uint32, ref]),
    "dyn_data_size": (c_size_t, [p, c_uint32]),
    "dyn_data_init": (STATUS, [p, c_uint32, p, c_size_t, ref]),
    "dyn_data_free": (None, [p]),
    "dyn_data_warm_up": (STATUS, [p, p]),
    "dyn_data_set_state": (STATUS, [p, p, p, p, p, p]),
    "dyn_data_set_effects": (STATUS, [p, p, i, c_uint32]),
    "dyn_data_effects": (STATUS, [p, p, i, ref]),
    "dyn_field_count": (i, []),
    "dyn_field_info": (STATUS, [c_int32, ref]),
    "dyn_field_id": (c_int32, [s]),
    "dyn_data_array": (STATUS, [p, p, c_int32, ref]),
    "dyn_effect_count": (i, []),
    "dyn_data_effect_info": (STATUS, [p, p, i, ref]),
    # kinematics
    "dyn_forward_kinematics": (STATUS, [p, p, p, p, p]),
    "dyn_frame_placement": (STATUS, [p, p, i, p]),
    "dyn_frame_placements": (STATUS, [p, p, p]),
    "dyn_frame_velocity": (STATUS, [p, p, i, i, p]),
    "dyn_frame_acceleration": (STATUS, [p, p, i, i, p]),
    "dyn_frame_classical_acceleration": (STATUS, [p, p, i, i, p]),
    "dyn_joint_jacobians": (STATUS, [p, p, p, p]),
    "dyn_joint_jacobians_time_variation": (STATUS, [p, p, p, p, p]),
    "dyn_frame_jacobian": (STATUS, [p, p, i, i, p]),
    "dyn_frame_jacobian_time_variation": (STATUS, [p, p, i, i, p]),
    "dyn_frame_velocity_derivatives": (STATUS, [p, p, i, i, p, p]),
    "dyn_frame_acceleration_derivatives": (STATUS, [p, p, i, i, p, p, p]),
    "dyn_frame_classical_acceleration_derivatives": (STATUS, [p, p, i, i, p, p, p]),
    "dyn_frame_kinematic_hessian": (STATUS, [p, p, i, i, p]),
    # centre of mass
    "dyn_com": (STATUS, [p, p, p, p, p, p, p, p]),
    "dyn_jcom": (STATUS, [p, p, p, p]),
    "dyn_vcom_derivatives": (STATUS, [p, p, p, p, p, p]),
    "dyn_subtree_com": (STATUS, [p, p, i, p, p]),
    "dyn_subtree_jcom": (STATUS, [p, p, i, p]),
    # dynamics
    "dyn_rnea": (STATUS, [p, p, p, p, p, p, p]),
    "dyn_nle": (STATUS, [p, p, p, p, p]),
    "dyn_gravity_torque": (STATUS, [p, p, p, p]),
    "dyn_static_torque": (STATUS, [p, p, p, p, p]),
    "dyn_coriolis_matrix": (STATUS, [p, p, p, p, p]),
    "dyn_aba": (STATUS, [p, p, p, p, p, p, p]),
    "dyn_crba": (STATUS, [p, p, p, p]),
    "dyn_cholesky": (STATUS, [p, p]),
    "dyn_cholesky_solve": (STATUS, [p, p, p, i, p]),
    "dyn_minv": (STATUS, [p, p, p, p]),
    "dyn_rnea_derivatives": (STATUS, [p, p, p, p, p, p, p, p]),
    "dyn_aba_derivatives": (STATUS, [p, p, p, p, p, p, p, p, p]),
    "dyn_gravity_torque_derivatives": (STATUS, [p, p, p, p]),
    "dyn_static_torque_derivatives": (STATUS, [p, p, p, p, p]),
    "dyn_rnea_second_order_product": (STATUS, [p] * 11),
    "dyn_rnea_second_order_derivatives": (STATUS, [p] * 10),
    "dyn_energy": (STATUS, [p, p, p, p, p, p]),
    "dyn_kinetic_energy": (STATUS, [p, p, p, p, p]),
    "dyn_potential_energy": (STATUS, [p, p, p, p]),
    "dyn_all_terms": (STATUS, [p, p, c_uint32, p, p, ref]),
    # centroidal
    "dyn_centroidal_map": (STATUS, [p, p, p, p, p, p, p]),
    "dyn_centroidal_map_time_variation": (STATUS, [p, p, p, p, p]),
    "dyn_centroidal_momentum": (STATUS, [p, p, p, p, p]),
    "dyn_centroidal_momentum_time_variation": (STATUS, [p, p, p, p, p, p]),
    "dyn_centroidal_derivatives": (STATUS, [p, p, p, p, p, p, p, p, p]),
    # identification
    "dyn_model_inertial_parameters": (STATUS, [p, p]),
    "dyn_joint_torque_regressor": (STATUS, [p, p, p, p, p, p]),
    "dyn_static_regressor": (STATUS, [p, p, p, p]),
    "dyn_kinetic_energy_regressor": (STATUS, [p, p, p, p, p]),
    "dyn_potential_energy_regressor": (STATUS, [p, p, p, p]),
    "dyn_joint_body_regressor": (STATUS, [p, p, i, p]),
    "dyn_frame_body_regressor": (STATUS, [p, p, i, p]),
    "dyn_body_regressor": (STATUS, [p, p, p]),
    "dyn_pseudo_inertia_from_parameters": (STATUS, [p, p]),
    "dyn_parameters_from_pseudo_inertia": (STATUS, [p, p]),
    "dyn_log_cholesky_from_parameters": (STATUS, [p, p]),
    "dyn_parameters_from_log_cholesky": (STATUS, [p, p]),
    "dyn_log_cholesky_jacobian": (STATUS, [p, p]),
    "dyn_is_physically_consistent": (STATUS, [p, ref]),
}  # fmt: skip
