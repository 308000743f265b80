// The solve of steps without a tolerance: accelerated sweeps, then other methods as far as max_iterations goes.
#include "simulation/accelerated_sweeps.hpp"

namespace dyn::simulation {

// Small islands and few sweeps leave iterations for methods that large mass ratios do not slow down.
void Island::solve_to_default(dynContactReport& report) {
  const Index most = w.max_iterations();
  const auto unsolved = [&] { return report.residual > tolerance && within_budget(report); };
  allowance = most;
  if (!accept_guess(report)) {
    AcceleratedSweeps(*this).run(large() ? most : std::min(most, tuning::acceleration::small_sweeps), report);
    if (!large() && unsolved() && (!sparse() || !newton(report, true)) && unsolved()) solve(report);
  }
  residual();  // sets by_dof and c for the best impulses
  if (equalities > 0) report.residual = std::max(report.residual, inconsistency);
}

}  // namespace dyn::simulation
