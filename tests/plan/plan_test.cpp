// Planners: exact solutions of linear problems, optimality within bounds, swing-ups, contacts, and what must not change.
#include "plan/planning.hpp"

namespace dyn_test {
namespace {

Model slider() {
  Builder b("slider");
  b.joint(Spec("x", DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)).body("mass", "x", 2, {0, 0, 0});
  return b.finish();
}

// x' = x + h v', v' = v + h u / m: the plan of one iteration is that of the Riccati equation.
TEST(Planner, SolvesALinearQuadraticProblemInOneIteration) {
  constexpr int N = 30;
  constexpr double h = 0.1, mass = 2, R = 0.3, Q[2] = {2, 0.5}, QN[2] = {20, 5};
  Planning p(slider(), N, DYN_PLAN_INPUT_TAU, h);
  p.cost(DYN_PLAN_COST_TYPE_STATE, 1, 10).weights = Q, p.cost(DYN_PLAN_COST_TYPE_INPUT, R, 0);
  p.begin({1.5}, {-0.7});
  p.options.max_iterations = 1;
  p.solve_well();
  double P[2][2] = {{QN[0], 0}, {0, QN[1]}}, gain[N][2];
  const double A[2][2] = {{1, h}, {0, 1}}, B[2] = {h * h / mass, h / mass};
  for (int k = N - 1; k >= 0; --k) {
    double PA[2][2], PB[2], next[2][2];
    for (int i = 0; i < 2; ++i) {
      PB[i] = P[i][0] * B[0] + P[i][1] * B[1];
      for (int j = 0; j < 2; ++j) PA[i][j] = P[i][0] * A[0][j] + P[i][1] * A[1][j];
    }
    const double uu = R + B[0] * PB[0] + B[1] * PB[1];
    for (int j = 0; j < 2; ++j) gain[k][j] = -(B[0] * PA[0][j] + B[1] * PA[1][j]) / uu;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        next[i][j] = (i == j ? Q[i] : 0) + A[0][i] * PA[0][j] + A[1][i] * PA[1][j] - gain[k][i] * uu * gain[k][j];
    std::memcpy(P, next, sizeof P);
  }
  double x[2] = {1.5, -0.7};
  for (int k = 0; k < N; ++k) {
    const double u = gain[k][0] * x[0] + gain[k][1] * x[1];
    EXPECT_NEAR(u, p.u[std::size_t(k)], 1e-9) << k;
    for (int j = 0; j < 2; ++j) EXPECT_NEAR(gain[k][j], p.K[std::size_t(2 * k + j)], 1e-9) << k;
    x[1] += h * u / mass, x[0] += h * x[1];
    EXPECT_NEAR(x[0], p.q[std::size_t(k + 1)], 1e-9) << k;
  }
  EXPECT_NEAR(0.5 * (P[0][0] * 1.5 * 1.5 - 2 * P[0][1] * 1.5 * 0.7 + P[1][1] * 0.7 * 0.7), p.report.cost, 1e-9);
  p.options.max_iterations = 5;
  p.solve_well();
  EXPECT_EQ(DYN_PLAN_STATUS_CONVERGED, p.report.status);
}

// The same with bounds: a quadratic program. Its gradient by each input, from the adjoint equation, vanishes inside and points
// outwards at bounds.
TEST(Planner, IsOptimalWithinBounds) {
  constexpr int N = 40;
  constexpr double h = 0.1, mass = 2, R = 0.3, Q[2] = {2, 0.5}, lower = -0.4, upper = 0.5;
  Planning p(slider(), N, DYN_PLAN_INPUT_TAU, h);
  p.cost(DYN_PLAN_COST_TYPE_STATE, 1, 10).weights = Q, p.cost(DYN_PLAN_COST_TYPE_INPUT, R, 0);
  p.problem.lower = &lower, p.problem.upper = &upper;
  p.options.tolerance = 1e-15;
  p.begin({1.5}, {-0.7});
  p.solve_well();
  EXPECT_EQ(DYN_PLAN_STATUS_CONVERGED, p.report.status);
  EXPECT_EQ(0, p.report.bound_violation);
  double l[2] = {10 * Q[0] * p.q[N], 10 * Q[1] * p.v[N]};
  int active = 0;
  for (std::size_t k = N; k-- > 0;) {
    const double u = p.u[k], gradient = R * u + h / mass * (h * l[0] + l[1]);
    if (u == lower) EXPECT_GE(gradient, -1e-9);
    else if (u == upper) EXPECT_LE(gradient, 1e-9);
    else EXPECT_NEAR(0, gradient, 1e-9) << k;
    active += u == lower || u == upper;
    EXPECT_LE(lower, u);
    EXPECT_LE(u, upper);
    l[1] = Q[1] * p.v[k] + h * l[0] + l[1], l[0] = Q[0] * p.q[k] + l[0];
  }
  EXPECT_LT(5, active);
  EXPECT_GT(N - 5, active);
}

Model cart_pole() {
  Builder b("cart_pole");
  b.joint(Spec("slide", DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)).body("cart", "slide", 1, {0, 0, 0});
  b.joint(Spec("hinge", DYN_JOINT_TYPE_CONTINUOUS, "slide").about(0, 1, 0)).body("pole", "hinge", 0.3, {0, 0, -0.5}, no_inertia);
  dynActuator motor;
  dyn_actuator_init(&motor, DYN_ACTUATOR_TYPE_MOTOR);
  motor.control_range[0] = -10, motor.control_range[1] = 10;
  EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, "force", &motor, "slide")) << dyn_last_error();
  return b.finish();
}
constexpr double upright[4] = {0, M_PI, 0, 0};

