// Damped least squares in a box: the d that minimises |r + J d|^2 + lambda |d|^2 subject to lower <= d <= upper.
// A strictly convex program, whose optimality conditions are a linear complementarity problem: block principal pivoting (Judice and
// Pires 1994; the exchange rule of Kim and Park 2011), which ends after finitely many exchanges at the exact solution.
#pragma once

#include <algorithm>
#include <cmath>

#include "dyn/base/types.hpp"

namespace dyn {

// J and r, or the normal equations: whichever is smaller. g = J^T r.
template <class T>
struct LeastSquares {
  Index n, rows;  // rows < n: matrix is J, rows x n; otherwise J^T J, n x n
  T *matrix, *factor, *r, *g;
  Index filled;   // rows so far

  bool wide() const { return rows < n; }
  void clear() {
    filled = 0;
    std::fill_n(matrix, std::ptrdiff_t(wide() ? rows : n) * n, T(0));
    std::fill_n(g, n, T(0));
  }
  // h more rows: errors e, and columns (h x count) of the coordinates in list
  void add(Index h, const T* e, const T* columns, const Index* list, Index count) {
    for (Index a = 0; a < count; ++a) {
      const T* A = columns + h * a;
      T sum = T(0);
      for (Index k = 0; k < h; ++k) sum += A[k] * e[k];
      g[list[a]] += sum;
      if (wide()) {
        std::copy_n(A, h, matrix + filled + std::ptrdiff_t(rows) * list[a]);
        continue;
      }
      for (Index b = 0; b <= a; ++b) {
        const T* B = columns + h * b;
        T product = T(0);
        for (Index k = 0; k < h; ++k) product += A[k] * B[k];
        const auto [low, high] = std::minmax(list[a], list[b]);
        matrix[high + std::ptrdiff_t(n) * low] += product;
      }
    }
    if (wide()) std::copy_n(e, h, r + filled);
    filled += h;
  }
  // J^T J in full
  void finish() {
    if (wide()) return;
    for (Index c = 0; c < n; ++c)
      for (Index i = c + 1; i < n; ++i) matrix[c + std::ptrdiff_t(n) * i] = matrix[i + std::ptrdiff_t(n) * c];
  }
  const T* column(Index k) const { return matrix + std::ptrdiff_t(wide() ? rows : n) * k; }
  // tr(J^T J)
  T trace() const {
    T sum = T(0);
    for (Index k = 0; k < n; ++k) {
      if (!wide()) sum += column(k)[k];
      else
        for (Index i = 0; i < rows; ++i) sum += column(k)[i] * column(k)[i];
    }
    return sum;
  }
};

namespace detail {

// A = L L^T in place (lower, n x n); false when a pivot is not positive.
template <class T>
inline bool cholesky(T* A, Index n) {
  using std::sqrt;
  for (Index k = 0; k < n; ++k) {
    T* column = A + std::ptrdiff_t(n) * k;
    if (!(column[k] > T(0))) return false;
    const T inverse = T(1) / sqrt(column[k]);
    for (Index i = k; i < n; ++i) column[i] *= inverse;
    for (Index j = k + 1; j < n; ++j) {
      const T a = column[j];
      T* target = A + std::ptrdiff_t(n) * j;
      for (Index i = j; i < n; ++i) target[i] -= a * column[i];
    }
  }
  return true;
}
template <class T>
inline void cholesky_solve(const T* L, Index n, T* x) {
  for (Index k = 0; k < n; ++k) {
    const T* column = L + std::ptrdiff_t(n) * k;
    x[k] /= column[k];
    for (Index i = k + 1; i < n; ++i) x[i] -= column[i] * x[k];
  }
  for (Index k = n - 1; k >= 0; --k) {
    const T* column = L + std::ptrdiff_t(n) * k;
    for (Index i = k + 1; i < n; ++i) x[k] -= column[i] * x[i];
    x[k] /= column[k];
  }
}

}  // namespace detail

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
  // Answers how much it lowers |r + J d|^2 / 2, or a negative number when there is no solution in these digits.
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
