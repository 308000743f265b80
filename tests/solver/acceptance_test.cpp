// When impulses count as a solution: rounding, energy, and rows that nothing moves.
#include "model/block.hpp"
#include "solver/list.hpp"
#include "solver/scenes.hpp"

namespace dyn_test {
namespace {

namespace solver = dyn::solver;
using solver::Budget;

// Buffers of the solvers, and a problem scaled into them.
struct Room {
  dyn::Zeros zeros{solver::workspace_bytes(64)};
  solver::Workspace w;
  Room() { solver::place(w, 64, zeros.memory); }
  explicit Room(Scene& s) : Room() {
    solver::scale(*s.get(), w.problem);
    w.problem.speed = 1;
  }
};

// Equal rows, all equalities: G has ones everywhere.
Scene equal_rows(int n, double g) {
  Scene s;
  s.problem.equalities = n;
  s.G.assign(std::size_t(n) * n, 1), s.g.assign(n, g);
  return s;
}

// Velocities within a few roundings of the tolerance are computed with more digits; larger errors are errors.
TEST(Acceptance, ErrorsNearRoundingAreComputedExactly) {
  const double large = 1e8, rounding = 2 * 2.2e-16 * large;
  for (const double off : {3 * rounding, 30 * rounding}) {
    Scene s = equal_rows(2, 0);
    Room room(s);
    Budget b;
    b.tolerance = 1e-12;
    const double y[] = {large, -large}, c[] = {off, off};  // c is zero
    EXPECT_EQ(off < 10 * rounding, keep_best(room.w, b, y, c));
    EXPECT_NEAR(off < 10 * rounding ? 0 : off, b.best, 0.01 * off);
  }
}

// Impulses whose rounding is a ten-thousandth of the speeds are no solution: any test would pass.
TEST(Acceptance, RoundingMustNotHideTheSpeeds) {
  EXPECT_FALSE(solver::is_lost_to_round_off(1e11, 1));
  EXPECT_TRUE(solver::is_lost_to_round_off(2e12, 1));
  EXPECT_FALSE(solver::is_lost_to_round_off(2e12, 0));
}

// Rows of equalities and limits that move by 1e-12 of what others do, move by rounding: an impulse is in the others' unit.
TEST(Acceptance, RowsThatOnlyRoundingMovesHaveNoScaleOfTheirOwn) {
  for (const double moved : {5e-13, 5e-12}) {
    Scene s = equal_rows(2, 1);
    s.G = {1, 0, 0, moved * moved};
    Room room(s);
    EXPECT_EQ(1, room.w.problem.d[0]);
    EXPECT_NEAR(moved < 1e-12 ? 1 : 1 / moved, room.w.problem.d[1], moved < 1e-12 ? 0 : 0.5 / moved);
  }
}

// A ball whose rebound gains energy: by this share of what it loses on the way.
Scene gaining(double share) {
  Scene s;
  s.G = {1, 0, 0, 0, 1, 0, 0, 0, 1}, s.g = {0, 0, -1}, s.v_minus = {0, 0, -1 - 2 * share};
  s.friction = {0.5}, s.restitution = {1};
  return s;
}

TEST(Acceptance, RestitutionMayGainRoundingOnly) {
  for (const dynContactSolverType type : all_solvers) {
    Scene rounding = gaining(3e-11), more = gaining(3e-10);
    EXPECT_EQ(1, solve(rounding, with(type, 100, 1e-13)).report.restitution_scale);
    EXPECT_GT(1, solve(more, with(type, 100, 1e-13)).report.restitution_scale);
  }
}

// Or what the tolerance leaves: ten times as much.
TEST(Acceptance, RestitutionMayGainWhatTheToleranceLeaves) {
  for (const dynContactSolverType type : all_solvers) {
    Scene some = gaining(3e-6), more = gaining(3e-5);
    EXPECT_EQ(1, solve(some, with(type, 100, 1e-6)).report.restitution_scale);
    EXPECT_GT(1, solve(more, with(type, 100, 1e-6)).report.restitution_scale);
  }
}

// The factor of restitution is the largest that gains no energy, to a hundredth: the ball leaves as fast as it came.
TEST(Acceptance, RestitutionIsReducedAsLittleAsPossible) {
  for (const dynContactSolverType type : all_solvers)
    for (const double share : {0.03, 0.1, 0.2, 0.4, 0.7}) {
      Scene s = gaining(share);
      const double factor = solve(s, with(type)).report.restitution_scale, largest = 1 / (1 + 2 * share);
      EXPECT_LE(factor, largest + 1e-9);
      EXPECT_GT(factor, largest - 0.01);
    }
}

// Impulses that miss the velocities asked for do not rebound: a residual of a hundredth is the bound.
TEST(Acceptance, ReboundsNeedAResidual) {
  int rough = 0;
  for (unsigned seed = 1; seed < 30; ++seed)
    for (int sweeps = 1; sweeps < 12; ++sweeps) {
      Scene s = random_scene(6, 30, 0.5, seed);
      s.restitution.assign(6, 0.2);
      const dynContactReport r = solve(s, with(DYN_CONTACT_SOLVER_TYPE_PGS, sweeps)).report;
      if (r.restitution_scale < 1) continue;
      EXPECT_LE(r.residual, 1e-2) << seed << ", " << sweeps;
      rough += r.residual > 3e-3;
    }
  EXPECT_GT(rough, 5);
}

// Stopped by a clock, sweeps leave the best iterate of at most twenty sweeps ago.
TEST(Acceptance, StoppedSweepsKeepWhatTheyFound) {
  Scene s = random_scene(12, 20, 0.5, 3);
  Room room(s);
  static double readings;  // of the clock, one a sweep
  readings = 0;
  solver::TimeLimit limit{};
  limit.start([] { return ++readings; }, 25);
  Budget b;
  b.tolerance = 1e-14, b.max_iterations = 1000, b.limit = &limit;
  std::fill_n(room.w.y, room.w.problem.n, 0.0), std::copy_n(room.w.problem.g, room.w.problem.n, room.w.c);
  ASSERT_FALSE(keep_best(room.w, b, room.w.y, room.w.c));
  const double before = b.best;
  solver::pgs(room.w, b);
  EXPECT_EQ(DYN_CONTACT_STATUS_TIME_BUDGET, b.status);
  EXPECT_LT(b.best, 0.1 * before);
}

// Without friction tangential impulses are errors of the guess, also beside a contact whose impulse is nearer to its cone.
TEST(Acceptance, ImpulsesOfRowsWithoutACoefficientAreErrors) {
  Scene s;
  s.g = {0, 0, -1, 0, 0, -1}, s.friction = {0, 0.5}, s.G.assign(36, 0);
  for (int k = 0; k < 6; ++k) s.G[std::size_t(7 * k)] = 1;
  const Solver solver(6);
  const auto primal = [&](double without, double tangential) {
    const double lambda[6] = {without, 0, 1, tangential, 0, 1};
    dynContactReport r{};
    r.struct_size = sizeof r;
    EXPECT_EQ(DYN_OK, dyn_contact_solver_residuals(solver.s, s.get(), lambda, &r)) << dyn_last_error();
    return r.primal;
  };
  EXPECT_NEAR(0.3, primal(0.3, 0.5), 1e-15);
  EXPECT_NEAR(0.3, primal(0.3, 0.6), 1e-15);
  EXPECT_NEAR(0.5 / std::sqrt(1.25), primal(0.3, 1), 1e-15);  // distance to the cone of slope 1/2
}

}  // namespace
}  // namespace dyn_test