struct SwingUp : Planning {
  explicit SwingUp(int N = 100) : Planning(cart_pole(), N, DYN_PLAN_INPUT_CONTROL, 0.02) {
    cost(DYN_PLAN_COST_TYPE_STATE, 0.02, 2000).reference = upright;
    cost(DYN_PLAN_COST_TYPE_INPUT, 1e-3, 0);
    options.max_iterations = 500;
    begin({0, 0}, {0, 0}), wave(0.1, 0.1);
  }
};

TEST(Planner, SwingsACartPoleUp) {
  SwingUp p;
  p.solve_well();
  EXPECT_EQ(DYN_PLAN_STATUS_CONVERGED, p.report.status);
  EXPECT_NEAR(0, p.q[200], 1e-2);
  EXPECT_NEAR(M_PI, p.q[201], 1e-2);
  EXPECT_NEAR(0, p.v[200], 1e-2);
  EXPECT_NEAR(0, p.v[201], 1e-2);
  int at_bounds = 0;
  for (const double u : p.u) {
    EXPECT_LE(std::abs(u), 10);
    at_bounds += std::abs(u) == 10;
  }
  EXPECT_LT(0, at_bounds);
  // steps of the data, from the same state, are the plan
  for (std::size_t k = 0; k < 100; ++k) {
    ASSERT_EQ(DYN_OK, dyn_data_set_control(p.m, p.d, &p.u[k]));
    ASSERT_EQ(DYN_OK, dyn_step(p.m, p.d));
  }
  EXPECT_NEAR(p.q[201], field(p.m, p.d, "q")[1], 1e-6);  // 100 steps with rounding that an inverted pole amplifies
}

Model acrobot() {
  const double I[9] = {0.083, 0, 0, 0, 0.083, 0, 0, 0, 1e-3};
  Builder b("acrobot");
  b.joint(Spec("shoulder", DYN_JOINT_TYPE_CONTINUOUS).about(0, 1, 0)).body("upper", "shoulder", 1, {0, 0, -0.5}, I);
  b.joint(Spec("elbow", DYN_JOINT_TYPE_CONTINUOUS, "shoulder", {0, 0, -1}).about(0, 1, 0));
  b.body("lower", "elbow", 1, {0, 0, -0.5}, I);
  dynActuator motor;
  dyn_actuator_init(&motor, DYN_ACTUATOR_TYPE_MOTOR);
  motor.control_range[0] = -8, motor.control_range[1] = 8;
  EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, "motor", &motor, "elbow")) << dyn_last_error();
  return b.finish();
}

