// Planners of a quadruped on the floor: it stands up, and it is pushed while every sample of time has one iteration.
#include "plan/planning.hpp"

namespace dyn_test {
namespace {

struct Quadruped : Planning {
  Numbers effort = Numbers(18);

  explicit Quadruped(int knots) : Planning(on_floor(), knots, DYN_PLAN_INPUT_TAU, 0.02) {
    const double* const limit = dyn_model_array(m, DYN_MODEL_ARRAY_EFFORT_LIMIT);
    std::copy(limit + 6, limit + 18, effort.begin() + 6);
  }
  static Model on_floor() {
    Builder b;
    dyn_builder_free(b.b);
    EXPECT_EQ(DYN_OK, dyn_builder_from_model(robot("go2", DYN_BASE_FLOATING), &b.b)) << dyn_last_error();
    return b.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}).finish();
  }
  // q with a foot's lowest point on the floor.
  Numbers pose(double thigh, double calf) {
    Numbers x(19);
    x[6] = 1;
    for (std::size_t leg = 0; leg < 4; ++leg) x[8 + 3 * leg] = thigh, x[9 + 3 * leg] = calf;
    double X[12];
    EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, d, x.data(), nullptr, nullptr));
    EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, dyn_model_frame_id(m, "FL_foot"), X)) << dyn_last_error();
    x[2] = 0.022 - X[11];
    return x;
  }
  // Torques of servos at a state, with a quarter of the weight on each foot.
  Numbers servos(const Numbers& q, const Numbers& v, const Numbers& target) {
    Numbers tau(18), J(6 * 18);
    EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, d, q.data(), nullptr, nullptr));
    for (const char* foot : {"FL_foot", "FR_foot", "RL_foot", "RR_foot"}) {
      EXPECT_EQ(DYN_OK, dyn_frame_jacobian(m, d, dyn_model_frame_id(m, foot), DYN_REFERENCE_LOCAL_WORLD_ALIGNED, J.data()));
      for (std::size_t k = 6; k < 18; ++k) tau[k] -= J[6 * k + 2] * 9.81 * dyn_model_total_mass(m) / 4;
    }
    for (std::size_t k = 6; k < 18; ++k)
      tau[k] = std::clamp(tau[k] + 60 * (target[k + 1] - q[k + 1]) - v[k], -effort[k], effort[k]);
    return tau;
  }
  Numbers error(const Numbers& reference, const double* q) const {
    Numbers e(18);
    EXPECT_EQ(DYN_OK, dyn_difference(m, reference.data(), q, e.data()));
    return e;
  }
  // Steps of a simulation beside the planner's.
  void step(dynData* sim, const Numbers& tau) const {
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, sim, nullptr, nullptr, nullptr, tau.data()));
    ASSERT_EQ(DYN_OK, dyn_step(m, sim)) << dyn_last_error();
  }
};

Numbers joined(Numbers a, const Numbers& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
double largest(const Numbers& x) {
  double most = 0;
  for (double e : x) most = std::max(most, std::abs(e));
  return most;
}

// The guess: servos that follow a ramp. The plan ends nearer, in bounds, with a fraction of its cost.
TEST(PlannerOfAQuadruped, StandsUp) {
  constexpr int N = 50;
  Quadruped p(N);
  const Numbers low = p.pose(1.25, -2.5), high = p.pose(0.75, -1.5), still(18);
  const Data sim(p.m);
  dynStepOptions o;
  dyn_step_options_init(&o);
  o.dt = 0.02;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(p.m, sim, &o));
  ASSERT_EQ(DYN_OK, dyn_data_set_state(p.m, sim, low.data(), still.data(), nullptr, nullptr));
  Numbers u;
  for (int k = 0; k < N; ++k) {
    const double s = std::min(1.0, k / 25.0);
    Numbers target(19);
    for (std::size_t i = 0; i < 19; ++i) target[i] = low[i] + s * (high[i] - low[i]);
    const Numbers tau = p.servos(field(p.m, sim, "q"), field(p.m, sim, "v"), target);
    p.step(sim, tau);
    u.insert(u.end(), tau.begin(), tau.end());
  }
  const Numbers goal = joined(high, still);
  Numbers weights(36, 1);
  std::fill_n(weights.begin(), 2, 10), std::fill_n(weights.begin() + 2, 4, 100);
  std::fill_n(weights.begin() + 18, 6, 1), std::fill_n(weights.begin() + 24, 12, 0.05);
  dynPlanCost& state = p.cost(DYN_PLAN_COST_TYPE_STATE, 0.1, 300);
  state.reference = goal.data(), state.weights = weights.data();
  p.cost(DYN_PLAN_COST_TYPE_INPUT, 1e-3, 0);
  p.begin(low, still), p.guess(u);
  p.options.max_iterations = 1, p.options.tolerance = 1e300;  // the guess itself
  p.solve_well();
  const double before = p.report.cost;
  p.options.max_iterations = 60, p.options.tolerance = 1e-9;
  p.solve_well();
  EXPECT_LT(p.report.cost, 0.75 * before);
  EXPECT_EQ(0, p.report.bound_violation);
  for (std::size_t k = 0; k < p.u.size(); ++k) EXPECT_LE(std::abs(p.u[k]), p.effort[k % 18]);
  EXPECT_LT(largest(p.error(high, &p.q[19 * N])), 2e-2);
  EXPECT_LT(largest(Numbers(p.v.end() - 18, p.v.end())), 0.3);
}

