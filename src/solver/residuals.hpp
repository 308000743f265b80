// Residuals of y: what solvers compare with the tolerance, and the report in the caller's units.
#pragma once

#include "solver/problem.hpp"

namespace dyn::solver {

// Returns whether an impulse is so large that its round-off hides the speeds: y - c is then y, a fixed point of any test.
inline bool is_lost_to_round_off(double impulse, double speed) {
  return tuning::epsilon * std::fabs(impulse) > tuning::accept::lost_speed * speed && speed > 0;
}
inline bool is_lost_to_round_off(const Problem& p, const double* y) {
  double most = 0;
  for (Index i = 0; i < p.n; ++i) most = std::max(most, std::fabs(y[i] * p.per_unit[i]));
  return is_lost_to_round_off(most, p.speed);
}

// e = y - P_K(y - u) of one cone, u = c + (mu |c_t|, 0).
inline void natural_map(const Cone& cone, const double* y, const double* c, double* e) {
  double w[6];
  w[0] = y[0] - c[0] - de_saxce(cone.mu, cone.size, c);
  for (Index i = 1; i < cone.size; ++i) w[i] = y[i] - c[i];
  project_cone(cone.mu, cone.size, w, e);
  for (Index i = 0; i < cone.size; ++i) e[i] = y[i] - e[i];
}

struct Worst {
  double residual = 0;  // a velocity, in the caller's unit
  Index row = -1;
};

// c = G y + g. NaN counts as infinite.
inline Worst residual(const Problem& p, const double* y, const double* c) {
  Worst worst;
  const auto take = [&](Index i, double e) {
    const double r = e == e ? std::fabs(e) * p.per_unit[i] : HUGE_VAL;
    if (r > worst.residual || worst.row < 0) worst = {r, i};
  };
  for (Index i = 0; i < p.boxes; ++i) take(i, y[i] - project_box(p, i, y[i] - c[i]));
  for (Index k = 0; k < p.cones; ++k) {
    const Cone& cone = p.cone[k];
    double e[6];
    natural_map(cone, y + cone.row, c + cone.row, e);
    for (Index i = 0; i < cone.size; ++i) take(cone.row + i, e[i]);
  }
  return worst;
}

// Fills all of the report that follows from y.
void report(const dynContactProblem& x, const Problem& p, const double* y, const double* c, dynContactReport& out);

}  // namespace dyn::solver
