// M = L^T D L with the tree's sparsity: L_ij is non-zero only for ancestors j of i (Featherstone 2008, 6.5, Table 6.3).
// dof_parent is the elimination tree (with mimic joints: of the filled pattern of M). Row i of D L holds, by their depth, the
// ancestors of i and at last the pivot D_i: ancestors of i are the first ones of its descendants too, so that rows are dense,
// however the tree branches. Of the pack in which the pivot lies nobody reads what is beyond it.
#pragma once

#include "algorithm/padding.hpp"
#include "base/simd_memory.hpp"
#include "model/data.hpp"

namespace dyn {

template <class T>
DYN_INLINE T* factor_row(const Model& m, const Data<T>& d, Index i) {
  return d.L + padded_factor(m) * i;
}

// f(first, last, at) for the runs of degree of freedom i and its ancestors, i first, entries at and on of their rows; nothing for
// i < 0.
template <class F>
DYN_INLINE void for_each_run(const Model& m, Index i, F&& f) {
  const Index *run = m.dof_run(), *depth = m.dof_depth(), *parent = m.dof_parent();
  while (i >= 0) {
    const Index first = run[i];
    f(first, i + 1, depth[first]);
    i = parent[first];
  }
}

// x = from less what the elimination of the count rows below takes from it, some packs of a row: theirs, from rows on, times
// their entries at coefficient, divided by D. The last row that was eliminated comes last, because its D is the last to be known.
template <int packs, class T>
DYN_INLINE void eliminate_rows(const T* from, T* x, const T* rows, const T* coefficient, std::ptrdiff_t room, const T* Dinv,
                               std::ptrdiff_t count) {
  using P = Simd<T, block_lanes>;
  P sum[packs];
#pragma GCC unroll 4
  for (int p = 0; p < packs; ++p) sum[p] = P::load(from + block_lanes * p);
  rows += room * count, coefficient += room * count;
  for (std::ptrdiff_t k = count - 1; k >= 0; --k) {
    rows -= room, coefficient -= room;
    const T L = *coefficient * Dinv[k];
#pragma GCC unroll 4
    for (int p = 0; p < packs; ++p) sum[p] = sum[p] - P::load(rows + block_lanes * p) * L;
  }
#pragma GCC unroll 4
  for (int p = 0; p < packs; ++p) sum[p].store(x + block_lanes * p);
}
template <class T>
DYN_INLINE void eliminate_rows(std::ptrdiff_t entries, const T* from, T* x, const T* rows, const T* coefficient,
                               std::ptrdiff_t room, const T* Dinv, std::ptrdiff_t count) {
  switch (std::size_t(entries - 1) / block_lanes) {
    case 0: return eliminate_rows<1>(from, x, rows, coefficient, room, Dinv, count);
    case 1: return eliminate_rows<2>(from, x, rows, coefficient, room, Dinv, count);
    case 2: return eliminate_rows<3>(from, x, rows, coefficient, room, Dinv, count);
    default: return eliminate_rows<4>(from, x, rows, coefficient, room, Dinv, count);
  }
}

// f.template operator()<count>() for the count of a group's degrees of freedom
template <class F>
DYN_INLINE auto visit_group(Index count, F&& f) {
  switch (count) {
    case 1: return f.template operator()<1>();
    case 2: return f.template operator()<2>();
    case 3: return f.template operator()<3>();
    default: return f.template operator()<4>();
  }
}

// The rows of L of a group side by side, column by column by depth: zero on and above the diagonal.
template <int count, class T>
DYN_INLINE void gather_group(const Data<T>& d, std::ptrdiff_t room, const DofGroup& g) {
  using P = Simd<T, 4>;
  const T *rows = d.L + room * g.first, *Dinv = d.D + g.first;
  T* columns = d.Lgroups + room * g.first;
  auto row = [&](int r, Index c) DYN_INLINE_LAMBDA { return r < count ? P::load(rows + room * r + c) * Dinv[r] : P::zero(); };
  for (Index c = 0; c < g.depth + count - 1; c += 4) {
    if constexpr (count == 1) {
      row(0, c).store(columns + c);
    } else {
      P x, y, z, w;
      transpose4(row(0, c), row(1, c), row(2, c), row(3, c), x, y, z, w);
      T* to = columns + count * c;
      x.store(to), y.store(to + count), z.store(to + 2 * count), w.store(to + 3 * count);
    }
  }
  for (int c = 0; c < count - 1; ++c)
    for (int r = 0; r <= c; ++r) columns[count * (g.depth + c) + r] = T(0);
}

// The rows of M of a group, by depth (M is symmetric: they are its columns). Beyond the pivots anything may stand.
template <int count, class T>
DYN_INLINE void copy_group(const Model& m, const Data<T>& d, std::ptrdiff_t room, const DofGroup& g) {
  using P = Simd<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  const T* from = d.M + n * g.first;
  T* to = d.L + room * g.first;
  for (int r = 0; r < count; ++r) P::load(from + n * r + g.first).store(to + room * r + g.depth);
  for_each_run(m, g.parent, [&](Index first, Index last, Index at) DYN_INLINE_LAMBDA {
    for (Index end = last - first; end > 0; end -= 4) {  // by fours that reach into what comes next, on towards the root
      const Index k = std::max(end - 4, -at);
      for (int r = 0; r < count; ++r) {
        const T* a = from + n * r + first + k;
        T* b = to + room * r + at + k;
        if (at + end >= 4) P::load(a).store(b);
        else store_partial(load_partial(a, at + end), b, at + end);
      }
    }
  });
}

// From the current d.M. Returns 0, or 1 + the degree of freedom whose pivot is not positive.
template <class T>
Index factorize(const Model& m, Data<T>& d) {
  const std::ptrdiff_t room = padded_factor(m);
  const DofGroup *groups = m.dof_groups(), *groups_end = groups + m.groups;
  for (const DofGroup* g = groups; g != groups_end; ++g)
    visit_group(g->count, [=, &m, &d]<int count>() DYN_INLINE_LAMBDA { copy_group<count>(m, d, room, *g); });
  const Index *depths = m.dof_depth(), *end = m.dof_descendants_end();
  T *row = d.L + room * m.n.nv, *Dinv = d.D + m.n.nv;
  for (std::ptrdiff_t i = m.n.nv - 1; i >= 0; --i) {
    const std::ptrdiff_t depth = depths[i], count = end[i] - 1 - i;
    const T* below = row;
    row -= room;
    if (count)
      for (std::ptrdiff_t c = 0; c <= depth; c += 4 * block_lanes)
        eliminate_rows(depth + 1 - c, row + c, row + c, below + c, below + depth, room, Dinv, count);
    if (!(row[depth] > T(0))) return Index(i) + 1;
    *--Dinv = T(1) / row[depth];
  }
  for (const DofGroup* g = groups; g != groups_end; ++g)
    visit_group(g->count, [=, &d]<int count>() DYN_INLINE_LAMBDA { gather_group<count>(d, room, *g); });
  d.mark_fresh(Stage::Factor);
  return 0;
}

// a less count packs times numbers x: two chains side by side. What comes last may be known last.
template <int step, class T>
DYN_INLINE Simd<T, 4> less_products(Simd<T, 4> a, const T* packs, std::ptrdiff_t stride, const T* x, std::ptrdiff_t count) {
  using P = Simd<T, 4>;
  P b = P::zero();
  const T* end = x + step * count;
  if (count & 1) b = b - P::load(packs) * x[0], packs += stride, x += step;
  for (; x != end; packs += 2 * stride, x += 2 * step) a = a - P::load(packs) * x[0], b = b - P::load(packs + stride) * x[step];
  return a + b;
}

// x = D^-1 L^-T b for a group, when its descendants have theirs; before = x
template <int count, class T>
DYN_INLINE void solve_upwards(const Data<T>& d, std::ptrdiff_t room, const DofGroup& g, const T* b, T* x, T* before) {
  using P = Simd<T, 4>;
  const std::ptrdiff_t others = g.end - g.first - count;
  const T *rows = d.L + room * g.first + g.depth, *Dinv = d.D + g.first;
  P y = less_products<-1>(load_partial<count>(b + g.first), rows + room * (count + others - 1), -room, x + g.end - 1, others);
  auto row = [&]<int r>() DYN_INLINE_LAMBDA { return blend<r>(P::load(rows + room * r), P::zero()) * Dinv[r]; };
  if constexpr (count > 3) y = y - row.template operator()<3>() * broadcast<3>(y);
  if constexpr (count > 2) y = y - row.template operator()<2>() * broadcast<2>(y);
  if constexpr (count > 1) y = y - row.template operator()<1>() * broadcast<1>(y);
  store_partial<count>(load_partial<count>(x + g.first), before + g.first);
  store_partial<count>(y * load_partial<count>(Dinv), x + g.first);
}
// x = L^-1 x for a group, when its ancestors have theirs, and in four lanes
template <int count, class T>
DYN_INLINE Simd<T, 4> solve_downwards(const Model& m, const Data<T>& d, std::ptrdiff_t room, const DofGroup& g, T* x) {
  using P = Simd<T, 4>;
  const T* columns = d.Lgroups + room * g.first;
  P y = load_partial<count>(x + g.first);
  for_each_run(m, g.parent, [&](Index first, Index last, Index at) DYN_INLINE_LAMBDA {
    y = less_products<1>(y, columns + count * at, count, x + first, last - first);
  });
  columns += count * g.depth;
  if constexpr (count > 1) y = y - P::load(columns) * broadcast<0>(y);
  if constexpr (count > 2) y = y - P::load(columns + count) * broadcast<1>(y);
  if constexpr (count > 3) y = y - P::load(columns + 2 * count) * broadcast<2>(y);
  store_partial<count>(y, x + g.first);
  return y;
}

// before = x, x = M^-1 b; all three may be the same. true: x is finite (false: perhaps not).
template <class T>
bool solve(const Model& m, const Data<T>& d, const T* b, T* x, T* before) {
  using P = Simd<T, 4>;
  const std::ptrdiff_t room = padded_factor(m);
  const DofGroup *groups = m.dof_groups(), *end = groups + m.groups;
  for (const DofGroup* g = end; g-- != groups;)
    visit_group(g->count, [=, &d]<int count>() DYN_INLINE_LAMBDA { solve_upwards<count>(d, room, *g, b, x, before); });
  P sum = P::zero();  // 0 times what is not finite is not a number
  for (const DofGroup* g = groups; g != end; ++g)
    sum = sum + T(0) * visit_group(g->count, [=, &m, &d]<int count>()
                                                 DYN_INLINE_LAMBDA { return solve_downwards<count>(m, d, room, *g, x); });
  return (sum[0] + sum[1]) + (sum[2] + sum[3]) == T(0);
}

}  // namespace dyn
