#include "simulation/interior.hpp"

namespace dyn::simulation {

using namespace solver::tuning::interior;

bool Interior::factorize(bool symmetric) {
  for_each([&](const Block&, Index k) { w.newton[k].acts = true, activate(k); });
  return factorize_laws(symmetric);
}

void Interior::start() {
  const double shift = inside * std::sqrt(error().own / x.rows);
  path.start_inside(shift, shift), velocities(y, c);
}

// Newton's method from here; if it fails, the iterate is restored.
bool Interior::newton_refine(Index most, dynContactReport& report) {
  std::copy_n(y, x.rows, y_here), std::copy_n(c, x.rows, c_here);
  if (Newton::run(most, 0, report)) return true;
  std::copy_n(y_here, x.rows, y), std::copy_n(c_here, x.rows, c);
  return false;
}

bool Interior::run(dynContactReport& report) {
  start();
  double tried = HUGE_VAL;
  for (Index k = 0; k < solver::tuning::interior::max_steps && x.within_budget(report) && step(report); ++k) {
    const Error now = error();
    if (!(now.most < newton_error * x.fastest && now.most < newton_reduction * tried)) continue;
    tried = now.most;
    if (newton_refine(newton_steps, report)) return true;
  }
  return false;
}

bool interior(const Island& x, dynContactReport& report) {
  Interior method(x);
  if (method.Newton::run(report) || method.run(report)) return true;
  method.write_best(report);
  return false;
}

}  // namespace dyn::simulation
