// What admm and newton begin with.
#pragma once

#include "dyn/solver/alart_curnier.hpp"
#include "dyn/solver/multipliers.hpp"
#include "dyn/solver/pgs.hpp"

namespace dyn::solver {

// A good guess is a few Newton steps from the solution. Otherwise two sweeps of Gauss-Seidel, and the same. true: done.
inline bool start(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  if (!b.newton) return false;
  if (b.warm && alart_curnier(w, b, w.y, w.c)) return true;
  prepare_sweeps(w);
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  for (int k = 0; k < 2 && !b.spent(); ++k, ++b.iterations) sweep(w, 1, w.x, w.v);
  if (keep_best(w, b, w.x, w.v)) return true;
  return alart_curnier(w, b, w.x, w.v);
}

}  // namespace dyn::solver
