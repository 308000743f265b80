// Linear least squares |r + J d|^2 in the form that is smaller: J itself, or its normal equations.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.hpp"

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

// Number of independent rows of J, by Cholesky with pivots.
template <class T>
Index rank(const LeastSquares<T>& s) {
  const Index n = s.wide() ? s.rows : s.n;
  T* A = s.factor;
  if (s.wide()) {
    std::fill_n(A, std::ptrdiff_t(n) * n, T(0));
    for (Index k = 0; k < s.n; ++k)
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) A[i + std::ptrdiff_t(n) * j] += s.column(k)[i] * s.column(k)[j];
  } else {
    std::copy_n(s.matrix, std::ptrdiff_t(n) * n, A);
  }
  auto at = [&](Index i, Index j) -> T& { return A[i + std::ptrdiff_t(n) * j]; };
  T largest = T(0);
  for (Index k = 0; k < n; ++k) {
    Index p = 0;
    for (Index i = 1; i < n; ++i)
      if (at(i, i) > at(p, p)) p = i;
    const T pivot = at(p, p);
    largest = std::max(largest, pivot);
    if (!(pivot > T(1e-9) * largest)) return k;
    for (Index j = 0; j < n; ++j)
      if (j != p)
        for (Index i = 0; i < n; ++i)
          if (i != p) at(i, j) -= at(i, p) * at(p, j) / pivot;
    for (Index i = 0; i < n; ++i) at(i, p) = at(p, i) = T(0);
  }
  return n;
}

}  // namespace dyn
