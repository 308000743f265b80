// Derivatives of inverse dynamics on the tangent space (Singh, Russell, Wensing 2022, "Efficient analytical derivatives of
// rigid-body dynamics using spatial vector algebra", equations 18 to 21), at the origin of each tree's root in world axes.
// With psi' = v_p x S, psi'' = a_p x S + v_p x psi', S' = v x S (p the parent), Ic, B, f summed over the subtree of i,
// and j supporting i:
//   dtau_i/dq_j = (2 B^T S_i) . psi'_j + (Ic S_i) . psi''_j        dtau_i/dv_j = (2 B^T S_i) . S_j + (Ic S_i) . (psi'_j + S'_j)
//   dtau_j/dq_i = S_j . (2 B psi'_i + Ic psi''_i + S_i x* f)        dtau_j/dv_i = S_j . (2 B S_i + Ic (psi'_i + S'_i))
// Every entry is a product of 6-vectors, four by four in tiles.
#pragma once

#include "algorithm/coriolis.hpp"

namespace dyn {

template <class T>
struct SpatialState : VelocityState<T> {
  Motion<T> a;

  explicit DYN_INLINE SpatialState(const Data<T>& d) : VelocityState<T>(d) {
    a = {-load3(d.world_gravity), Vec3<T>::zero()};
  }
  DYN_INLINE void enter(const Data<T>& d, Index parent) { VelocityState<T>::enter(d, parent), a = d.spatial_a[parent]; }
  DYN_INLINE void leave(Data<T>& d, Index i) const { VelocityState<T>::leave(d, i), d.spatial_a[i] = a; }
};

// Columns S, psi', psi'', psi' + S', and what moves with each body, at the tree's root.
template <class T>
void derivative_columns(const Model& m, Data<T>& d, const T* v, const T* a) {
  using State = SpatialState<T>;
  const State world(d);
  world.leave(d, 0);
  place_forward(m, d, world, [&]<class J>(Index i, Index dof, const SE3<T>& X, State& state) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    state.place(d, i, X, b.parent == 0);
    const Motion<T> vp = state.v, ap = state.a;
    Motion<T> vi = vp, ai = ap;
    for (int k = 0; k < J::nv; ++k) {
      const Index at = dof + k;
      const Motion<T> s = state.template column<J>(b, k), ds = cross(vp, s);
      d.S[at] = s;
      d.dS[at] = ds;
      d.ddS[at] = cross(ap, s) + cross(vp, ds);
      vi = vi + s * v[at];
      ai = ai + s * a[at] + ds * v[at];
      if constexpr (J::nv == 1) d.W[at] = ds * T(2);  // S x S = 0
    }
    if constexpr (J::nv > 1)
      for (int k = 0; k < J::nv; ++k) d.W[dof + k] = d.dS[dof + k] + cross(vi, d.S[dof + k]);
    state.v = vi, state.a = ai;

    const Moments<T> Y = Moments<T>::posed(T(b.m), cast<T>(b.h), cast<T>(b.I), state.R, state.rel);
    const MomentRates<T> rates = MomentRates<T>::of(Y, vi);
    Composite<T>& c = d.composite[i];
    c.Y.m = Y.m, c.Y.h = Y.h, c.Y.P.x = Y.P.x, c.Y.P.y = Y.P.y, c.Y.P.z = Y.P.z;
    c.rates.p = rates.p, c.rates.V.x = rates.V.x, c.rates.V.y = rates.V.y, c.rates.V.z = rates.V.z;
    c.f = newton_euler(Y, rates, vi, ai);
  }).done(d);
}

// Of the composites' forces: fext, which is given on each joint's body in the joint's own frame.
template <class T>
void subtract_external_at_root(const Model& m, Data<T>& d, const T* fext) {
  for (Index j = 1; j < m.n.joints; ++j) {
    const JointRecord& joint = m.joints()[j];
    const Mat3<T> R = d.R[joint.last_body] * cast<T>(joint.C);
    const Force<T> f = load_force(fext + 6 * j);
    Force<T>& at = d.composite[joint.last_body].f;
    at = at - shift(Force<T>{R * f.linear, R * f.angular}, d.rel[joint.last_body]);
  }
}

// Composites of the subtrees, and the forces F, Fq, Fv, Q that their columns take; tau = S^T f, expanded, unless it is nullptr.
template <class T>
void composite_forces(const Model& m, Data<T>& d, T* tau) {
  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Composite<T>& c = d.composite[i];
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      const Motion<T> s = d.S[at];
      if (tau) tau[at] = dot(s, c.f);
      d.F[at] = c.Y * s;
      d.Q[at] = c.rates.coriolis_transposed(s);
      d.Fq[at] = c.rates.coriolis(d.dS[at]) + c.Y * d.ddS[at] + cross(s, c.f);
      d.Fv[at] = c.rates.coriolis(s) + c.Y * d.W[at];
    }
    if (b.parent == 0) return;
    Composite<T>& up = d.composite[b.parent];
    up.Y.m += c.Y.m, up.Y.h += c.Y.h, up.Y.P = up.Y.P + c.Y.P;
    up.rates.p += c.rates.p, up.rates.V = up.rates.V + c.rates.V;
    up.f = up.f + c.f;
  });
}

