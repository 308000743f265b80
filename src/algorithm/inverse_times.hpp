// -M^-1 B for matrices B with the tree's sparsity: column j of B has entries at the ancestors and descendants of j only.
#pragma once

#include "algorithm/cholesky.hpp"

namespace dyn {

// Columns j .. j + width - 1, rows i .. i + lanes - 1, of both products.
template <int lanes, int width, class T>
DYN_INLINE void minus_inverse_times(const Model& m, const T* Minv, const T* B, const T* C, T* minus_MinvB, T* minus_MinvC,
                                    std::ptrdiff_t i, std::ptrdiff_t j) {
  using P = Simd<T, lanes>;
  const std::ptrdiff_t n = m.n.nv;
  P b[width], c[width];
#pragma GCC unroll 4
  for (int l = 0; l < width; ++l) b[l] = c[l] = P::zero();
  auto add = [&](std::ptrdiff_t first, std::ptrdiff_t last) DYN_INLINE_LAMBDA {
    const T *column = Minv + i + n * first, *at_b = B + n * j + first, *at_c = C + n * j + first;
    for (std::ptrdiff_t k = first; k < last; ++k, column += n, ++at_b, ++at_c) {
      const P x = P::load(column);
#pragma GCC unroll 4
      for (int l = 0; l < width; ++l) b[l] = b[l] - x * at_b[n * l], c[l] = c[l] - x * at_c[n * l];
    }
  };
  Index end = 0;
#pragma GCC unroll 4
  for (int l = 0; l < width; ++l) end = std::max(end, m.dof_descendants_end()[j + l]);
  for_each_run(m, m.dof_parent()[j], [&](Index first, Index last, Index) DYN_INLINE_LAMBDA { add(first, last); });
  add(j, end);
#pragma GCC unroll 4
  for (int l = 0; l < width; ++l) b[l].store(minus_MinvB + i + n * (j + l)), c[l].store(minus_MinvC + i + n * (j + l));
}

// Blocks that would reach beyond the end overlap the ones before instead.
template <int lanes, int width, class T>
void minus_inverse_times(const Model& m, const T* Minv, const T* B, const T* C, T* minus_MinvB, T* minus_MinvC) {
  const std::ptrdiff_t n = m.n.nv;
  for (std::ptrdiff_t j = 0; j < n; j += width)
    for (std::ptrdiff_t i = 0; i < n; i += lanes)
      minus_inverse_times<lanes, width>(m, Minv, B, C, minus_MinvB, minus_MinvC, std::min(i, n - lanes), std::min(j, n - width));
}
template <class T>
void minus_inverse_times(const Model& m, const T* Minv, const T* B, const T* C, T* minus_MinvB, T* minus_MinvC) {
  if (m.n.nv >= block_lanes) return minus_inverse_times<block_lanes, 4>(m, Minv, B, C, minus_MinvB, minus_MinvC);
  if (m.n.nv >= 4) return minus_inverse_times<4, 4>(m, Minv, B, C, minus_MinvB, minus_MinvC);
  minus_inverse_times<1, 1>(m, Minv, B, C, minus_MinvB, minus_MinvC);
}

}  // namespace dyn
