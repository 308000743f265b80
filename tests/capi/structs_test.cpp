// Tests that every struct with a struct_size may grow: programs of an older and of a newer dyn.h run with this library.
#include <functional>
#include <map>

#include "capi/surfaces.hpp"

namespace dyn_test::structs_test {
namespace {

// A robot with one of everything.
struct Robot {
  Model m = make();
  Data d{m}, finer{m};  // finer: in shorter steps
  Surfaces surfaces;
  dynContactSolver* solver = nullptr;
  dynBatch* batch = nullptr;
  dynPlanner* planner = nullptr;
  dynGeometry ball = geometry();
  double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, x[6] = {0, 0, 1, 0, 0, 0};
  double G[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2}, g[3] = {0, 0, -1}, lambda[3] = {}, out[64] = {};

  Robot() {
    EXPECT_EQ(DYN_OK, dyn_contact_solver_new(3, &solver));
    EXPECT_EQ(DYN_OK, dyn_batch_new(m, 0, 1, &batch));
    EXPECT_EQ(DYN_OK, dyn_planner_new(m, 2, DYN_PLAN_INPUT_CONTROL, &planner));
    EXPECT_EQ(DYN_OK, dyn_distances(m, d, nullptr, nullptr));
    dynStepOptions steps;
    dyn_step_options_init(&steps);
    steps.dt /= 2;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, finer, &steps));
  }
  ~Robot() { dyn_contact_solver_free(solver), dyn_batch_free(batch), dyn_planner_free(planner); }

  static dynGeometry geometry() {
    dynGeometry s;
    dyn_geometry_init(&s);
    s.size[0] = 0.1;
    return s;
  }
  static Model make() {
    Builder b;
    b.joint(Spec("a", DYN_JOINT_TYPE_PRISMATIC)).body("la", "a").joint(Spec("b", DYN_JOINT_TYPE_PRISMATIC)).body("lb", "b");
    b.shape("la", DYN_SHAPE_TYPE_SPHERE, {0.1, 0, 0}).shape("lb", DYN_SHAPE_TYPE_SPHERE, {0.1, 0, 0});
    dynConstraint c;
    dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_POINT);
    EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(b, "foot", &c, "la", nullptr)) << dyn_last_error();
    dynActuator motor;
    dyn_actuator_init(&motor, DYN_ACTUATOR_TYPE_MOTOR);
    EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, "motor", &motor, "a")) << dyn_last_error();
    return b.finish();
  }
};

// An urdf whose report has a line.
Model reported() {
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string("<robot name='r'><link name='a'/><unknown/></robot>", nullptr, &m)) << dyn_last_error();
  EXPECT_LT(0, dyn_model_report_count(m));
  return Model(m);
}

using Init = void (*)(void*, std::uint32_t);
struct Row {
  std::size_t size, align, older;  // older: bytes of the struct before its last fields; 0: no shorter one is allowed
  Init init;                       // null: the struct is a result
  std::function<dynStatus(Robot&, void*)> call;
};

template <class S>
S& as(void* p) {
  return *static_cast<S*>(p);
}

#define READ(S, init_function, field, ...)                                                                                       \
  {                                                                                                                              \
    #S, {                                                                                                                        \
      sizeof(S), alignof(S), offsetof(S, field), [](void* p, std::uint32_t size) { (init_function)(static_cast<S*>(p), size); }, \
          [](Robot& r, void* memory) -> dynStatus {                                                                              \
            S& s = as<S>(memory);                                                                                                \
            __VA_ARGS__                                                                                                          \
          }                                                                                                                      \
    }                                                                                                                            \
  }
#define READ_KIND(S, init_function, kind, field, ...)                                           \
  {                                                                                             \
    #S, {                                                                                       \
      sizeof(S), alignof(S), offsetof(S, field),                                                \
          [](void* p, std::uint32_t size) { (init_function)(static_cast<S*>(p), size, kind); }, \
          [](Robot& r, void* memory) -> dynStatus {                                             \
            S& s = as<S>(memory);                                                               \
            __VA_ARGS__                                                                         \
          }                                                                                     \
    }                                                                                           \
  }
