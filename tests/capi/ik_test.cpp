// dyn_ik: closed forms, limits, what can't be reached, tasks that share, and every argument that is refused.
#include <algorithm>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

dynIkTask make(dynIkTaskType type, int frame = 0) {
  dynIkTask t;
  dyn_ik_task_init(&t);
  t.type = type, t.frame = frame;
  return t;
}
dynIkTask at(int frame, double x, double y, double z = 0) {
  dynIkTask t = make(DYN_IK_TASK_TYPE_POSITION, frame);
  t.target[9] = x, t.target[10] = y, t.target[11] = z;
  return t;
}
dynIkOptions make_options() {
  dynIkOptions o;
  dyn_ik_options_init(&o);
  return o;
}

// A planar arm of links one metre long, and its tip.
struct Arm {
  Model m;
  Data d;
  int tip;
  Numbers q, residuals = Numbers(20);
  dynIkOptions o = make_options();
  dynIkResult r{};

  explicit Arm(int links) : m(build(links)), d(m), tip(dyn_model_frame_id(m, "tip")), q(std::size_t(links)) {
    r.struct_size = sizeof r;
  }
  static Model build(int links) {
    Builder b("arm");
    std::string parent;
    for (int k = 0; k < links; ++k) {
      const std::string name = "j" + std::to_string(k);
      b.joint(Spec(name.c_str(), DYN_JOINT_TYPE_REVOLUTE, k ? parent.c_str() : nullptr, {k ? 1.0 : 0.0, 0, 0}));
      b.body(("l" + std::to_string(k)).c_str(), name.c_str());
      parent = name;
    }
    double placement[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0};
    EXPECT_EQ(DYN_OK, dyn_builder_add_frame(b, "tip", parent.c_str(), placement, DYN_FRAME_TYPE_OP_FRAME));
    return b.finish();
  }
  void solve(const std::vector<dynIkTask>& tasks) {
    EXPECT_EQ(DYN_OK,
              dyn_ik(m, d, q.data(), tasks.data(), int(tasks.size()), &o, with<dynIkOutput>({0, q.data(), residuals.data(), &r})))
        << dyn_last_error();
    EXPECT_TRUE(same_bits(q, field(m, d, "q")));
    double X[12];
    EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, tip, X)) << "placements are of the solution";
  }
};

TEST(Ik, StretchedTowardsWhatIsOutOfReach) {
  Arm a(2);
  a.q = {0.4, 0.9};
  a.solve({at(a.tip, 3, 0)});
  EXPECT_EQ(DYN_IK_REASON_SINGULAR, a.r.reason);
  EXPECT_NEAR(1, a.residuals[0], 1e-9);
  EXPECT_EQ(0, a.residuals[1]);
  EXPECT_NEAR(0.5, a.r.cost, 1e-9);
  EXPECT_LE(a.r.optimality, 1e-6);
  EXPECT_EQ(-1, a.r.joint);
  EXPECT_EQ(20, a.r.restarts);
  EXPECT_NEAR(0, std::remainder(a.q[0], 6.283185307179586), 1e-5);
}

TEST(Ik, LimitsHold) {
  Arm a(2);
  const double lower[] = {-3, 0.5}, upper[] = {3, 2};
  a.o.lower = lower, a.o.upper = upper;
  a.q = {0.4, 0.9};
  a.solve({at(a.tip, 3, 0)});
  EXPECT_EQ(DYN_IK_REASON_LIMITS, a.r.reason);
  EXPECT_EQ(dyn_model_joint_id(a.m, "j1"), a.r.joint);
  EXPECT_EQ(0.5, a.q[1]);
  EXPECT_NEAR(3 - std::sqrt(2 + 2 * std::cos(0.5)), a.residuals[0], 1e-9);
  EXPECT_LE(a.r.optimality, 1e-6);
  // a start outside is moved inside; locked coordinates stay; without limits the target is met
  const double locked_lower[] = {-3, 1}, locked_upper[] = {3, 1};
  a.o.lower = locked_lower, a.o.upper = locked_upper;
  a.q = {9, -9};
  const double reach = std::sqrt(2 + 2 * std::cos(1.0));
  a.solve({at(a.tip, 0, reach)});
  EXPECT_EQ(DYN_IK_REASON_CONVERGED, a.r.reason);
  EXPECT_EQ(1, a.q[1]);
  a.o.limits = 0;
  a.solve({at(a.tip, 0.3, 0.2)});
  EXPECT_EQ(DYN_IK_REASON_CONVERGED, a.r.reason);
  EXPECT_LE(a.r.residual_linear, 1e-6);
}

