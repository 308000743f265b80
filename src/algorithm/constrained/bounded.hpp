// Rows with bounded forces: G lambda - b = w, with w = 0 where lambda is free, w >= 0 at a lower bound, w <= 0 at an upper bound.
// The active set is that of the positive definite G + mu D, so of contradictory rows one moves to its bound. Primal-dual active
// set method (Hintermueller, Ito, Kunisch 2002). If it stalls, it exchanges only the first violated row, which terminates for
// positive definite matrices (Murty 1974). The forces are then solved with G.
#pragma once

#include "algorithm/constrained/proximal.hpp"

namespace dyn {

template <class T>
struct Bounds {
  const T *lower, *upper;  // of all rows
  Index* state;            // -1: at the lower bound, 1: at the upper one, 0: free
  Index* free;             // indices of the free rows
  T* matrix;               // their part of G
};

template <class T>
void solve_bounded(const RowWork<T>& work, const T* G, std::ptrdiff_t ld, Index n, const T* b, const Bounds<T>& bounds,
                   const ProximalOptions& options, T* lambda, ProximalResult<T>& result) {
  T *w = work.vector(5), *part = work.vector(6), *forces = work.vector(7);
  const T mu = options.regularisation > 0 ? T(options.regularisation) : T(automatic_regularisation);
  for (Index i = 0; i < n; ++i) bounds.state[i] = bounds.lower[i] < bounds.upper[i] ? 0 : -1;
  // the free rows, minus the contribution of rows at bounds
  Index count = 0;
  std::ptrdiff_t part_ld = 0;
  auto gather_free = [&] {
    count = 0;
    for (Index i = 0; i < n; ++i) {
      if (bounds.state[i] == 0) bounds.free[count++] = i;
      else lambda[i] = bounds.state[i] < 0 ? bounds.lower[i] : bounds.upper[i];
    }
    part_ld = padded_rows(count);
    for (Index c = 0; c < count; ++c) {
      const T* column = G + ld * bounds.free[c];
      for (Index r = 0; r < part_ld; ++r) bounds.matrix[part_ld * c + r] = r < count ? column[bounds.free[r]] : T(0);
    }
    for (Index r = 0; r < count; ++r) {
      const Index i = bounds.free[r];
      part[r] = b[i];
      for (Index j = 0; j < n; ++j)
        if (bounds.state[j] != 0) part[r] -= G[ld * j + i] * lambda[j];
    }
  };
  auto scatter_free = [&] {
    for (Index r = 0; r < count; ++r) lambda[bounds.free[r]] = forces[r];
  };
  const T slack = T(1e-12) * largest_size(b, n);
  auto next_state = [&](Index i) -> Index {
    if (!(bounds.lower[i] < bounds.upper[i])) return bounds.state[i];
    if (bounds.state[i] == 0) return lambda[i] < bounds.lower[i] ? -1 : lambda[i] > bounds.upper[i] ? 1 : 0;
    const T wanted = w[i] - mu * G[ld * i + i] * lambda[i];
    return bounds.state[i] < 0 ? (wanted > slack ? 0 : -1) : (wanted < -slack ? 0 : 1);
  };
  Index fewest_wrong = n + 1, attempts = 10;
  for (Index round = 0; round < 20 + 10 * n; ++round) {
    gather_free();
    solve_regularised(work, bounds.matrix, part_ld, count, part, mu, forces);
    scatter_free();
    row_residual(G, ld, n, b, lambda, w);  // -w
    Index wrong = 0, first = 0;
    for (Index i = n - 1; i >= 0; --i)
      if (next_state(i) != bounds.state[i]) first = i, ++wrong;
    if (wrong == 0) {
      solve_equalities(work, bounds.matrix, part_ld, count, part, options, forces, result);
      scatter_free();
      return;
    }
    if (wrong < fewest_wrong) fewest_wrong = wrong, attempts = 10;
    else --attempts;
    for (Index i = first; i < n; ++i) {
      bounds.state[i] = next_state(i);
      if (attempts <= 0) break;
    }
  }
  gather_free();
  solve_equalities(work, bounds.matrix, part_ld, count, part, options, forces, result);
  scatter_free();
  result.reason = DYN_CONSTRAINT_REASON_MAX_ITERATIONS;
}

}  // namespace dyn
