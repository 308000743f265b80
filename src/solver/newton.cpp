#include "solver/newton.hpp"

#include "solver/smoothing.hpp"

namespace dyn::solver {

namespace {

using namespace tuning::newton;

// Returns true when the tolerance is met.
bool augmented_lagrangian(Workspace& w, Budget& b, Index steps) {
  Multipliers m(w, b);
  for (Index k = 0; k < steps && !b.spent(); ++k) {
    if (!m.augmented_lagrangian_step(subproblem_steps)) return false;
    m.velocity();
    if (keep_best(w, b, m.y, w.newton_c)) return true;
    if (b.newton && alart_curnier(w, b, m.y, w.newton_c)) return true;
    for (int i = 0; b.newton && i < admm_steps && !b.spent(); ++i)  // ADMM steps follow the correction more closely
      if (!m.admm_step()) return false;
  }
  return false;
}

}  // namespace

void newton(Workspace& w, Budget& b) {
  if (start(w, b)) return;
  if (!b.newton) {
    augmented_lagrangian(w, b, b.max_iterations);
    return;
  }
  // if all fail, the interior point method starts from smaller impulses, and as many more steps follow
  for (double factor = 1; factor > tuning::epsilon && !b.spent(); factor /= tuning::growth)
    if (interior(w, b, factor) || (factor == 1 && !b.is_rough() && smoothing_newton(w, b)) ||
        augmented_lagrangian(w, b, Index(std::min<double>(first_steps / factor, b.max_iterations))))
      return;
}

}  // namespace dyn::solver
