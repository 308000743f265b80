// What the tests of planners share: a planner with its model, its data and its results.
#pragma once

#include "capi/support.hpp"

namespace dyn_test {

struct Planning {
  Model m;
  Data d{m};
  int knots;
  std::size_t n, inputs;  // n = 2 nv
  dynPlanner* planner = nullptr;
  std::vector<dynPlanCost> costs;
  dynPlanProblem problem;
  dynPlanOptions options;
  dynPlanReport report{};
  Numbers q, v, u, K, gaps;

  Planning(Model model, int knots_, dynPlanInput input, double dt) : m(std::move(model)), knots(knots_) {
    n = std::size_t(2 * m.nv()), inputs = std::size_t(input == DYN_PLAN_INPUT_TAU ? m.nv() : dyn_model_nu(m));
    EXPECT_EQ(DYN_OK, dyn_planner_new(m, knots, input, &planner)) << dyn_last_error();
    dyn_plan_problem_init(&problem), dyn_plan_options_init(&options);
    step_by(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, dt);
    const std::size_t N = std::size_t(knots);
    q.resize((N + 1) * std::size_t(m.nq())), v.resize((N + 1) * std::size_t(m.nv())), u.resize(N * inputs);
    K.resize(N * inputs * n), gaps.resize(N * n);
  }
  Planning(const Planning&) = delete;
  ~Planning() { dyn_planner_free(planner); }
  void step_by(dynIntegrator integrator, double dt) {
    dynStepOptions o;
    dyn_step_options_init(&o);
    o.integrator = integrator, o.dt = dt;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &o)) << dyn_last_error();
  }
  dynPlanCost& cost(dynPlanCostType type, double weight, double terminal) {
    dynPlanCost c;
    dyn_plan_cost_init(&c);
    c.type = type, c.weight = weight, c.terminal_weight = terminal;
    return costs.push_back(c), costs.back();
  }
  void begin(const Numbers& q0, const Numbers& v0) {
    EXPECT_EQ(DYN_OK, dyn_data_set_state(m, d, q0.data(), v0.data(), nullptr, nullptr)) << dyn_last_error();
  }
  void guess(const Numbers& inputs_of_knots) {
    EXPECT_EQ(DYN_OK, dyn_planner_set_guess(planner, m, nullptr, nullptr, inputs_of_knots.data())) << dyn_last_error();
  }
  // A guess that is no equilibrium by symmetry.
  void wave(double amplitude, double rate) {
    Numbers x(u.size());
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = amplitude * std::sin(rate * double(k));
    guess(x);
  }
  dynStatus solve() {
    problem.costs = costs.data(), problem.cost_count = std::int32_t(costs.size());
    dynPlanOutput out;
    dyn_plan_output_init(&out);
    report = {};
    report.struct_size = sizeof report;
    out.q = q.data(), out.v = v.data(), out.u = u.data(), out.K = K.data(), out.gaps = gaps.data(), out.report = &report;
    return dyn_planner_solve(planner, m, d, &problem, &options, &out);
  }
  void solve_well() { ASSERT_EQ(DYN_OK, solve()) << dyn_last_error(); }
};

}  // namespace dyn_test
