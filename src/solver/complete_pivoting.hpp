// Gauss elimination with complete pivoting (Golub and Van Loan, Matrix Computations, 3.4): the rank of a small matrix, and
// solutions of many right-hand sides at once. Matrices lie row by row.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/small_product.hpp"

namespace dyn::solver {

// to += factor from
inline void add_row(double* __restrict to, const double* __restrict from, double factor, std::ptrdiff_t n) {
  for (std::ptrdiff_t c = 0; c < n; ++c) to[c] += factor * from[c];
}

// to += sum of factors[stride l] from[l], rows of n numbers each `room` apart; rows with the factor 0 are left out.
inline void add_rows(double* __restrict to, const double* __restrict from, std::ptrdiff_t room, const double* factors,
                     std::ptrdiff_t stride, Index count, std::ptrdiff_t n) {
  const double* row[4];
  double by[4];
  int kept = 0;
  const auto flush = [&] {
    for (; kept < 4; ++kept) row[kept] = row[0], by[kept] = 0;
    const double *const a = row[0], *const b = row[1], *const c = row[2], *const e = row[3];
    for (std::ptrdiff_t k = 0; k < n; ++k) to[k] += by[0] * a[k] + by[1] * b[k] + by[2] * c[k] + by[3] * e[k];
    kept = 0;
  };
  for (Index l = 0; l < count; ++l) {
    if (factors[stride * l] == 0) continue;
    row[kept] = from + room * l, by[kept++] = factors[stride * l];
    if (kept == 4) flush();
  }
  if (kept) flush();
}

// The largest absolute value: of eight sequences, as a single one is no vector loop.
inline double largest_of(const double* x, std::ptrdiff_t n) {
  double most[8] = {};
  std::ptrdiff_t k = 0;
  for (; k + 8 <= n; k += 8)
    for (int i = 0; i < 8; ++i) most[i] = std::abs(x[k + i]) > most[i] ? std::abs(x[k + i]) : most[i];
  for (; k < n; ++k) most[0] = std::max(most[0], std::abs(x[k]));
  return *std::max_element(most, most + 8);
}

// P F Q = L U, of n x n, in place. The first `rank` rows and columns are independent.
struct RankedLu {
  double* F;
  Index n;
  Index *rows, *columns;  // rows: swaps; columns: which unknown each column of U is of
  Index rank = 0;

  // Pivots below this share of the largest count as zero.
  void factor(double least) {
    for (Index k = 0; k < n; ++k) columns[k] = k;
    double first = 0;
    for (rank = 0; rank < n; ++rank) {
      Index r, c;
      const double pivot = find_pivot(r, c);
      if (rank == 0) first = pivot;
      if (!(pivot > least * first)) return;
      rows[rank] = r;
      if (r != rank) std::swap_ranges(F + n * rank, F + n * (rank + 1), F + n * r);
      if (c != rank) {
        for (Index i = 0; i < n; ++i) std::swap(F[n * i + rank], F[n * i + c]);
        std::swap(columns[rank], columns[c]);
      }
      const double* const own = F + n * rank + rank;
      for (Index i = rank + 1; i < n; ++i)
        if (double& by = F[n * i + rank]; by != 0) by /= *own, add_row(F + n * i + rank + 1, own + 1, -by, n - rank - 1);
    }
  }

  // b, n x count, becomes: in row k < rank, unknown columns[k] of a solution whose unknowns beyond the rank are zero; in the rows
  // beyond the rank, what no solution meets.
  void solve(double* b, std::ptrdiff_t count) const {
    for (Index k = 0; k < rank; ++k)
      if (rows[k] != k) std::swap_ranges(b + count * k, b + count * (k + 1), b + count * rows[k]);
    negate(b, count * n);
    for (Index k = 0; k < rank; ++k) {
      double* const to = b + count * k;
      add_rows(to, b, count, F + n * k, 1, k, count), negate(to, count);
    }
    double* const rest = b + count * rank;
    add_product(rest, count, n - rank, {F + n * rank, n, 1}, b, count, rank, count), negate(rest, count * (n - rank));
    for (Index k = rank - 1; k >= 0; --k) {
      double* const to = b + count * k;
      negate(to, count), add_rows(to, b + count * (k + 1), count, F + n * k + k + 1, 1, rank - k - 1, count);
      const double by = -1 / F[n * k + k];
      for (std::ptrdiff_t c = 0; c < count; ++c) to[c] *= by;
    }
  }
  // The same with all unknowns, in x.
  void solve(double* b, std::ptrdiff_t count, double* x) const {
    solve(b, count);
    std::fill_n(x, n * count, 0.0);
    for (Index k = 0; k < rank; ++k) std::copy_n(b + count * k, count, x + count * columns[k]);
  }

  // The transpose of solve(b, 1), as far as that gives unknowns. b: zero beyond the rank.
  void solve_transposed(double* b) const {
    for (Index k = 0; k < rank; ++k) b[k] /= F[n * k + k], add_row(b + k + 1, F + n * k + k + 1, -b[k], rank - k - 1);
    for (Index k = rank - 1; k > 0; --k) add_row(b, F + n * k, -b[k], k);
    for (Index k = rank - 1; k >= 0; --k) std::swap(b[k], b[rows[k]]);
  }

  // x: a solution of F x = 0 in which unknown columns[at] is 1 and the others beyond the rank are zero.
  void null_vector(Index at, double* x) const {
    std::fill_n(x, n, 0.0);
    x[columns[at]] = 1;
    for (Index k = rank - 1; k >= 0; --k) {
      const double* const row = F + n * k;
      double sum = row[at];
      for (Index j = k + 1; j < rank; ++j) sum += row[j] * x[columns[j]];
      x[columns[k]] = -sum / row[k];
    }
  }

 private:
  double find_pivot(Index& row, Index& column) const {
    double most = -1;
    row = column = rank;
    for (Index i = rank; i < n; ++i) {
      const double* const entries = F + n * i;
      if (const double largest = largest_of(entries + rank, n - rank); largest > most) most = largest, row = i;
    }
    for (Index j = rank; j < n; ++j)
      if (std::abs(F[n * row + j]) == most) return column = j, most;
    return 0;  // no numbers
  }
  static void negate(double* x, std::ptrdiff_t n) {
    for (std::ptrdiff_t c = 0; c < n; ++c) x[c] = -x[c];
  }
};

}  // namespace dyn::solver
