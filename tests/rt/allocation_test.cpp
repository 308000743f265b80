// Tests that after creation nothing allocates, locks, or makes a system call: every entry point on an arm, a quadruped, a humanoid,
// a gripper with mimic joints, and a robot of all joint types; results and errors alike.
#include <link.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/seccomp.h>

#include <array>
#include <functional>

#include "capi/batch.hpp"
#include "capi/surfaces.hpp"
#include "rt/interposed.hpp"

namespace dyn_test {
namespace {

struct Robot {
  const char* name;
  Model m;
};
// Two pyramids and a ball over a height field.
Model surfaces() {
  const Surfaces made;
  Builder b("surfaces");
  b.body("ground", nullptr, 0, {0, 0, 0}, no_inertia);
  const auto shape = [&](const char* body, dynShapeType type, const dynMesh* surface) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type, s.surface = surface, s.size[0] = 0.2;
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  };
  shape("ground", DYN_SHAPE_TYPE_HEIGHT_FIELD, made.field);
  for (const char* name : {"one", "two", "ball"}) {
    b.joint(Spec((std::string(name) + "_joint").c_str(), DYN_JOINT_TYPE_FREE_FLYER)).body(name, (std::string(name) + "_joint").c_str());
    const bool ball = std::string(name) == "ball";
    shape(name, ball ? DYN_SHAPE_TYPE_SPHERE : DYN_SHAPE_TYPE_TRIANGLES, ball ? nullptr : made.pyramid);
  }
  return b.finish();
}

std::vector<Robot> robots() {
  std::vector<Robot> all;
  all.push_back({"panda", robot("panda")});
  all.push_back({"go2", robot("go2", DYN_BASE_FLOATING)});
  all.push_back({"humanoid", robot("humanoid", DYN_BASE_FLOATING)});
  all.push_back({"gripper", robot("gripper")});
  all.push_back({"all types", all_types()});
  all.push_back({"all types without mimic", all_types(false)});
  all.push_back({"singular", singular_at_zero()});
  all.push_back({"singular with mimic", singular_at_zero(true)});
  all.push_back({"surfaces", surfaces()});
  return all;
}

// A call with its name, ready to be made any number of times.
struct Ready {
  std::string name;
  std::function<void()> call;
};

// All that may be asked of a model and a data once they exist. Everything that the calls point to lives in Work.
struct Work {
  const Model& m;
  Data d, foreign_data;
  State s, odd;
  std::vector<std::unique_ptr<Prepared>> prepared;
  std::vector<unsigned char> memory;
  std::unique_ptr<unsigned char, void (*)(void*)> image{nullptr, std::free};
  std::size_t image_bytes = 0;
  Numbers x, y, J1, J2, parameters, peer = Numbers(1000);
  std::vector<const char*> names;
  std::vector<std::int32_t> ids;
  std::string long_name = std::string(3000, 'n');
  std::vector<Ready> calls;

  explicit Work(const Model& model)
      : m(model), d(m), foreign_data(m), s(random_state(m, 1)), odd(random_state(m, 2)), memory(dyn_data_size(m, 0)), x(s.q), y(random_state(m, 3).q),
        J1(std::size_t(m.nv() * m.nv()) + 100), J2(J1), parameters(10 * std::size_t(m.njoints())) {
    for (int j = 1; j < m.njoints(); ++j) names.push_back(dyn_model_joint_name(m, j));
    names.push_back(dyn_model_joint_name(m, 1));
    ids.resize(names.size());
    for (double& e : odd.v) e = 1e200;
    functions_of_data();
    functions_of_a_model();
  }

  void add(std::string name, std::function<void()> f) { calls.push_back({std::move(name), std::move(f)}); }
  Prepared& prepare(const CallRow& row, const State& state) {
    prepared.push_back(std::make_unique<Prepared>(row, m, state));
    return *prepared.back();
  }
  void call(const std::string& what, Prepared& p) {
    add(std::string(p.row.name) + what, [this, &p] { p(m, d); });
  }

