// What admm and newton begin with.
#pragma once

#include "dyn/base/portable.hpp"
#include "dyn/solver/alart_curnier.hpp"
#include "dyn/solver/multipliers.hpp"
#include "dyn/solver/pgs.hpp"

namespace dyn::solver {

// A good guess is a few Newton steps from the solution. Otherwise two sweeps of Gauss-Seidel, more as long as
// they converge fast enough, which is the slower the larger a factorization is, and the same. true: done.
inline bool start(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  if (!b.newton) return false;
  if (b.warm && alart_curnier(w, b, w.y, w.c, true)) return true;
  prepare_sweeps(w);
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  const double fast = std::min(0.7, math::exp(-12.0 / p.n));
  double error = HUGE_VAL;
  for (bool going = true; going && !b.spent();) {
    sweep(w, 1, w.x, w.v);
    const double before = error;
    error = residual(p, w.x, w.v).residual;
    ++b.iterations;
    going = error > b.tolerance && (b.iterations < 2 || error < fast * before);
  }
  times(p.G, w.x, p.g, w.v, p.n);  // without what the updates have gathered
  if (keep_best(w, b, w.x, w.v)) return true;
  return alart_curnier(w, b, w.x, w.v, true);
}

}  // namespace dyn::solver