#define WRITTEN(S, field, ...)                                                                      \
  {                                                                                                 \
    #S, {                                                                                           \
      sizeof(S), alignof(S), offsetof(S, field), nullptr, [](Robot& r, void* memory) -> dynStatus { \
        S* s = &as<S>(memory);                                                                      \
        __VA_ARGS__                                                                                 \
      }                                                                                             \
    }                                                                                               \
  }

const std::map<std::string, Row> rows = {
    READ(dynLoadOptions, dyn_load_options_init, srdf, dynModel* m = nullptr; (void)r;
         const dynStatus status = dyn_model_load_string("<robot name='r'><link name='a'/></robot>", &s, &m); dyn_model_free(m);
         return status;),
    READ(dynSaveOptions, dyn_save_options_init, context, size_t n = 0;
         return dyn_model_save_memory(r.m, DYN_FORMAT_URDF, &s, nullptr, 0, &n);),
    READ(dynJointSpec, dyn_joint_spec_init, rotor_inertia, (void)r; Builder b; s.name = "j";
         return dyn_builder_add_joint(b, &s);),
    READ(dynShapeSpec, dyn_shape_spec_init, surface, (void)r; Builder b; s.body = "universe";
         s.size[0] = s.size[1] = s.size[2] = 1; return dyn_builder_add_shape(b, &s);),
    READ(dynStateLayout, dyn_state_layout_init, child_frame, return dyn_state_layout_sizes(r.m, &s, nullptr, nullptr);),
    READ(dynStateInput, dyn_state_input_init, tau, s.q = r.out; dynStateLayout l; dyn_state_layout_init(&l);
         return dyn_state_layout_convert(r.m, &l, DYN_DIRECTION_TO_PEER, &s,
                                         with<dynStateOutput>({0, r.out, nullptr, nullptr, nullptr}));),
    READ(dynStateOutput, dyn_state_output_init, tau, s.q = r.out; const double q[2] = {}; dynStateLayout l;
         dyn_state_layout_init(&l); return dyn_state_layout_convert(r.m, &l, DYN_DIRECTION_TO_PEER,
                                                                    with<dynStateInput>({0, q, nullptr, nullptr, nullptr}), &s);),
    READ(dynCentroidalDerivatives, dyn_centroidal_derivatives_init, dhdot_da, s.dh_dq = r.out;
         return dyn_centroidal_derivatives(r.m, r.d, nullptr, nullptr, nullptr, &s);),
    READ(dynSecondOrderDerivatives, dyn_second_order_derivatives_init, dadq, s.dqdq = r.out;
         return dyn_rnea_second_order_derivatives(r.m, r.d, nullptr, nullptr, nullptr, nullptr, &s);),
    READ(dynAbaDerivatives, dyn_aba_derivatives_init, ddq_dtau, s.ddq_dq = r.out;
         return dyn_aba_derivatives(r.m, r.d, nullptr, nullptr, nullptr, nullptr, &s);),
    READ(dynIkTask, dyn_ik_task_init, weight, s.frame = dyn_model_frame_id(r.m, "la"); s.type = DYN_IK_TASK_TYPE_POSITION;
         dynIkResult result; result.struct_size = sizeof result;
         return dyn_ik(r.m, r.d, nullptr, &s, 1, nullptr, with<dynIkOutput>({0, nullptr, nullptr, &result}));),
    READ(dynIkOptions, dyn_ik_options_init, tolerance_linear, dynIkTask t; dyn_ik_task_init(&t); t.type = DYN_IK_TASK_TYPE_COM;
         dynIkResult result; result.struct_size = sizeof result;
         return dyn_ik(r.m, r.d, nullptr, &t, 1, &s, with<dynIkOutput>({0, nullptr, nullptr, &result}));),
    READ(dynIkOutput, dyn_ik_output_init, result, dynIkTask t; dyn_ik_task_init(&t);
         return dyn_ik(r.m, r.d, nullptr, &t, 1, nullptr, &s);),
    READ_KIND(dynConstraint, dyn_constraint_init, DYN_CONSTRAINT_TYPE_POINT, stiffness, s.first = dyn_model_frame_id(r.m, "la");
              return dyn_data_set_constraint(r.m, r.d, 0, &s);),
    READ(dynConstraintOptions, dyn_constraint_options_init, tolerance,
         return dyn_constrained_dynamics(r.m, r.d, nullptr, nullptr, nullptr, nullptr, &s, nullptr);),
    READ(dynConstrainedOutput, dyn_constrained_output_init, result, s.ddq = r.out;
         return dyn_constrained_dynamics(r.m, r.d, nullptr, nullptr, nullptr, nullptr, nullptr, &s);),
    READ(dynConstraintDerivatives, dyn_constraint_derivatives_init, lambda_dq, s.ddq_dq = r.out;
         return dyn_constrained_dynamics_derivatives(r.m, r.d, nullptr, nullptr, nullptr, nullptr, nullptr, &s);),
    READ(dynProjectOptions, dyn_project_options_init, tolerance,
         return dyn_project(r.m, r.d, nullptr, nullptr, &s, nullptr, nullptr, nullptr);),
    READ(dynGeometry, dyn_geometry_init, surface, s.size[0] = 1; dynRayHit hit; hit.struct_size = sizeof hit;
         return dyn_geometry_ray(&s, r.X, r.x, r.x, &hit);),
    READ(dynGeometryPair, dyn_geometry_pair_init, motion_a, s.a = s.b = &r.ball; s.placement_a = s.placement_b = r.X; dynImpact i;
         i.struct_size = sizeof i; return dyn_geometry_sweep(&s, 1, 0, &i);),
    READ(dynRays, dyn_rays_init, max_t, s.count = 1; s.origins = s.directions = r.x;
         return dyn_rays(r.m, r.d, nullptr, &s, nullptr, nullptr, nullptr);),
    READ(dynDistanceOptions, dyn_distance_options_init, struct_size, dynDistance d; d.struct_size = sizeof d;
         return dyn_geometry_distance(&r.ball, r.X, &r.ball, r.X, &s, &d);),
    READ(dynContactProblem, dyn_contact_problem_init, restitution, s.contacts = 1; s.G = r.G; s.g = r.g; dynContactReport report;
         report.struct_size = sizeof report; return dyn_contact_solver_solve(r.solver, &s, nullptr, r.lambda, nullptr, &report);),
    READ(dynContactOptions, dyn_contact_options_init, time_budget, dynContactProblem p; dyn_contact_problem_init(&p);
         p.contacts = 1; p.G = r.G; p.g = r.g; dynContactReport report; report.struct_size = sizeof report;
         return dyn_contact_solver_solve(r.solver, &p, &s, r.lambda, nullptr, &report);),
    READ(dynQp, dyn_qp_init, H, dynContactProblem p; dyn_contact_problem_init(&p); p.contacts = 1; p.G = r.G; p.g = r.g;
         return dyn_contact_problem_qp(&p, 8, 1, &s);),
    READ_KIND(dynTendon, dyn_tendon_init, DYN_TENDON_TYPE_FIXED, range, (void)r; Builder b;
              b.joint(Spec("j", DYN_JOINT_TYPE_PRISMATIC)); dynTendonElement e;
              dyn_tendon_element_init(&e, DYN_TENDON_ELEMENT_TYPE_JOINT); e.name = "j";
              return dyn_builder_add_tendon(b, "t", &s, &e, 1);),
    READ_KIND(dynTendonElement, dyn_tendon_element_init, DYN_TENDON_ELEMENT_TYPE_JOINT, id, (void)r; Builder b;
              b.joint(Spec("j", DYN_JOINT_TYPE_PRISMATIC)); dynTendon t; dyn_tendon_init(&t, DYN_TENDON_TYPE_FIXED); s.name = "j";
              return dyn_builder_add_tendon(b, "t", &t, &s, 1);),
    READ_KIND(dynActuator, dyn_actuator_init, DYN_ACTUATOR_TYPE_MOTOR, muscle, (void)r; Builder b;
              b.joint(Spec("j", DYN_JOINT_TYPE_PRISMATIC)); return dyn_builder_add_actuator(b, "m", &s, "j");),
    READ_KIND(dynSensor, dyn_sensor_init, DYN_QUANTITY_JOINTPOS, field, (void)r; Builder b;
              b.joint(Spec("j", DYN_JOINT_TYPE_PRISMATIC)); return dyn_builder_add_sensor(b, "s", &s, "j", nullptr);),
    READ(dynStepOptions, dyn_step_options_init, sleep_speed, return dyn_data_set_step_options(r.m, r.d, &s);),
    READ(dynStepDerivativeOptions, dyn_step_derivative_options_init, margin, dynStepDerivatives out;
         dyn_step_derivatives_init(&out); return dyn_step_derivatives(r.m, r.d, &s, &out);),
    READ(dynStepDerivatives, dyn_step_derivatives_init, report, return dyn_step_derivatives(r.m, r.d, nullptr, &s);),
    READ(dynPlanCost, dyn_plan_cost_init, reference, dynPlanProblem problem; dyn_plan_problem_init(&problem); problem.costs = &s;
         problem.cost_count = 1; return dyn_planner_solve(r.planner, r.m, r.d, &problem, nullptr, nullptr);),
    READ(dynPlanProblem, dyn_plan_problem_init, context,
         return dyn_planner_solve(r.planner, r.m, r.d, &s, nullptr, nullptr);),
    READ(dynPlanOptions, dyn_plan_options_init, margin, dynPlanProblem problem; dyn_plan_problem_init(&problem);
         return dyn_planner_solve(r.planner, r.m, r.d, &problem, &s, nullptr);),
    READ(dynPlanOutput, dyn_plan_output_init, report, dynPlanProblem problem; dyn_plan_problem_init(&problem);
         return dyn_planner_solve(r.planner, r.m, r.d, &problem, nullptr, &s);),
    READ(dynMeshOptions, dyn_mesh_options_init, relative_to, (void)r; dynMesh* mesh = nullptr;
         return dyn_mesh_load("/nowhere/m.stl", &s, &mesh);),
    READ(dynHeightField, dyn_height_field_init, bottom, (void)r; const double h[4] = {1, 1, 1, 1}; s.columns = s.rows = 2;
         s.heights = h; s.step_x = s.step_y = 1; dynMesh* mesh = nullptr;
         const dynStatus status = dyn_mesh_from_height_field(&s, &mesh); dyn_mesh_free(mesh); return status;),
    READ(dynBatchArrays, dyn_batch_arrays_init, status, s.q = r.x; s.out[0] = r.out;
         return dyn_batch_run(r.batch, DYN_ALGORITHM_CRBA, 1, &s);),
    READ(dynRollout, dyn_rollout_init, final_states, s.q = r.out; return dyn_batch_rollout(r.batch, 1, &s);),

    WRITTEN(dynArray, data, return dyn_data_array(r.m, r.d, dyn_field_id("q"), s);),
    WRITTEN(dynReportEntry, message, (void)r; const Model m = reported(); return dyn_model_report_entry(m, 0, s);),
    WRITTEN(dynJointInfo, pitch, return dyn_model_joint_info(r.m, 1, s);),
    WRITTEN(dynFrameInfo, inertia, return dyn_model_frame_info(r.m, 1, s);),
    WRITTEN(dynShapeInfo, material, return dyn_model_shape_info(r.m, 0, s);),
    WRITTEN(dynParameter, count, dynBuilder* b = nullptr; dyn_builder_from_model(r.m, &b);
            const dynStatus status = dyn_builder_parameter(b, 0, s); dyn_builder_free(b); return status;),
    WRITTEN(dynEffectInfo, bytes, return dyn_data_effect_info(r.m, r.d, 0, s);),
    WRITTEN(dynFieldInfo, sentence, (void)r; return dyn_field_info(0, s);),
    WRITTEN(dynForceLimit, range, (void)r; Builder b; b.joint(Spec("j", DYN_JOINT_TYPE_PRISMATIC)).body("link", "j");
            if (dyn_builder_limit_actuators(b, "j", -1, 1, 0) != DYN_OK) return DYN_ERROR_INVALID; const Model m = b.finish();
            return dyn_model_force_limit_info(m, 0, s);),
    WRITTEN(dynIkResult, cost, dynIkTask t; dyn_ik_task_init(&t); t.type = DYN_IK_TASK_TYPE_COM;
            return dyn_ik(r.m, r.d, nullptr, &t, 1, nullptr, with<dynIkOutput>({0, nullptr, nullptr, s}));),
    WRITTEN(dynConstraintResult, condition,
            return dyn_constraint_impulse(r.m, r.d, nullptr, nullptr, nullptr, nullptr, nullptr, s);),
    WRITTEN(dynConstraintReport, error, return dyn_constraint_report(r.m, r.d, nullptr, s, nullptr, 0);),
    WRITTEN(dynDistance, point_b, return dyn_geometry_distance(&r.ball, r.X, &r.ball, r.X, nullptr, s);),
    WRITTEN(dynRayHit, normal, return dyn_geometry_ray(&r.ball, r.X, r.x, r.x, s);),
    WRITTEN(dynClosestPoint, normal, return dyn_geometry_closest_point(&r.ball, r.X, r.x, s);),
    WRITTEN(dynImpact, point_b,
            return dyn_geometry_sweep(with<dynGeometryPair>({0, &r.ball, &r.ball, r.X, r.X, nullptr, nullptr}), 1, 0, s);),
    WRITTEN(dynContactReport, energy, dynContactProblem p; dyn_contact_problem_init(&p); p.contacts = 1; p.G = r.G; p.g = r.g;
            return dyn_contact_solver_solve(r.solver, &p, nullptr, r.lambda, nullptr, s);),
    WRITTEN(dynStepReport, residual, return dyn_data_step_report(r.m, r.d, s);),
    WRITTEN(dynStepDerivativeReport, reason, dynStepDerivatives out; dyn_step_derivatives_init(&out); out.report = s;
            return dyn_step_derivatives(r.m, r.d, nullptr, &out);),
    WRITTEN(dynPlanReport, steps, dynPlanOutput out; dyn_plan_output_init(&out); out.report = s; dynPlanProblem problem;
            dyn_plan_problem_init(&problem); return dyn_planner_solve(r.planner, r.m, r.d, &problem, nullptr, &out);),
    WRITTEN(dynErrorBar, v, return dyn_data_error_bar(r.m, r.d, r.finer, s);),
    WRITTEN(dynErrorLedger, cone, return dyn_data_ledger(r.m, r.d, s);),
    WRITTEN(dynMeshInfo, area, return dyn_mesh_info(r.surfaces.field, s);),
    WRITTEN(dynMeshArrays, planes, return dyn_mesh_arrays(r.surfaces.field, s);),
    WRITTEN(dynAlgorithmInfo, precondition, return dyn_algorithm_info(r.m, DYN_ALGORITHM_RNEA, s);),
    WRITTEN(dynEnumInfo, count, (void)r; return dyn_enum_info(0, s);),
    WRITTEN(dynEnumValueInfo, sentence, (void)r; return dyn_enum_value_info(0, 0, s);),
    WRITTEN(dynJointTypeInfo, sentence, (void)r; return dyn_joint_type_info(DYN_JOINT_TYPE_PLANAR, s);),
    WRITTEN(dynShapeTypeInfo, sentence, (void)r; return dyn_shape_type_info(DYN_SHAPE_TYPE_BOX, s);),
    WRITTEN(dynConstraintTypeInfo, sentence, (void)r; return dyn_constraint_type_info(DYN_CONSTRAINT_TYPE_WELD, s);),
    WRITTEN(dynEffectTypeInfo, sentence, (void)r; return dyn_effect_type_info(DYN_EFFECT_DAMPING, s);),
    WRITTEN(dynContactSolverTypeInfo, sentence, (void)r; return dyn_contact_solver_type_info(DYN_CONTACT_SOLVER_TYPE_ADMM, s);),
    WRITTEN(dynIntegratorInfo, sentence, (void)r; return dyn_integrator_info(DYN_INTEGRATOR_RK4, s);),
};
#undef READ
#undef READ_KIND
#undef WRITTEN