// Products of the columns with the composite forces, by tiles.
template <class T>
DYN_INLINE void derivatives_by_tiles(const Model& m, Data<T>& d, const TiledMatrix<T>& dq, const TiledMatrix<T>& dv,
                                     const TiledMatrix<T>& M) {
  struct Rows {
    Six<T> S, dS, ddS, W;
  };
  for_each_tile<T>(
      m,
      [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA {
        return Rows{Six<T>::transposed(d.S + i0), Six<T>::transposed(d.dS + i0), Six<T>::transposed(d.ddS + i0),
                    Six<T>::transposed(d.W + i0)};
      },
      [&](const Rows& rows, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        auto tile = [&](auto&& entry) DYN_INLINE_LAMBDA { return Tile<T>::of(j0, mask, entry); };
        const Tile<T> inertia = tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot(d.F[j]); });
        M.store_pair(inertia, inertia.transposed(), i0, j0);
        dq.store_pair(tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot(d.Fq[j]); }),
                      tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA {
                        return rows.ddS.dot(d.F[j]) + rows.dS.dot_angular(d.Q[j]);
                      }).transposed(),
                      i0, j0);
        dv.store_pair(tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot(d.Fv[j]); }),
                      tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA {
                        return rows.W.dot(d.F[j]) + rows.S.dot_angular(d.Q[j]);
                      }).transposed(),
                      i0, j0);
      });
}
// The same entry by entry.
template <class T>
DYN_INLINE void derivatives_by_entries(const Model& m, Data<T>& d) {
  const std::ptrdiff_t n = m.n.nv;
  for_each_entry(m, [&](std::ptrdiff_t i, std::ptrdiff_t j) DYN_INLINE_LAMBDA {
    const std::ptrdiff_t upper = i + n * j, lower = j + n * i;
    d.M[lower] = d.M[upper] = dot(d.S[i], d.F[j]);
    d.dtau_dq[lower] = dot(d.ddS[i], d.F[j]) + dot(d.dS[i].angular, d.Q[j]);
    d.dtau_dv[lower] = dot(d.W[i], d.F[j]) + dot(d.S[i].angular, d.Q[j]);
    d.dtau_dq[upper] = dot(d.S[i], d.Fq[j]), d.dtau_dv[upper] = dot(d.S[i], d.Fv[j]);
  });
}

// d.dtau_dq, d.dtau_dv, d.M, nv x nv, and d.tau, from the columns and each body's forces.
template <class T>
void torque_derivatives(const Model& m, Data<T>& d, const T* v, const T* a) {
  composite_forces(m, d, m.has_mimic ? d.taux : d.tau);

  const TiledMatrix<T> dq{m.has_mimic ? d.dqx : d.dtau_dq, m.n.nvx}, dv{m.has_mimic ? d.dvx : d.dtau_dv, m.n.nvx},
      M{m.has_mimic ? d.Mx : d.M, m.n.nvx};
  if (branches_by_state<T> || m.has_mimic) derivatives_by_tiles(m, d, dq, dv, M);
  else derivatives_by_entries(m, d);

  // columns of one joint: what turns the force turns them as well
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    if constexpr (J::nv > 1) {
      const std::ptrdiff_t at = m.bodies()[i].idx_v;
      for (int c = 1; c < J::nv; ++c) {
        const Force<T> turned = cross(d.S[at + c], d.composite[i].f);
        for (int r = 0; r < c; ++r) dq.p[at + r + dq.n * (at + c)] -= dot(d.S[at + r], turned);
      }
    }
  });

  if (m.has_mimic) {
    contract(m, d.dqx, d.dtau_dq);
    contract(m, d.dvx, d.dtau_dv);
    contract_symmetric(m, d.Mx, d.M);
    d.reduce(m, d.taux, d.tau);
  }
  add_armature(m, d);
  if constexpr (branches_by_state<T>)
    if (resists(d)) add_resistance(m, d, v, d.tau), add_resistance_derivatives(m, d, v, d.dtau_dq, d.dtau_dv);
  for (Index k = 0; k < m.n.nv; ++k) d.tau[k] += d.armature[k] * a[k];
  d.mark_fresh(Stage::Mass);
}

// The same; fext 6 x njoints in joint frames, or nullptr.
template <class T>
void rnea_derivatives(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext) {
  derivative_columns(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax));
  if (fext) subtract_external_at_root(m, d, fext);
  torque_derivatives(m, d, v, a);
}

}  // namespace dyn
