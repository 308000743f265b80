// M^-1 = L^-1 D^-1 L^-T from the factor. Column k of L^-1 has entries at k and its descendants only, which follow k in number; so
// an entry (i, j) of M^-1 is a sum over the common ancestors of i and j.
#pragma once

#include "dyn/algorithm/cholesky.hpp"
#include "dyn/algorithm/tiles.hpp"

namespace dyn {

// d.Linv, by columns, in packs that start at multiples of four.
template <class T>
void invert_factor(const Model& m, Data<T>& d) {
  using P = Pack<T, 4>;
  const Index n = m.n.nv;
  const std::ptrdiff_t room = tile_room(n);
  const Index *parent = m.dof_parent(), *depth = m.dof_depth(), *end = m.dof_descendants_end();
  for (Index k = 0; k < n; ++k) {
    T* x = d.Linv + room * k;
    for (Index c = k & ~3; c < end[k]; c += 4)
      for (int l = 0; l < 4; ++l) x[c + l] = T(0);
    x[k] = T(1);
  }
  for (Index k = n - 1; k >= 0; --k) {
    const T *row = factor_row(m, d, k), *x = d.Linv + room * k;
    for (Index i = parent[k], at = depth[k] - 1; i >= 0; i = parent[i], --at) {
      const T L = row[at] * d.D[k];
      T* y = d.Linv + room * i;
      for (Index c = k & ~3; c < end[k]; c += 4) (P::load(y + c) - P::load(x + c) * L).store(y + c);
    }
  }
}

// d.Minv, full and symmetric to the last bit.
template <class T>
void invert(const Model& m, Data<T>& d) {
  using P = Pack<T, 4>;
  invert_factor(m, d);
  const Index n = m.n.nv;
  const std::ptrdiff_t room = tile_room(n);
  const TiledMatrix<T> Minv{d.Minv, n};
  for (Index j0 = 0; j0 < n; j0 += 4)
    for (Index i0 = 0; i0 <= j0; i0 += 4) {
      const T zeros[4] = {};
      P a = P::load(zeros), b = a, c = a, e = a;
      auto add = [&](Index first, Index last) DYN_INLINE_LAMBDA {
        const T* x = d.Linv + room * first;
        for (Index k = first; k < last; ++k, x += room) {
          const P y = P::load(x + i0) * d.D[k];
          a = a + y * x[j0], b = b + y * x[j0 + 1], c = c + y * x[j0 + 2], e = e + y * x[j0 + 3];
        }
      };
      for_each_run(m, j0, [&](Index first, Index last, Index) DYN_INLINE_LAMBDA { add(first, std::min(last, i0 + 4)); });
      if (i0 == j0) add(j0 + 1, std::min(j0 + 4, n));
      const Tile<T> t{a, b, c, e};
      Minv.store_pair(t, t.transposed(), i0, j0);
    }
  d.done(Stage::Minv);
}

}  // namespace dyn