  void functions_of_data() {
    for (const CallRow& row : call_rows) {
      call("", prepare(row, s));
      for (dynReference r : {DYN_REFERENCE_WORLD, DYN_REFERENCE_LOCAL_WORLD_ALIGNED})
        if (row.uses & uses_reference) prepare(row, s).x.reference = r, call(" in another reference", *prepared.back());
    }
    prepare(call_row("dyn_step"), s).x.integrator = DYN_INTEGRATOR_RK4, call(" RK4", *prepared.back());
    // inverse kinematics that has to search: J kept as it is, and its normal equations, with limits, restarts and a posture
    for (int count : {1, 3})
      add("dyn_ik of " + std::to_string(count) + " tasks", [this, count] {
        dynIkTask tasks[3];
        for (dynIkTask& t : tasks) dyn_ik_task_init(&t);
        tasks[0].type = DYN_IK_TASK_TYPE_POSITION, tasks[0].frame = m.nframes() - 1, tasks[0].target[9] = 9;
        tasks[1].type = DYN_IK_TASK_TYPE_COM;
        tasks[2].type = DYN_IK_TASK_TYPE_POSTURE, tasks[2].posture = s.q.data(), tasks[2].priority = 1;
        dynIkResult result{};
        result.struct_size = sizeof result;
        dyn_ik(m, d, s.q.data(), tasks, count, nullptr, with<dynIkOutput>({0, nullptr, nullptr, &result}));
      });
    // errors
    for (const CallRow& row : call_rows) {
      Prepared& p = prepare(row, s);
      add(std::string(row.name) + " without data", [this, &p] { p(m, nullptr); });
      add(std::string(row.name) + " without model", [this, &p] { p(nullptr, d); });
      if (row.uses & uses_q) prepare(row, s).s.q[0] = nan, call(" NaN", *prepared.back());
      if (row.uses & uses_v) call(" overflow", prepare(row, odd));
      if (row.uses & uses_q) {
        Prepared& zero = prepare(row, s);
        std::fill(zero.s.q.begin(), zero.s.q.end(), 0.0);
        call(" zero", zero);  // a zero quaternion, or a singular configuration
      }
      if (row.uses & uses_frame) prepare(row, s).x.frame = -1, call(" no frame", *prepared.back());
      if (row.uses & uses_joint) prepare(row, s).x.joint = 1 << 20, call(" no joint", *prepared.back());
    }
    prepare(call_row("dyn_step"), s).x.dt = 1e300, call(" too far", *prepared.back());
    prepare(call_row("dyn_all_terms"), s).x.mask = ~0u, call(" mask", *prepared.back());
  }