// Structs that both are read and written, by the call that writes them.
const std::map<std::string, std::function<dynStatus(Robot&, void*)>> also_written = {
    {"dynConstraint", [](Robot& r, void* p) { return dyn_data_constraint(r.m, r.d, 0, static_cast<dynConstraint*>(p)); }},
    {"dynActuator", [](Robot& r, void* p) { return dyn_model_actuator_info(r.m, 0, static_cast<dynActuator*>(p)); }},
    {"dynStepOptions", [](Robot& r, void* p) { return dyn_data_step_options(r.m, r.d, static_cast<dynStepOptions*>(p)); }},
};

// Memory of a caller's with noise behind the struct.
struct Memory {
  alignas(16) unsigned char bytes[4096 + 64];
  explicit Memory(unsigned char fill = 0xa5) { std::memset(bytes, fill, sizeof bytes); }
  std::uint32_t size() const {
    std::uint32_t n;
    std::memcpy(&n, bytes, sizeof n);
    return n;
  }
  void set_size(std::size_t n) {
    const auto size = std::uint32_t(n);
    std::memcpy(bytes, &size, sizeof size);
  }
  bool all(std::size_t from, std::size_t to, unsigned char value) const {
    return std::all_of(bytes + from, bytes + to, [&](unsigned char b) { return b == value; });
  }
  bool kept_from(std::size_t n) const { return all(n, sizeof bytes, 0xa5); }
};

