// Tests handles: NULL, freed, foreign and mismatched ones are refused by every function of dyn.h, and nothing changes.
#include <fstream>
#include <set>
#include <sstream>

#include "capi/model_functions.hpp"

namespace dyn_test::handles_test {
namespace {

struct Refusal {
  const dynModel* model;
  dynData* data;
  dynStatus status;
  std::vector<std::string> fragments;
};

// Memory that is none of the library's.
alignas(64) unsigned char zeros[256], noise[256];

TEST(Handles, EveryCallOnData) {
  const Model m = all_types(), other = chain(3);
  const State s = random_state(m, 1);
  Data mine(m), others(other);
  compute_all(m, mine, s);
  Model dead_model = chain(2);
  dynModel* const freed_model = dead_model;
  dead_model = Model();
  Data orphan(other);
  dynData* freed_data = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, 0, &freed_data));
  dyn_data_free(freed_data);
  Builder builder;
  std::memset(noise, 0x5a, sizeof noise);
  auto as_model = [](void* p) { return static_cast<const dynModel*>(p); };
  auto as_data = [](void* p) { return static_cast<dynData*>(p); };

  const std::vector<Refusal> refusals = {
      {nullptr, mine, DYN_ERROR_HANDLE, {"model", "NULL", "dyn_model_load"}},
      {freed_model, mine, DYN_ERROR_HANDLE, {"model", "freed"}},
      {as_model(mine.d), mine, DYN_ERROR_HANDLE, {"model", "no handle", "dyn_model_load"}},
      {as_model(builder.b), mine, DYN_ERROR_HANDLE, {"model", "no handle"}},
      {as_model(zeros), mine, DYN_ERROR_HANDLE, {"model", "no handle"}},
      {as_model(noise), mine, DYN_ERROR_HANDLE, {"model", "no handle"}},
      {nullptr, nullptr, DYN_ERROR_HANDLE, {"model", "NULL"}},
      {m, nullptr, DYN_ERROR_HANDLE, {"data", "NULL", "dyn_data_new"}},
      {m, freed_data, DYN_ERROR_HANDLE, {"data", "freed"}},
      {m, as_data(m.m), DYN_ERROR_HANDLE, {"data", "no handle", "dyn_data_new"}},
      {m, as_data(builder.b), DYN_ERROR_HANDLE, {"data", "no handle"}},
      {m, as_data(zeros), DYN_ERROR_HANDLE, {"data", "no handle"}},
      {m, as_data(noise), DYN_ERROR_HANDLE, {"data", "no handle"}},
      {m, others, DYN_ERROR_MODEL, {"another model", "make data from the model"}},
      {other, mine, DYN_ERROR_MODEL, {"another model"}},
  };
  const Snapshot before(m, mine);
  for (const CallRow& row : call_rows) {
    Prepared p(row, m, s);
    for (const Refusal& r : refusals) {
      EXPECT_EQ(r.status, p(r.model, r.data)) << row.name << ": " << r.fragments[0] << " " << r.fragments.back();
      EXPECT_TRUE(says(r.fragments)) << row.name;
      EXPECT_TRUE(p.untouched()) << row.name;
    }
  }
  EXPECT_EQ("", before.differs(Snapshot(m, mine)));
}

TEST(Handles, DataOutlivesItsModel) {
  Model m = chain(3);
  const Model next = chain(3);  // alike, but another
  Data d(m);
  const State s = random_state(m, 2);
  dynModel* const dead = m;
  m = Model();
  for (const CallRow& row : call_rows) {
    Prepared p(row, next, s);
    EXPECT_EQ(DYN_ERROR_MODEL, p(next, d)) << row.name;
    EXPECT_TRUE(says({"freed", "make data from the model"})) << row.name;
    EXPECT_EQ(DYN_ERROR_HANDLE, p(dead, d)) << row.name;
    EXPECT_TRUE(says({"freed"})) << row.name;
    EXPECT_TRUE(p.untouched()) << row.name;
  }
}

TEST(Handles, EveryFunctionOfAModel) {
  dynModel* const freed_model = chain(1).m;  // the temporary is gone
  const Model alive = chain(1);
  Data d(alive);
  Builder builder;
  void* const handles[] = {nullptr, freed_model, d.d, builder.b, zeros, noise};
  std::fill(std::begin(out), std::end(out), 1.5);
  for (const auto& [name, refuses] : model_functions)
    for (void* handle : handles) {
      EXPECT_TRUE(refuses(static_cast<dynModel*>(handle))) << name << (handle ? "" : " NULL");
      EXPECT_TRUE(says({"model", !handle ? "dyn_builder_finish" : handle == freed_model ? "freed" : "no handle"})) << name;
      EXPECT_TRUE(kept()) << name;
    }
}

