// Every function that takes a model alone, with what tells that it refused a handle.
#pragma once

#include <functional>
#include <utility>

#include "capi/calls.hpp"

namespace dyn_test {

// The functions of a model alone: each says whether it refused this handle, with nothing written.
using ModelFunction = std::pair<const char*, std::function<bool(const dynModel*)>>;
inline double out[64];
inline bool kept() {
  for (double x : out)
    if (x != 1.5) return false;
  return true;
}
template <class Info>
bool keeps(dynStatus (*call)(const dynModel*, int, Info*), const dynModel* m, dynStatus expected) {
  Info info, before;
  std::memset(static_cast<void*>(&info), 0x3c, sizeof info), std::memset(static_cast<void*>(&before), 0x3c, sizeof before);
  info.struct_size = before.struct_size = sizeof info;
  return call(m, 0, &info) == expected && std::memcmp(&info, &before, sizeof info) == 0;
}
inline const ModelFunction model_functions[] = {
    {"dyn_model_report_count", [](auto* m) { return dyn_model_report_count(m) == -1; }},
    {"dyn_model_report_entry", [](auto* m) { return keeps(dyn_model_report_entry, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_save", [](auto* m) { return dyn_model_save(m, "/nowhere/m.urdf", nullptr) == DYN_ERROR_HANDLE; }},
    {"dyn_model_save_memory",
     [](auto* m) {
       size_t size = 7;
       return dyn_model_save_memory(m, DYN_FORMAT_URDF, nullptr, nullptr, 0, &size) == DYN_ERROR_HANDLE && size == 7;
     }},
    {"dyn_model_image",
     [](auto* m) {
       size_t size = 7;
       return dyn_model_image(m, 0, nullptr, 0, &size) == DYN_ERROR_HANDLE && size == 7;
     }},
    {"dyn_model_shape_rgba", [](auto* m) { return dyn_model_shape_rgba(m, 0, out) == DYN_ERROR_HANDLE; }},
    {"dyn_model_shape_mesh",
     [](auto* m) {
       dynMesh* mesh = nullptr;
       return dyn_model_shape_mesh(m, 0, &mesh) == DYN_ERROR_HANDLE && !mesh;
     }},
    {"dyn_model_nq", [](auto* m) { return dyn_model_nq(m) == -1; }},
    {"dyn_model_nv", [](auto* m) { return dyn_model_nv(m) == -1; }},
    {"dyn_model_njoints", [](auto* m) { return dyn_model_njoints(m) == -1; }},
    {"dyn_model_nframes", [](auto* m) { return dyn_model_nframes(m) == -1; }},
    {"dyn_model_nbodies", [](auto* m) { return dyn_model_nbodies(m) == -1; }},
    {"dyn_model_size", [](auto* m) { return dyn_model_size(m) == 0; }},
    {"dyn_model_name", [](auto* m) { return dyn_model_name(m) == nullptr; }},
    {"dyn_model_joint_name", [](auto* m) { return dyn_model_joint_name(m, 0) == nullptr; }},
    {"dyn_model_frame_name", [](auto* m) { return dyn_model_frame_name(m, 0) == nullptr; }},
    {"dyn_model_joint_id", [](auto* m) { return dyn_model_joint_id(m, "universe") == -1; }},
    {"dyn_model_frame_id", [](auto* m) { return dyn_model_frame_id(m, "universe") == -1; }},
    {"dyn_model_frame_id_of_type",
     [](auto* m) { return dyn_model_frame_id_of_type(m, "universe", DYN_FRAME_TYPE_OP_FRAME) == -1; }},
    {"dyn_model_joint_info", [](auto* m) { return keeps(dyn_model_joint_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_frame_info", [](auto* m) { return keeps(dyn_model_frame_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_nmocaps", [](auto* m) { return dyn_model_nmocaps(m) == -1; }},
    {"dyn_model_mocap_id", [](auto* m) { return dyn_model_mocap_id(m, "b") == -1; }},
    {"dyn_model_mocap_frame", [](auto* m) { return dyn_model_mocap_frame(m, 0) == -1; }},
    {"dyn_model_ntendons", [](auto* m) { return dyn_model_ntendons(m) == -1; }},
    {"dyn_model_tendon_name", [](auto* m) { return dyn_model_tendon_name(m, 0) == nullptr; }},
    {"dyn_model_tendon_id", [](auto* m) { return dyn_model_tendon_id(m, "t") == -1; }},
    {"dyn_model_tendon_info", [](auto* m) { return keeps(dyn_model_tendon_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_tendon_element",
     [](auto* m) {
       dynTendonElement e;
       dyn_tendon_element_init(&e, DYN_TENDON_ELEMENT_TYPE_SITE);
       return dyn_model_tendon_element(m, 0, 0, &e) == DYN_ERROR_HANDLE && e.value == 1;
     }},
    {"dyn_model_nsensors", [](auto* m) { return dyn_model_nsensors(m) == -1; }},
    {"dyn_model_nsensordata", [](auto* m) { return dyn_model_nsensordata(m) == -1; }},
    {"dyn_model_sensor_name", [](auto* m) { return dyn_model_sensor_name(m, 0) == nullptr; }},
    {"dyn_model_sensor_id", [](auto* m) { return dyn_model_sensor_id(m, "s") == -1; }},
    {"dyn_model_sensor_info", [](auto* m) { return keeps(dyn_model_sensor_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_sensor_noise",
     [](auto* m) {
       double x = 1;
       return dyn_sensor_noise(m, 0, 0, &x) == DYN_ERROR_HANDLE && x == 1;
     }},
    {"dyn_sensor_delay",
     [](auto* m) {
       double t = 0, x = 1;
       return dyn_sensor_delay(m, &t, &x, 1, 0, &x) == DYN_ERROR_HANDLE && x == 1;
     }},
    {"dyn_model_nforce_limits", [](auto* m) { return dyn_model_nforce_limits(m) == -1; }},
    {"dyn_model_force_limit_info", [](auto* m) { return keeps(dyn_model_force_limit_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_nshapes", [](auto* m) { return dyn_model_nshapes(m) == -1; }},
    {"dyn_model_shape_info", [](auto* m) { return keeps(dyn_model_shape_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_ndisabled_pairs", [](auto* m) { return dyn_model_ndisabled_pairs(m) == -1; }},
    {"dyn_model_disabled_pair",
     [](auto* m) {
       int a = -7, b = -7;
       const char* reason = nullptr;
       return dyn_model_disabled_pair(m, 0, &a, &b, &reason) == DYN_ERROR_HANDLE && a == -7 && b == -7 && !reason;
     }},
    {"dyn_model_array", [](auto* m) { return dyn_model_array(m, DYN_MODEL_ARRAY_GRAVITY) == nullptr; }},
    {"dyn_model_total_mass", [](auto* m) { return std::isnan(dyn_model_total_mass(m)); }},
    {"dyn_model_nconfigurations", [](auto* m) { return dyn_model_nconfigurations(m) == -1; }},
    {"dyn_model_configuration_name", [](auto* m) { return dyn_model_configuration_name(m, 0) == nullptr; }},
    {"dyn_model_initial_configuration", [](auto* m) { return dyn_model_initial_configuration(m) == -1; }},
    {"dyn_model_step_options",
     [](auto* m) {
       dynStepOptions o;
       dyn_step_options_init(&o);
       return dyn_model_step_options(m, &o) == DYN_ERROR_HANDLE && o.dt == 1e-3;
     }},
    {"dyn_model_configuration", [](auto* m) { return dyn_model_configuration(m, "neutral", out) == DYN_ERROR_HANDLE; }},
    {"dyn_model_q_permutation",
     [](auto* m) {
       const char* names[] = {"j0"};
       std::int32_t ids[2] = {-7, -7};
       return dyn_model_q_permutation(m, names, 1, ids, ids + 1) == DYN_ERROR_HANDLE && ids[0] == -7 && ids[1] == -7;
     }},
    {"dyn_builder_from_model",
     [](auto* m) {
       dynBuilder* b = nullptr;
       return dyn_builder_from_model(m, &b) == DYN_ERROR_HANDLE && !b;
     }},
    {"dyn_builder_attach",
     [](auto* m) {
       const Builder b;
       return dyn_builder_attach(b, m, "", nullptr) == DYN_ERROR_HANDLE;
     }},
    {"dyn_model_nconstraints", [](auto* m) { return dyn_model_nconstraints(m) == -1; }},
    {"dyn_model_nconstraint_slots", [](auto* m) { return dyn_model_nconstraint_slots(m) == -1; }},
    {"dyn_model_contact_capacity", [](auto* m) { return dyn_model_contact_capacity(m) == -1; }},
    {"dyn_model_constraint_name", [](auto* m) { return dyn_model_constraint_name(m, 0) == nullptr; }},
    {"dyn_model_constraint_id", [](auto* m) { return dyn_model_constraint_id(m, "loop") == -1; }},
    {"dyn_model_constraint_info", [](auto* m) { return keeps(dyn_model_constraint_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_nactuators", [](auto* m) { return dyn_model_nactuators(m) == -1; }},
    {"dyn_model_nu", [](auto* m) { return dyn_model_nu(m) == -1; }},
    {"dyn_model_actuator_name", [](auto* m) { return dyn_model_actuator_name(m, 0) == nullptr; }},
    {"dyn_model_actuator_id", [](auto* m) { return dyn_model_actuator_id(m, "drive") == -1; }},
    {"dyn_model_actuator_info", [](auto* m) { return keeps(dyn_model_actuator_info, m, DYN_ERROR_HANDLE); }},
    {"dyn_model_npairs", [](auto* m) { return dyn_model_npairs(m) == -1; }},
    {"dyn_model_pair", [](auto* m) { return dyn_model_pair(m, 0, nullptr, nullptr, nullptr) == DYN_ERROR_HANDLE; }},
    {"dyn_data_new",
     [](auto* m) {
       dynData* d = nullptr;
       return dyn_data_new(m, 0, &d) == DYN_ERROR_HANDLE && !d;
     }},
    {"dyn_data_size", [](auto* m) { return dyn_data_size(m, 0) == 0; }},
    {"dyn_data_init",
     [](auto* m) {
       dynData* d = nullptr;
       return dyn_data_init(m, 0, out, sizeof out, &d) == DYN_ERROR_HANDLE && !d;
     }},
    {"dyn_integrate", [](auto* m) { return dyn_integrate(m, out, out, out) == DYN_ERROR_HANDLE; }},
    {"dyn_difference", [](auto* m) { return dyn_difference(m, out, out, out) == DYN_ERROR_HANDLE; }},
    {"dyn_interpolate", [](auto* m) { return dyn_interpolate(m, out, out, 0.5, out) == DYN_ERROR_HANDLE; }},
    {"dyn_configuration_distance", [](auto* m) { return dyn_configuration_distance(m, out, out, out) == DYN_ERROR_HANDLE; }},
    {"dyn_configuration_neutral", [](auto* m) { return dyn_configuration_neutral(m, out) == DYN_ERROR_HANDLE; }},
    {"dyn_configuration_random",
     [](auto* m) { return dyn_configuration_random(m, 1, nullptr, nullptr, out) == DYN_ERROR_HANDLE; }},
    {"dyn_configuration_normalize", [](auto* m) { return dyn_configuration_normalize(m, out) == DYN_ERROR_HANDLE; }},
    {"dyn_configuration_is_normalized",
     [](auto* m) {
       int answer = -7;
       return dyn_configuration_is_normalized(m, out, 1e-6, &answer) == DYN_ERROR_HANDLE && answer == -7;
     }},
    {"dyn_integrate_jacobians", [](auto* m) { return dyn_integrate_jacobians(m, out, out, out, out) == DYN_ERROR_HANDLE; }},
    {"dyn_model_inertial_parameters", [](auto* m) { return dyn_model_inertial_parameters(m, out) == DYN_ERROR_HANDLE; }},
    {"dyn_difference_jacobians", [](auto* m) { return dyn_difference_jacobians(m, out, out, out, out) == DYN_ERROR_HANDLE; }},
    {"dyn_state_layout_sizes",
     [](auto* m) {
       int n[2] = {-7, -7};
       dynStateLayout layout;
       dyn_state_layout_init(&layout);
       return dyn_state_layout_sizes(m, &layout, n, n + 1) == DYN_ERROR_HANDLE && n[0] == -7 && n[1] == -7;
     }},
    {"dyn_state_layout_convert",
     [](auto* m) {
       dynStateLayout layout;
       dyn_state_layout_init(&layout);
       return dyn_state_layout_convert(m, &layout, DYN_DIRECTION_TO_PEER, with<dynStateInput>({0, out, out, out, out}),
                                       with<dynStateOutput>({0, out, out, out, out})) == DYN_ERROR_HANDLE;
     }},
};

}  // namespace dyn_test
