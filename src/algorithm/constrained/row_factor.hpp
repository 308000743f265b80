// Small dense symmetric matrices between rows, leading dimension ld = padded_rows(n): G + mu 1 = L D L^T, products, solutions.
// Padding in a column may be anything finite.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/simd.hpp"
#include "constraint/constraint_instance.hpp"

namespace dyn {

// Index of the largest number of x, n > 0; the first if several are as large.
template <class T>
Index largest_entry(const T* x, Index n) {
  using P = Simd<T, 4>;
  T most = x[0];
  Index i = 1;
  if (n >= 8) {
    P top = P::load(x);
    for (i = 4; i + 4 <= n; i += 4) top = max(top, P::load(x + i));
    for (int k = 0; k < 4; ++k) most = std::max(most, T(top[k]));
  }
  for (; i < n; ++i) most = std::max(most, x[i]);
  for (i = 0; i + 1 < n && x[i] != most; ++i) {}
  return i;
}

// Larger matrices are looked at for zeros: mechanisms couple few of their rows.
inline constexpr Index sparse_rows = 32;

// Column j of D L from `first` down: that of G less the columns before it, but for those with a zero in row j.
template <class T>
void subtract_columns(const T* G, std::ptrdiff_t ld, std::ptrdiff_t j, std::ptrdiff_t first, Index n, T* W, const T* Dinv) {
  using P = Simd<T, row_lanes>;
  constexpr int room = 64;
  std::ptrdiff_t column[room];
  T factor[room];
  const T* from = G + ld * j;
  std::ptrdiff_t k = 0;
  do {
    int count = 0;
    for (; k < j && count < room; ++k)
      if (const T x = W[ld * k + j]; x != T(0)) column[count] = ld * k, factor[count++] = x * Dinv[k];
    for (std::ptrdiff_t p = first; p < n; p += row_lanes) {
      P sum = P::load(from + p);
      for (int i = 0; i < count; ++i) sum = sum - P::load(W + column[i] + p) * factor[i];
      sum.store(W + ld * j + p);
    }
    from = W + ld * j;
  } while (k < j);
}

// Copies the lower triangle of G into the upper one.
template <class T>
void mirror(T* G, std::ptrdiff_t ld, Index n) {
  constexpr Index lines = 8;  // read side by side
  for (Index first = 0; first < n; first += lines)
    for (Index r = first + 1; r < n; ++r)
      for (Index c = first, end = std::min<Index>(first + lines, r); c < end; ++c) G[c + ld * r] = G[r + ld * c];
}

// W: columns of D L from the diagonal down. Dinv: 1 / D. Pivots below `least` are raised to it. Returns the smallest pivot over
// its diagonal entry: 1 for uncoupled rows, near 0 for dependent ones, 0 if an entry is not positive.
template <class T>
T factor_rows(const T* G, std::ptrdiff_t ld, Index n, T mu, T least, T* W, T* Dinv) {
  using P = Simd<T, row_lanes>;
  T smallest = T(1);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const std::ptrdiff_t first = j / row_lanes * row_lanes;
    if (n > sparse_rows) subtract_columns(G, ld, j, first, n, W, Dinv);
    for (std::ptrdiff_t p = first; n <= sparse_rows && p < n; p += row_lanes) {
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
    if (x[j] == T(0)) continue;
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
