// G lambda = b for a positive semidefinite G by the proximal iteration lambda += (G + mu D)^-1 (b - G lambda), D the diagonal of
// G. The matrix is factored once (Carpentier, Budhiraja, Mansard 2021). Started at zero it stays in the range of G in the metric
// of D, so redundant rows get the smallest lambda. Clearly independent rows take mu = 0 and end after one step.
#pragma once

#include "algorithm/constrained/row_factor.hpp"
#include "model/data.hpp"

namespace dyn {

inline constexpr double clearly_independent = 1e-6, independent = 1e-10, automatic_regularisation = 1e-9,
                        contradiction_tolerance = 1e-8;

struct ProximalOptions {
  int max_iterations = 100;
  double regularisation = 0, tolerance = 1e-12;
  double misalignment = 0;  // redundant rows are left out up to this (redundant_rows.hpp); 0: none
};

template <class T>
struct ProximalResult {
  Index rank = 0, iterations = 0;
  dynConstraintReason reason = DYN_CONSTRAINT_REASON_CONVERGED;
  T contradiction{}, condition = T(1), regularisation{};
};

// Matrices and vectors of the solver, in the data.
template <class T>
struct RowWork {
  T *factor, *scaled, *range, *vectors;
  std::ptrdiff_t room;  // of a vector
  T* vector(int k) const { return vectors + k * room; }
};

// Pivoted Cholesky: R^T R = G. R is rank x n, row k at R + ld k. Returns the rank; pivots: first and last.
template <class T>
Index pivoted_factor(const T* G, std::ptrdiff_t ld, Index n, T tolerance, T* R, T* remaining, T& first, T& last) {
  using std::sqrt;
  for (Index i = 0; i < n; ++i) remaining[i] = G[ld * i + i];
  first = last = T(1);
  Index rank = 0;
  for (; rank < n; ++rank) {
    const Index best = largest_entry(remaining, n);
    const T pivot = remaining[best];
    if (!(pivot > tolerance)) break;
    if (rank == 0) first = pivot;
    last = pivot;
    T* row = R + ld * rank;
    for (Index i = 0; i < n; ++i) row[i] = G[ld * best + i];
    for (Index k = 0; k < rank; ++k) {
      const T x = R[ld * k + best];
      if (x == T(0)) continue;
      for (Index i = 0; i < n; ++i) row[i] -= R[ld * k + i] * x;
    }
    const T scale = T(1) / sqrt(pivot);
    for (Index i = 0; i < n; ++i) {
      row[i] *= scale;
      remaining[i] -= row[i] * row[i];
    }
    remaining[best] = T(0);
  }
  return rank;
}

// Factor of R R^T in K, Dinv.
template <class T>
void factor_range(const T* R, std::ptrdiff_t ld, Index rank, Index n, T* K, T* Dinv) {
  for (Index i = 0; i < rank; ++i)
    for (Index j = 0; j <= i; ++j) {
      T sum = T(0);
      for (Index k = 0; k < n; ++k) sum += R[ld * i + k] * R[ld * j + k];
      K[ld * j + i] = K[ld * i + j] = sum;
    }
  factor_rows(K, ld, rank, T(0), T(0), K, Dinv);
}

// Projects b onto the range of G = R^T R. K, Dinv: from factor_range.
template <class T>
void project_on_range(const T* R, std::ptrdiff_t ld, Index rank, Index n, const T* K, const T* Dinv, T* z, T* b) {
  for (Index i = 0; i < rank; ++i) {
    z[i] = T(0);
    for (Index k = 0; k < n; ++k) z[i] += R[ld * i + k] * b[k];
  }
  solve_factored(K, Dinv, ld, rank, z);
  for (Index k = 0; k < n; ++k) {
    b[k] = T(0);
    for (Index i = 0; i < rank; ++i) b[k] += R[ld * i + k] * z[i];
  }
}

// x += G^+ b = R^T (R R^T)^-2 R b for b in the range of G = R^T R.
template <class T>
void solve_on_range(const T* R, std::ptrdiff_t ld, Index rank, Index n, const T* K, const T* Dinv, T* z, const T* b, T* x) {
  for (Index i = 0; i < rank; ++i) {
    z[i] = T(0);
    for (Index k = 0; k < n; ++k) z[i] += R[ld * i + k] * b[k];
  }
  solve_factored(K, Dinv, ld, rank, z), solve_factored(K, Dinv, ld, rank, z);
  for (Index k = 0; k < n; ++k)
    for (Index i = 0; i < rank; ++i) x[k] += R[ld * i + k] * z[i];
}

// The iteration. W, Dinv: factor of G + mu 1.
template <class T>
bool iterate(const T* G, std::ptrdiff_t ld, Index n, const T* W, const T* Dinv, const T* b, const ProximalOptions& options,
             T* step, T* lambda, ProximalResult<T>& result) {
  const T rhs = largest_size(b, n);
  T most = T(0);
  for (Index i = 0; i < n; ++i) lambda[i] = T(0), step[i] = b[i], most = std::max(most, G[ld * i + i]);
  T before = rhs;
  for (result.iterations = 0; result.iterations < options.max_iterations;) {
    solve_factored(W, Dinv, ld, n, step);
    for (Index i = 0; i < n; ++i) lambda[i] += step[i];
    ++result.iterations;
    row_residual(G, ld, n, b, lambda, step);
    const T left = largest_size(step, n), noise = T(4e-16) * T(double(n)) * most * largest_size(lambda, n);
    if (left <= noise || (left <= T(options.tolerance) * rhs && left > T(0.1) * before)) return true;
    if (result.iterations > 3 && left > T(0.99) * before && left <= T(1e-9) * rhs) return true;  // round-off of G itself
    before = left;
  }
  return false;
}

// S = G scaled to unit diagonal. Rows without any motion have no scale. Entries that are round-off count as such rows.
template <class T>
void scale_rows(const T* G, std::ptrdiff_t ld, Index n, T* scale, T* S) {
  using std::sqrt;
  T most = T(0);
  for (Index i = 0; i < n; ++i) most = std::max(most, G[ld * i + i]);
  for (Index i = 0; i < n; ++i) scale[i] = G[ld * i + i] > T(1e-24) * most ? T(1) / sqrt(G[ld * i + i]) : T(0);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < ld; ++i) S[ld * j + i] = i < n ? G[ld * j + i] * scale[i] * scale[j] : T(0);
}