// Stretched out, no first-order motion goes inwards.
TEST(Ik, LeavesASingularStart) {
  Arm a(2);
  a.o.restarts = 0;
  a.q = {0, 0};
  a.solve({at(a.tip, 1, 0)});
  EXPECT_EQ(DYN_IK_REASON_CONVERGED, a.r.reason);
  EXPECT_NEAR(2 * 3.14159265358979 / 3, std::abs(a.q[1]), 1e-5);
}

TEST(Ik, ContradictionsAreSharedByTheSquaresOfTheWeights) {
  Arm a(3);
  dynIkTask one = at(a.tip, 1, 1), two = at(a.tip, 1, 0.5);
  a.q = {0.3, 0.2, 0.4};
  one.weight = 2;
  a.solve({one, two});
  EXPECT_EQ(DYN_IK_REASON_LOCAL_MINIMUM, a.r.reason);
  EXPECT_NEAR(0.1, a.residuals[0], 1e-7);
  EXPECT_NEAR(0.4, a.residuals[2], 1e-7);
  EXPECT_LE(a.r.optimality, 1e-6);
  // a component without weight does not count
  const double x_only[] = {1, 0, 0};
  two.weights = x_only;
  a.solve({one, two});
  EXPECT_EQ(DYN_IK_REASON_CONVERGED, a.r.reason);
}

// The posture is as near as the null space of the position lets it come: its gradient there vanishes.
TEST(Ik, PostureInTheNullSpace) {
  for (int links : {3, 7}) {
    Arm a(links);
    const std::size_t n = std::size_t(links);
    Numbers posture(n, 0.3), weights(n, 1.0), J(6 * n);
    weights[0] = 0.5;
    dynIkTask rest = make(DYN_IK_TASK_TYPE_POSTURE);
    rest.posture = posture.data(), rest.weights = weights.data(), rest.priority = 1;
    a.q.assign(n, 0.8);
    a.solve({at(a.tip, 1.2, 0.4), rest});
    ASSERT_EQ(DYN_IK_REASON_CONVERGED, a.r.reason);
    EXPECT_LE(a.residuals[0], 1e-6);
    EXPECT_GT(a.residuals[3], 0.1);
    ASSERT_EQ(DYN_OK, dyn_frame_jacobian(a.m, a.d, a.tip, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J.data()));
    // gradient of the posture's cost less its part in the row space of the position's Jacobian (Gram-Schmidt)
    Numbers g(a.q), x(g), y(g);
    auto dot = [&](const Numbers& u, const Numbers& v) {
      double sum = 0;
      for (std::size_t k = 0; k < u.size(); ++k) sum += u[k] * v[k];
      return sum;
    };
    for (std::size_t k = 0; k < g.size(); ++k)
      g[k] = weights[k] * weights[k] * (a.q[k] - posture[k]), x[k] = J[6 * k], y[k] = J[6 * k + 1];
    const double before = std::sqrt(dot(g, g)), xy = dot(x, y) / dot(x, x);
    for (std::size_t k = 0; k < g.size(); ++k) y[k] -= xy * x[k];
    for (const Numbers* row : {&x, &y}) {
      const double part = dot(g, *row) / dot(*row, *row);
      for (std::size_t k = 0; k < g.size(); ++k) g[k] -= part * (*row)[k];
    }
    EXPECT_LE(std::sqrt(dot(g, g)), 1e-4 * before) << links;
  }
}

