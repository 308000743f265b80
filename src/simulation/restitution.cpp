// Restitution in islands too large for a dense matrix: as much of it as gains no energy.
#include "simulation/island.hpp"
#include "solver/budget.hpp"

namespace dyn::simulation {

// Multiplies the coefficients of restitution by a factor.
void Island::scale_restitution(double factor) {
  for (Index k = 0, contact = 0; k < constraint_count; ++k) {
    const ActiveConstraint& a = constraint(k);
    if (a.kind != RowKind::Contact) continue;
    const Index n = a.first + normal_row(a.rows);
    if (restitution[contact] > 0 && v_minus[n] < 0) bias[n] = factor * restitution[contact] * v_minus[n];
    ++contact;
  }
  fastest = speed();
}

// Returns whether the impulses gain energy beyond the tolerance, or nothing near a solution was found (as in solver/solve.cpp).
bool Island::adds_energy(const dynContactReport& report) const {
  namespace accept = solver::tuning::accept;
  double work = 0, size = 0;
  for (Index i = 0; i < rows; ++i) work += lambda[i] * (g[i] + c[i]) / 2, size += std::abs(lambda[i] * g[i]);
  return work > (accept::energy + accept::energy_by_tolerance * tolerance) * size || report.residual > accept::max_residual;
}

// Restitution in islands too large for a matrix: the largest factor (bisection) with which no energy is gained.
void Island::solve_restitution(dynContactReport& report) {
  Index iterations = 0, newton_steps = 0;
  solver::Tries tries{w.max_iterations()};
  const auto refused = [&](double factor) {
    report.iterations = report.newton_steps = 0;
    allowance = tries.next();
    scale_restitution(factor);
    if (uses_sweeps_only() || !is_exact()) accelerated_sweeps(allowance, report);
    else sweeps_and_newton(report);
    residual();  // sets c for the best impulses
    iterations += report.iterations, newton_steps += report.newton_steps;
    tries.left -= report.iterations + report.newton_steps;
    return adds_energy(report);
  };
  if (refused(1) && !w.time_is_up()) {
    double low = 0, high = 1;
    while (high - low > solver::tuning::accept::restitution_step && tries.left > 1 && !w.time_is_up()) {
      const double factor = 0.5 * (low + high);
      (refused(factor) ? high : low) = factor;
    }
    refused(low);
  }
  report.iterations = std::int32_t(iterations), report.newton_steps = std::int32_t(newton_steps);
}

}  // namespace dyn::simulation
