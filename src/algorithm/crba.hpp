// Joint-space inertia by the composite-rigid-body algorithm (Featherstone 2008, Table 6.2): M_ij = S_i . Ic_j S_j for i
// supporting j. The columns S_i and the forces F_j = Ic_j S_j are referred to the origin of the tree's root (so that distance
// from the world's origin costs no digits), which leaves one product of two 6-vectors for an entry.
#pragma once

#include "algorithm/kinematics.hpp"
#include "algorithm/tiles.hpp"

namespace dyn {

// Rotors on the diagonal of d.M, which is then complete.
template <class T>
void add_armature(const Model& m, Data<T>& d) {
  if (!(d.acting & DYN_EFFECT_ARMATURE)) return;
  for (std::ptrdiff_t k = 0; k < m.n.nv; ++k) d.M[k + m.n.nv * k] += d.armature[k];
}

// M = G^T X G (tiles.hpp) of the M of mimic joints, whose entries of degrees of freedom that the elimination tree does not relate
// are zero for good: trees that nothing couples cost nothing together.
template <class T>
void contract_related(const Model& m, const T* X, T* M) {
  const std::ptrdiff_t n = m.n.nv, nx = m.n.nvx;
  const Index *user = m.expand_v(), *parent = m.dof_parent();
  const double* ratio = m.ratio_v();
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j >= 0; j = parent[j]) M[j + n * i] = T(0);
  for (Index i = 1; i < m.n.bodies; ++i)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
      for (Index a = i; a != 0; a = m.bodies()[a].parent)
        for (Index l = m.bodies()[a].idx_v, last = a == i ? k + 1 : first_dof(m, a + 1); l < last; ++l) {
          const Index u = user[k], w = user[l];
          const T x = T(ratio[k] * ratio[l]) * X[l + nx * k];
          M[std::min(u, w) + n * std::max(u, w)] += u == w && k != l ? T(2) * x : x;
        }
  for (Index i = 0; i < n; ++i)
    for (Index j = parent[i]; j >= 0; j = parent[j]) M[i + n * j] = M[j + n * i];
}

// d.M from the columns and forces, by tiles.
template <class T>
DYN_INLINE void inertia_by_tiles(const Model& m, Data<T>& d) {
  const TiledMatrix<T> M{m.has_mimic ? d.Mx : d.M, m.n.nvx};
  const bool large = m.n.nvx > 256;  // beyond the cache nearby
  for_each_tile<T>(
      m, [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA { return Six<T>::transposed(d.S + i0); },
      [&](const Six<T>& S, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        const Force<T>* F = d.F + j0;
        const Tile<T> t{mask(j0, S.dot(F[0])), mask(j0 + 1, S.dot(F[1])), mask(j0 + 2, S.dot(F[2])), mask(j0 + 3, S.dot(F[3]))};
        const Tile<T> other = t.transposed();
        if (i0 == j0) return M.store_diagonal(t, other, i0);
        if (large) M.prefetch(i0 + 8, j0);
        M.store(t, i0, j0);
        M.store(other, j0, i0);
      });
  if (m.has_mimic) contract_related(m, d.Mx, d.M);
}

// d.M, full and symmetric.
template <class T>
void crba(const Model& m, Data<T>& d) {
  place_forward(m, d, RelativePose<T>(d),
                [&]<class J>(Index i, Index dof, const SE3<T>& X, RelativePose<T>& s) DYN_INLINE_LAMBDA {
                  const Body& b = m.bodies()[i];
                  s.place(d, i, X, b.parent == 0);
                  d.Ic[i] = world_inertia(b, s.R);
#pragma GCC unroll 6
                  for (int k = 0; k < J::nv; ++k) d.S[dof + k] = s.template column<J>(b, k);
                })
      .done(d);

  backward_chains(m, Inertia<T>::zero(), [&]<class J>(Index i, Index dof, bool, Inertia<T>& up) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Inertia<T> Y = d.Ic[i] + up;
#pragma GCC unroll 6
    for (int k = 0; k < J::nv; ++k) d.F[dof + k] = shift(momentum<J>(Y, J::column(b, d.R[i], k), k), d.rel[i]);
    up = Y.shifted(d.r[i]);
  }, [&](Index parent, const Inertia<T>& up) DYN_INLINE_LAMBDA {
    if (parent) d.Ic[parent] = d.Ic[parent] + up;
  });

  if (branches_by_state<T> || m.has_mimic) {
    inertia_by_tiles(m, d);
  } else {
    for_each_entry(m, [&](std::ptrdiff_t i, std::ptrdiff_t j) DYN_INLINE_LAMBDA {
      d.M[i + m.n.nv * j] = d.M[j + m.n.nv * i] = dot(d.S[i], d.F[j]);
    });
  }
  add_armature(m, d);
  d.mark_fresh(Stage::Mass);
}

}  // namespace dyn