// Four steps of 5 ms from knot to knot.
TEST(Planner, SwingsAnAcrobotUp) {
  constexpr double goal[4] = {M_PI, 0, 0, 0}, weights[4] = {1, 1, 0.1, 0.1};
  Planning p(acrobot(), 200, DYN_PLAN_INPUT_CONTROL, 0.005);
  dynPlanCost& state = p.cost(DYN_PLAN_COST_TYPE_STATE, 0, 1000);
  state.reference = goal, state.weights = weights;
  p.cost(DYN_PLAN_COST_TYPE_INPUT, 1e-3, 0);
  p.options.max_iterations = 300, p.options.steps = 4;
  p.begin({0, 0}, {0, 0}), p.wave(0.5, 2 * M_PI / 2.2 * 0.02);
  p.solve_well();
  double e[2];
  ASSERT_EQ(DYN_OK, dyn_difference(p.m, goal, &p.q[400], e));
  EXPECT_NEAR(0, e[0], 1e-2);
  EXPECT_NEAR(0, e[1], 1e-2);
  EXPECT_NEAR(0, p.v[400], 2e-2);
  EXPECT_NEAR(0, p.v[401], 2e-2);
  for (const double u : p.u) EXPECT_LE(std::abs(u), 8);
}

// The cost of the plan as it is.
double cost_of_guess(Planning& p) {
  const dynPlanOptions kept = p.options;
  p.options.max_iterations = 1, p.options.tolerance = 1e300;
  p.solve_well();
  p.options = kept;
  return p.report.cost;
}

// panda with a free base: every type of cost, in turn.
TEST(Planner, EveryCostFallsAsItsGradientSays) {
  for (const dynPlanCostType type : every<dynPlanCostType>("dynPlanCostType")) {
    Planning p(robot("panda", DYN_BASE_FLOATING), 6, DYN_PLAN_INPUT_TAU, 0.01);
    const State s = random_state(p.m, 3);
    const State other = random_state(p.m, 8);
    Numbers reference(64);
    if (type == DYN_PLAN_COST_TYPE_STATE) {
      std::copy(other.q.begin(), other.q.end(), reference.begin());
    } else if (type == DYN_PLAN_COST_TYPE_FRAME_ORIENTATION || type == DYN_PLAN_COST_TYPE_FRAME_PLACEMENT) {
      reference = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6, 0.3, 0.2, -0.1};
    }
    Numbers weights(64);
    for (std::size_t k = 0; k < 64; ++k) weights[k] = 0.5 + 0.1 * double(k % 7);
    dynPlanCost& c = p.cost(type, 1, 2);
    c.reference = reference.data(), c.weights = weights.data(), c.frame = p.m.nframes() - 1;
    const Numbers wide(p.inputs, 1e3), low(p.inputs, -1e3);
    p.problem.lower = low.data(), p.problem.upper = wide.data();
    Numbers guess(p.u.size());
    for (std::size_t k = 0; k < guess.size(); ++k) guess[k] = std::cos(0.7 * double(k));
    p.begin(s.q, s.v), p.guess(guess);
    const double before = cost_of_guess(p);
    p.guess(guess);
    // a step so short that the cost is linear along it
    p.options.max_iterations = 1, p.options.tolerance = 0, p.options.regularisation = 1e9;
    p.solve_well();
    EXPECT_EQ(1, p.report.step_length) << type;
    const double decrease = before - p.report.cost;
    EXPECT_LT(0, decrease) << type;
    // what is not linear is of the order of 1 / regularisation; the decrease itself is known to 1e-16 of the cost
    EXPECT_NEAR(1, decrease / p.report.expected_decrease, 2e-3 + 1e-15 * before / decrease) << type;
  }
}

TEST(Planner, ClosesTheGapsOfAGuess) {
  SwingUp p;
  Numbers q(202), v(202), u(100, 0.5);
  for (std::size_t k = 0; k <= 100; ++k) q[2 * k + 1] = M_PI * double(k) / 100, v[2 * k + 1] = M_PI / 2;
  ASSERT_EQ(DYN_OK, dyn_planner_set_guess(p.planner, p.m, q.data(), v.data(), u.data()));
  p.options.max_iterations = 1;
  p.solve_well();
  EXPECT_LT(0, p.report.step_length);
  p.options.max_iterations = 500;
  p.solve_well();
  EXPECT_EQ(DYN_PLAN_STATUS_CONVERGED, p.report.status);
  EXPECT_GE(1e-8, p.report.gap);
  EXPECT_NEAR(M_PI, std::abs(std::remainder(p.q[201], 2 * M_PI)), 1e-2);
}

