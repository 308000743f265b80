// Interior point method with de Saxce's correction fixed: U_0 = c_n / mu + s is a convex problem, whose solution gives the next s
// = |c_t| (Cadoux 2009; Acary, Cadoux, Lemarechal and Malick 2011). Newton's method is tried after each problem.
#include "simulation/interior.hpp"

namespace dyn::simulation {

// The next correction of each contact. A correction that keeps its direction is over-relaxed, twice as far each time.
void Interior::update_correction() {
  Newton::for_each([&](const Block& b, State& s, Index) {
    const double step = solver::norm(c + b.first + 1, b.rows - 1) - s.correction;
    s.relaxed = step * s.corrected > 0 ? 2 * s.relaxed : 1;
    s.corrected = step;
    s.correction = std::max(0.0, s.correction + s.relaxed * step);
  });
}

bool Interior::run_fixed_correction(dynContactReport& report) {
  using namespace solver::tuning::interior;
  path.fixed_correction = true;
  Newton::for_each([&](const Block&, State& s, Index) { s.correction = s.corrected = 0, s.relaxed = 1; });
  while (x.within_budget(report)) {
    update_correction();
    start();
    for (Index i = 0; i < max_steps && x.within_budget(report) && step(report); ++i) {}
    if (newton_refine(newton_steps, report)) return true;
  }
  return false;
}

// A residual slightly above the tolerance: contacts contradict one another by as little, and a solution of all is hard to find.
void Island::solve_fixed_correction(dynContactReport& report) {
  if (!sparse() && !ordered()) return;
  const Index more = tuning::island::rounds * w.method_iterations();
  allowance = std::min(w.max_iterations(), report.iterations + report.newton_steps + more);
  build_rows();
  Interior method(*this);
  if (!method.run_fixed_correction(report)) method.write_best(report);
}

}  // namespace dyn::simulation