// A quadruped moves its centre of mass over feet that stay.
TEST(Ik, CentreOfMassOverFixedFeet) {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  Data d(m);
  Numbers q(std::size_t(m.nq())), com(3);
  ASSERT_EQ(DYN_OK, dyn_configuration_neutral(m, q.data()));
  q[2] = 0.3;
  for (std::size_t leg = 0; leg < 4; ++leg) q[7 + 3 * leg + 1] = 0.8, q[7 + 3 * leg + 2] = -1.6;
  ASSERT_EQ(DYN_OK, dyn_com(m, d, q.data(), nullptr, nullptr, com.data(), nullptr, nullptr));
  std::vector<dynIkTask> tasks;
  for (const char* foot : {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}) {
    tasks.push_back(make(DYN_IK_TASK_TYPE_POSITION, dyn_model_frame_id(m, foot)));
    ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, tasks.back().frame, tasks.back().target));
  }
  tasks.push_back(make(DYN_IK_TASK_TYPE_ORIENTATION, dyn_model_frame_id(m, "base")));
  tasks.push_back(make(DYN_IK_TASK_TYPE_COM));
  for (std::size_t k = 0; k < 3; ++k) tasks.back().target[9 + k] = com[k] + std::array{0.03, -0.02, -0.04}[k];
  dynIkOptions o = make_options();
  o.restarts = 0, o.tolerance_linear = o.tolerance_angular = 1e-9;
  dynIkResult r{};
  r.struct_size = sizeof r;
  Numbers residuals(2 * tasks.size());
  ASSERT_EQ(DYN_OK,
            dyn_ik(m, d, q.data(), tasks.data(), int(tasks.size()), &o, with<dynIkOutput>({0, q.data(), residuals.data(), &r})))
      << dyn_last_error();
  EXPECT_EQ(DYN_IK_REASON_CONVERGED, r.reason) << r.residual_linear;
  EXPECT_LE(r.iterations, 10);
  ASSERT_EQ(DYN_OK, dyn_com(m, d, nullptr, nullptr, nullptr, com.data(), nullptr, nullptr));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(tasks.back().target[9 + k], com[k], 1e-9);
  for (const dynIkTask& t : tasks)
    if (t.type == DYN_IK_TASK_TYPE_POSITION) {
      double X[12];
      ASSERT_EQ(DYN_OK, dyn_frame_placement(m, d, t.frame, X));
      for (int k = 9; k < 12; ++k) EXPECT_NEAR(t.target[k], X[k], 1e-9);
    }
}

// Limits of a free flyer's position hold in the axes of its joint, whatever its orientation.
TEST(Ik, LimitsOfAFreeFlyer) {
  const Model m = all_types();
  Data d(m);
  const State s = random_state(m, 3);
  Numbers lower(dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT), dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT) + m.nq()),
      upper(dyn_model_array(m, DYN_MODEL_ARRAY_UPPER_LIMIT), dyn_model_array(m, DYN_MODEL_ARRAY_UPPER_LIMIT) + m.nq());
  for (std::size_t k = 0; k < 3; ++k) lower[k] = -0.2, upper[k] = 0.1;
  dynIkOptions o = make_options();
  o.lower = lower.data(), o.upper = upper.data();
  dynIkTask t = make(DYN_IK_TASK_TYPE_POSE, dyn_model_frame_id(m, "trunk"));
  t.target[9] = 0.5, t.target[10] = -0.05, t.target[11] = -1;
  dynIkResult r{};
  r.struct_size = sizeof r;
  Numbers q(s.q);
  ASSERT_EQ(DYN_OK, dyn_ik(m, d, s.q.data(), &t, 1, &o, with<dynIkOutput>({0, q.data(), nullptr, &r}))) << dyn_last_error();
  EXPECT_EQ(DYN_IK_REASON_LIMITS, r.reason);
  EXPECT_EQ(dyn_model_joint_id(m, "free"), r.joint);
  EXPECT_EQ(0.1, q[0]);
  EXPECT_EQ(-0.2, q[2]);
  EXPECT_LE(r.optimality, 1e-6);
}