// lambda = (G + mu D)^-1 b, D the diagonal of G.
template <class T>
void solve_regularised(const RowWork<T>& work, const T* G, std::ptrdiff_t ld, Index n, const T* b, T mu, T* lambda) {
  T *Dinv = work.vector(0), *scale = work.vector(3);
  scale_rows(G, ld, n, scale, work.scaled);
  factor_rows(work.scaled, ld, n, mu, mu / T(2), work.factor, Dinv);
  for (Index i = 0; i < n; ++i) lambda[i] = b[i] * scale[i];
  solve_factored(work.factor, Dinv, ld, n, lambda);
  for (Index i = 0; i < n; ++i) lambda[i] *= scale[i];
}

// Separates inert rows, which no motion changes and whose right-hand side is rounding (rows across a planar mechanism). S: G with
// these rows decoupled, wanted: b without them. Returns their number. noise_floor: bound on the rounding.
template <class T>
Index separate_inert_rows(const T* G, std::ptrdiff_t ld, Index n, const T* b, T noise_floor, T* S, T* wanted) {
  using std::abs;
  T most = T(0);
  for (Index i = 0; i < n; ++i) most = std::max(most, G[ld * i + i]);
  const auto inert = [&](Index i) { return !(G[ld * i + i] > T(1e-24) * most) && abs(b[i]) <= noise_floor; };
  Index count = 0;
  for (Index i = 0; i < n; ++i) count += inert(i);
  if (count == 0 || count == n) return 0;
  std::copy(G, G + ld * n, S), std::copy(b, b + n, wanted);
  for (Index i = 0; i < n; ++i) {
    if (!inert(i)) continue;
    for (Index j = 0; j < n; ++j)
      if (S[ld * i + j] != T(0)) S[ld * i + j] = S[ld * j + i] = T(0);
    S[ld * i + i] = most, wanted[i] = T(0);
  }
  return count;
}

