// Joint-space inertia by the composite-rigid-body algorithm (Featherstone 2008, Table 6.2): M_ij = S_i . Ic_j S_j for i supporting
// j. The columns S_i and the forces F_j = Ic_j S_j are referred to the origin of the tree's root (so that distance from the
// world's origin costs no digits), which leaves one product of two 6-vectors for an entry.
#pragma once

#include "dyn/algorithm/kinematics.hpp"
#include "dyn/algorithm/tiles.hpp"

namespace dyn {

// Rotors on the diagonal of d.M, which is then complete, and its trace in d.extent[3].
template <class T>
void add_armature(const Model& m, Data<T>& d) {
  T trace = T(0);
  T* at = d.M;
#pragma GCC unroll 4
  for (Index k = 0; k < m.n.nv; ++k, at += m.n.nv + 1) trace += *at += d.armature[k];
  d.extent[3] = trace;
}

// d.M, full and symmetric.
template <class T>
void crba(const Model& m, Data<T>& d) {
  place_forward(m, d, RelativePose<T>(d), [&]<class J>(Index i, Index dof, const SE3<T>& X, RelativePose<T>& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    s.place(d, i, X, b.parent == 0);
    d.Ic[i] = world_inertia(b, s.R);
#pragma GCC unroll 6
    for (int k = 0; k < J::nv; ++k) d.S[dof + k] = s.template column<J>(b, k);
  }).done(d);

  backward_chains(m, Inertia<T>::zero(), [&]<class J>(Index i, Index dof, bool, Inertia<T>& up) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Inertia<T> Y = d.Ic[i] + up;
#pragma GCC unroll 6
    for (int k = 0; k < J::nv; ++k) d.F[dof + k] = shift(momentum<J>(Y, J::column(b, d.R[i], k), k), d.rel[i]);
    up = Y.shifted(d.r[i]);
  }, [&](Index parent, const Inertia<T>& up) DYN_INLINE_LAMBDA {
    if (parent) d.Ic[parent] = d.Ic[parent] + up;
  });

  const TiledMatrix<T> M{m.has_mimic ? d.Mx : d.M, m.n.nvx};
  for_each_tile<T>(
      m, [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA { return Six<T>::transposed(d.S + i0); },
      [&](const Six<T>& S, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        const Force<T>* F = d.F + j0;
        const Tile<T> t{mask(j0, S.dot(F[0])), mask(j0 + 1, S.dot(F[1])), mask(j0 + 2, S.dot(F[2])), mask(j0 + 3, S.dot(F[3]))};
        const Tile<T> other = t.transposed();
        if (i0 == j0) return M.store_diagonal(t, other, i0);
        M.prefetch(i0 + 8, j0);
        M.store(t, i0, j0);
        M.store(other, j0, i0);
      });
  if (m.has_mimic) contract_symmetric(m, d.Mx, d.M);
  add_armature(m, d);
  d.done(Stage::Mass);
}

}  // namespace dyn