// Far targets and contradictory ones on a whole robot: no feasible step lowers the cost to first order.
TEST(Ik, WhatCannotBeReachedIsALeastSquaresOptimum) {
  for (const char* name : {"panda", "humanoid", "gripper"}) {
    const Model m = robot(name, std::string(name) == "humanoid" ? DYN_BASE_FLOATING : DYN_BASE_FIXED);
    Data d(m);
    dynIkResult r{};
    r.struct_size = sizeof r;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const State s = random_state(m, seed);
      std::vector<dynIkTask> tasks = {make(DYN_IK_TASK_TYPE_POSE, m.nframes() - 1),
                                      at(m.nframes() - 1, 2, 0.3 * double(seed), 1)};
      tasks[0].target[10] = 3;
      dynIkOptions o = make_options();
      o.restarts = 2, o.seed = seed;
      Numbers q(s.q), again(s.q);
      ASSERT_EQ(DYN_OK, dyn_ik(m, d, s.q.data(), tasks.data(), 2, &o, with<dynIkOutput>({0, q.data(), nullptr, &r})))
          << dyn_last_error();
      EXPECT_NE(DYN_IK_REASON_CONVERGED, r.reason);
      EXPECT_NE(DYN_IK_REASON_MAX_ITERATIONS, r.reason) << name;
      EXPECT_LE(r.optimality, 1e-5 * (1 + r.cost)) << name << " " << seed;
      ASSERT_EQ(DYN_OK, dyn_ik(m, d, s.q.data(), tasks.data(), 2, &o, with<dynIkOutput>({0, again.data(), nullptr, &r})));
      EXPECT_TRUE(same_bits(q, again)) << "the same seed, the same result";
    }
  }
}

// However early it is stopped, and also where its first steps overshoot: the cost is no more than that of the start.
TEST(Ik, NoStepRaisesTheCost) {
  Arm a(4);
  Random random{5};
  a.o.restarts = 0;
  for (int k = 0; k < 40; ++k) {
    const Numbers start = random.numbers(4, -3, 3);
    const std::vector<dynIkTask> tasks = {at(a.tip, random.uniform(-2, 2), random.uniform(-2, 2))};
    a.q = start;
    double X[12];
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(a.m, a.d, start.data(), nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_frame_placement(a.m, a.d, a.tip, X));
    const double x = X[9] - tasks[0].target[9], y = X[10] - tasks[0].target[10], cost = (x * x + y * y) / 2;
    for (int most = 1; most <= 6; ++most) {
      a.q = start, a.o.max_iterations = most;
      a.solve(tasks);
      EXPECT_LE(a.r.cost, cost * (1 + 1e-12)) << k << " " << most;
    }
  }
}

TEST(Ik, IterationsRunOut) {
  Arm a(3);
  a.o.max_iterations = 1, a.o.restarts = 0;
  a.q = {2, -2, 2};
  a.solve({at(a.tip, -1, -1)});
  EXPECT_EQ(DYN_IK_REASON_MAX_ITERATIONS, a.r.reason);
}

// ---------------------------------------------------------------------------------------------------- refusals

struct IkRefused : ::testing::Test {
  Model m = all_types();
  Data d{m};
  State s = random_state(m, 1), other = random_state(m, 2);
  std::vector<dynIkTask> tasks = {make(DYN_IK_TASK_TYPE_POSE, 3), make(DYN_IK_TASK_TYPE_COM), make(DYN_IK_TASK_TYPE_POSTURE)};
  Numbers posture = s.q, weights = Numbers(std::size_t(m.nv()), 1.0);
  dynIkOptions o = make_options();
  dynIkResult r{};
  int count = 3;
  const double* q = other.q.data();

