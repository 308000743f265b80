// Second-order cone K = {(n, t): |t| <= mu n}, dual K* = {(n, t): n >= mu |t|}, exact projections, de Saxce's correction.
// Torsional and rolling friction add scaled rows to t (problem.hpp): the cone is the same in any dimension.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.hpp"

namespace dyn::solver {

inline double norm(const double* x, Index n) {
  double s = 0;
  for (Index i = 0; i < n; ++i) s += x[i] * x[i];
  return std::sqrt(s);
}

enum class ConeSide { inside, surface, apex };

// p = the point of K nearest to w = (n, t), d numbers. p may be w.
inline ConeSide project_cone(double mu, Index d, const double* w, double* p) {
  const double t = norm(w + 1, d - 1);
  if (t <= mu * w[0]) {
    std::copy_n(w, d, p);
    return ConeSide::inside;
  }
  if (w[0] <= -mu * t) {
    std::fill_n(p, d, 0.0);
    return ConeSide::apex;
  }
  const double n = (w[0] + mu * t) / (1 + mu * mu), scale = mu * n / t;
  for (Index i = 1; i < d; ++i) p[i] = scale * w[i];
  p[0] = n;
  return ConeSide::surface;
}

inline double distance_to_cone(double mu, Index d, const double* w) {
  double p[6] = {};
  project_cone(mu, d, w, p);
  double s = 0;
  for (Index i = 0; i < d; ++i) s += (w[i] - p[i]) * (w[i] - p[i]);
  return std::sqrt(s);
}

inline double distance_to_dual_cone(double mu, Index d, const double* w) {
  double p[6] = {};
  for (Index i = 0; i < d; ++i) p[i] = -w[i];
  project_cone(mu, d, p, p);
  return norm(p, d);
}

// Orthonormal basis of dimension m whose first vector is a / |a| (Householder).
template <int columns>
inline void basis(const double* a, Index m, double (*out)[columns]) {
  const double length = norm(a, m);
  double v[5], square = 0;
  for (Index i = 0; i < m; ++i) v[i] = a[i] / length;
  const double sign = v[0] > 0 ? -1.0 : 1.0;
  v[0] -= sign;
  for (Index i = 0; i < m; ++i) square += v[i] * v[i];
  for (Index k = 0; k < m; ++k)
    for (Index i = 0; i < m; ++i) out[k][i] = (k == 0 ? sign : 1.0) * ((i == k) - 2 * v[i] * v[k] / square);
}

// Gamma(c) = (mu |c_t|, 0): K lambda _|_ c + Gamma(c) in K* is Signorini's condition and Coulomb's law (de Saxce and Feng 1998).
inline double de_saxce(double mu, Index d, const double* c) { return mu * norm(c + 1, d - 1); }


// e = y - P_K(y - u), u = c + Gamma(c): zero at solutions
inline void natural_map(double mu, Index d, const double* y, const double* c, double* e) {
  double w[6] = {y[0] - c[0] - de_saxce(mu, d, c)};
  for (Index i = 1; i < d; ++i) w[i] = y[i] - c[i];
  project_cone(mu, d, w, e);
  for (Index i = 0; i < d; ++i) e[i] = y[i] - e[i];
}

}  // namespace dyn::solver
