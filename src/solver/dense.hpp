// Dense linear algebra of the contact solvers, in place, without heap. Column-major, 64-byte aligned columns.
// The leading dimension is a multiple of 8; rows up to it are readable and writable.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/simd.hpp"
#include "solver/tuning.hpp"

namespace dyn::solver {

inline constexpr Index lanes = 8;
inline constexpr Index padded(Index n) { return (n + lanes - 1) / lanes * lanes; }
using Lanes = Simd<double, lanes>;

// A matrix of the workspace.
struct Matrix {
  double* x;
  Index ld;
  double* column(Index j) const { return x + std::ptrdiff_t(j) * ld; }
  double& operator()(Index i, Index j) const { return column(j)[i]; }
};

inline double dot(const double* a, const double* b, Index n) {
  Lanes s = Lanes::zero();
  Index i = 0;
  for (; i + lanes <= n; i += lanes) s = s + Lanes::load(a + i) * Lanes::load(b + i);
  double r = sum(s);
  for (; i < n; ++i) r += a[i] * b[i];
  return r;
}

// y[from .. n-1] += a x
inline void axpy(double a, const double* x, double* y, Index n, Index from = 0) {
  for (Index i = from; i < n; ++i) y[i] += a * x[i];
}

// y = A x + b. Vectors are as long as columns; columns with x = 0 are skipped.
inline void times(const Matrix& A, const double* x, const double* b, double* y, Index n) {
  Index i = 0;
  const auto rows = [&]<int count>() {  // count groups of eight rows at a time
    for (; i + lanes * (count - 1) < n; i += lanes * count) {
      Lanes sum[count];
      for (int k = 0; k < count; ++k) sum[k] = b ? Lanes::load(b + i + lanes * k) : Lanes::zero();
      for (Index j = 0; j < n; ++j) {
        if (x[j] == 0) continue;
        const double* column = A.column(j) + i;
        for (int k = 0; k < count; ++k) sum[k] = sum[k] + Lanes::load(column + lanes * k) * x[j];
      }
      for (int k = 0; k < count; ++k) sum[k].store(y + i + lanes * k);
    }
  };
  if constexpr (register_lanes > 2) rows.operator()<4>();  // enough registers
  rows.operator()<2>();
  rows.operator()<1>();
}

// Columns j .. j+3 of A, rows from first - first % 8: A -= L(:, 0 .. k-1) U, U(l, c) at u[l row + c column].
inline void subtract_product(const Matrix& A, const Matrix& L, Index j, Index k, Index first, Index n, const double* u,
                             std::ptrdiff_t row, std::ptrdiff_t column) {
  for (Index i = first / lanes * lanes; i < n; i += lanes) {
    Lanes a0 = Lanes::load(A.column(j) + i), a1 = Lanes::load(A.column(j + 1) + i), a2 = Lanes::load(A.column(j + 2) + i),
          a3 = Lanes::load(A.column(j + 3) + i);
    for (Index l = 0; l < k; ++l) {
      const Lanes x = Lanes::load(L.column(l) + i);
      const double* v = u + l * row;
      a0 = a0 - x * v[0], a1 = a1 - x * v[column], a2 = a2 - x * v[2 * column], a3 = a3 - x * v[3 * column];
    }
    a0.store(A.column(j) + i), a1.store(A.column(j + 1) + i), a2.store(A.column(j + 2) + i), a3.store(A.column(j + 3) + i);
  }
}

// Cholesky factorization in the lower triangle; the upper one is overwritten. Returns false if not positive definite.
inline bool cholesky(const Matrix& A, Index n) {
  for (Index j = 0; j < n; j += 4) {
    const Index width = std::min<Index>(4, n - j);
    if (width == 4)
      subtract_product(A, A, j, j, j, n, A.x + j, A.ld, 1);
    else
      for (Index c = 0; c < width; ++c)
        for (Index l = 0; l < j; ++l) axpy(-A(j + c, l), A.column(l), A.column(j + c), n, j);
    for (Index c = j; c < j + width; ++c) {
      for (Index l = j; l < c; ++l) axpy(-A(c, l), A.column(l), A.column(c), n, c);
      const double pivot = A(c, c);
      if (!(pivot > 0)) return false;
      const double scale = 1 / std::sqrt(pivot);
      for (Index i = c; i < n; ++i) A(i, c) *= scale;
    }
  }
  return true;
}

// x = (L L^T)^-1 x
inline void cholesky_solve(const Matrix& L, Index n, double* x) {
  for (Index j = 0; j < n; ++j) {
    x[j] /= L(j, j);
    axpy(-x[j], L.column(j), x, n, j + 1);
  }
  for (Index j = n - 1; j >= 0; --j) x[j] = (x[j] - dot(L.column(j) + j + 1, x + j + 1, n - j - 1)) / L(j, j);
}

// Factorizes columns first .. first + count - 1 and updates the columns behind them.
template <Index count>
inline bool eliminate(const Matrix& A, Index n, Index first, Index* pivots) {
  const Index end = first + count;
  for (Index c = first; c < end; ++c) {
    double* const column = A.column(c);
    const auto size = [&](Index i) { return std::bit_cast<std::int64_t>(std::fabs(column[i])); };  // ordered as the magnitudes
    std::int64_t most = 0;
    for (Index i = c; i < n; ++i) most = std::max(most, size(i));
    Index p = c;
    while (size(p) != most) ++p;
    pivots[c] = p;
    if (!(std::fabs(column[p]) > 0)) return false;
    if (p != c)
      for (Index k = 0; k < n; ++k) std::swap(A(c, k), A(p, k));
    const double scale = 1 / column[c];
    for (Index i = c + 1; i < n; ++i) column[i] *= scale;
    for (Index k = c + 1; k < end; ++k) axpy(-A(c, k), column, A.column(k), n, c + 1);
  }
  if (end == n) return true;
  const Index from = end / lanes * lanes;  // rows from .. end-1 belong to U
  Lanes head[count];
  for (Index l = 0; l < count; ++l) {
    double x[lanes];
    for (Index i = 0; i < lanes; ++i) x[i] = from + i < end ? 0 : A(from + i, first + l);
    head[l] = Lanes::load(x);
  }
  for (Index k = end; k < n; ++k) {
    double *const a = A.column(k), u[count];
    for (Index l = 0; l < count; ++l) {
      u[l] = a[first + l];
      for (Index m = 0; m < l; ++m) u[l] -= A(first + l, first + m) * u[m];
    }
    Lanes x = Lanes::load(a + from);
    for (Index l = 0; l < count; ++l) x = x - head[l] * u[l];
    x.store(a + from);
    for (Index i = from + lanes; i < n; i += lanes) {
      x = Lanes::load(a + i);
      for (Index l = 0; l < count; ++l) x = x - Lanes::load(A.column(first + l) + i) * u[l];
      x.store(a + i);
    }
    for (Index l = 1; l < count; ++l) a[first + l] = u[l];
  }
  return true;
}

// A = P^T L U with partial pivoting, the last columns one at a time: their rows fill few lanes. Returns false if singular.
inline bool lu(const Matrix& A, Index n, Index* pivots) {
  Index j = 0;
  for (; n - j > lanes; j += 4)
    if (!eliminate<4>(A, n, j, pivots)) return false;
  for (; j < n; ++j)
    if (!eliminate<1>(A, n, j, pivots)) return false;
  return true;
}

inline void lu_solve(const Matrix& A, Index n, const Index* pivots, double* x) {
  for (Index j = 0; j < n; ++j) std::swap(x[j], x[pivots[j]]);
  for (Index j = 0; j < n; ++j) axpy(-x[j], A.column(j), x, n, j + 1);
  for (Index j = n - 1; j >= 0; --j) {
    x[j] /= A(j, j);
    axpy(-x[j], A.column(j), x, j);
  }
}

}  // namespace dyn::solver
