// Articulated inertias alone, without bias forces: the factor of M^-1 (articulated_solve.hpp) that depends on q only
// (Featherstone 2008, Table 7.1).
#pragma once

#include "algorithm/aba.hpp"

namespace dyn {

// d.S, d.U_root, d.Dinv for a model without mimic joints. Returns 0, or the body whose joint has an articulated inertia that is
// not positive.
template <class T>
Index articulated_factor(const Model& m, Data<T>& d) {
  struct State : RelativePose<T> {
    using RelativePose<T>::RelativePose;
    // others than the next body add to this one's IA in memory
    DYN_INLINE void leave(Data<T>& d, Index i) const { d.IA[i] = ArticulatedInertia<T>::zero(); }
  };
  place_forward(m, d, State(d), [&]<class J>(Index i, Index dof, const SE3<T>& X, State& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    s.place(d, i, X, b.parent == 0);
    d.Y[i] = world_inertia(b, s.R);
    for (int k = 0; k < J::nv; ++k) d.S[dof + k] = s.template column<J>(b, k);
  }).done(d);

  Index singular = 0;
  using IA_t = ArticulatedInertia<T>;
  backward_chains(m, IA_t::zero(), [&]<class J>(Index i, Index dof, bool last, IA_t& up) DYN_INLINE_LAMBDA {
    IA_t IA = up + IA_t::rigid(d.Y[i]);
    if (last) IA = IA + d.IA[i];
    for (int k = J::nv - 1; k >= 0; --k) {
      const Index at = dof + k;
      const Motion<T> s = J::column(m.bodies()[i], d.R[i], k);
      const Force<T> U = times_column<J>(IA, s);
      const T D = dot_column<J>(s, U) + d.armature[at];
      if (!(D > T(0)) && !singular) singular = i;
      const T Dinv = T(1) / D;
      IA = IA.minus_outer(U, Dinv);
      d.U_root[at] = shift(U, d.rel[i]);
      d.Dinv[at] = Dinv;
    }
    up = IA.shifted(d.r[i]);
  }, [&](Index parent, const IA_t& up) DYN_INLINE_LAMBDA {
    if (parent) d.IA[parent] = d.IA[parent] + up;
  });
  return singular;
}

}  // namespace dyn
