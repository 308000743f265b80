#include "solver/admm.hpp"

#include "solver/smoothing.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::admm;

// Returns true when the tolerance is met.
bool admm_iterations(Workspace& w, Budget& b, Index steps) {
  Multipliers m(w, b);
  double tried = HUGE_VAL;  // error at the last Newton attempt
  for (Index k = 1; k <= steps && !b.spent(); ++k) {
    if (!m.admm_step()) return false;
    if (!(m.error <= b.tolerance || (b.newton && m.error < newton_reduction * tried) || k % tuning::sweeps_a_check == 0))
      continue;
    m.velocity();
    if (keep_best(w, b, m.y, w.newton_c)) return true;
    tried = m.error;
    if (b.newton && alart_curnier(w, b, m.y, w.newton_c)) return true;
  }
  return false;
}

}  // namespace

void admm(Workspace& w, Budget& b) {
  if (start(w, b)) return;
  if (!b.newton) {
    admm_iterations(w, b, b.max_iterations);
    return;
  }
  // if all fail, the interior point method starts from smaller impulses, after as many more steps
  for (double factor = 1; factor > tuning::epsilon && !b.spent(); factor /= tuning::growth)
    if (admm_iterations(w, b, Index(std::min<double>(first_steps / factor, b.max_iterations))) || interior(w, b, factor) ||
        (factor == 1 && !b.is_rough() && smoothing_newton(w, b)))
      return;
}

}  // namespace dyn::solver
