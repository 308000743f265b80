// Damped least squares in a box: the d that minimises |r + J d|^2 + lambda |d|^2 subject to lower <= d <= upper.
// A strictly convex program, whose optimality conditions are a linear complementarity problem: block principal pivoting (Judice
// and Pires 1994; the exchange rule of Kim and Park 2011), which ends after finitely many exchanges at the exact solution.
#pragma once

#include "algorithm/least_squares.hpp"

namespace dyn {

enum Bound : Index { bound_none, bound_lower, bound_upper, bound_both };

template <class T>
struct BoxStep {
  const LeastSquares<T>& s;
  const T *lower, *upper;
  T *d, *z;      // the step; the gradient of the damped model there, where it is at a bound
  T* work;       // n
  Index* state;  // of each coordinate: Bound

  // The minimiser over the free coordinates, the others being at their bounds.
  bool solve_free(T lambda) {
    for (Index k = 0; k < s.n; ++k)
      if (state[k]) d[k] = state[k] == bound_upper ? upper[k] : lower[k];
    return s.wide() ? solve_wide(lambda) : solve_normal(lambda);
  }
  bool solve_normal(T lambda) {
    Index* list = state + s.n;
    Index f = 0;
    for (Index k = 0; k < s.n; ++k)
      if (!state[k]) list[f++] = k;
    for (Index b = 0; b < f; ++b) {
      const T* from = s.column(list[b]);
      T* to = s.factor + std::ptrdiff_t(f) * b;
      for (Index a = b; a < f; ++a) to[a] = from[list[a]];
      to[b] += lambda;
      work[b] = -s.g[list[b]];
    }
    for (Index k = 0; f < s.n && k < s.n; ++k)
      if (state[k] && d[k] != T(0))
        for (Index b = 0; b < f; ++b) work[b] -= s.column(k)[list[b]] * d[k];
    if (!detail::cholesky(s.factor, f)) return false;
    detail::cholesky_solve(s.factor, f, work);
    for (Index b = 0; b < f; ++b) d[list[b]] = work[b];
    return true;
  }
  // d = -J^T (J J^T + lambda)^-1 (r + J d_bound)
  bool solve_wide(T lambda) {
    const Index h = s.rows;
    T* A = s.factor;
    std::fill_n(A, std::ptrdiff_t(h) * h, T(0));
    std::copy_n(s.r, h, work);
    for (Index k = 0; k < s.n; ++k) {
      const T* J = s.column(k);
      if (state[k]) {
        for (Index i = 0; i < h; ++i) work[i] += J[i] * d[k];
        continue;
      }
      for (Index j = 0; j < h; ++j)
        for (Index i = j; i < h; ++i) A[i + std::ptrdiff_t(h) * j] += J[i] * J[j];
    }
    for (Index i = 0; i < h; ++i) A[i + std::ptrdiff_t(h) * i] += lambda;
    if (!detail::cholesky(A, h)) return false;
    detail::cholesky_solve(A, h, work);
    for (Index k = 0; k < s.n; ++k) {
      if (state[k]) continue;
      T sum = T(0);
      for (Index i = 0; i < h; ++i) sum += s.column(k)[i] * work[i];
      d[k] = -sum;
    }
    return true;
  }
  // z = g + (J^T J + lambda) d
  void gradient(T lambda) {
    if (s.wide()) {
      std::copy_n(s.r, s.rows, work);
      for (Index k = 0; k < s.n; ++k)
        for (Index i = 0; i < s.rows; ++i) work[i] += s.column(k)[i] * d[k];
      for (Index k = 0; k < s.n; ++k) {
        T sum = lambda * d[k];
        for (Index i = 0; i < s.rows; ++i) sum += s.column(k)[i] * work[i];
        z[k] = sum;
      }
      return;
    }
    for (Index k = 0; k < s.n; ++k) z[k] = s.g[k] + lambda * d[k];
    for (Index k = 0; k < s.n; ++k)
      for (Index i = 0; i < s.n; ++i) z[i] += s.column(k)[i] * d[k];
  }
  // The state that coordinate k should have, given d and z.
  Index wanted(Index k) const {
    if (state[k] == bound_none) return d[k] < lower[k] ? bound_lower : d[k] > upper[k] ? bound_upper : bound_none;
    if (state[k] == bound_lower && z[k] < T(0)) return bound_none;
    if (state[k] == bound_upper && z[k] > T(0)) return bound_none;
    return state[k];
  }
  // Returns how much it lowers |r + J d|^2 / 2, or a negative number when there is no solution in these digits.
  T operator()(T lambda) {
    bool bounded = false;
    for (Index k = 0; k < s.n; ++k) {
      state[k] = lower[k] == upper[k] ? bound_both
                 : lower[k] == T(0) && s.g[k] > T(0) ? bound_lower
                 : upper[k] == T(0) && s.g[k] < T(0) ? bound_upper : bound_none;
      bounded |= state[k] != bound_none;
    }
    Index fewest = s.n + 1, patience = 3;
    for (Index pass = 0; pass < 50 + s.n; ++pass) {
      if (!solve_free(lambda)) return T(-1);
      if (bounded) gradient(lambda);
      Index count = 0, last = 0;
      for (Index k = 0; k < s.n; ++k)
        if (wanted(k) != state[k]) ++count, last = k;
      if (count == 0) break;
      bounded = true;
      const bool block = count < fewest || patience > 0;
      patience = count < fewest ? 3 : patience - 1;
      fewest = std::min(fewest, count);
      if (!block) state[last] = wanted(last);
      else
        for (Index k = 0; k < s.n; ++k) state[k] = wanted(k);
    }
    T decrease = T(0);
    for (Index k = 0; k < s.n; ++k) d[k] = std::min(std::max(d[k], lower[k]), upper[k]);
    if (bounded) gradient(lambda);
    for (Index k = 0; k < s.n; ++k) decrease += (lambda * d[k] - s.g[k] - (bounded ? z[k] : T(0))) * d[k];
    return decrease * T(0.5);
  }
};

}  // namespace dyn
