// Coriolis matrix C with C v + g = nle and dM/dt = C + C^T (Echeandia and Wensing 2021, "Numerical methods to compute the
// Coriolis matrix and Christoffel symbols for rigid-body systems", algorithm 1), at the origin of each tree's root in world axes.
// With S' = v x S, and Ic, B summed over the subtree of i (MomentRates), for j supporting i:
//   C_ji = S_j . (Ic S'_i + B S_i)        C_ij = S'_j . (Ic S_i) + S_j . (B^T S_i)
#pragma once

#include "algorithm/composite.hpp"
#include "algorithm/crba.hpp"

namespace dyn {

// What goes along a chain: pose and spatial velocity at the tree's root.
template <class T>
struct VelocityState : RelativePose<T> {
  Motion<T> v;

  explicit DYN_INLINE VelocityState(const Data<T>& d) : RelativePose<T>(d), v(Motion<T>::zero()) {}
  DYN_INLINE void enter(const Data<T>& d, Index parent) { RelativePose<T>::enter(d, parent), v = d.spatial_v[parent]; }
  DYN_INLINE void leave(Data<T>& d, Index i) const { d.spatial_v[i] = v; }
};

// d.coriolis, nv x nv, fully written, of the current d.q and d.v.
template <class T>
void coriolis_matrix(const Model& m, Data<T>& d) {
  using State = VelocityState<T>;
  const T* v = d.expand(m, d.v, d.vx);
  const State world(d);
  world.leave(d, 0);
  place_forward(m, d, world, [&]<class J>(Index i, Index dof, const SE3<T>& X, State& state) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    state.place(d, i, X, b.parent == 0);
    Motion<T> vi = state.v;
    for (int k = 0; k < J::nv; ++k) {
      const Motion<T> s = state.template column<J>(b, k);
      d.S[dof + k] = s;
      vi = vi + s * v[dof + k];
      if constexpr (J::nv == 1) d.dS[dof] = cross(state.v, s);  // S x S = 0
    }
    if constexpr (J::nv > 1)
      for (int k = 0; k < J::nv; ++k) d.dS[dof + k] = cross(vi, d.S[dof + k]);
    state.v = vi;

    const Moments<T> Y = Moments<T>::posed(T(b.m), cast<T>(b.h), cast<T>(b.I), state.R, state.rel);
    const MomentRates<T> rates = MomentRates<T>::of(Y, vi);
    Composite<T>& c = d.composite[i];
    c.Y.m = Y.m, c.Y.h = Y.h, c.Y.P.x = Y.P.x, c.Y.P.y = Y.P.y, c.Y.P.z = Y.P.z;
    c.rates.p = rates.p, c.rates.V.x = rates.V.x, c.rates.V.y = rates.V.y, c.rates.V.z = rates.V.z;
  }).done(d);

  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Composite<T>& c = d.composite[i];
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      const Motion<T> s = d.S[at];
      d.F[at] = c.Y * s;
      d.Fv[at] = c.Y * d.dS[at] + c.rates.coriolis(s) * T(0.5);
      d.Q[at] = c.rates.coriolis_transposed(s) * T(0.5);
    }
    if (b.parent == 0) return;
    Composite<T>& up = d.composite[b.parent];
    up.Y.m += c.Y.m, up.Y.h += c.Y.h, up.Y.P = up.Y.P + c.Y.P;
    up.rates.p += c.rates.p, up.rates.V = up.rates.V + c.rates.V;
  });

  const TiledMatrix<T> C{m.has_mimic ? d.dvx : d.coriolis, m.n.nvx};
  struct Rows {
    Six<T> S, dS;
  };
  for_each_tile<T>(
      m, [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA { return Rows{Six<T>::transposed(d.S + i0), Six<T>::transposed(d.dS + i0)}; },
      [&](const Rows& rows, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        C.store_pair(
            Tile<T>::of(j0, mask, [&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot(d.Fv[j]); }),
            Tile<T>::of(j0, mask,
                        [&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.dS.dot(d.F[j]) + rows.S.dot_angular(d.Q[j]); })
                .transposed(),
            i0, j0);
      });
  if (m.has_mimic) contract(m, d.dvx, d.coriolis);
  d.mark_fresh(Stage::Coriolis);
}

}  // namespace dyn
