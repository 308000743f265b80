// Matrices over pairs of degrees of freedom with the tree's sparsity, in tiles of 4 x 4: an entry is non-zero only where one
// of the two supports the other, i.e. for j in [i, end of i's subtree) or the reverse. Four rows i lie side by side in the lanes
// of six packs; a column j is a 6-vector whose components every lane shares. So a tile costs products alone: no shift from body
// to body, no sum across lanes.
#pragma once

#include "base/scalar.hpp"
#include "base/simd_memory.hpp"
#include "base/transpose.hpp"
#include "joint/list.hpp"
#include "model/model.hpp"
#include "spatial/motion.hpp"

namespace dyn {

template <class T>
DYN_INLINE Simd<T, 4> quad(const Vec3<T>& a) {
  if constexpr (std::is_same_v<decltype(a.v), Simd<T, 4>>) return a.v;
  else return Simd<T, 4>(a[0], a[1], a[2], T(0));
}

// Four 6-vectors by components: linear x, y, z, angular x, y, z.
template <class T>
struct Six {
  using P = Simd<T, 4>;
  P x, y, z, u, v, w;

  template <class V>  // Motion or Force
  static DYN_INLINE Six transposed(const V* s) {
    Six a;
    P rest;
    transpose4(quad(s[0].linear), quad(s[1].linear), quad(s[2].linear), quad(s[3].linear), a.x, a.y, a.z, rest);
    transpose4(quad(s[0].angular), quad(s[1].angular), quad(s[2].angular), quad(s[3].angular), a.u, a.v, a.w, rest);
    return a;
  }
  DYN_INLINE void store(T* p) const {
    x.store(p), y.store(p + 4), z.store(p + 8), u.store(p + 12), v.store(p + 16), w.store(p + 20);
  }
  static DYN_INLINE Six load(const T* p) {
    return {P::load(p), P::load(p + 4), P::load(p + 8), P::load(p + 12), P::load(p + 16), P::load(p + 20)};
  }
  template <class V>
  DYN_INLINE P dot(const V& f) const {
    return dot_linear(f.linear) + dot_angular(f.angular);
  }
  DYN_INLINE P dot_linear(const Vec3<T>& f) const { return x * f[0] + y * f[1] + z * f[2]; }
  DYN_INLINE P dot_angular(const Vec3<T>& n) const { return u * n[0] + v * n[1] + w * n[2]; }
};

// A tile: columns j0 .. j0 + 3 as packs over the rows i0 .. i0 + 3.
template <class T>
struct Tile {
  using P = Simd<T, 4>;
  P a, b, c, d;
  // entry(j) gives column j, mask clears what is zero in it
  template <class Mask, class Entry>
  static DYN_INLINE Tile of(std::ptrdiff_t j0, Mask&& mask, Entry&& entry) {
    return {mask(j0, entry(j0)), mask(j0 + 1, entry(j0 + 1)), mask(j0 + 2, entry(j0 + 2)), mask(j0 + 3, entry(j0 + 3))};
  }
  DYN_INLINE Tile transposed() const {
    Tile t;
    transpose4(a, b, c, d, t.a, t.b, t.c, t.d);
    return t;
  }
};

// The square matrix in which tiles are stored: n x n, column-major.
template <class T>
struct TiledMatrix {
  using P = Simd<T, 4>;
  T* p;
  std::ptrdiff_t n;