// consistent: the part of rhs in the range of S (unit diagonal). Returns false if all of it is, because the pivots exceed
// `least`.
template <class T>
bool consistent_part(const RowWork<T>& work, const T* S, std::ptrdiff_t ld, Index n, T least, const T* rhs, T* consistent,
                     ProximalResult<T>& result) {
  T *Dinv = work.vector(0), *z = work.vector(4), first, last;
  result.rank = pivoted_factor(S, ld, n, least, work.range, z, first, last);
  result.condition = first / last;
  if (result.rank == n) return false;
  std::copy_n(rhs, n, consistent);
  factor_range(work.range, ld, result.rank, n, work.factor, Dinv);
  project_on_range(work.range, ld, result.rank, n, work.factor, Dinv, z, consistent);
  return true;
}

// lambda for n rows with the matrix G; all vectors have n numbers. The part of b outside the range is the contradiction.
template <class T>
void solve_equalities(const RowWork<T>& work, const T* G, std::ptrdiff_t ld, Index n, const T* b, const ProximalOptions& options,
                      T* lambda, ProximalResult<T>& result) {
  using std::abs;
  T *Dinv = work.vector(0), *step = work.vector(1), *rhs = work.vector(2), *scale = work.vector(3), *z = work.vector(4);
  result = {};
  result.rank = n;
  if (n == 0) return;
  const T noise_floor = std::max(T(contradiction_tolerance) * largest_size(b, n), T(1e-12));  // less is round-off
  if (options.regularisation == 0) {
    const Index inert = separate_inert_rows(G, ld, n, b, noise_floor, work.scaled, rhs);
    const T *matrix = inert ? work.scaled : G, *wanted = inert ? rhs : b;
    const T smallest = factor_rows(matrix, ld, n, T(0), T(0), work.factor, Dinv);
    if (smallest > T(clearly_independent)) {
      result.rank = n - inert;
      result.condition = T(1) / smallest;
      if (!iterate(matrix, ld, n, work.factor, Dinv, wanted, options, step, lambda, result))
        result.reason = DYN_CONSTRAINT_REASON_MAX_ITERATIONS;
      return;
    }
  }

  T* S = work.scaled;
  scale_rows(G, ld, n, scale, S);
  for (Index j = 0; j < n; ++j) {
    rhs[j] = b[j] * scale[j];
    if (scale[j] == T(0) && abs(b[j]) > noise_floor) result.contradiction = std::max(result.contradiction, abs(b[j]));
  }
  T* consistent = step;
  if (consistent_part(work, S, ld, n, T(independent), rhs, consistent, result)) {
    const T size = largest_size(rhs, n);
    T off = T(0);
    for (Index i = 0; i < n; ++i) off = std::max(off, abs(rhs[i] - consistent[i]));
    if (off > T(contradiction_tolerance) * size) {
      for (Index i = 0; i < n; ++i) {
        if (scale[i] > T(0)) result.contradiction = std::max(result.contradiction, abs(rhs[i] - consistent[i]) / scale[i]);
        rhs[i] = consistent[i];
      }
    }
  }
  if (result.contradiction > T(0)) result.reason = DYN_CONSTRAINT_REASON_CONTRADICTORY;
  const T mu = options.regularisation > 0 ? T(options.regularisation) : T(automatic_regularisation);
  result.regularisation = mu;
  factor_rows(S, ld, n, mu, mu / T(2), work.factor, Dinv);
  if (!iterate(S, ld, n, work.factor, Dinv, rhs, options, step, lambda, result) &&
      result.reason == DYN_CONSTRAINT_REASON_CONVERGED)
    result.reason = DYN_CONSTRAINT_REASON_MAX_ITERATIONS;
  if (result.rank < n) {  // round-off outside the range has grown by 1 / mu
    factor_range(work.range, ld, result.rank, n, work.factor, Dinv);
    project_on_range(work.range, ld, result.rank, n, work.factor, Dinv, z, lambda);
    row_residual(S, ld, n, rhs, lambda, step);
    solve_on_range(work.range, ld, result.rank, n, work.factor, Dinv, z, step, lambda);
  }
  for (Index i = 0; i < n; ++i) lambda[i] *= scale[i];
}

}  // namespace dyn