// Largest error of the base's position and orientation (m, rad); feet may have slipped.
double base_error(const Quadruped& p, dynData* sim, const Numbers& stand) {
  const Numbers e = p.error(stand, field(p.m, sim, "q").data());
  return largest(Numbers(e.begin(), e.begin() + 6));
}

// 25 knots of 20 ms, one iteration a sample, 60 N sideways for 0.1 s; the simulation has steps of 2 ms.
TEST(PlannerOfAQuadruped, HoldsItsStandAgainstAPush) {
  constexpr int N = 25;
  Quadruped p(N);
  const Data sim(p.m);
  dynStepOptions o;
  dyn_step_options_init(&o);
  o.dt = 0.002;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(p.m, sim, &o));
  const Numbers start = p.pose(0.75, -1.5), still(18);
  ASSERT_EQ(DYN_OK, dyn_data_set_state(p.m, sim, start.data(), still.data(), nullptr, nullptr));
  Numbers hold;
  for (int k = 0; k < 1000; ++k) p.step(sim, hold = p.servos(field(p.m, sim, "q"), field(p.m, sim, "v"), start));
  const Numbers stand = field(p.m, sim, "q"), goal = joined(stand, still);
  Numbers weights(36, 1), u;
  std::fill_n(weights.begin(), 6, 100), weights[2] = 400;
  std::fill_n(weights.begin() + 6, 12, 3), std::fill_n(weights.begin() + 18, 6, 3), std::fill_n(weights.begin() + 24, 12, 0.1);
  dynPlanCost& state = p.cost(DYN_PLAN_COST_TYPE_STATE, 1, 10);
  state.reference = goal.data(), state.weights = weights.data();
  p.cost(DYN_PLAN_COST_TYPE_INPUT, 1e-3, 0).reference = hold.data();
  for (int k = 0; k < N; ++k) u.insert(u.end(), hold.begin(), hold.end());
  p.guess(u);
  p.options.max_iterations = 1;
  double worst = 0;
  const int pushed = dyn_model_frame_id(p.m, "root_joint");
  ASSERT_LE(0, pushed);
  for (int k = 0; k < 60; ++k) {
    p.begin(field(p.m, sim, "q"), field(p.m, sim, "v"));
    ASSERT_EQ(DYN_OK, dyn_planner_shift(p.planner, k > 0));
    p.solve_well();
    p.options.regularisation = std::min(p.report.regularisation, 100.0);
    ASSERT_EQ(DYN_OK, dyn_data_clear_wrenches(p.m, sim));
    const double force[6] = {0, k >= 10 && k < 15 ? 60.0 : 0.0, 0, 0, 0, 0};
    ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(p.m, sim, pushed, nullptr, force, DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
    for (int s = 0; s < 10; ++s) p.step(sim, Numbers(p.u.begin(), p.u.begin() + 18));
    worst = std::max(worst, base_error(p, sim, stand));
  }
  EXPECT_LT(5e-3, worst);  // the push was felt
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(base_error(p, sim, stand), 0.02);
  EXPECT_LT(largest(field(p.m, sim, "v")), 0.05);
}

}  // namespace
}  // namespace dyn_test
