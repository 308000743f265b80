#include "solver/pgs.hpp"

namespace dyn::solver {

void pgs(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  double *y = w.x, *c = w.v;
  std::copy_n(w.y, p.n, y), std::copy_n(w.c, p.n, c);
  while (!b.spent()) {
    const double omega = b.relaxation > 0 ? b.relaxation : b.iterations == 0 ? 1 : tuning::pgs::relaxation;
    ++b.iterations;  // one sweep solves a single contact
    sweep(Dense{p, c}, omega, y);
    if (residual(p, y, c).residual > b.tolerance && b.iterations % tuning::sweeps_a_check != 0 && b.iterations < b.max_iterations)
      continue;
    times(p.G, y, p.g, c, p.n);  // without accumulated round-off
    if (keep_best(w, b, y, c)) return;
  }
}

}  // namespace dyn::solver
