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

// The natural map of blocks, as velocities.
struct BlockError {
  double worst = 0, most = 0;  // most: largest impulse, as a velocity

  void take(const Block& s, const double* y, const double* c) {
    double wrong[Block::max_rows];
    s.natural_map(y, c, wrong);
    for (Index i = 0; i < s.rows; ++i) {
      const bool moves = s.is_cone() || s.response[i] > 0;
      const double error = moves ? std::abs(wrong[i]) * s.per_speed[i] : 0;
      most = std::max(most, std::abs(y[i]) * s.per_speed[i]);
      if (!(error <= worst)) worst = error >= 0 ? error : HUGE_VAL;  // NaN counts as infinite
    }
  }
  double error(double fastest) const { return is_lost_to_round_off(most, fastest) ? HUGE_VAL : worst; }
};

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
  p.for_each([&](const Block& s) {
    double e[Block::max_rows];
    s.natural_map(y + s.first, c + s.first, e);
    for (Index i = 0; i < s.rows; ++i) take(s.first + i, e[i]);
  });
  return worst;
}

// Fills all of the report that follows from y.
void report(const dynContactProblem& x, const Problem& p, const double* y, const double* c, dynContactReport& out);

}  // namespace dyn::solver
