// Contact solvers: units, warm starts, repetition and early stops.
#include "solver/scenes.hpp"

namespace dyn_test {
namespace {

// Units change nothing: lengths and masses scaled by powers of two to 2^30 give the same digits.
TEST(ContactSolver, UnitsChangeNothing) {
  for (const dynContactSolverType type : all_solvers)
    for (const double units : {0x1p-30, 0x1p30})
      for (const double masses : {0x1p-30, 0x1p30}) {
        const Bodies bodies = table(4, 1, 0.2);
        Vector v = bodies.falling(1e-3);
        v[0] = 0.004;
        Scene s = bodies.scene(0.5, v), t = s;
        for (double& x : t.G) x *= masses;
        for (double& x : t.g) x *= units;
        const Answer a = solve(s, with(type, 10000)), b = solve(t, with(type, 10000));
        EXPECT_EQ(a.report.iterations, b.report.iterations) << solver_names[type];
        EXPECT_EQ(a.report.newton_steps, b.report.newton_steps);
        for (int i = 0; i < s.rows(); ++i) EXPECT_NEAR(a.lambda[i], b.lambda[i] * masses / units, 1e-13) << solver_names[type];
      }
}

// Each row in its own unit, to 1e+-9.
TEST(ContactSolver, EachRowMayHaveItsOwnUnit) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> u(-9, 9);
  for (const dynContactSolverType type : all_solvers) {
    Scene s = random_scene(6, 24, 0.6, 5), t = s;
    Vector d(s.rows());
    for (int k = 0; k < 6; ++k) d[3 * k] = d[3 * k + 1] = d[3 * k + 2] = std::pow(10, u(generator));
    for (int j = 0; j < s.rows(); ++j)
      for (int i = 0; i < s.rows(); ++i) t.G[i + s.rows() * j] *= d[i] * d[j];
    for (int i = 0; i < s.rows(); ++i) t.g[i] *= d[i];
    for (int j = 0; j < s.rows(); ++j)
      for (int i = 0; i < j; ++i) t.G[i + s.rows() * j] = t.G[j + s.rows() * i];
    const Answer a = solve(s, with(type, 10000, 1e-12)), b = solve(t, with(type, 10000, 1e-22));
    for (int i = 0; i < s.rows(); ++i) EXPECT_NEAR(a.lambda[i], b.lambda[i] * d[i], 1e-8) << solver_names[type] << " " << i;
  }
}

TEST(ContactSolver, WarmStartSavesIterations) {
  for (const dynContactSolverType type : all_solvers) {
    const Bodies bodies = stack({1, 2, 5});
    Vector v = bodies.falling(1e-3);
    v[12] = 0.002;
    Scene s = bodies.scene(0.6, v);
    const Answer cold = solve(s, with(type, 100000));
    ASSERT_EQ(DYN_CONTACT_STATUS_CONVERGED, cold.report.status) << solver_names[type];
    dynContactOptions warm = with(type);
    warm.warm_start = 1;
    Answer a = solve(s, warm, cold.lambda);
    EXPECT_LE(a.report.iterations + a.report.newton_steps, 1) << solver_names[type];
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
    if (type == DYN_CONTACT_SOLVER_TYPE_PGS) continue;
    for (double& x : v) x *= 1.001;  // the next step
    v[12] += 1e-6;
    s = bodies.scene(0.6, v);
    a = solve(s, warm, cold.lambda);
    EXPECT_EQ(DYN_CONTACT_STATUS_CONVERGED, a.report.status);
    EXPECT_LE(a.report.iterations + a.report.newton_steps, 2) << solver_names[type];
  }
}

// A guess that is far worse than no impulses (of other contacts, or of a jam) counts as none.
TEST(ContactSolver, AGuessThatIsFarOffIsLeft) {
  for (const dynContactSolverType type : all_solvers)
    for (int seed = 1; seed <= 5; ++seed) {
      Scene s = random_scene(6, 24, 0.6, seed);
      dynContactOptions warm = with(type);
      warm.warm_start = 1;
      Vector far_off(s.rows());
      for (int i = 0; i < s.rows(); ++i) far_off[i] = i % 3 == 2 ? 1e9 : -1e8;
      const Answer a = solve(s, warm, Vector(s.rows())), b = solve(s, warm, far_off);
      EXPECT_EQ(a.lambda, b.lambda) << solver_names[type] << " " << seed;
    }
}

// The same bits every time, whatever the solver was used for before.
TEST(ContactSolver, ResultsAreDeterministic) {
  for (const dynContactSolverType type : all_solvers) {
    const Solver solver(200);
    Scene small = random_scene(5, 12, 0.5, 1), large = random_scene(40, 60, 0.5, 2);
    Vector first;
    const dynContactOptions options = with(type, 200);
    for (int k = 0; k < 3; ++k) {
      dynContactReport report{};
      report.struct_size = sizeof report;
      Vector a(small.rows()), b(large.rows());
      ASSERT_EQ(DYN_OK, dyn_contact_solver_solve(solver.s, small.get(), &options, a.data(), nullptr, &report));
      ASSERT_EQ(DYN_OK, dyn_contact_solver_solve(solver.s, large.get(), &options, b.data(), nullptr, &report));
      if (k == 0) first = a;
      EXPECT_EQ(first, a) << solver_names[type];
    }
  }
}

// Stopped early: a feasible impulse with its residual, never worse for more iterations.
TEST(ContactSolver, StoppedEarlyTheImpulseIsFeasible) {
  for (const dynContactSolverType type : all_solvers) {
    Scene s = random_scene(20, 30, 0.8, 4);
    double before = HUGE_VAL;
    for (const int most : {0, 1, 2, 3, 5, 8, 13, 21, 34}) {
      const Answer a = solve(s, with(type, most));
      EXPECT_LE(a.report.iterations + a.report.newton_steps, most);
      EXPECT_LE(a.report.residual, before);
      before = a.report.residual;
      for (int k = 0; k < 20; ++k)
        EXPECT_LE(std::hypot(a.lambda[3 * k], a.lambda[3 * k + 1]), 0.8 * a.lambda[3 * k + 2] * (1 + 1e-14));
      dynContactReport again{};
      again.struct_size = sizeof again;
      const Solver solver(60);
      ASSERT_EQ(DYN_OK, dyn_contact_solver_residuals(solver.s, s.get(), a.lambda.data(), &again));
      EXPECT_NEAR(a.report.residual, again.residual, 1e-12 + 1e-9 * again.residual);
      EXPECT_NEAR(a.report.natural_map, again.natural_map, 1e-11 + 1e-9 * again.natural_map);
    }
    dynContactOptions timed = with(type, 1000000, 0);
    timed.time_budget = 1e-3;
    const Answer a = solve(s, timed);
    EXPECT_NE(DYN_CONTACT_STATUS_MAX_ITERATIONS, a.report.status);
  }
}

}  // namespace
}  // namespace dyn_test