  IkRefused() {
    r.struct_size = sizeof r;
    tasks[2].posture = posture.data(), tasks[2].weights = weights.data();
    compute_all(m, d, s);
  }
  void expect(dynStatus status, const std::vector<std::string>& fragments) {
    const Snapshot before(m, d);
    Numbers solution(std::size_t(m.nq()), 7), residuals(6, 7);
    EXPECT_EQ(status, dyn_ik(m, d, q, tasks.data(), count, &o, with<dynIkOutput>({0, solution.data(), residuals.data(), &r})))
        << fragments[0];
    EXPECT_TRUE(says(fragments));
    EXPECT_TRUE(says({"dyn_ik"}));
    EXPECT_EQ("", before.differs(Snapshot(m, d), status == DYN_ERROR_NUMERIC));
    EXPECT_EQ(Numbers(std::size_t(m.nq()), 7), solution);
    EXPECT_EQ(Numbers(6, 7), residuals);
  }
};

TEST_F(IkRefused, Tasks) {
  const std::vector<dynIkTask> good = tasks;
  auto with = [&](int k, auto change, dynStatus status, const std::vector<std::string>& fragments) {
    tasks = good;
    change(tasks[std::size_t(k)]);
    expect(status, fragments);
    tasks = good;
  };
  for (double bad : {nan, inf, -inf}) {
    with(0, [&](dynIkTask& t) { t.target[4] = bad; }, DYN_ERROR_NONFINITE,
         {"target[4]", "task 0", bad != bad ? "NaN" : "infinite"});
    with(1, [&](dynIkTask& t) { t.target[10] = bad; }, DYN_ERROR_NONFINITE, {"target[1]", "task 1"});
    with(0, [&](dynIkTask& t) { t.weight = bad; }, DYN_ERROR_NONFINITE, {"weight[0]", "task 0"});
    weights[5] = bad;
    expect(DYN_ERROR_NONFINITE, {"weights[5]", "task 2"});
    weights[5] = 1, posture[7] = bad;
    expect(DYN_ERROR_NONFINITE, {"posture[7]", "task 2"});
    posture = s.q;
  }
  with(1, [](dynIkTask& t) { t.weight = -1; }, DYN_ERROR_ARGUMENT, {"weight[0]", "task 1", "-1", "zero or more"});
  with(0, [](dynIkTask& t) { t.target[0] = 2; }, DYN_ERROR_ARGUMENT, {"task 0", "no rotation"});
  with(0, [](dynIkTask& t) { t.target[0] = -1; }, DYN_ERROR_ARGUMENT, {"task 0", "no rotation", "mirrors"});
  with(0, [](dynIkTask& t) { t.frame = 999; }, DYN_ERROR_ARGUMENT, {"frame 999", "0 to", "dyn_model_frame_id"});
  with(0, [](dynIkTask& t) { t.frame = -1; }, DYN_ERROR_ARGUMENT, {"frame -1"});
  with(0, [](dynIkTask& t) { t.priority = 2; }, DYN_ERROR_ARGUMENT, {"priority 2", "task 0"});
  with(2, [](dynIkTask& t) { t.posture = nullptr; }, DYN_ERROR_ARGUMENT, {"posture", "task 2", "NULL", "nq"});
  with(1, [](dynIkTask& t) { t.struct_size = 8; }, DYN_ERROR_SIZE, {"struct_size", "dynIkTask", "8"});
  with(1, [](dynIkTask& t) { t.struct_size += 8; }, DYN_ERROR_SIZE, {"struct_size of task 1", "the first"});
  for (int type : {0, -1, 6, 1000})
    with(1, [&](dynIkTask& t) { std::memcpy(&t.type, &type, sizeof type); }, DYN_ERROR_ARGUMENT,
         {"type of task 1 is " + std::to_string(type)});
  std::fill_n(posture.begin() + 3, 4, 0.0);
  expect(DYN_ERROR_QUATERNION, {"quaternion", "free"});
  posture = s.q;
  for (int n : {0, -1, std::numeric_limits<int>::min()}) {
    count = n;
    expect(DYN_ERROR_ARGUMENT, {"ntasks is " + std::to_string(n)});
  }
  count = 3;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_ik(m, d, q, nullptr, 3, &o, dyn_test::with<dynIkOutput>({0, nullptr, nullptr, &r})));
  EXPECT_TRUE(says({"tasks is NULL"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_ik(m, d, q, tasks.data(), 3, &o, nullptr));
  EXPECT_TRUE(says({"result is NULL", "required"}));
}

TEST_F(IkRefused, OptionsResultsAndStart) {
  const dynIkOptions good = o;
  auto with = [&](auto change, dynStatus status, const std::vector<std::string>& fragments) {
    change(o);
    expect(status, fragments);
    o = good;
  };
  with([](dynIkOptions& x) { x.struct_size = 4; }, DYN_ERROR_SIZE, {"struct_size", "dynIkOptions"});
  with([](dynIkOptions& x) { x.max_iterations = 0; }, DYN_ERROR_ARGUMENT, {"max_iterations is 0"});
  with([](dynIkOptions& x) { x.restarts = -1; }, DYN_ERROR_ARGUMENT, {"restarts is -1"});
  for (double bad : {0.0, -1.0, nan, inf}) {
    with([&](dynIkOptions& x) { x.tolerance_linear = bad; }, DYN_ERROR_ARGUMENT, {"tolerance_linear", "positive"});
    with([&](dynIkOptions& x) { x.tolerance_angular = bad; }, DYN_ERROR_ARGUMENT, {"tolerance_angular", "positive"});
  }
  Numbers lower(std::size_t(m.nq()), -1), upper(std::size_t(m.nq()), 1);
  for (double bad : {2.0, nan}) {
    lower[8] = bad;
    with([&](dynIkOptions& x) { x.lower = lower.data(), x.upper = upper.data(); }, DYN_ERROR_ARGUMENT,
         {"lower[8]", "upper[8]", "lower <= upper"});
  }
  r.struct_size = 4;
  expect(DYN_ERROR_SIZE, {"struct_size", "dynIkResult"});
  r.struct_size = sizeof r;
  Numbers start = other.q;
  q = start.data();
  start[8] = nan;
  expect(DYN_ERROR_NONFINITE, {"q[8]", "NaN"});
  start = other.q, start[0] = 1e200;
  expect(DYN_ERROR_NUMERIC, {"overflows", "free"});
  start = other.q;
  tasks[0].weight = 1e300;
  expect(DYN_ERROR_NUMERIC, {"cost", "overflows", "weights"});
  q = nullptr;
  expect(DYN_ERROR_NUMERIC, {"cost", "overflows", "weights"});
}

// Whatever is finite is survived: huge weights and targets, tasks without weight, a robot that can't move.
TEST_F(IkRefused, NothingIsBroken) {
  for (double weight : {0.0, 1e-300, 1e140})
    for (double target : {0.0, 1e99}) {
      tasks[0].weight = weight, tasks[1].target[9] = target;
      const dynStatus status = dyn_ik(m, d, q, tasks.data(), 3, &o, with<dynIkOutput>({0, nullptr, nullptr, &r}));
      EXPECT_TRUE(status == DYN_OK || status == DYN_ERROR_NUMERIC) << dyn_last_error();
      EXPECT_TRUE(finite(field(m, d, "q")));
    }
  Builder b("rock");
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "rock", nullptr, nullptr, 1, some_inertia, some_inertia)) << dyn_last_error();
  const Model rock = b.finish();
  Data still(rock);
  dynIkTask t = at(rock.nframes() - 1, 1, 0);
  ASSERT_EQ(DYN_OK, dyn_ik(rock, still, nullptr, &t, 1, nullptr, with<dynIkOutput>({0, nullptr, nullptr, &r})))
      << dyn_last_error();
  EXPECT_EQ(DYN_IK_REASON_LOCAL_MINIMUM, r.reason);
}

}  // namespace
}  // namespace dyn_test