TEST(Planner, GivesTheSameBitsAndLeavesTheState) {
  SwingUp a, b;
  a.options.max_iterations = b.options.max_iterations = 20;
  const Numbers q = field(a.m, a.d, "q"), v = field(a.m, a.d, "v");
  a.solve_well(), b.solve_well();
  EXPECT_TRUE(same_bits(a.u, b.u) && same_bits(a.q, b.q) && same_bits(a.v, b.v) && same_bits(a.K, b.K));
  EXPECT_TRUE(same_bits(q, field(a.m, a.d, "q")) && same_bits(v, field(a.m, a.d, "v")));
  // again, from the same guess, in the same planner
  const Numbers u = a.u;
  a.begin({0, 0}, {0, 0}), a.wave(0.1, 0.1), a.solve_well();
  EXPECT_TRUE(same_bits(u, a.u));
}

// In the caller's memory, shifted by a knot.
TEST(Planner, ShiftsItsPlan) {
  std::unique_ptr<void, decltype(&std::free)> memory(nullptr, std::free);  // outlives the planner
  SwingUp p(10);
  const std::size_t size = dyn_planner_size(p.m, 10, DYN_PLAN_INPUT_CONTROL);
  memory.reset(std::aligned_alloc(64, (size + 63) / 64 * 64));
  dynPlanner* own = nullptr;
  ASSERT_EQ(DYN_OK, dyn_planner_init(p.m, 10, DYN_PLAN_INPUT_CONTROL, memory.get(), size, &own)) << dyn_last_error();
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_planner_init(p.m, 10, DYN_PLAN_INPUT_CONTROL, memory.get(), size - 1, &own));
  std::swap(own, p.planner);
  dyn_planner_free(own);
  p.wave(0.1, 1), p.solve_well();
  const Numbers u = p.u, q = p.q;
  EXPECT_EQ(DYN_OK, dyn_planner_shift(p.planner, 1));
  p.begin({q[2], q[3]}, {p.v[2], p.v[3]});
  p.options.tolerance = 1e300, p.options.gap_tolerance = 1e300;  // as it is
  p.solve_well();
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(u[std::min<std::size_t>(k + 1, 9)], p.u[k]);
  for (std::size_t k = 0; k <= 20; ++k) EXPECT_EQ(q[std::min<std::size_t>(k + 2, 20 + k % 2)], p.q[k]) << k;
}

// l = u^2 / 2000 and (x - reference)^2, as the planner's own costs have them.
int add_costs(void*, const dynPlanPoint* at) {
  const bool last = at->inputs == 0;
  const double w = last ? 2000 : 0.02, x[4] = {at->q[0], std::remainder(at->q[1] - M_PI, 2 * M_PI), at->v[0], at->v[1]};
  for (int k = 0; k < 4; ++k) {
    *at->cost += 0.5 * w * x[k] * x[k];
    if (at->l_x) at->l_x[k] += w * x[k], at->l_xx[5 * k] += w;
  }
  if (last) return 0;
  *at->cost += 0.5e-3 * at->u[0] * at->u[0];
  if (at->l_u) at->l_u[0] += 1e-3 * at->u[0], at->l_uu[0] += 1e-3;
  return dyn_crba(at->model, at->data, at->q, nullptr) != DYN_OK;  // the data may be used
}

TEST(Planner, TakesTheCallersCosts) {
  SwingUp own, callers;
  callers.costs.clear();
  callers.problem.function = add_costs;
  own.begin({0, 0.1}, {0, 0}), callers.begin({0, 0.1}, {0, 0});  // at 0 the difference to pi has either sign
  own.options.max_iterations = callers.options.max_iterations = 3;
  own.solve_well(), callers.solve_well();
  EXPECT_NEAR(own.report.cost, callers.report.cost, 1e-9 * own.report.cost);
  callers.problem.function = [](void*, const dynPlanPoint* at) { return int(at->knot == 3); };
  EXPECT_EQ(DYN_ERROR_CANCELLED, callers.solve());
  callers.problem.function = [](void*, const dynPlanPoint* at) { return *at->cost = nan, 0; };
  EXPECT_EQ(DYN_ERROR_NUMERIC, callers.solve());
}

