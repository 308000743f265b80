// M^-1 = L^-1 D^-1 L^-T from the factor. Column i of L^-1 has entries at i and its descendants only, which follow i in number; so
// an entry (i, j) of M^-1 is a sum over the common ancestors of i and j.
#pragma once

#include "algorithm/cholesky.hpp"
#include "algorithm/tiles.hpp"

namespace dyn {

// A column of 1 to be read from where its zeros begin or end.
template <class T>
inline const auto unit_column = [] {
  struct { T x[5 * block_lanes]; } column{};
  column.x[block_lanes - 1] = T(1);
  return column;
}();

// d.Linv, by columns, in whole packs: column i is that of 1 less the columns k of its descendants times L_ki.
template <class T>
void invert_factor(const Model& m, Data<T>& d) {
  const T* one = unit_column<T>.x + block_lanes - 1;
  const std::ptrdiff_t n = m.n.nv, room = padded_factor(m);
  const Index *depth = m.dof_depth(), *ends = m.dof_descendants_end();
  const T *below = d.L + room * n, *Dinv = d.D + n;
  T* next = d.Linv + room * n;
  for (std::ptrdiff_t i = n - 1; i >= 0; --i, below -= room, --Dinv) {
    const std::ptrdiff_t end = ends[i], first = i & ~std::ptrdiff_t(block_lanes - 1);
    const T *columns = next, *from = one - (i - first);
    next -= room;
    for (std::ptrdiff_t c = first; c < end; c += 4 * block_lanes, from = one + 1) {
      const std::ptrdiff_t last = std::min(end, c + 4 * block_lanes);
      eliminate_rows(last - c, from, next + c, columns + c, below + depth[i], room, Dinv, last - 1 - i);
    }
  }
}

// Columns j0 .. j0 + 3 of M^-1 from row i0 on, as many as a pack has, as far as they are on or above the tiles on the diagonal;
// and what mirrors them. Not inline: the addresses are quicker to compute than to carry along.
template <class T>
__attribute__((noinline)) void invert_tiles(const Model& m, const Data<T>& d, std::ptrdiff_t i0, std::ptrdiff_t j0) {
  using P = Simd<T, block_lanes>;
  const std::ptrdiff_t room = padded_factor(m);
  const T *Linv = d.Linv, *Dinv = d.D;
  P a = P::zero(), b = a, c = a, e = a;
  auto add = [&](std::ptrdiff_t first, std::ptrdiff_t last) DYN_INLINE_LAMBDA {
    const T* x = Linv + room * first;
    for (std::ptrdiff_t k = first; k < last; ++k, x += room) {
      const P y = P::load(x + i0) * Dinv[k];
      a = a + y * x[j0], b = b + y * x[j0 + 1], c = c + y * x[j0 + 2], e = e + y * x[j0 + 3];
    }
  };
  for_each_run(m, Index(j0), [&](Index first, Index last, Index) DYN_INLINE_LAMBDA {
    add(first, std::min<std::ptrdiff_t>(last, i0 + block_lanes));
  });
  if (j0 < i0 + block_lanes) add(j0 + 1, std::min<std::ptrdiff_t>(j0 + 4, m.n.nv));
  auto store = [&]<int first>() DYN_INLINE_LAMBDA {
    const Tile<T> t{slice4<first>(a), slice4<first>(b), slice4<first>(c), slice4<first>(e)};
    TiledMatrix<T>{d.Minv, m.n.nv}.store_pair(t, t.transposed(), i0 + first, j0);
  };
  store.template operator()<0>();
  if constexpr (block_lanes == 8)
    if (i0 + 4 <= j0) store.template operator()<4>();
}

// d.Minv, full and symmetric to the last bit.
template <class T>
void invert(const Model& m, Data<T>& d) {
  invert_factor(m, d);
  for (std::ptrdiff_t j0 = 0; j0 < m.n.nv; j0 += 4)
    for (std::ptrdiff_t i0 = 0; i0 <= j0; i0 += block_lanes) invert_tiles(m, d, i0, j0);
  d.mark_fresh(Stage::Minv);
}

}  // namespace dyn
