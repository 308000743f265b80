// The solve of steps without a tolerance: Newton's method near a solution, accelerated sweeps elsewhere, bounded by max_iterations.
#include "simulation/accelerated_sweeps.hpp"
#include "simulation/newton.hpp"

namespace dyn::simulation {

void Island::accelerated_sweeps(dynContactReport& report) {
  build_rows();
  AcceleratedSweeps sweeps(*this);
  sweeps.run(w.max_iterations(), report);
  sweeps.write();
}

// Newton's method goes on to the fine residual: bodies at rest then stay exactly at rest, and the next steps have nothing to solve.
// Small islands and few sweeps leave iterations for methods that large mass ratios do not slow down.
void Island::solve_to_default(dynContactReport& report) {
  using namespace tuning::default_solve;
  allowance = w.max_iterations();
  build_rows();
  AcceleratedSweeps sweeps(*this);
  const auto unsolved = [&] { return report.residual > tolerance && within_budget(report); };
  const auto newton_near = [&](double near) {
    if (!(report.residual > tuning::island::fine && report.residual <= near && within_budget(report) && ordered())) return;
    const double wanted = tolerance;
    tolerance = std::min(tolerance, tuning::island::fine);
    Newton method(*this);
    if (!method.run(newton_steps, newton_share, report)) method.write_best(report);
    tolerance = wanted;
    sweeps.load();
  };
  report.residual = fastest > 0 ? sweeps.residual() / fastest : 0;
  newton_near(near_guess);
  if (unsolved()) {
    const Index left = allowance - report.newton_steps;
    sweeps.run(large() ? left : std::min(left, tuning::acceleration::small_sweeps), report);
    report.residual = sweeps.residual() / fastest, sweeps.write();
    if (unsolved()) newton_near(near_sweeps);
    if (!large() && unsolved()) {
      if (!sparse()) solve(report);
      else if (!newton(report, true) && rows <= dense_rows) solve(report);
      sweeps.load();
    }
  }
  const double wrong = sweeps.finish();
  report.residual = fastest > 0 ? wrong / fastest : 0;
  if (equalities > 0) report.residual = std::max(report.residual, inconsistency);
}

}  // namespace dyn::simulation