  void functions_of_a_model() {
    add("sizes", [this] {
      dyn_model_nq(m), dyn_model_nv(m), dyn_model_njoints(m), dyn_model_nframes(m), dyn_model_nbodies(m), dyn_model_size(m), dyn_model_total_mass(m), dyn_model_report_count(m), dyn_model_nshapes(m);
      dyn_model_nconfigurations(m), dyn_field_count(), dyn_data_size(m, 0), dyn_model_name(m), dyn_version(), dyn_build_info(), dyn_last_error();
      dyn_status_name(DYN_OK), dyn_data_size(m, ~0u), dyn_model_nq(nullptr);
    });
    add("infos", [this] {
      dynJointInfo joint{};
      dynFrameInfo frame{};
      dynShapeInfo shape{};
      dynReportEntry entry{};
      dynFieldInfo field{};
      joint.struct_size = sizeof joint, frame.struct_size = sizeof frame, shape.struct_size = sizeof shape;
      entry.struct_size = sizeof entry, field.struct_size = sizeof field;
      for (int k = -1; k <= m.nframes(); ++k) {
        dyn_model_joint_info(m, k, &joint), dyn_model_frame_info(m, k, &frame), dyn_model_shape_info(m, k, &shape), dyn_model_report_entry(m, k, &entry);
        dyn_field_info(k, &field), dyn_model_joint_name(m, k), dyn_model_frame_name(m, k), dyn_model_configuration_name(m, k);
      }
      for (int which = -1; which <= 8; ++which) dyn_model_array(m, dynModelArray(which < 0 ? 8 : which));
    });
    add("inertial parameters", [this] {
      Numbers& pi = J1;
      int answer;
      for (double mass : {2.0, -1.0, nan}) {
        const double body[10] = {mass, 0.1, 0.2, 0, 1, 0, 1, 0, 0, 1};
        dyn_pseudo_inertia_from_parameters(body, J2.data()), dyn_parameters_from_pseudo_inertia(J2.data(), pi.data());
        dyn_log_cholesky_from_parameters(body, J2.data()), dyn_is_physically_consistent(body, &answer), dyn_body_regressor(body, body, J2.data());
        dyn_parameters_from_log_cholesky(body, J2.data()), dyn_log_cholesky_jacobian(body, J2.data());
      }
      dyn_model_inertial_parameters(m, parameters.data()), dyn_model_inertial_parameters(nullptr, pi.data());
    });
    add("names", [this] {
      for (const char* name : names) dyn_model_joint_id(m, name), dyn_model_frame_id(m, name), dyn_model_frame_id_of_type(m, name, DYN_FRAME_TYPE_JOINT);
      dyn_field_id("M");
    });
    add("unknown names", [this] {
      for (const char* name : {"Joint", "free_", "panda_link", "", long_name.c_str()}) {
        dyn_model_joint_id(m, name), dyn_model_frame_id(m, name), dyn_field_id(name), dyn_model_configuration(m, name, x.data());
        dyn_model_frame_id_of_type(m, name, DYN_FRAME_TYPE_BODY);
      }
    });
    add("permutation", [this] {
      dyn_model_q_permutation(m, names.data(), names.size() - 1, ids.data(), ids.data());
      dyn_model_q_permutation(m, names.data(), names.size(), ids.data(), ids.data());
    });
    add("data in memory", [this] {
      dynData* placed = nullptr;
      dyn_data_init(m, 0, memory.data(), memory.size(), &placed);
      dyn_crba(m, placed, nullptr, nullptr);
      dyn_data_free(placed), dyn_data_free(placed);
      dyn_data_init(m, 0, memory.data(), 3, &placed);
    });
    dyn_model_image(m, 0, nullptr, 0, &image_bytes);
    image.reset(static_cast<unsigned char*>(std::aligned_alloc(64, (image_bytes + 63) / 64 * 64)));
    dyn_model_image(m, 0, image.get(), image_bytes, &image_bytes);
    add("a model in place", [this] {
      const dynModel* placed = nullptr;
      EXPECT_EQ(DYN_OK, dyn_model_from_buffer(image.get(), image_bytes, &placed)) << dyn_last_error();
      dyn_model_from_buffer(image.get(), image_bytes - 1, &placed), dyn_model_from_buffer(image.get() + 1, image_bytes, &placed);
    });
    add("other libraries' states", [this] {
      dynStateLayout layout;
      dyn_state_layout_init(&layout);
      for (const dynConvention c : {DYN_CONVENTION_PINOCCHIO, DYN_CONVENTION_MUJOCO, DYN_CONVENTION_DRAKE, DYN_CONVENTION_ROS}) {
        layout.convention = c;
        int nq = 0, nv = 0;
        if (dyn_state_layout_sizes(m, &layout, &nq, &nv) != DYN_OK || std::size_t(nq + nv) > peer.size()) continue;  // ROS: joints of one coordinate
        dyn_state_layout_convert(m, &layout, DYN_DIRECTION_TO_PEER, s.q.data(), s.v.data(), nullptr, nullptr, with<dynStateOutput>({0, peer.data(), peer.data() + nq, nullptr, nullptr}));
        dyn_state_layout_convert(m, &layout, DYN_DIRECTION_FROM_PEER, peer.data(), peer.data() + nq, nullptr, nullptr, with<dynStateOutput>({0, J1.data(), J2.data(), nullptr, nullptr}));
      }
      layout.joints = names.data(), layout.joints_count = names.size();
      dyn_state_layout_convert(m, &layout, DYN_DIRECTION_TO_PEER, s.q.data(), nullptr, nullptr, nullptr, with<dynStateOutput>({0, peer.data(), nullptr, nullptr, nullptr}));
      dyn_state_layout_convert(m, nullptr, DYN_DIRECTION_TO_PEER, nullptr, nullptr, nullptr, nullptr, nullptr);
    });
    add("configurations", [this] {
      double* out = J1.data();
      int answer;
      dyn_configuration_neutral(m, out), dyn_configuration_random(m, 7, nullptr, nullptr, out), dyn_model_configuration(m, "neutral", out);
      dyn_integrate(m, x.data(), s.v.data(), out), dyn_difference(m, x.data(), y.data(), out), dyn_interpolate(m, x.data(), y.data(), 0.3, out);
      dyn_configuration_distance(m, x.data(), y.data(), out), dyn_configuration_is_normalized(m, x.data(), 1e-9, &answer), dyn_configuration_normalize(m, x.data());
      dyn_integrate_jacobians(m, x.data(), s.v.data(), J1.data(), J2.data()), dyn_difference_jacobians(m, x.data(), y.data(), J1.data(), J2.data());
      dyn_integrate(m, x.data(), odd.v.data(), out), dyn_configuration_random(nullptr, 1, nullptr, nullptr, out), dyn_configuration_distance(m, nullptr, nullptr, out);
    });
  }
};

TEST(Allocations, TheCountersCount) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = chain(2);
  const long before = allocations, locks_before = locks;
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, 0, &d));  // creation allocates and locks
  EXPECT_GT(allocations, before);
  EXPECT_GT(locks, locks_before);
  const long between = allocations;
  dyn_data_free(d);
  EXPECT_GT(allocations, between);
  dynModel* bad = nullptr;
  const long third = allocations;
  dyn_model_load_string("<robot/>", nullptr, &bad);
  EXPECT_GT(allocations, third);
}