// Two links in a plane, whose tip goes round a disc of radius 0.35 m: penalty of its depth, by the caller.
struct Disc {
  double x = 0.9, z = 0.35, radius = 0.35;
  double depth(const double* p) const { return radius - std::hypot(p[0] - x, p[2] - z); }
};
int keep_out(void* context, const dynPlanPoint* at) {
  const Disc& disc = *static_cast<const Disc*>(context);
  double X[12], J[12];
  const int tip = dyn_model_frame_id(at->model, "tip");
  if (dyn_forward_kinematics(at->model, at->data, at->q, nullptr, nullptr) ||
      dyn_frame_placement(at->model, at->data, tip, X) ||
      dyn_frame_jacobian(at->model, at->data, tip, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J))
    return 1;
  const double margin = 0.02, depth = disc.depth(X + 9) + margin, weight = 1e4;
  if (depth <= 0) return 0;
  *at->cost += 0.5 * weight * depth * depth;
  if (!at->l_x) return 0;
  const double r = disc.radius + margin - depth, nx = (X[9] - disc.x) / r, nz = (X[11] - disc.z) / r;
  const double g[2] = {-nx * J[0] - nz * J[2], -nx * J[6] - nz * J[8]};  // of the depth
  for (int i = 0; i < 2; ++i) {
    at->l_x[i] += weight * depth * g[i];
    for (int j = 0; j < 2; ++j) at->l_xx[i + 4 * j] += weight * g[i] * g[j];
  }
  return 0;
}