TEST(Structs, AllAreTested) {
  std::vector<std::string> names;
#define DYN_READ(type, init) names.push_back(#type);
#define DYN_WRITTEN(type) names.push_back(#type);
#include "../../capi/structs.def"
  EXPECT_EQ(rows.size(), names.size());
  for (const std::string& name : names) EXPECT_TRUE(rows.contains(name)) << name;
}

TEST(Structs, InitWritesWithinTheCallersSize) {
  for (const auto& [name, row] : rows) {
    if (!row.init) continue;
    for (const std::size_t size : {row.older, row.size, row.size + 32}) {
      if (size == 0) continue;
      Memory m;
      row.init(m.bytes, std::uint32_t(size));
      EXPECT_EQ(size, m.size()) << name;
      EXPECT_TRUE(m.kept_from(size)) << name;
      EXPECT_TRUE(m.all(std::min(row.size, size), size, 0)) << name;
    }
    for (const std::size_t size : {0, 4, 8, 4100}) {
      Memory m;
      row.init(m.bytes, std::uint32_t(size));
      EXPECT_TRUE(m.size() == 0 && m.kept_from(4)) << name << ": " << size;
    }
    row.init(nullptr, std::uint32_t(row.size));
  }
}

// Behind the shorter struct lies noise, which is no option, no number and no pointer.
TEST(Structs, OlderProgramsAreServed) {
  for (const auto& [name, row] : rows) {
    if (!row.init || row.older == 0) continue;
    Robot r;
    Memory now, older;
    row.init(now.bytes, std::uint32_t(row.size)), row.init(older.bytes, std::uint32_t(row.older));
    const dynStatus expected = name == "dynIkOutput" ? DYN_ERROR_ARGUMENT : row.call(r, now.bytes);  // its last field is required
    EXPECT_EQ(expected, row.call(r, older.bytes)) << name << ": " << dyn_last_error();
    EXPECT_TRUE(expected != DYN_ERROR_SIZE && (expected != DYN_ERROR_ARGUMENT || name == "dynIkOutput"))
        << name << ": " << dyn_last_error();
  }
}

