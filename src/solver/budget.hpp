// Limits of a solve and what it used.
#pragma once

#include "solver/residuals.hpp"
#include "solver/time_limit.hpp"
#include "solver/workspace.hpp"

namespace dyn::solver {

struct Budget {
  double tolerance = 0;  // of the residual (unit of Worst)
  Index max_iterations = 0;
  double enough = -1;  // of the residual: after `few` iterations, so much ends the solve
  Index few = 0;
  double relaxation = 0;
  bool newton = true;
  bool warm = false;  // start from the caller's guess
  bool sweeps = true;  // begin with the Gauss-Seidel sweeps of start.hpp
  bool brief = false;  // report the residual and the counts only
  TimeLimit* limit = nullptr;

  Index iterations = 0, newton_steps = 0, factorizations = 0;
  dynContactStatus status = DYN_CONTACT_STATUS_STALLED;
  double best = HUGE_VAL;  // residual of w.y

  bool is_rough() const { return enough > tolerance; }
  bool spent() {
    if (iterations + newton_steps >= (best <= enough ? std::min(few, max_iterations) : max_iterations)) {
      status = DYN_CONTACT_STATUS_MAX_ITERATIONS;
      return true;
    }
    if (!limit || !limit->is_up()) return false;
    status = DYN_CONTACT_STATUS_TIME_BUDGET;
    return true;
  }
};

// Shares iterations among the tries that find a factor of restitution by bisection. The first is mostly the only one, and takes
// three quarters. A bisection ends where one iteration is left: the last try takes it.
struct Tries {
  static constexpr Index most = 8;  // after the first: seven halvings to restitution_step, and the last
  Index left;                       // iterations
  Index later = most;               // tries that may follow

  // Of the next try, at least one.
  Index next() {
    const Index share = later == most ? left - (left + 3) / 4 : left / (later + 1);
    --later;
    return std::max<Index>(1, share);
  }
};
static_assert(0x1p-7 <= tuning::accept::restitution_step && 0x1p-6 > tuning::accept::restitution_step);

// Keeps y (feasible, c = G y + g) in w.y if it is the best so far. Returns true when the tolerance is met.
inline bool keep_best(Workspace& w, Budget& b, const double* y, const double* c) {
  const Problem& p = w.problem;
  double r = residual(p, y, c).residual;
  const double* own = c;
  if (r > b.tolerance && r < tuning::accept::near_round_off * round_off(p, y)) {
    exact_velocity(p, y, w.exact);
    r = residual(p, y, own = w.exact).residual;
  }
  if (!(r < b.best) || is_lost_to_round_off(p, y)) return false;
  b.best = r;
  std::copy_n(y, p.n, w.y), std::copy_n(own, p.n, w.c);
  if (r <= b.tolerance) b.status = DYN_CONTACT_STATUS_CONVERGED;
  return r <= b.tolerance;
}

}  // namespace dyn::solver