TEST(Allocations, NoneAfterCreation) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  dyn_model_nq(nullptr);  // the thread's first error
  std::size_t calls = 0;
  for (const Robot& r : robots()) {
    Work work(r.m);
    for (int round = 0; round < 2; ++round)  // stale at first, fresh then
      for (const Ready& c : work.calls) {
        const long before = allocations, locked = locks;
        c.call();
        EXPECT_EQ(before, allocations) << r.name << ": " << c.name << " (" << dyn_last_error() << ")";
        EXPECT_EQ(locked, locks) << r.name << ": " << c.name;
        ++calls;
      }
  }
  EXPECT_GT(calls, 2000u);
}

// With constraints that act: independent ones, then some twice, with a limit and dry friction, then a loop.
TEST(Allocations, NoneUnderConstraints) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = robot("go2", DYN_BASE_FLOATING);
  Data d(m);
  const State s = random_state(m, 1);
  const std::size_t nv = std::size_t(m.nv());
  Numbers ddq(nv), lambda(64), square(nv * nv), J(64 * nv), G(64 * 64), projected(std::size_t(m.nq()));
  dynConstraintResult result{};
  result.struct_size = sizeof result;
  dynConstraintDerivatives out{};
  out.struct_size = sizeof out, out.ddq_dq = square.data(), out.lambda_dq = J.data(), out.result = &result;
  dynConstraintReport report{};
  report.struct_size = sizeof report;
  dynConstraint c[8];
  for (int k = 0; k < 4; ++k) {
    dyn_constraint_init(&c[k], DYN_CONSTRAINT_TYPE_POINT);
    c[k].first = dyn_model_frame_id(m, std::array{"FL_foot", "FR_foot", "RL_foot", "RR_foot"}[std::size_t(k)]);
  }
  c[4] = c[0], c[5] = c[1];
  dyn_constraint_init(&c[6], DYN_CONSTRAINT_TYPE_LIMIT), dyn_constraint_init(&c[7], DYN_CONSTRAINT_TYPE_FRICTION);
  c[6].first = 2, c[7].first = 3, c[7].force = 1;
  auto calls = [&] {
    EXPECT_EQ(DYN_OK, dyn_constrained_dynamics(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr, with<dynConstrainedOutput>({0, ddq.data(), nullptr, lambda.data(), &result}))) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constrained_dynamics_derivatives(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr, &out)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constraint_impulse(m, d, s.q.data(), s.v.data(), nullptr, ddq.data(), lambda.data(), &result)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constraint_impulse_derivatives(m, d, s.q.data(), s.v.data(), nullptr, &out)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constrained_inverse_dynamics(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr, nullptr, with<dynConstrainedOutput>({0, nullptr, ddq.data(), lambda.data(), &result})));
    EXPECT_EQ(DYN_OK, dyn_constraint_terms(m, d, s.q.data(), s.v.data(), lambda.data(), J.data(), lambda.data(), lambda.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus(m, d, s.q.data(), G.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_factor(m, d, s.q.data(), J.data(), lambda.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_times(m, d, s.q.data(), J.data(), lambda.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_solve(m, d, s.q.data(), 1e-3, J.data(), lambda.data())) << dyn_last_error();
    dyn_constraint_report(m, d, s.q.data(), &report, nullptr, 0);
    EXPECT_EQ(DYN_OK, dyn_project(m, d, s.q.data(), s.v.data(), nullptr, projected.data(), ddq.data(), &result)) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_data_anchor_constraint(m, d, 0, s.q.data())) << dyn_last_error();
  };
  auto quiet = [&](const char* what) {
    const long before = allocations, locked = locks;
    calls();
    EXPECT_EQ(before, allocations) << what;
    EXPECT_EQ(locked, locks) << what;
  };
  dyn_model_nq(nullptr);  // the thread's first error
  for (int k = 0; k < 8; ++k) {
    const long before = allocations;
    ASSERT_EQ(DYN_OK, dyn_data_set_constraint(m, d, k, &c[k])) << dyn_last_error();
    EXPECT_EQ(before, allocations);
    if (k == 3) quiet("four feet");
    if (k == 5) quiet("two of them twice");
  }
  quiet("a limit and dry friction");
  dyn_constraint_init(&c[0], DYN_CONSTRAINT_TYPE_LOOP);
  c[0].joint_type = DYN_JOINT_TYPE_UNIVERSAL, c[0].first = c[1].first, c[0].second = c[2].first;
  ASSERT_EQ(DYN_OK, dyn_data_set_constraint(m, d, 4, &c[0])) << dyn_last_error();
  quiet("a loop");
}

// A process that may only read, write and leave (seccomp's strict mode; the kernel kills it for anything else).
TEST(SystemCalls, NoneAfterCreation) {
  if (sanitized) GTEST_SKIP() << "sanitizers make system calls";
  for (const Robot& r : robots()) {
    Work work(r.m);
    dyn_model_nq(nullptr);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
      for (int round = 0; round < 2; ++round)
        for (const Ready& c : work.calls) c.call();
      syscall(SYS_exit, 0);
    }
    int status = 0;
    ASSERT_EQ(child, waitpid(child, &status, 0));
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "no seccomp here";
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << r.name << ": a system call was made (status " << status << ")";
  }
}

