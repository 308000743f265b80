// Derivatives of the forces that hold a robot at rest on the tangent space, tau_i = S_i . (Y_i a_0 - fext_i) with a_0 = -g, Y and
// fext summed over the subtree of i, at the origin of each tree's root in world axes. For j supporting i (those of weight are a
// gradient):
//   dtau_i/dq_j = (a_0 x S_j) . Y_i S_i                dtau_j/dq_i = dtau_i/dq_j - S_j . (S_i x* fext_i)
#pragma once

#include "algorithm/effects.hpp"
#include "algorithm/rnea_derivatives.hpp"

namespace dyn {

// out, nv x nv; fext 6 x njoints in joint frames, or nullptr.
template <class T>
void gravity_derivatives(const Model& m, Data<T>& d, const T* fext, T* out) {
  const Motion<T> a0 = SpatialState<T>(d).a;
  place_forward(m, d, RelativePose<T>(d),
                [&]<class J>(Index i, Index dof, const SE3<T>& X, RelativePose<T>& s) DYN_INLINE_LAMBDA {
                  const Body& b = m.bodies()[i];
                  s.place(d, i, X, b.parent == 0);
                  for (int k = 0; k < J::nv; ++k) {
                    const Motion<T> S = s.template column<J>(b, k);
                    d.S[dof + k] = S;
                    d.ddS[dof + k] = cross(a0, S);
                  }
                  Composite<T>& c = d.composite[i];
                  c.Y.m = T(b.m), c.Y.h = s.R * cast<T>(b.h) + s.rel * T(b.m), c.f = Force<T>::zero();
                })
      .done(d);
  if (fext) subtract_external_at_root(m, d, fext);

  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Composite<T>& c = d.composite[i];
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      d.F[at].linear = d.S[at].linear * c.Y.m + cross(d.S[at].angular, c.Y.h);
      d.Fq[at] = cross(d.S[at], c.f);
    }
    if (b.parent == 0) return;
    Composite<T>& up = d.composite[b.parent];
    up.Y.m += c.Y.m, up.Y.h += c.Y.h, up.f = up.f + c.f;
  });

  const TiledMatrix<T> dq{m.has_mimic ? d.dqx : out, m.n.nvx};
  struct Rows {
    Six<T> S, weight;
  };
  for_each_tile<T>(
      m, [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA { return Rows{Six<T>::transposed(d.S + i0), Six<T>::transposed(d.ddS + i0)}; },
      [&](const Rows& rows, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        const Tile<T> below =
            Tile<T>::of(j0, mask, [&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.weight.dot_linear(d.F[j].linear); });
        const Tile<T> above = fext ? Tile<T>::of(j0, mask, [&](std::ptrdiff_t j) DYN_INLINE_LAMBDA {
          return rows.weight.dot_linear(d.F[j].linear) + rows.S.dot(d.Fq[j]);
        }) : below;
        dq.store_pair(above, below.transposed(), i0, j0);
      });
  // columns of one joint turn together
  for_each_block(m, [&](Index, std::ptrdiff_t first, int nv) {
    for (std::ptrdiff_t c = first; c < first + nv; ++c)
      for (std::ptrdiff_t r = first; r < c; ++r) dq.p[r + dq.n * c] = dot(d.ddS[c].linear, d.F[r].linear);
  });
  if (m.has_mimic) contract(m, d.dqx, out);
}

// The same with springs.
template <class T>
void static_torque_derivatives(const Model& m, Data<T>& d, const T* fext, T* out) {
  gravity_derivatives(m, d, fext, out);
  add_resistance_by_q(m, d, out);
}

}  // namespace dyn
