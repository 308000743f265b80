// The root of a function that grows from a negative value at zero: Newton's method, and bisection where its step leaves the
// bracket.
#pragma once

#include <cmath>
#include <limits>

#include "solver/tuning.hpp"

namespace dyn::solver {

// f(a) returns the value at a and sets `slope`, which ends as that of the last call. Returns the root, from the guess a > 0.
template <class F>
DYN_INLINE double bracketed_newton(F&& f, const double& slope, double a, double tolerance) {
  double low = 0, high = 0;  // high: 0 while none is known
  for (int k = 0; k < 2 * std::numeric_limits<double>::digits; ++k) {  // halvings that leave no number within a bracket
    const double value = f(a);
    if (!(std::fabs(value) > tolerance)) break;
    (value < 0 ? low : high) = a;
    double next = a - value / slope;
    if (!(next > low && (high == 0 || next < high))) next = high == 0 ? tuning::pgs::root_growth * a : 0.5 * (low + high);
    if (std::fabs(next - a) <= 2 * tuning::epsilon * a) break;
    a = next;
  }
  return a;
}

}  // namespace dyn::solver