// Shapes by themselves, and the broad phase through a life of its boxes.
TEST(Allocations, NoneInShapesAndTheBroadPhase) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  dynGeometry box, drum;
  dyn_geometry_init(&box), dyn_geometry_init(&drum);
  box.type = DYN_SHAPE_TYPE_BOX, box.size[0] = box.size[1] = box.size[2] = 1;
  drum.type = DYN_SHAPE_TYPE_CYLINDER, drum.size[0] = drum.size[1] = 1;
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Y[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0.9}, motion[6] = {0, 0, -1, 1, 0, 0}, *const point = motion;
  dynBroadPhase* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_broad_phase_new(1000, 100000, 0.01, &b));
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  dynRayHit hit{};
  dynClosestPoint near{};
  dynImpact impact{};
  hit.struct_size = sizeof hit, near.struct_size = sizeof near, impact.struct_size = sizeof impact;
  const long before = allocations, locked = locks;
  int count = 0, id = 0;
  std::int64_t pairs = 0;
  dyn_geometry_contacts(with<dynGeometryPair>({0, &box, &drum, X, Y, nullptr, nullptr}), 0.1, 0, contacts, &count);
  EXPECT_GT(count, 2);
  dyn_geometry_ray(&drum, X, motion + 3, motion, &hit), dyn_geometry_closest_point(&drum, X, point, &near);
  dyn_geometry_sweep(with<dynGeometryPair>({0, &box, &drum, X, Y, nullptr, motion}), 1, 0, &impact);
  for (int step = 0; step < 20; ++step) {
    for (int k = 0; k < 1000; ++k) {
      const double lower[3] = {0.03 * k + 0.02 * step * (k % 7), 0.01 * ((k * step) % 50), 0}, upper[3] = {lower[0] + 0.1, lower[1] + 0.1, 0.1};
      if (step == 0)
        dyn_broad_phase_insert(b, lower, upper, &id);
      else if (k % step == 0)
        dyn_broad_phase_update(b, k, lower, upper);
    }
    EXPECT_EQ(DYN_OK, dyn_broad_phase_pairs(b, nullptr, 0, &pairs));
    EXPECT_GT(pairs, 0);
    const double lower[3] = {0, 0, 0}, upper[3] = {9, 9, 9};
    dyn_broad_phase_query(b, lower, upper, &id, 1, &count), dyn_broad_phase_ray(b, lower, upper, 1, &id, 1, &count);
  }
  for (int k = 0; k < 1000; k += 3) dyn_broad_phase_remove(b, k);
  EXPECT_EQ(DYN_OK, dyn_broad_phase_pairs(b, nullptr, 0, &pairs));
  EXPECT_EQ(before, allocations);
  EXPECT_EQ(locked, locks);
  dyn_broad_phase_free(b);
}

