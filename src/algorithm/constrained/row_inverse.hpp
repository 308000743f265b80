// G^-1, or the pseudoinverse on the free rows for dependent rows and rows at a bound.
#pragma once

#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn {

// X = (L D L^T)^-1, n x n with the factor's leading dimension. Two packs of columns at a time hide each other's latency.
template <class T>
void invert_rows(const T* W, const T* Dinv, std::ptrdiff_t ld, std::ptrdiff_t n, T* X) {
  using P = Simd<T, row_lanes>;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    std::fill_n(X + ld * i, ld, T(0));
    X[ld * i + i] = T(1);
  }
  auto columns = [&]<int packs>(std::ptrdiff_t c) {
    P sum[packs];
    auto load = [&](const T* row) {
      for (int p = 0; p < packs; ++p) sum[p] = P::load(row + row_lanes * p);
    };
    auto subtract = [&](const T* row, T x) {
      for (int p = 0; p < packs; ++p) sum[p] = sum[p] - P::load(row + row_lanes * p) * x;
    };
    for (std::ptrdiff_t i = c + 1; i < n; ++i) {
      load(X + ld * i + c);
      for (std::ptrdiff_t j = c; j < i; ++j) subtract(X + ld * j + c, W[ld * j + i] * Dinv[j]);
      for (int p = 0; p < packs; ++p) sum[p].store(X + ld * i + c + row_lanes * p);
    }
    for (std::ptrdiff_t i = n - 1; i >= 0; --i) {
      load(X + ld * i + c);
      for (std::ptrdiff_t j = n - 1; j > i; --j) subtract(X + ld * j + c, W[ld * i + j]);
      for (int p = 0; p < packs; ++p) (sum[p] * Dinv[i]).store(X + ld * i + c + row_lanes * p);
    }
  };
  std::ptrdiff_t c = 0;
  for (; c + row_lanes < n; c += 2 * row_lanes) columns.template operator()<2>(c);
  if (c < n) columns.template operator()<1>(c);
}

// Pseudoinverse of the part of G with state 0 (null: all), zero elsewhere. Uses the proximal iteration on the range of that part.
template <class T>
void pseudoinvert_rows(const RowWork<T>& work, const T* G, const Index* state, std::ptrdiff_t ld, Index n, T* X) {
  T *Dinv = work.vector(0), *step = work.vector(1), *scale = work.vector(3), *z = work.vector(4), *x = work.vector(5),
    *S = work.scaled;
  scale_rows(G, ld, n, scale, S);
  for (Index i = 0; i < n; ++i)
    if (state && state[i]) scale[i] = T(0);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) S[ld * j + i] = G[ld * j + i] * scale[i] * scale[j];
  T first, last;
  const Index rank = pivoted_factor(S, ld, n, T(independent), work.range, z, first, last);
  auto project = [&] {
    factor_range(work.range, ld, rank, n, work.factor, Dinv);
    for (Index i = 0; i < n; ++i) project_on_range(work.range, ld, rank, n, work.factor, Dinv, z, X + ld * i);
  };
  for (Index i = 0; i < n; ++i) {
    std::fill_n(X + ld * i, ld, T(0));
    X[ld * i + i] = T(scale[i] > T(0));
  }
  if (rank < n) project();
  const T mu = T(automatic_regularisation);
  factor_rows(S, ld, n, mu, mu / T(2), work.factor, Dinv);
  for (Index j = 0; j < n; ++j) {
    ProximalResult<T> result;
    iterate(S, ld, n, work.factor, Dinv, X + ld * j, ProximalOptions{20, 0, 1e-13}, step, x, result);
    std::copy_n(x, n, X + ld * j);
  }
  if (rank < n) project();  // round-off outside the range has grown by 1 / mu
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) X[ld * j + i] *= scale[i] * scale[j];
}

// G^-1 for G = d.row_matrix, whose factor may be left by solve_equalities.
template <class T>
const T* row_inverse(const Model& m, Data<T>& d, bool bounded, bool factored, Index rows) {
  const std::ptrdiff_t ld = padded_rows(rows);
  const RowWork<T> work = row_work(m, d);
  if (factored ||
      (!bounded && factor_rows(d.row_matrix, ld, rows, T(0), T(0), work.factor, work.vector(0)) > T(clearly_independent)))
    invert_rows(work.factor, work.vector(0), ld, rows, d.row_free);
  else pseudoinvert_rows(work, d.row_matrix, bounded ? d.row_state : nullptr, ld, rows, d.row_free);
  return d.row_free;
}

}  // namespace dyn
