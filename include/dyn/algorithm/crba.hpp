// Joint-space inertia by the composite-rigid-body algorithm (Featherstone 2008, Table 6.2), in world axes.
// M_ij = S_i . F_j, F_j = Ic_j S_j, both referred to the origin of the tree's root (so that distance from the world's origin
// costs no digits). The ancestors' columns lie component by component in memory: a column of M is six vector operations.
#pragma once

#include "dyn/algorithm/kinematics.hpp"
#include "dyn/base/pack.hpp"

namespace dyn {

// Y s, with what is zero in the columns of J left out.
template <class J, class T>
DYN_INLINE Force<T> momentum(const Inertia<T>& Y, const Motion<T>& s) {
  if constexpr (!J::translates)
    return {cross(s.angular, Y.h), Y.I * s.angular};
  else if constexpr (!J::rotates)
    return {s.linear * Y.m, cross(Y.h, s.linear)};
  else
    return Y * s;
}

// The columns of S at the tree's root by components, composite inertias, and F = Ic S at the tree's root.
template <class T>
void composite_inertias(const Model& m, Data<T>& d) {
  const Index n = dof_stride(m);
  T *l = d.dof, *w = d.dof + 3 * n;
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    d.Ic[i] = world_inertia(b, d.R[i]);
    d.rel[i] = b.parent == 0 ? Vec3<T>::zero() : d.rel[b.parent] + d.r[i];
    for (int k = 0; k < J::nv; ++k) {
      Motion<T> s = J::column(b, d.R[i], k);
      if constexpr (J::rotates) s = shift(s, -d.rel[i]);
      const Index at = b.idx_v + k;
      for (int x = 0; x < 3; ++x) l[x * n + at] = s.linear[x], w[x * n + at] = s.angular[x];
    }
  });
  Inertia<T> up = Inertia<T>::zero();  // what body i + 1 passes to its parent, in registers when that is body i
  bool chain = false;
  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    Inertia<T> Y = d.Ic[i];
    if (chain) Y = Y + up;
    for (int k = 0; k < J::nv; ++k) d.F[b.idx_v + k] = shift(momentum<J>(Y, J::column(b, d.R[i], k)), d.rel[i]);
    up = Y.shifted(d.r[i]);
    chain = b.parent == i - 1;
    if (!chain && b.parent) d.Ic[b.parent] = d.Ic[b.parent] + up;
  });
}

// out[i] = S_i . F for W expanded degrees of freedom from i on.
template <int W, class T>
DYN_INLINE Pack<T, W> project_pack(const T* dof, Index n, Index i, const Force<T>& F) {
  using P = Pack<T, W>;
  return (P::load(dof + i) * F.linear[0] + P::load(dof + n + i) * F.linear[1] + P::load(dof + 2 * n + i) * F.linear[2]) +
         (P::load(dof + 3 * n + i) * F.angular[0] + P::load(dof + 4 * n + i) * F.angular[1] + P::load(dof + 5 * n + i) * F.angular[2]);
}

// out[i] for i in [first, last). May write up to room numbers past last.
template <class T>
DYN_INLINE void project_columns(const T* dof, Index n, Index first, Index last, const Force<T>& F, T* out, Index room) {
  Index i = first;
  if constexpr (wide > 4)
    for (; i + wide <= last; i += wide) project_pack<wide>(dof, n, i, F).store(out + i);
  for (; i + 4 <= last || (i < last && i + 4 <= last + room); i += 4) project_pack<4>(dof, n, i, F).store(out + i);
  if (i < last) {
    const Pack<T, 4> rest = project_pack<4>(dof, n, i, F);
    for (int k = 0; i + k < last; ++k) out[i + k] = rest[k];
  }
}

// f(first, last) for the runs of expanded degrees of freedom that support body i (its own included), tip to root.
template <class F>
DYN_INLINE void for_each_support(const Model& m, Index i, F&& f) {
  Index last = i + 1 < m.n.bodies ? m.bodies()[i + 1].idx_v : m.n.nvx;
  while (i != 0) {
    const Index begin = m.chain_begin()[i];
    f(m.bodies()[begin].idx_v, last);
    i = m.bodies()[begin].parent;
    last = i + 1 < m.n.bodies ? m.bodies()[i + 1].idx_v : m.n.nvx;
  }
}