TEST(Planner, ReachesAroundADisc) {
  constexpr int N = 80;
  const double I[9] = {0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.02};
  Builder b("arm");
  const double none[3] = {};
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  b.joint(Spec("shoulder", DYN_JOINT_TYPE_REVOLUTE).about(0, -1, 0)).body("upper", "shoulder", 1, {0.35, 0, 0}, I);
  b.joint(Spec("elbow", DYN_JOINT_TYPE_REVOLUTE, "shoulder", {0.7, 0, 0}).about(0, -1, 0));
  b.body("fore", "elbow", 1, {0.35, 0, 0}, I);
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.7, 0, 0};
  EXPECT_EQ(DYN_OK, dyn_builder_add_frame(b, "tip", "elbow", X, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
  Planning p(b.finish(), N, DYN_PLAN_INPUT_TAU, 0.02);
  const Disc disc;
  const double target[3] = {0.9, 0, 0.85}, still[4] = {0, 0, 1, 1}, bound[2] = {20, 20}, lower[2] = {-20, -20};
  dynPlanCost& reach = p.cost(DYN_PLAN_COST_TYPE_FRAME_POSITION, 0, 1e4);
  const int tip = dyn_model_frame_id(p.m, "tip");
  reach.reference = target, reach.frame = tip;
  p.cost(DYN_PLAN_COST_TYPE_INPUT, 1e-2, 0), p.cost(DYN_PLAN_COST_TYPE_STATE, 1e-3, 100).weights = still;
  p.problem.lower = lower, p.problem.upper = bound;
  p.problem.context = const_cast<Disc*>(&disc);
  p.options.max_iterations = 200;
  const auto deepest = [&] {
    double most = -1;
    for (std::size_t k = 0; k <= N; ++k) {
      double place[12];
      EXPECT_EQ(DYN_OK, dyn_forward_kinematics(p.m, p.d, &p.q[2 * k], nullptr, nullptr));
      EXPECT_EQ(DYN_OK, dyn_frame_placement(p.m, p.d, tip, place));
      most = std::max(most, disc.depth(place + 9));
    }
    return most;
  };
  const Numbers start = {-0.8, 1.2};  // in front of the disc
  for (const bool free : {true, false}) {
    p.problem.function = free ? nullptr : keep_out;
    p.begin(start, {0, 0}), p.guess(Numbers(p.u.size(), 0.01));
    p.solve_well();
    double place[12];
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(p.m, p.d, &p.q[2 * N], nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_frame_placement(p.m, p.d, tip, place));
    EXPECT_NEAR(target[0], place[9], 1e-2);
    EXPECT_NEAR(target[2], place[11], 1e-2);
    const double depth = deepest();
    EXPECT_TRUE(free ? depth > 0.1 : depth < 0) << depth;
  }
}

TEST(Planner, RefusesWhatIsWrong) {
  SwingUp p(5);
  dynPlanner* none = nullptr;
  EXPECT_EQ(DYN_ERROR_LIMIT, dyn_planner_new(p.m, 0, DYN_PLAN_INPUT_TAU, &none));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_new(p.m, 5, static_cast<dynPlanInput>(7), &none));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_planner_new(nullptr, 5, DYN_PLAN_INPUT_TAU, &none));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_new(p.m, 5, DYN_PLAN_INPUT_TAU, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_planner_shift(nullptr, 1));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_shift(p.planner, -1));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_planner_solve(nullptr, p.m, p.d, &p.problem, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_solve(p.planner, p.m, p.d, nullptr, nullptr, nullptr));
  const Numbers bad(64, nan), good(64);
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_planner_set_guess(p.planner, p.m, nullptr, nullptr, bad.data()));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_set_guess(p.planner, p.m, good.data(), nullptr, nullptr));
  const Model other = cart_pole();
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_planner_set_guess(p.planner, other, nullptr, nullptr, nullptr));

  const auto refused = [&](dynStatus expected, const char* word, auto&& change) {
    const auto costs = p.costs;
    const auto problem = p.problem;
    const auto options = p.options;
    change();
    EXPECT_EQ(expected, p.solve()) << word;
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), word)) << dyn_last_error();
    p.costs = costs, p.problem = problem, p.options = options;
  };
  const double one = 1, zero = 0;
  refused(DYN_ERROR_ARGUMENT, "lower[0]", [&] { p.problem.lower = &one, p.problem.upper = &zero; });
  refused(DYN_ERROR_ARGUMENT, "lower[0]", [&] { p.problem.lower = bad.data(); });
  refused(DYN_ERROR_ARGUMENT, "weight[0] of cost 1", [&] { p.costs[1].weight = -1; });
  refused(DYN_ERROR_NONFINITE, "terminal_weight", [&] { p.costs[0].terminal_weight = inf; });
  refused(DYN_ERROR_NONFINITE, "reference", [&] { p.costs[0].reference = bad.data(); });
  refused(DYN_ERROR_ARGUMENT, "reference_stride", [&] { p.costs[0].reference_stride = 3; });
  refused(DYN_ERROR_ARGUMENT, "type of a cost", [&] { p.costs[0].type = static_cast<dynPlanCostType>(99); });
  refused(DYN_ERROR_ARGUMENT, "frame", [&] { p.costs[0].type = DYN_PLAN_COST_TYPE_FRAME_POSITION, p.costs[0].frame = 99; });
  refused(DYN_ERROR_ARGUMENT, "rotation", [&] {
    p.costs[0].type = DYN_PLAN_COST_TYPE_FRAME_ORIENTATION, p.costs[0].reference = good.data();
  });
  refused(DYN_ERROR_ARGUMENT, "max_iterations", [&] { p.options.max_iterations = 0; });
  refused(DYN_ERROR_ARGUMENT, "steps", [&] { p.options.steps = 0; });
  refused(DYN_ERROR_ARGUMENT, "epsilon", [&] { p.options.epsilon = 0; });
  refused(DYN_ERROR_ARGUMENT, "method", [&] { p.options.method = static_cast<dynDerivativeMethod>(9); });
  refused(DYN_ERROR_NONFINITE, "tolerance", [&] { p.options.tolerance = nan; });
  p.step_by(DYN_INTEGRATOR_RK4, 0.02);
  refused(DYN_ERROR_UNSUPPORTED, "ANALYTIC", [&] { p.options.method = DYN_DERIVATIVE_METHOD_ANALYTIC; });
  p.solve_well();
  EXPECT_EQ(0, p.report.analytic);
  EXPECT_LT(0, p.report.differences);
  Data small(p.m, DYN_PART_SIMULATION);
  EXPECT_EQ(DYN_ERROR_PART, dyn_planner_solve(p.planner, p.m, small, &p.problem, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_planner_solve(p.planner, other, p.d, &p.problem, nullptr, nullptr));
  dynPlanner* const freed = p.planner;
  dyn_planner_free(freed), dyn_planner_free(freed), dyn_planner_free(nullptr);
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_planner_shift(freed, 1));
}

}  // namespace
}  // namespace dyn_test
