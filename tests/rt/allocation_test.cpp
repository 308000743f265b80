// Tests that after creation nothing allocates or locks: every entry point on an arm, a quadruped, a humanoid, a gripper with
// mimic joints, and a robot of all joint types; constraints, contact solvers and batches.
#include <array>

#include "capi/batch.hpp"
#include "rt/interposed.hpp"
#include "rt/work.hpp"

namespace dyn_test {
namespace {

TEST(Allocations, TheCountersCount) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = chain(2);
  const long before = allocations, locks_before = locks;
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_INVERSE, &d));  // creation allocates and locks
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
    EXPECT_EQ(DYN_OK, dyn_constrained_dynamics(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr,
                                               with<dynConstrainedOutput>({0, ddq.data(), nullptr, lambda.data(), &result})))
        << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constrained_dynamics_derivatives(m, d, s.q.data(), s.v.data(), s.tau.data(), nullptr, nullptr, &out))
        << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constraint_impulse(m, d, s.q.data(), s.v.data(), nullptr, ddq.data(), lambda.data(), &result))
        << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_constraint_impulse_derivatives(m, d, s.q.data(), s.v.data(), nullptr, &out)) << dyn_last_error();
    EXPECT_EQ(DYN_OK,
              dyn_constrained_inverse_dynamics(m, d, s.q.data(), s.v.data(), s.a.data(), nullptr, nullptr,
                                               with<dynConstrainedOutput>({0, nullptr, ddq.data(), lambda.data(), &result})));
    EXPECT_EQ(DYN_OK, dyn_constraint_terms(m, d, s.q.data(), s.v.data(), lambda.data(), J.data(), lambda.data(), lambda.data()))
        << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus(m, d, s.q.data(), G.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_factor(m, d, s.q.data(), J.data(), lambda.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_times(m, d, s.q.data(), J.data(), lambda.data())) << dyn_last_error();
    EXPECT_EQ(DYN_OK, dyn_delassus_solve(m, d, s.q.data(), 1e-3, J.data(), lambda.data())) << dyn_last_error();
    dyn_constraint_report(m, d, s.q.data(), &report, nullptr, 0);
    EXPECT_EQ(DYN_OK, dyn_project(m, d, s.q.data(), s.v.data(), nullptr, projected.data(), ddq.data(), &result))
        << dyn_last_error();
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

// A swing of an arm: derivatives, the line search, and errors.
TEST(Allocations, NoneInPlanners) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Model m = chain(3);
  const Data d(m);
  dynPlanner* planner = nullptr;
  ASSERT_EQ(DYN_OK, dyn_planner_new(m, 10, DYN_PLAN_INPUT_TAU, &planner)) << dyn_last_error();
  dynPlanCost cost[2];
  dyn_plan_cost_init(&cost[0]), dyn_plan_cost_init(&cost[1]);
  cost[0].type = DYN_PLAN_COST_TYPE_FRAME_PLACEMENT, cost[1].type = DYN_PLAN_COST_TYPE_INPUT;
  cost[0].frame = m.nframes() - 1;
  dynPlanProblem problem;
  dyn_plan_problem_init(&problem);
  problem.costs = cost, problem.cost_count = 2;
  const long before = allocations, locked = locks;
  EXPECT_EQ(DYN_OK, dyn_planner_solve(planner, m, d, &problem, nullptr, nullptr)) << dyn_last_error();
  EXPECT_EQ(DYN_OK, dyn_planner_shift(planner, 1));
  cost[0].weight = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_planner_solve(planner, m, d, &problem, nullptr, nullptr));
  EXPECT_EQ(before, allocations);
  EXPECT_EQ(locked, locks);
  dyn_planner_free(planner);
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
    c.q[10] = c.v[10] = c.a[10] = c.tau[10] = nan;  // of which each algorithm reads one at least
    const long before = anywhere, calls_before = system_calls;
    const dynStatus status = c(batch);
    EXPECT_EQ(before, anywhere) << c.info.name;
    EXPECT_LE(system_calls - calls_before, 3 * 4) << c.info.name;
    EXPECT_EQ(DYN_ERROR_NONFINITE, status);
  }
  EXPECT_GT(system_calls, 0);  // they are counted
}

}  // namespace
}  // namespace dyn_test