// M += G^T M_x G for one column of the expanded M_x: q_x = G q has one entry, the ratio, in each row.
template <class T>
void add_mimic_column(const Model& m, Data<T>& d, Index j, Index at, const T* column) {
  const std::ptrdiff_t nv = m.n.nv;
  const Body& bj = m.bodies()[j];
  const Index uj = bj.user_v + (at - bj.idx_v);
  for_each_support(m, j, [&](Index first, Index last) {
    for (Index i = first; i < last && i <= at; ++i) {
      const Body& bi = m.bodies()[m.dof_body()[i]];
      const Index ui = bi.user_v + (i - bi.idx_v);
      const T x = T(bi.ratio) * T(bj.ratio) * column[i];
      d.M[ui + nv * uj] += x;
      if (i != at) d.M[uj + nv * ui] += x;
    }
  });
}

// M[j, i] = M[i, j] for i0 <= i < j and j0 <= j < j1.
template <class T>
DYN_INLINE void mirror_rest(T* M, std::ptrdiff_t n, std::ptrdiff_t i0, std::ptrdiff_t j0, std::ptrdiff_t j1) {
  for (std::ptrdiff_t j = j0; j < j1; ++j)
    for (std::ptrdiff_t i = i0; i < j; ++i) M[j + n * i] = M[i + n * j];
}
// Rows j0 .. j1 - 1 (at most 8) of the lower triangle from the columns of the upper one; eight rows are a line of cache.
template <class T>
DYN_INLINE void mirror(T* M, std::ptrdiff_t n, std::ptrdiff_t j0, std::ptrdiff_t j1) {
  std::ptrdiff_t i = 0;
  if (j1 - j0 == 8)
    for (; i < j0; i += 4) {
      transpose4(M + i + n * j0, n, M + j0 + n * i, n);
      transpose4(M + i + n * (j0 + 4), n, M + j0 + 4 + n * i, n);
    }
  else if (j1 - j0 >= 4)
    for (; i < j0; i += 4) transpose4(M + i + n * j0, n, M + j0 + n * i, n);
  if (j1 - j0 >= 4) {
    for (std::ptrdiff_t c = j0; c < j0 + 4; ++c)
      for (std::ptrdiff_t r = c + 1; r < j0 + 4; ++r) M[r + n * c] = M[c + n * r];
    if (j1 - j0 > 4) mirror_rest(M, n, j1 - j0 == 8 ? j0 : 0, j0 + 4, j1);
  } else {
    mirror_rest(M, n, 0, j0, j1);
  }
}

// d.M, full and symmetric.
template <class T>
void crba(const Model& m, Data<T>& d) {
  ensure_position(m, d);
  composite_inertias(m, d);
  const std::ptrdiff_t nv = m.n.nv;
  T* M = d.M;
  if (m.has_mimic)
    for (std::ptrdiff_t k = 0; k < nv * nv; ++k) M[k] = T(0);

  std::ptrdiff_t mirrored = 0;
  forward(m, [&]<class J>(Index j) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[j];
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      T* column = m.has_mimic ? d.column : M + nv * at;
      // what is written past the diagonal of the column is overwritten by its mirror image
      Index room = m.has_mimic ? 3 : Index(nv) - 1 - at;
      for_each_support(m, j, [&](Index first, Index last) {
        project_columns(d.dof, dof_stride(m), first, last > at ? at + 1 : last, d.F[at], column, room);
        room = 0;
      });
      if (m.has_mimic) add_mimic_column(m, d, j, at, column);
    }
    if (!m.has_mimic)
      for (; mirrored + 8 <= b.idx_v + J::nv; mirrored += 8) mirror(M, nv, mirrored, mirrored + 8);
  });
  if (!m.has_mimic) mirror(M, nv, mirrored, nv);
  for (std::ptrdiff_t k = 0; k < nv; ++k) M[k + nv * k] += T(m.armature()[k]);
  d.done(Stage::Mass);
}

}  // namespace dyn
