// The solve of steps without a tolerance: Newton's method near a solution, accelerated sweeps elsewhere.
// max_iterations bounds their sum.
#include "simulation/accelerated_sweeps.hpp"
#include "simulation/newton.hpp"

namespace dyn::simulation {

void Island::accelerated_sweeps(dynContactReport& report) {
  build_rows();
  AcceleratedSweeps sweeps(*this);
  sweeps.run(w.max_iterations(), report);
  report.residual = fastest > 0 ? sweeps.residual() / fastest : 0;
  sweeps.write();
}

// Stress that redundant contacts keep from an impact does not stay: now and then an island at rest takes its smallest impulses.
// They are taken if their residual is tolerated. Returns whether it tried.
bool Island::relax(const dynContactReport& report, double tolerated) {
  const auto step = std::llround(d.time[0] / h);
  if (step % tuning::island::relaxed_every != 0 || report.newton_steps > 0 || contacts == 0 || equalities > 0 || bounces ||
      w.closed_gap > 0 || (d.acting & DYN_EFFECT_SLEEPING) || !has_runs() || !ordered())
    return false;
  build_rows();
  Newton(*this).least_norm(tolerated);
  return true;
}

// Newton's method goes on to the fine residual: bodies at rest then stay at rest, and the next steps have nothing to solve.
// Where it does not get there, as in a jam, sweeps go on from the best impulses.
// Small islands and few sweeps leave iterations for methods that large mass ratios do not slow down.
void Island::solve_to_default(dynContactReport& report) {
  using namespace tuning::default_solve;
  allowance = w.max_iterations();
  build_rows();
  AcceleratedSweeps sweeps(*this);
  const auto unsolved = [&] { return report.residual > tolerance && within_budget(report); };
  report.residual = fastest > 0 ? sweeps.residual() / fastest : 0;
  if (report.residual <= tuning::island::tolerance && relax(report, tuning::island::tolerance)) {
    sweeps.load();
    report.residual = fastest > 0 ? sweeps.residual() / fastest : 0;
  }
  w.limit.expect(solver::TimeLimit::Unit::Segments, rows);
  const double fine = wanted(report.residual, tuning::island::fine);
  if (report.residual > fine && report.residual <= max_guess && !w.time_is_up() && ordered()) {
    const double wanted = tolerance;
    tolerance = std::min(tolerance, fine);
    Newton method(*this);
    if (!method.run(newton_steps, wanted, report)) method.write_best(report);
    tolerance = wanted;
    sweeps.load();
  }
  w.limit.expect(solver::TimeLimit::Unit::Sweep, rows);
  if (report.residual > tolerance && (report.newton_steps == 0 || within_budget(report))) {
    const Index left = std::max<Index>(1, allowance - report.newton_steps);
    sweeps.run(large() ? left : std::min(left, tuning::acceleration::small_sweeps), report);
    if (!large()) {
      report.residual = sweeps.residual() / fastest, sweeps.write();
      if (unsolved()) {
        if (!sparse()) solve(report);
        else if (!newton(report, true) && rows <= dense_rows) solve(report);
        sweeps.load();
      }
    }
  }
  const double wrong = sweeps.finish();
  report.residual = fastest > 0 ? wrong / fastest : 0;
  if (equalities > 0) report.residual = std::max(report.residual, inconsistency);
}

}  // namespace dyn::simulation
