// Start of admm and newton.
#pragma once

#include "base/portable.hpp"
#include "solver/alart_curnier.hpp"
#include "solver/multipliers.hpp"
#include "solver/pgs.hpp"
#include "solver/smoothing.hpp"

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

// Newton's method from a guess, after one sweep if it is not close. For a rough residual the smoothing method goes on from there.
// Without a guess two sweeps first, and more while they converge fast: larger factorizations justify more. Returns true when the
// tolerance is met.
inline bool start(Workspace& w, Budget& b) {
  using namespace tuning::start;
  const Problem& p = w.problem;
  if (!b.newton || !b.sweeps) return false;
  const auto sweep_once = [&] { sweep(Dense{p, w.v}, 1, w.x), ++b.iterations; };
  const auto keep = [&] {
    times(p.G, w.x, p.g, w.v, p.n);  // without accumulated round-off
    return keep_best(w, b, w.x, w.v);
  };
  const auto refine = [&] { return keep() || alart_curnier(w, b, w.x, w.v, sweep_steps); };
  std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  if (b.warm) {
    const bool close = b.best < close_guess * p.speed || all_contacts_stick(w);
    if (!close) sweep_once();
    if (refine()) return true;
    if (b.is_rough()) {
      if (close && !b.spent() && (sweep_once(), keep())) return true;  // it solves single contacts
      if (smoothing_newton(w, b)) return true;
    }
    std::copy_n(w.y, p.n, w.x), std::copy_n(w.c, p.n, w.v);
  }
  const double fast = std::min(max_contraction, math::exp(-rows_a_sweep / p.n));
  double error = HUGE_VAL;
  bool going = true;
  for (Index k = 1; going && !b.spent(); ++k) {
    sweep_once();
    const double before = error;
    error = residual(p, w.x, w.v).residual;
    going = error > b.tolerance && (k < 2 || error < fast * before);
  }
  return refine();
}

}  // namespace dyn::solver
