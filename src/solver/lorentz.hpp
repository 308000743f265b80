// The Lorentz cone |a_t| <= a_0; m numbers beside a_0.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.hpp"

namespace dyn::solver {

// a'Jb, J = diag(1, -1, ..)
inline double lorentz(double a0, const double* a, double b0, const double* b, Index m) {
  double s = a0 * b0;
  for (Index i = 0; i < m; ++i) s -= a[i] * b[i];
  return s;
}

// Largest t with a + t d in the cone, a inside.
inline double within_cone(double a0, const double* a, double d0, const double* d, Index m) {
  const double A = lorentz(d0, d, d0, d, m), B = lorentz(a0, a, d0, d, m), C = lorentz(a0, a, a0, a, m);
  const double root = std::sqrt(std::max(B * B - A * C, 0.0));
  if (B < 0) return B * B >= A * C ? C / (root - B) : HUGE_VAL;
  return A < 0 ? (-B - root) / A : HUGE_VAL;
}

}  // namespace dyn::solver
