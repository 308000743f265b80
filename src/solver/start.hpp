// Start of admm and newton.
#pragma once

#include "base/portable.hpp"
#include "solver/alart_curnier.hpp"
#include "solver/multipliers.hpp"
#include "solver/pgs.hpp"
#include "solver/smoothing.hpp"

namespace dyn::solver {

// Newton's method from a guess, which few steps lead to the solution or none; where it fails, the smoothing method from there.
// Without a guess two Gauss-Seidel sweeps first, and more while they converge fast: larger factorizations justify more.
// Returns true when the tolerance is met.
inline bool start(Workspace& w, Budget& b) {
  using namespace tuning::start;
  const Problem& p = w.problem;
  if (!b.newton || !b.sweeps) return false;
  if (b.warm && (alart_curnier(w, b, w.y, w.c, guess_steps) || smoothing_newton(w, b))) return true;
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  const double fast = std::min(max_contraction, math::exp(-rows_a_sweep / p.n));
  double error = HUGE_VAL;
  bool going = true;
  for (Index k = 1; going && !b.spent(); ++k) {
    sweep(Dense{p, w.v}, 1, w.x);
    const double before = error;
    error = residual(p, w.x, w.v).residual;
    ++b.iterations;
    going = error > b.tolerance && (k < 2 || error < fast * before);
  }
  times(p.G, w.x, p.g, w.v, p.n);  // without accumulated round-off
  return keep_best(w, b, w.x, w.v) || alart_curnier(w, b, w.x, w.v, sweep_steps) || (!b.warm && smoothing_newton(w, b));
}

}  // namespace dyn::solver
