#include "solver/pgs.hpp"

namespace dyn::solver {

void prepare_sweeps(Workspace& w) {
  const Problem& p = w.problem;
  const auto begin = [&](Index k, Index first, Index rows) -> Block& {
    Block& s = w.blocks[k];
    s.first = first, s.rows = rows;
    std::copy_n(p.per_unit + first, rows, s.per_speed);
    return s;
  };
  for (Index i = 0; i < p.boxes; ++i) {
    Block& s = begin(i, i, 1);
    s.kind = Block::Kind::rows, s.lower = p.lower[i], s.upper = p.upper[i];
    s.response[0] = p.G(i, i) > tuning::pgs::tiny ? 1 / p.G(i, i) : 0;
  }
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    Block& s = begin(p.boxes + k, cone.row, cone.size);
    s.kind = Block::Kind::cone, s.mu = cone.mu, s.cone = w.local + k;
    s.cone->set(&p.G(cone.row, cone.row), p.G.ld, cone.size);
  }
}

void pgs(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  double *y = w.x, *c = w.v;
  std::copy_n(w.y, p.n, y), std::copy_n(w.c, p.n, c);
  prepare_sweeps(w);
  while (!b.spent()) {
    const double omega = b.relaxation > 0 ? b.relaxation : b.iterations == 0 ? 1 : tuning::pgs::relaxation;
    ++b.iterations;  // one sweep solves a single contact
    sweep(Dense{w, c}, omega, y);
    if (residual(p, y, c).residual > b.tolerance && b.iterations % tuning::sweeps_a_check != 0 && b.iterations < b.max_iterations)
      continue;
    times(p.G, y, p.g, c, p.n);  // without accumulated round-off
    if (keep_best(w, b, y, c)) return;
  }
}

}  // namespace dyn::solver
