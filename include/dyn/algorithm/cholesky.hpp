// M = L^T D L with the tree's sparsity: L_ij is non-zero only for ancestors j of i (Featherstone 2008, 6.5, Table 6.3).
// dof_parent is the elimination tree (with mimic joints: of the filled pattern of M). Row i of D L holds, by their depth, the
// ancestors of i and at last the pivot D_i: ancestors of i are the first ones of its descendants too, so that rows are dense,
// however the tree branches. Of the pack in which the pivot lies nobody reads what is beyond it.
#pragma once

#include "dyn/base/pack.hpp"
#include "dyn/model/data.hpp"

namespace dyn {

template <class T>
DYN_INLINE T* factor_row(const Model& m, const Data<T>& d, Index i) {
  return d.L + factor_room(m) * i;
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

// x = from less what the elimination of the count rows below takes from it, some packs of a row: theirs, from rows on, times their
// entries at coefficient, divided by D. The last row that was eliminated comes last, because its D is the last to be known.
template <int packs, class T>
DYN_INLINE void eliminate_rows(const T* from, T* x, const T* rows, const T* coefficient, std::ptrdiff_t room, const T* Dinv, std::ptrdiff_t count) {
  using P = Pack<T, widest_pack>;
  P sum[packs];
#pragma GCC unroll 4
  for (int p = 0; p < packs; ++p) sum[p] = P::load(from + widest_pack * p);
  rows += room * count, coefficient += room * count;
  for (std::ptrdiff_t k = count - 1; k >= 0; --k) {
    rows -= room, coefficient -= room;
    const T L = *coefficient * Dinv[k];
#pragma GCC unroll 4
    for (int p = 0; p < packs; ++p) sum[p] = sum[p] - P::load(rows + widest_pack * p) * L;
  }
#pragma GCC unroll 4
  for (int p = 0; p < packs; ++p) sum[p].store(x + widest_pack * p);
}
template <class T>
DYN_INLINE void eliminate_rows(std::ptrdiff_t entries, const T* from, T* x, const T* rows, const T* coefficient, std::ptrdiff_t room, const T* Dinv,
                               std::ptrdiff_t count) {
  switch (std::size_t(entries - 1) / widest_pack) {
    case 0: return eliminate_rows<1>(from, x, rows, coefficient, room, Dinv, count);
    case 1: return eliminate_rows<2>(from, x, rows, coefficient, room, Dinv, count);
    case 2: return eliminate_rows<3>(from, x, rows, coefficient, room, Dinv, count);
    default: return eliminate_rows<4>(from, x, rows, coefficient, room, Dinv, count);
  }
}

// From the current d.M. Returns 0, or 1 + the degree of freedom whose pivot is not positive.
template <class T>
Index factorize(const Model& m, Data<T>& d) {
  const std::ptrdiff_t n = m.n.nv, room = factor_room(m);
  const T* column = d.M + n * n;
  T* row = d.L + room * n;
  for (std::ptrdiff_t i = n - 1; i >= 0; --i) {  // M is symmetric: its column i is its row i
    column -= n, row -= room;
    for_each_run(m, Index(i), [&](Index first, Index last, Index at) DYN_INLINE_LAMBDA {
      const T* from = column + first;
      T* to = row + at;
      Index count = last - first;
      for (; count >= 4; count -= 4, from += 4, to += 4) Pack<T, 4>::load(from).store(to);
      if (count) store(load(from, count), to, count);
    });
  }
  const Index *depths = m.dof_depth(), *end = m.dof_descendants_end();
  T* Dinv = d.D + n;
  row = d.L + room * n;
  for (std::ptrdiff_t i = n - 1; i >= 0; --i) {
    const std::ptrdiff_t depth = depths[i], count = end[i] - 1 - i;
    const T* below = row;
    row -= room;
    if (count)
      for (std::ptrdiff_t c = 0; c <= depth; c += 4 * widest_pack) eliminate_rows(depth + 1 - c, row + c, row + c, below + c, below + depth, room, Dinv, count);
    if (!(row[depth] > T(0))) return Index(i) + 1;
    *--Dinv = T(1) / row[depth];
  }
  d.done(Stage::Factor);
  return 0;
}

// x -= L_i^T x_i over the ancestors of i
template <class T>
DYN_INLINE void eliminate(const Model& m, const Data<T>& d, Index i, T* x) {
  const T* row = factor_row(m, d, i);
  const T xi = x[i] * d.D[i];
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last, Index at) {
    for (Index j = first; j < last; ++j) x[j] -= row[at + j - first] * xi;
  });
}
// D L_i x over the ancestors of i: four sums side by side
template <class T>
DYN_INLINE T row_times(const Model& m, const Data<T>& d, Index i, const T* x) {
  const T* row = factor_row(m, d, i);
  T sum[4] = {T(0), T(0), T(0), T(0)};
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last, Index at) {
    const T* entry = row + at - first;
    Index j = first;
    for (; j + 4 <= last; j += 4)
      for (int k = 0; k < 4; ++k) sum[k] += entry[j + k] * x[j + k];
    for (; j < last; ++j) sum[0] += entry[j] * x[j];
  });
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

// x = M^-1 x
template <class T>
void solve(const Model& m, const Data<T>& d, T* x) {
  const Index n = m.n.nv;
  for (Index i = n - 1; i >= 0; --i) eliminate(m, d, i, x);
  for (Index i = 0; i < n; ++i) x[i] = (x[i] - row_times(m, d, i, x)) * d.D[i];
}

}  // namespace dyn
