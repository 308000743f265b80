// Small dense symmetric matrices between rows, leading dimension ld = padded_rows(n): G + mu 1 = L D L^T, products, solutions.
// Padding in a column may be anything finite.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/simd.hpp"
#include "constraint/constraint_instance.hpp"

namespace dyn {

// W: columns of D L from the diagonal down. Dinv: 1 / D. Pivots below `least` are raised to it. Returns the smallest pivot over
// its diagonal entry: 1 for uncoupled rows, near 0 for dependent ones, 0 if an entry is not positive.
template <class T>
T factor_rows(const T* G, std::ptrdiff_t ld, Index n, T mu, T least, T* W, T* Dinv) {
  using P = Simd<T, row_lanes>;
  T smallest = T(1);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const std::ptrdiff_t first = j / row_lanes * row_lanes;
    for (std::ptrdiff_t p = first; p < n; p += row_lanes) {
      P sum = P::load(G + ld * j + p);
      for (std::ptrdiff_t k = 0; k < j; ++k) sum = sum - P::load(W + ld * k + p) * (W[ld * k + j] * Dinv[k]);
      sum.store(W + ld * j + p);
    }
    const T entry = G[ld * j + j] + mu;
    T pivot = W[ld * j + j] + mu;
    if (!(entry > T(0))) smallest = T(0);
    else smallest = std::min(smallest, pivot / entry);
    if (!(pivot > least)) pivot = least;
    W[ld * j + j] = pivot;
    Dinv[j] = pivot > T(0) ? T(1) / pivot : T(0);
  }
  return smallest;
}

// x = (L D L^T)^-1 x
template <class T>
void solve_factored(const T* W, const T* Dinv, std::ptrdiff_t ld, Index n, T* x) {
  for (Index j = 0; j < n; ++j) {
    const T z = x[j] * Dinv[j];
    const T* column = W + ld * j;
    for (Index i = j + 1; i < n; ++i) x[i] -= column[i] * z;
  }
  for (Index j = n - 1; j >= 0; --j) {
    const T* column = W + ld * j;
    T sum = x[j];
    for (Index i = j + 1; i < n; ++i) sum -= column[i] * x[i];
    x[j] = sum * Dinv[j];
  }
}

// out = b - G x
template <class T>
void row_residual(const T* G, std::ptrdiff_t ld, Index n, const T* b, const T* x, T* out) {
  for (Index i = 0; i < n; ++i) out[i] = b[i];
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) out[i] -= G[ld * j + i] * x[j];
}

template <class T>
T largest_size(const T* x, Index n) {
  using std::abs;
  T most = T(0);
  for (Index i = 0; i < n; ++i)
    if (!(abs(x[i]) <= most)) most = abs(x[i]);
  return most;
}

}  // namespace dyn