TEST(Structs, NewerProgramsAreServedWhereTheyAskForNothingNew) {
  for (const auto& [name, row] : rows) {
    if (!row.init) continue;
    Robot r;
    Memory now, newer;
    row.init(now.bytes, std::uint32_t(row.size)), row.init(newer.bytes, std::uint32_t(row.size + 32));
    const dynStatus expected = row.call(r, now.bytes);
    EXPECT_EQ(expected, row.call(r, newer.bytes)) << name << ": " << dyn_last_error();
    for (const std::size_t at : {row.size, row.size + 31}) {
      Memory asking;
      row.init(asking.bytes, std::uint32_t(row.size + 32));
      asking.bytes[at] = 1;
      EXPECT_EQ(DYN_ERROR_ARGUMENT, row.call(r, asking.bytes)) << name;
      EXPECT_TRUE(says({name, "newer than the library", "byte " + std::to_string(at)})) << name << ": " << dyn_last_error();
    }
  }
}

TEST(Structs, SizesThatNoHeaderHasAreRefused) {
  for (const auto& [name, row] : rows)
    for (const std::size_t size :
         {std::size_t(0), std::size_t(4), std::size_t(8), row.size - 1, std::size_t(4104), std::size_t(0xa5a5a5a5)}) {
      Robot r;
      Memory m;
      if (row.init) row.init(m.bytes, std::uint32_t(row.size));
      m.set_size(size);
      EXPECT_EQ(DYN_ERROR_SIZE, row.call(r, m.bytes)) << name << ": " << size;
      EXPECT_TRUE(says({name, "struct_size is " + std::to_string(std::uint32_t(size))})) << dyn_last_error();
    }
}

