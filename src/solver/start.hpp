// Start of admm and newton.
#pragma once

#include "base/portable.hpp"
#include "solver/alart_curnier.hpp"
#include "solver/multipliers.hpp"
#include "solver/pgs.hpp"

namespace dyn::solver {

// Returns whether all contacts of the best iterate stick. They should stay so: redundant normal forces may also be shared out
// so that contacts slip, and sweeps may lead there (a box in a gripper).
inline bool all_contacts_stick(const Workspace& w) {
  bool stick = true;
  w.problem.for_each([&](const Block& s) {
    const double *y = w.y + s.first, *c = w.c + s.first, normal = s.mu * (y[0] - c[0]);
    double square = 0;
    for (Index i = 1; i < s.rows; ++i) square += (y[i] - c[i]) * (y[i] - c[i]);
    stick &= !(s.is_cone() && normal > 0 && square > normal * normal);
  });
  return stick;
}

// A good guess is a few Newton steps from the solution; one sweep saves a step if it is less close.
// Otherwise two sweeps and more while they converge fast; larger factorizations justify more sweeps. Returns true when the
// tolerance is met.
inline bool start(Workspace& w, Budget& b) {
  const Problem& p = w.problem;
  if (!b.newton || !b.sweeps) return false;
  if (b.warm && (b.best < tuning::start::close_guess * p.speed || all_contacts_stick(w)) && alart_curnier(w, b, w.y, w.c, true))
    return true;
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  const auto refine = [&] {
    times(p.G, w.x, p.g, w.v, p.n);  // without accumulated round-off
    return keep_best(w, b, w.x, w.v) || alart_curnier(w, b, w.x, w.v, true);
  };
  const double fast = std::min(tuning::start::max_contraction, math::exp(-tuning::start::rows_a_sweep / p.n));
  double error = HUGE_VAL;
  bool going = true;
  for (Index k = 1; going && !b.spent(); ++k) {
    sweep(Dense{p, w.v}, 1, w.x);
    const double before = error;
    error = residual(p, w.x, w.v).residual;
    ++b.iterations;
    if (k == 1 && b.warm && refine()) return true;
    going = error > b.tolerance && (k < 2 || error < fast * before);
  }
  return refine();
}

}  // namespace dyn::solver