// One of each type.
std::vector<dynGeometry> shapes_of(const Surfaces& surfaces) {
  std::vector<dynGeometry> shapes;
  dynShapeTypeInfo info{};
  info.struct_size = sizeof info;
  for (int k = DYN_SHAPE_TYPE_BOX; dyn_shape_type_info(dynShapeType(k), &info) == DYN_OK; ++k) {
    const dynShapeType type = dynShapeType(k);
    if (type == DYN_SHAPE_TYPE_MESH || (type == DYN_SHAPE_TYPE_CONVEX && !surfaces.hull)) continue;
    dynGeometry g;
    dyn_geometry_init(&g);
    g.type = type, g.surface = surfaces.of(type);
    if (!g.surface) g.size[0] = 0.4, g.size[1] = 0.5, g.size[2] = 0.6;
    shapes.push_back(g);
  }
  return shapes;
}

// Every pair of types of shapes, apart, touching, overlapping, at one place; each by itself under rays and points; and what is refused.
TEST(Allocations, NoneInAnyPairOfShapes) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Surfaces surfaces;
  const std::vector<dynGeometry> shapes = shapes_of(surfaces);
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  dynDistance d{};
  dynRayHit hit{};
  dynClosestPoint near{};
  dynImpact impact{};
  d.struct_size = sizeof d, hit.struct_size = sizeof hit, near.struct_size = sizeof near, impact.struct_size = sizeof impact;
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, motion[6] = {0.1, 0, -1, 0, 0.2, 0}, up[3] = {0.1, 0.2, 1}, skew[12] = {};
  int queries = 0;
  for (const dynGeometry& a : shapes)
    for (const dynGeometry& b : shapes)
      for (const double z : {3., 1., 0.3, 0., -0.2}) {
        double Y[12] = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.05, 0.02, z};
        if (z == 0) std::copy(X, X + 12, Y);
        const long before = allocations, locked = locks;
        int count = 0;
        const dynStatus status = dyn_geometry_distance(&a, X, &b, Y, nullptr, &d);
        dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, nullptr}), 0.05, 0, contacts, &count);
        dyn_geometry_sweep(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, motion}), 1, 0, &impact);
        dyn_geometry_ray(&b, Y, motion, up, &hit), dyn_geometry_closest_point(&b, Y, motion, &near);
        dyn_geometry_distance(&a, X, &b, nullptr, nullptr, &d), dyn_geometry_distance(&a, skew, &b, Y, nullptr, &d);
        EXPECT_EQ(before, allocations) << int(a.type) << " and " << int(b.type) << " at " << z << ": " << dyn_last_error();
        EXPECT_EQ(locked, locks) << int(a.type) << " and " << int(b.type) << " at " << z;
        EXPECT_EQ(DYN_OK, status);
        ++queries;
      }
  EXPECT_GE(queries, 5 * 81);
}

