// Derivatives on the tangent space of the rows c = d2C/dt2 + stiffness C + damping dC/dt at given ddq, and of J^T lambda at given
// lambda. S, psi', psi'', W belong to degree of freedom k (rnea_derivatives.hpp), V and A to body B. A step along k moves B and
// changes V and A:
//   by q:  S_k   dV = psi' + S x V   dA = psi'' + psi' x V + S x A        by v:  dV = S_k   dA = W + S x V
// so dc/dq_k = alpha . S_k + beta . psi'_k + gamma . psi''_k and dc/dv_k = beta . S_k + gamma . W_k with one wrench each. For a
// row (f, t) in world axes; v, w are velocities of B's origin and axes, dv, dw their rates (less gravity), vA, wA, ... those of
// A:
//   gamma = (f; t)
//   beta  = (h; 2 v x f + w x t + l)        h = kd f - 2 f x wA + extra_v        l = kd t - t x wA + extra_w
//   alpha = (step + (f x wA - kd f - extra_v) x wA - f x dwA; turn + dv x f + v x h + w x l + dw x t)
// step and turn are further changes: kp dC, extra, and f, t themselves. Terms of V and A common to the three products cancel by
// Jacobi's identity. Rotating both bodies together changes nothing, so the derivative for A is minus that for B.
#pragma once

#include "algorithm/rnea_derivatives.hpp"
#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn {

// The last common ancestor of two bodies.
inline Index common_body(const Model& m, Index i, Index j) {
  while (i != j) {
    Index& at = i > j ? i : j;
    at = m.bodies()[at].parent;
  }
  return i;
}

// A frame as from moving_frame, with its columns, after derivative_columns. Accelerations less gravity.
template <class T>
MovingFrame<T> frame_of_columns(const Model& m, const Data<T>& d, Index body, const SE3<double>& X, const T* v, const T* a) {
  Motion<T> V = Motion<T>::zero(), A = d.spatial_a[0];
  const Vec3<T> o = Vec3<T>::zero();
  if (body == 0) return {cast<T>(X.R), cast<T>(X.p), cast<T>(X.p), o, o, A.linear, o};
  for (Index i = body; i != 0; i = m.bodies()[i].parent)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) {
      V = V + d.S[k] * v[k];
      A = A + d.S[k] * a[k] + d.dS[k] * v[k];
    }
  const Vec3<T> offset = d.R[body] * cast<T>(X.p), x = d.rel[body] + offset, velocity = V.linear + cross(V.angular, x);
  return {d.R[body] * cast<T>(X.R),
          d.p[body] + offset,
          x,
          velocity,
          V.angular,
          A.linear + cross(A.angular, x) + cross(V.angular, velocity),
          A.angular};
}

// Derivatives of one constraint: in lanes, about the root of either body's tree; and the changes of its forces.
template <class T>
struct RowDerivatives {
  struct Wrenches {
    alignas(64) T alpha[6 * row_lanes], beta[6 * row_lanes], gamma[6 * row_lanes], rate[6 * row_lanes];  // rate: of dC/dt, by S
  };
  Wrenches by1, by2;
  Force<T> F;            // sum of lambda times unit wrenches, at B's origin
  Mat3<T> F_step, F_turn;  // its change relative to a force that moves with B
  bool fixed;            // both are zero
  Vec3<T> x1, x2;        // B's origin from the roots of the two bodies' trees
};

template <class T>
void store_lanes(typename RowDerivatives<T>::Wrenches& to, const Force<T>& alpha, const Force<T>& beta, const Force<T>& gamma,
                 const Force<T>& rate, const Vec3<T>& at, T sign, int i) {
  store_lane(shift(alpha * sign, at), to.alpha, i), store_lane(shift(beta * sign, at), to.beta, i);
  store_lane(shift(gamma * sign, at), to.gamma, i), store_lane(shift(rate * sign, at), to.rate, i);
}

// v, a: expanded, at the acceleration of the dynamics. Call derivative_columns with them before.
template <class T>
void frame_row_derivatives(const Model& m, const Data<T>& d, const ConstraintInstance<T>& s, const T* v, const T* a,
                           const T* lambda, RowDerivatives<T>& out) {
  const MovingFrame<T> A = frame_of_columns(m, d, s.c.body2, s.c.X2, v, a), B = frame_of_columns(m, d, s.c.body1, s.c.X1, v, a);
  const RelativeMotion<T> X = relative_motion(A, B);
  const T kp = T(s.c.stiffness), kd = T(s.c.damping);
  const Vec3<T> o = Vec3<T>::zero();
  out.F = Force<T>::zero();
  out.F_step = out.F_turn = {o, o, o};
  out.fixed = true;
  out.x1 = B.x, out.x2 = A.x + (B.p - A.p);
  for (auto* w : {&out.by1, &out.by2}) *w = {};
  visit_frame_constraint(s.c.type, [&]<class K>() {
    K::evaluate(s.c, X.X, [&](int i, const Vec3<T>& fA, const Vec3<T>& tA, T, T, auto&&... change) {
      const Vec3<T> f = A.R * fA, t = A.R * tA;
      Vec3<T> step = f * kp, turn = t * kp, by_v = o, by_w = o, rate_step = o, rate_turn = o;
      if constexpr (sizeof...(change) > 0) {
        RowChange<T> by = RowChange<T>::fixed(fA, tA, kp != T(0));
        (change(by), ...);
        rate_step = A.R * transpose_times(by.f_step, X.X.v), rate_turn = A.R * transpose_times(by.t_turn, X.X.w);
        step = A.R * (by.error_step * kp + by.extra_step + transpose_times(by.f_step, X.dv)) + rate_step * kd;
        turn = A.R * (by.error_turn * kp + by.extra_turn + transpose_times(by.t_turn, X.dw)) + rate_turn * kd;
        by_v = A.R * by.extra_v, by_w = A.R * by.extra_w;
        out.F_step = out.F_step + by.f_step * lambda[i], out.F_turn = out.F_turn + by.t_turn * lambda[i];
        out.fixed = false;
      }
      const Vec3<T> fw = cross(f, A.w), h = f * kd + by_v - fw * T(2), l = t * kd + by_w - cross(t, A.w), vf = cross(B.v, f),
                    wt = cross(B.w, t);
      const Force<T> gamma{f, t}, beta{h, vf * T(2) + wt + l};
      const Force<T> alpha{step + cross(fw - f * kd - by_v, A.w) - cross(f, A.dw),
                           turn + cross(B.a, f) + cross(B.v, h) + cross(B.w, l) + cross(B.dw, t)};
      const Force<T> rate{rate_step - fw, rate_turn + vf + wt};
      if (s.c.body1) store_lanes<T>(out.by1, alpha, beta, gamma, rate, out.x1, T(1), i);
      if (s.c.body2) store_lanes<T>(out.by2, alpha, beta, gamma, rate, out.x2, T(-1), i);
      out.F = out.F + gamma * lambda[i];
    });
  });
  if (out.fixed) return;
  const Mat3<T> Rt = transpose(A.R);
  out.F_step = A.R * out.F_step * Rt, out.F_turn = A.R * out.F_turn * Rt;
}

}  // namespace dyn