  // Lines that will be written: of a large matrix each column is on a page of its own, which no machine foresees.
  DYN_INLINE void prefetch(std::ptrdiff_t i0, std::ptrdiff_t j0) const {
    const T* at = p + i0 + n * j0;
    for (int k = 0; k < 4; ++k) __builtin_prefetch(at + n * k, 1, 3);
  }
  DYN_INLINE void store(const Tile<T>& t, std::ptrdiff_t i0, std::ptrdiff_t j0) const {
    T* at = p + i0 + n * j0;
    if (i0 + 4 <= n && j0 + 4 <= n) [[likely]] {
      t.a.store(at), t.b.store(at + n), t.c.store(at + 2 * n), t.d.store(at + 3 * n);
      return;
    }
    const int rows = int(i0 + 4 <= n ? 4 : n - i0), columns = int(j0 + 4 <= n ? 4 : n - j0);
    store_partial(t.a, at, rows);
    if (columns > 1) store_partial(t.b, at + n, rows);
    if (columns > 2) store_partial(t.c, at + 2 * n, rows);
    if (columns > 3) store_partial(t.d, at + 3 * n, rows);
  }
  // the tile on the diagonal from its upper and, transposed, its lower triangle
  DYN_INLINE void store_diagonal(const Tile<T>& upper, const Tile<T>& lower, std::ptrdiff_t i0) const {
    store({blend<1>(upper.a, lower.a), blend<2>(upper.b, lower.b), blend<3>(upper.c, lower.c), upper.d}, i0, i0);
  }
  // the tile (i0, j0) and the one on the other side of the diagonal
  DYN_INLINE void store_pair(const Tile<T>& upper, const Tile<T>& lower, std::ptrdiff_t i0, std::ptrdiff_t j0) const {
    if (i0 == j0) return store_diagonal(upper, lower, i0);
    store(upper, i0, j0);
    store(lower, j0, i0);
  }
};

// f(rows, i0, j0, mask) for the tiles of the rows i0 .. i0 + 3 among the columns j0 .. columns_end that are not zero. next(j0) is
// the first column of the next tile.
template <class T, class Begin, class F, class Next>
DYN_INLINE void for_each_tile_of_rows(const Model& m, std::ptrdiff_t i0, std::ptrdiff_t j0, std::ptrdiff_t columns_end,
                                      Begin&& begin, F&& f, Next&& next) {
  using P = Simd<T, 4>;
  const std::ptrdiff_t longest = std::min<std::ptrdiff_t>(m.band_end()[i0 / 4], columns_end);
  const std::ptrdiff_t shortest = std::min<std::ptrdiff_t>(m.band_full()[i0 / 4], columns_end);
  if (j0 >= longest) return;
  const auto rows = begin(i0);
  for (; j0 + 4 <= shortest; j0 = next(j0)) f(rows, i0, j0, [](std::ptrdiff_t, const P& x) DYN_INLINE_LAMBDA { return x; });
  const P end = P::convert(m.dof_end() + i0);
  for (; j0 < longest; j0 = next(j0))
    f(rows, i0, j0, [&](std::ptrdiff_t j, const P& x) DYN_INLINE_LAMBDA { return select(end > T(double(j)), x, P::zero()); });
}

// f(rows, i0, j0, mask) for the tiles on and above the diagonal that are not zero; mask(j, x) clears the lanes whose degree of
// freedom does not support j. rows = begin(i0) is what the tiles of four rows share. Panels of 128 columns keep what is being
// written, and its mirror image, in the cache.
template <class T, class Begin, class F>
DYN_INLINE void for_each_tile(const Model& m, Begin&& begin, F&& f) {
  for (std::ptrdiff_t panel = 0; panel < m.n.nvx; panel += 128) {
    const std::ptrdiff_t panel_end = std::min<std::ptrdiff_t>(panel + 128, m.n.nvx);
    for (std::ptrdiff_t i0 = 0; i0 < panel_end; i0 += 4)
      for_each_tile_of_rows<T>(m, i0, std::max(i0, panel), panel_end, begin, f,
                               [](std::ptrdiff_t j0) DYN_INLINE_LAMBDA { return j0 + 4; });
  }
}

// The same for some tiles of a small matrix: next[k] is the first degree of freedom of the one that follows that of k, beyond the
// last one when there is none.
template <class T, class Begin, class F>
DYN_INLINE void for_each_tile_among(const Model& m, const Index* next, std::ptrdiff_t first, Begin&& begin, F&& f) {
  auto following = [&](std::ptrdiff_t j0) DYN_INLINE_LAMBDA { return std::ptrdiff_t(next[j0 / 4]); };
  for (std::ptrdiff_t i0 = first; i0 < m.n.nvx; i0 = following(i0))
    for_each_tile_of_rows<T>(m, i0, i0, m.n.nvx, begin, f, following);
}

// f(i, j) for the pairs of which i supports j, i <= j, of models without mimic joints: for scalars that fill registers by
// themselves (lane.hpp), and need no tiles.
template <class F>
DYN_INLINE void for_each_entry(const Model& m, F&& f) {
  const Index* parent = m.dof_parent();
  for (Index j = 0; j < m.n.nv; ++j)
    for (Index i = j; i >= 0; i = parent[i]) f(std::ptrdiff_t(i), std::ptrdiff_t(j));
}

// f(body, first, nv) for the bodies of more than one degree of freedom.
template <class F>
inline void for_each_block(const Model& m, F&& f) {
  for (Index k = 0; k < m.n.joint_runs; ++k) {
    const JointRun& run = m.joint_runs()[k];
    visit(run.type, [&]<class J>() DYN_INLINE_LAMBDA {
      if constexpr (J::nv > 1)
        for (Index i = run.first; i < run.last; ++i) f(i, std::ptrdiff_t(run.idx_v + J::nv * (i - run.first)), J::nv);
    });
  }
}

// M = G^T X G for v_x = G v: the rows and columns of a mimic's followers added to their leader's.
template <class T>
void contract(const Model& m, const T* X, T* M) {
  const std::ptrdiff_t n = m.n.nv, nx = m.n.nvx;
  const Index *own = m.own_v(), *followers = m.followers(), *leader = m.expand_v();
  const double* ratio = m.ratio_v();
  for (std::ptrdiff_t j = 0; j < n; ++j)
    for (std::ptrdiff_t i = 0; i < n; ++i) M[i + n * j] = X[own[i] + nx * own[j]];
  for (std::ptrdiff_t k = 0; k < nx - n; ++k) {
    const std::ptrdiff_t f = followers[k], at = leader[f];
    const T r = T(ratio[f]);
    for (std::ptrdiff_t i = 0; i < n; ++i) M[at + n * i] += r * X[f + nx * own[i]], M[i + n * at] += r * X[own[i] + nx * f];
    for (std::ptrdiff_t l = 0; l < nx - n; ++l) {
      const std::ptrdiff_t g = followers[l];
      M[at + n * leader[g]] += r * T(ratio[g]) * X[f + nx * g];
    }
  }
}

// The same for a symmetric X: symmetric to the last bit.
template <class T>
void contract_symmetric(const Model& m, const T* X, T* M) {
  contract(m, X, M);
  mirror_upper(M, m.n.nv);
}

}  // namespace dyn