// Contact problems of every solver, errors among them.
TEST(Allocations, NoneInContactSolvers) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  constexpr int rows = 12;
  double G[rows * rows] = {}, g[rows], friction[4] = {0.5, 0.6, 0.7, 0.8}, lambda[rows];
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < rows; ++i) G[i + rows * j] = (i == j ? 1.0 : 0.0) + std::cos(i) * std::cos(j);
  for (int i = 0; i < rows; ++i) g[i] = std::sin(2.5 * i) - (i % 3 == 2);
  dynContactProblem p;
  dynContactOptions o;
  dynContactReport r{};
  dyn_contact_problem_init(&p), dyn_contact_options_init(&o);
  p.contacts = 4, p.G = G, p.g = g, p.friction = friction, r.struct_size = sizeof r;
  dynContactSolver* s = nullptr;
  ASSERT_EQ(DYN_OK, dyn_contact_solver_new(rows, &s));
  const long before = allocations, locked = locks;
  for (const int type : {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON})
    for (const int newton : {0, 1}) {
      o.solver = static_cast<dynContactSolverType>(type), o.newton = newton;
      EXPECT_EQ(DYN_OK, dyn_contact_solver_solve(s, &p, &o, lambda, nullptr, &r));
      EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, r.status);
      o.time_budget = 1;
      dyn_contact_solver_solve(s, &p, &o, lambda, nullptr, &r), dyn_contact_solver_residuals(s, &p, lambda, &r);
      o.time_budget = -1;
      EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_contact_solver_solve(s, &p, &o, lambda, nullptr, &r));
      o.time_budget = 0;
    }
  EXPECT_EQ(before, allocations);
  EXPECT_EQ(locked, locks);
  dyn_contact_solver_free(s);
}

// Every algorithm, states that fail among them: nothing is allocated or locked in any thread, and there are as many system calls
// for thousands of states as for a few.
TEST(Allocations, NoneInBatches) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = all_types();
  const Batch batch(m, 4);
  for (int which = 0; which < batch_algorithms; ++which) {
    BatchCase c(m, which, 500);
    ASSERT_EQ(DYN_OK, c(batch)) << dyn_last_error();
    c.q[10] = nan;
    const long before = anywhere, calls_before = system_calls;
    const dynStatus status = c(batch);
    EXPECT_EQ(before, anywhere) << c.info.name;
    EXPECT_LE(system_calls - calls_before, 3 * 4) << c.info.name;
    EXPECT_EQ(DYN_ERROR_NONFINITE, status);
  }
  EXPECT_GT(system_calls, 0);  // they are counted
}

// With one thread there are none at all.
TEST(SystemCalls, NoneInABatchOnOneThread) {
  if (sanitized) GTEST_SKIP() << "sanitizers make system calls";
  const Model m = all_types();
  const Batch batch(m, 1);
  std::vector<std::unique_ptr<BatchCase>> cases;
  for (int which = 0; which < batch_algorithms; ++which) cases.push_back(std::make_unique<BatchCase>(m, which, 20));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
    for (const auto& c : cases) (*c)(batch);
    syscall(SYS_exit, 0);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "no seccomp here";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "a system call was made (status " << status << ")";
}

// ---------------------------------------------------------------------------------------------------- stack and pages

// How far down the stack f goes: on a painted one of its own.
std::size_t stack_of(const std::function<void()>& f) {
  constexpr std::size_t size = 1 << 20;
  constexpr unsigned char paint = 0xc5;
  unsigned char* const memory = static_cast<unsigned char*>(std::aligned_alloc(4096, size));
  std::memset(memory, paint, size);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes), pthread_attr_setstack(&attributes, memory, size);
  pthread_t thread;
  EXPECT_EQ(0, pthread_create(&thread, &attributes, [](void* work) -> void* { return (*static_cast<const std::function<void()>*>(work))(), nullptr; }, const_cast<std::function<void()>*>(&f)));
  pthread_join(thread, nullptr), pthread_attr_destroy(&attributes);
  std::size_t untouched = 0;
  while (untouched < size && memory[untouched] == paint) ++untouched;
  std::free(memory);
  return size - untouched;
}