TEST(Handles, EveryFunctionOfABuilder) {
  dynBuilder* freed_builder = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_new("b", &freed_builder));
  dyn_builder_free(freed_builder);
  const Model m = chain(1);
  Data d(m);
  const Spec spec("j", DYN_JOINT_TYPE_REVOLUTE);
  const double gravity[3] = {0, 0, -1}, com[3] = {}, q[1] = {};
  for (void* handle : {static_cast<void*>(nullptr), static_cast<void*>(freed_builder), static_cast<void*>(m.m),
                       static_cast<void*>(d.d), static_cast<void*>(zeros)}) {
    dynBuilder* b = static_cast<dynBuilder*>(handle);
    const std::string word = !handle ? "dyn_builder_new" : handle == freed_builder ? "freed" : "no handle";
    auto refused = [&](dynStatus s) {
      EXPECT_EQ(DYN_ERROR_HANDLE, s);
      EXPECT_TRUE(says({"builder", word}));
    };
    refused(dyn_builder_set_gravity(b, gravity));
    dynParameter parameter{};
    parameter.struct_size = sizeof parameter;
    EXPECT_EQ(-1, dyn_builder_parameter_count(b));
    refused(dyn_builder_parameter(b, 0, &parameter));
    refused(dyn_builder_set_parameter(b, 0, gravity, 3));
    refused(dyn_builder_add_joint(b, &spec));
    refused(dyn_builder_add_body(b, "l", "j", nullptr, 1, com, some_inertia));
    refused(dyn_builder_add_frame(b, "f", nullptr, nullptr, DYN_FRAME_TYPE_OP_FRAME));
    refused(dyn_builder_add_configuration(b, "c", q, 1));
    const char* joint = "j";
    refused(dyn_builder_lock(b, &joint, 1, q, 1));
    refused(dyn_builder_attach(b, m, "x", nullptr));
    refused(dyn_builder_keep_subtree(b, joint));
    refused(dyn_builder_remove_subtree(b, joint));
    dynActuator motor;
    dyn_actuator_init(&motor, DYN_ACTUATOR_TYPE_MOTOR);
    refused(dyn_builder_add_actuator(b, "m", &motor, joint));
    refused(dyn_builder_set_gravity_compensation(b, "l", 1));
    refused(dyn_builder_set_mocap(b, "l"));
    refused(dyn_builder_set_medium(b, 1, 0, nullptr));
    refused(dyn_builder_add_pair(b, "x", "y", nullptr));
    const double red[4] = {1, 0, 0, 1};
    refused(dyn_builder_set_shape_rgba(b, red));
    refused(dyn_builder_set_shape_fluid(b, nullptr, nullptr, nullptr));
    dynModel* none = nullptr;
    refused(dyn_builder_finish(b, &none));
    EXPECT_EQ(nullptr, none);
  }
}

TEST(Handles, FreeingTwiceAndNothing) {
  dyn_model_free(nullptr), dyn_data_free(nullptr), dyn_builder_free(nullptr);
  Builder b;
  dynModel* m = chain(1).m;  // freed already
  dyn_model_free(m), dyn_model_free(m);
  dynBuilder* builder = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_new("b", &builder));
  dyn_builder_free(builder), dyn_builder_free(builder);
  const Model alive = chain(1);
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(alive, 0, &d));
  dyn_data_free(d), dyn_data_free(d);
  // another kind of handle is left alone
  Data kept(alive);
  dyn_model_free(reinterpret_cast<dynModel*>(kept.d)), dyn_builder_free(reinterpret_cast<dynBuilder*>(kept.d));
  dyn_data_free(reinterpret_cast<dynData*>(alive.m));
  EXPECT_EQ(DYN_OK, dyn_crba(alive, kept, nullptr, nullptr));
}

// Freed handles are refused while a million others are made and freed.
TEST(Handles, FreedOnesAreRemembered) {
  const Model m = chain(1);
  dynData* data = nullptr;
  dynBuilder* builder = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, 0, &data));
  ASSERT_EQ(DYN_OK, dyn_builder_new("b", &builder));
  dyn_data_free(data), dyn_builder_free(builder);
  const int most = sanitized ? 20000 : 1000000;
  for (int k = 0; k < most; ++k) {
    dynBuilder* b = nullptr;
    ASSERT_EQ(DYN_OK, dyn_builder_new("b", &b));
    ASSERT_NE(builder, b);
    dyn_builder_free(b);
    ASSERT_TRUE(k % 1024 || dyn_builder_set_constraint_slots(builder, 1) == DYN_ERROR_HANDLE) << k;
  }
  for (int k = 0; k < 5000; ++k) {
    Data d(m, DYN_PART_KINEMATICS);
    ASSERT_NE(data, d.d);
  }
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_crba(m, data, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_builder_set_constraint_slots(builder, 1));
  EXPECT_TRUE(says({"builder", "freed"}));
}