void expect_written_within(const std::string& name, const Row& row, const std::function<dynStatus(Robot&, void*)>& call) {
  Robot r;
  Memory now(0), older, newer;
  now.set_size(row.size), older.set_size(row.older), newer.set_size(row.size + 32);
  ASSERT_EQ(DYN_OK, call(r, now.bytes)) << name << ": " << dyn_last_error();
  ASSERT_EQ(DYN_OK, call(r, older.bytes)) << name << ": " << dyn_last_error();
  ASSERT_EQ(DYN_OK, call(r, newer.bytes)) << name << ": " << dyn_last_error();
  EXPECT_TRUE(now.size() == row.size && older.size() == row.older && newer.size() == row.size + 32) << name;
  EXPECT_TRUE(now.all(row.size, sizeof now.bytes, 0)) << name;
  EXPECT_TRUE(older.kept_from(row.older)) << name;
  EXPECT_TRUE(newer.all(row.size, row.size + 32, 0) && newer.kept_from(row.size + 32)) << name;
  EXPECT_FALSE(older.all(4, row.older, 0xa5)) << name;
}

TEST(Structs, ResultsAreWrittenWithinTheCallersSize) {
  for (const auto& [name, row] : rows)
    if (!row.init) expect_written_within(name, row, row.call);
  for (const auto& [name, call] : also_written) expect_written_within(name, rows.at(name), call);
}

}  // namespace
}  // namespace dyn_test::structs_test