// Every entry point stays within 128 KiB, of which dyn_data_warm_up touches all; printed with what a thread takes that does nothing.
TEST(Stack, IsBounded) {
  if (sanitized) GTEST_SKIP() << "sanitizers make frames larger";
  const std::size_t nothing = stack_of([] {});
  std::size_t most = 0;
  std::string where;
  for (const Robot& r : robots()) {
    Work work(r.m);
    for (const Ready& c : work.calls) {
      if (c.name.starts_with("dyn_data_warm_up")) continue;  // which takes what it touches
      const std::size_t bytes = stack_of(c.call) - nothing;
      if (bytes > most) most = bytes, where = std::string(r.name) + ": " + c.name;
    }
  }
  const Surfaces surfaces;
  const std::vector<dynGeometry> shapes = shapes_of(surfaces);
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Y[12] = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.05, 0.02, 0.3}, motion[6] = {0.1, 0, -1, 0, 0.2, 0};
  for (const dynGeometry& a : shapes)
    for (const dynGeometry& b : shapes) {
      dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
      dynDistance d{};
      dynImpact impact{};
      d.struct_size = sizeof d, impact.struct_size = sizeof impact;
      int count = 0;
      const std::pair<const char*, std::function<void()>> queries[] = {
          {"dyn_geometry_distance", [&] { dyn_geometry_distance(&a, X, &b, Y, nullptr, &d); }},
          {"dyn_geometry_contacts", [&] { dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, nullptr}), 0.05, 0, contacts, &count); }},
          {"dyn_geometry_sweep", [&] { dyn_geometry_sweep(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, motion}), 1, 0, &impact); }}};
      for (const auto& [name, query] : queries)
        if (const std::size_t bytes = stack_of(query) - nothing; bytes > most)
          most = bytes, where = std::string(name) + ", types " + std::to_string(a.type) + " and " + std::to_string(b.type);
    }
  std::printf("stack: %zu bytes at most, %s (a thread itself: %zu)\n", most, where.c_str(), nothing);
  EXPECT_LE(most, std::size_t(128) << 10);
  EXPECT_GT(most, std::size_t(1) << 10);
}

// The pages of the library's code are no longer mapped, as before its first use.
void forget_library() {
  dl_iterate_phdr([](dl_phdr_info* info, std::size_t, void*) {
    if (!std::strstr(info->dlpi_name, "libdyn.so")) return 0;
    for (int k = 0; k < info->dlpi_phnum; ++k)
      if (const auto& s = info->dlpi_phdr[k]; s.p_type == PT_LOAD && (s.p_flags & PF_X) && !(s.p_flags & PF_W)) {
        const std::uintptr_t from = (std::uintptr_t(info->dlpi_addr) + s.p_vaddr) / 4096 * 4096;
        madvise(reinterpret_cast<void*>(from), s.p_memsz, MADV_DONTNEED);
      }
    return 1;
  }, nullptr);
}

// The first calls on a new data after dyn_data_warm_up wait for no page of memory; without it they do.
TEST(Warmup, NoPageIsMissingAfterIt) {
  if (sanitized) GTEST_SKIP() << "sanitizers touch memory of their own";
  const Model m = robot("humanoid", DYN_BASE_FLOATING);
  const auto faults = [&](bool warm) {
    Data d(m);
    forget_library();
    if (warm) {
      EXPECT_EQ(DYN_OK, dyn_data_warm_up(m, d)) << dyn_last_error();
    }
    rusage before{}, after{};
    getrusage(RUSAGE_THREAD, &before), getrusage(RUSAGE_THREAD, &before);
    dyn_rnea(m, d, nullptr, nullptr, nullptr, nullptr, nullptr), dyn_aba_derivatives(m, d, nullptr, nullptr, nullptr, nullptr, nullptr);
    for (int k = 0; k < 5; ++k) dyn_step(m, d);
    dyn_rnea(m, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr);
    getrusage(RUSAGE_THREAD, &after);
    return after.ru_minflt - before.ru_minflt;
  };
  EXPECT_GT(faults(false), 0);
  EXPECT_EQ(0, faults(true));
}

}  // namespace
}  // namespace dyn_test