// The tables of these tests and the header name the same functions.
TEST(Handles, TablesAreComplete) {
  std::ifstream file(std::string(DYN_MODELS_DIR) + "/../include/dyn.h");
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  const std::string header = text.str();
  std::set<std::string> declared,
      tested = {
          // no handle, or a maker or a destroyer of one: tested by name elsewhere
          "dyn_status_name", "dyn_last_error", "dyn_version", "dyn_build_info", "dyn_load_options_init", "dyn_ik_task_init",
          "dyn_ik_options_init", "dyn_model_load", "dyn_model_load_string", "dyn_model_from_buffer", "dyn_model_free",
          "dyn_joint_spec_init", "dyn_builder_new", "dyn_builder_free", "dyn_builder_set_gravity", "dyn_builder_add_joint",
          "dyn_builder_parameter_count", "dyn_builder_parameter", "dyn_builder_set_parameter",
          "dyn_builder_add_body", "dyn_builder_add_frame", "dyn_builder_add_configuration", "dyn_builder_finish", "dyn_data_free",
          "dyn_builder_set_shape_rgba", "dyn_builder_set_shape_fluid", "dyn_builder_lock", "dyn_builder_keep_subtree",
          "dyn_builder_remove_subtree",
          "dyn_effect_count", "dyn_data_effect_info", "dyn_field_count", "dyn_field_info", "dyn_field_id",
          "dyn_state_layout_init",
          // structs_test.cpp
          "dyn_save_options_init", "dyn_centroidal_derivatives_init", "dyn_second_order_derivatives_init",
          "dyn_aba_derivatives_init", "dyn_state_input_init", "dyn_state_output_init", "dyn_ik_output_init",
          "dyn_constrained_output_init",
          "dyn_constraint_derivatives_init", "dyn_geometry_pair_init", "dyn_rays_init", "dyn_qp_init", "dyn_height_field_init",
          // numbers alone: inertial_parameters_test.cpp
          "dyn_body_regressor", "dyn_pseudo_inertia_from_parameters", "dyn_parameters_from_pseudo_inertia",
          "dyn_log_cholesky_from_parameters", "dyn_parameters_from_log_cholesky", "dyn_log_cholesky_jacobian",
          "dyn_is_physically_consistent",
          // collision_test.cpp
          "dyn_geometry_init", "dyn_shape_spec_init", "dyn_builder_add_shape", "dyn_geometry_distance",
          "dyn_distance_options_init", "dyn_data_pair", "dyn_data_set_pair", "dyn_pair_distance", "dyn_distance_gradients",
          // contact_test.cpp
          "dyn_geometry_contacts", "dyn_geometry_ray", "dyn_geometry_closest_point", "dyn_geometry_sweep",
          "dyn_data_set_shape_masks", "dyn_data_shape_masks",
          // broad_phase_test.cpp
          "dyn_broad_phase_new", "dyn_broad_phase_free", "dyn_broad_phase_insert", "dyn_broad_phase_update",
          "dyn_broad_phase_remove", "dyn_broad_phase_pairs", "dyn_broad_phase_query", "dyn_broad_phase_ray",
          // contact_solver_test.cpp
          "dyn_contact_problem_init", "dyn_contact_options_init", "dyn_contact_solver_new", "dyn_contact_solver_size",
          "dyn_contact_solver_init", "dyn_contact_solver_free", "dyn_contact_solver_solve", "dyn_contact_solver_residuals",
          "dyn_contact_compliance", "dyn_contact_stiffness_hertz", "dyn_contact_problem_qp",
          // stepping_test.cpp
          "dyn_step_options_init", "dyn_data_set_step_options", "dyn_data_step_options", "dyn_data_step_report", "dyn_advance",
          "dyn_data_reset",
          // tests/simulation
          "dyn_model_state_size", "dyn_data_save_state", "dyn_data_restore_state", "dyn_data_copy", "dyn_data_step_contacts", "dyn_data_ledger", "dyn_data_error_bar",
          "dyn_data_set_shape_material", "dyn_data_shape_material",
          // tests/simulation/step_derivatives_test.cpp
          "dyn_step_derivative_options_init", "dyn_step_derivatives_init",
          // tests/plan
          "dyn_plan_cost_init", "dyn_plan_problem_init", "dyn_plan_options_init", "dyn_plan_output_init", "dyn_planner_new",
          "dyn_planner_size", "dyn_planner_init", "dyn_planner_free", "dyn_planner_set_guess", "dyn_planner_shift",
          "dyn_planner_solve",
          // tests/simulation/actuation_test.cpp
          "dyn_actuator_init", "dyn_builder_add_actuator", "dyn_builder_set_gravity_compensation", "dyn_builder_set_medium",
          "dyn_builder_add_pair", "dyn_data_set_control", "dyn_data_apply_wrench", "dyn_data_clear_wrenches",
          "dyn_data_set_gravity",
          // tests/simulation/tendons_test.cpp
          "dyn_tendon_init", "dyn_tendon_element_init", "dyn_builder_add_tendon", "dyn_builder_couple_tendons",
          "dyn_builder_add_actuator_between", "dyn_tendon_path",
          // tests/simulation/mocap_test.cpp
          "dyn_builder_set_mocap", "dyn_data_set_mocap", "dyn_data_mocap",
          // capi/python/tests/test_sensors.py
          "dyn_sensor_init", "dyn_builder_add_sensor",
          // capi/python/tests/test_transmissions.py
          "dyn_builder_limit_actuators", "dyn_builder_limit_tendon_actuators",
          // effects_test.cpp
          "dyn_batch_set_effects",
          // constraint_test.cpp
          "dyn_constraint_init", "dyn_constraint_options_init", "dyn_project_options_init", "dyn_builder_add_constraint",
          "dyn_builder_set_constraint_slots", "dyn_builder_set_contact_capacity", "dyn_data_anchor_constraint",
          // tests/mesh
          "dyn_mesh_options_init", "dyn_mesh_load", "dyn_mesh_from_arrays", "dyn_mesh_free", "dyn_mesh_info", "dyn_mesh_arrays",
          "dyn_mesh_hull", "dyn_mesh_from_height_field", "dyn_mesh_rgb",
          // batch_test.cpp
          "dyn_batch_new", "dyn_batch_free", "dyn_batch_arrays_init", "dyn_batch_run", "dyn_algorithm_info",
          // reflection_test.cpp
          "dyn_algorithm_run", "dyn_enum_count", "dyn_enum_id", "dyn_enum_info", "dyn_enum_value_info", "dyn_joint_type_info",
          "dyn_shape_type_info", "dyn_constraint_type_info", "dyn_integrator_info", "dyn_effect_type_info",
          "dyn_contact_solver_type_info", "dyn_interface_json",
          // rollout_test.cpp
          "dyn_rollout_init", "dyn_batch_rollout", "dyn_sensor_size",
          // groups_test.cpp
          "dyn_so3_compose", "dyn_so3_inverse", "dyn_so3_act", "dyn_so3_exp", "dyn_so3_log", "dyn_so3_jexp", "dyn_so3_jlog",
          "dyn_so3_interpolate", "dyn_so3_from_quaternion", "dyn_so3_to_quaternion", "dyn_so3_from_rpy", "dyn_so3_to_rpy",
          "dyn_se3_compose", "dyn_se3_inverse", "dyn_se3_act", "dyn_se3_act_motion", "dyn_se3_act_force",
          "dyn_se3_act_inertia", "dyn_se3_adjoint", "dyn_se3_exp", "dyn_se3_log", "dyn_se3_jexp", "dyn_se3_jlog",
          "dyn_se3_interpolate", "dyn_se3_from_matrix", "dyn_se3_to_matrix", "dyn_se3_from_quaternion",
          "dyn_se3_to_quaternion", "dyn_se3_from_rpy", "dyn_se3_to_rpy"};
  for (std::size_t at = header.find("\nDYN_API "); at != std::string::npos; at = header.find("\nDYN_API ", at + 1)) {
    const std::size_t open = header.find('(', at), begin = header.find_last_of(" *", open) + 1;
    declared.insert(header.substr(begin, open - begin));
  }
  EXPECT_GT(declared.size(), 80u);
  for (const CallRow& row : call_rows) tested.insert(row.name);
  for (const auto& [name, function] : model_functions) tested.insert(name);
  for (const std::string& name : declared) EXPECT_TRUE(tested.count(name)) << name << " is in no table of tests/capi";
  for (const std::string& name : tested) EXPECT_TRUE(declared.count(name)) << name << " is not in dyn.h";
}

}  // namespace
}  // namespace dyn_test::handles_test
