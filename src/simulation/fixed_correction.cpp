// Interior point method with de Saxce's correction fixed: U_0 = c_n / mu + s is a convex problem, whose solution gives the next s
// = |c_t| (Cadoux 2009; Acary, Cadoux, Lemarechal and Malick 2011). Newton's method is tried after each problem.
#include "simulation/interior.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::fixed_correction;

}  // namespace

// The next correction of each contact. A correction that keeps its direction is over-relaxed, twice as far each time.
void Interior::update_correction() {
  for_each([&](const ActiveConstraint& a, State& s, Index) {
    const double step = solver::norm(c + a.s->first + 1, s.rows - 1) - s.correction;
    s.relaxed = step * s.corrected > 0 && std::abs(step) > same_change * std::abs(s.corrected)
                    ? std::min(max_relaxation, 2 * s.relaxed)
                    : 1;
    s.corrected = step;
    s.correction = std::max(0.0, s.correction + s.relaxed * step);
  });
}

bool Interior::run_fixed_correction(dynContactReport& report) {
  fixed_correction = true;
  for (Index k = 0; k < 2 * problems && x.within_budget(report); ++k) {
    if (k % problems == 0)  // start from the guess's corrections, then from zero
      for_each([&](const ActiveConstraint& a, State& s, Index) {
        s.correction = k ? 0 : solver::norm(c + a.s->first + 1, s.rows - 1), s.corrected = 0, s.relaxed = 1;
      });
    else
      update_correction();
    const double wrong = error().own / x.rows;
    start_inside(tuning::interior::inside * std::sqrt(wrong)), velocities();
    short_steps = 0;
    for (Index i = 0;
         i < tuning::interior::max_steps && x.within_budget(report) && step(report) && complementarity() > solved * wrong; ++i) {
    }
    if (newton_refine(newton_steps, 1, report)) return true;
  }
  return false;
}

// A residual slightly above the tolerance: contacts contradict one another by as little, and a solution of all is hard to find.
void Island::solve_fixed_correction(dynContactReport& report) {
  if (w.method_iterations() < min_iterations || report.residual < rounding || (!sparse() && !ordered())) return;
  const Index more = (report.residual > far * tolerance ? far_rounds : near_rounds) * w.method_iterations();
  allowance = std::min(w.max_iterations(), report.iterations + report.newton_steps + more);
  build_rows();
  Interior method(*this);
  if (!method.run_fixed_correction(report)) method.write_best(report);
}

}  // namespace dyn::simulation
