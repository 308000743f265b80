// Derivatives of a frame's velocity V and acceleration A on the tangent space, and of its Jacobian. A step of q along the column
// S_k of body i, whose parent is p, carries everything beyond rigidly with S_k, but for what p adds to its motion. As seen from
// the frame (spatial vectors; Carpentier and Mansard 2018, Singh, Russell, Wensing 2022):
//   dV/dq = V_p x S                                         dV/dv = S
//   dA/dq = A_p x S + V_p x dV/dq + dV/dq x V               dA/dv = V_p x S + V_i x S + S x V                 dA/da = S
// As seen from the world, the step turns V and A themselves as well.
#pragma once

#include "algorithm/jacobian.hpp"

namespace dyn {

// Of body i at the point p.
template <class T>
DYN_INLINE Motion<T> velocity_at(const Data<T>& d, Index i, const Vec3<T>& p) {
  return shift(Motion<T>{d.vel[i], d.omega[i]}, p - d.p[i]);
}
template <class T>
DYN_INLINE Motion<T> spatial_acceleration_at(const Data<T>& d, Index i, const Vec3<T>& p) {
  return shift(Motion<T>{d.acc[i] - cross(d.omega[i], d.vel[i]), d.alpha[i]}, p - d.p[i]);
}

// What the step S changes a vector of the frame by, because the frame moves along: nothing as seen from there.
template <class T>
DYN_INLINE Motion<T> carried(dynReference reference, const Motion<T>& S, const Motion<T>& x) {
  if (reference == DYN_REFERENCE_WORLD) return cross(S, x);
  if (reference == DYN_REFERENCE_LOCAL_WORLD_ALIGNED) return {cross(S.angular, x.linear), cross(S.angular, x.angular)};
  return Motion<T>::zero();
}

// f(body, k, S): the columns that move the frame, at its origin.
template <class T, class F>
inline void for_each_carrier(const Model& m, const Data<T>& d, const FramePose<T>& frame, F&& f) {
  for (Index i = frame.body; i != 0; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    visit(b.type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (int k = 0; k < J::nv; ++k) f(i, k, shift(J::column(b, d.R[i], k), frame.p - d.p[i]));
    });
  }
}

template <class T>
inline void clear_columns(const Model& m, T* X) {
  if (X) std::fill_n(X, 6 * std::ptrdiff_t(m.n.nv), T(0));
}

// 6 x nv each, fully written; either may be nullptr.
template <class T>
void frame_velocity_derivatives(const Model& m, const Data<T>& d, Index frame, dynReference reference, T* dv_dq, T* dv_dv) {
  const FramePose<T> F = frame_pose(m, d, frame);
  const Motion<T> V = frame_velocity(F, d);
  clear_columns(m, dv_dq), clear_columns(m, dv_dv);
  for_each_carrier(m, d, F, [&](Index i, int k, const Motion<T>& S) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const std::ptrdiff_t at = 6 * (b.user_v + k);
    const Motion<T> dV = cross(velocity_at(d, b.parent, F.p), S);
    if (dv_dq) add6(dv_dq + at, express(F, reference, dV + carried(reference, S, V)), T(b.ratio));
    if (dv_dv) add6(dv_dv + at, express(F, reference, S), T(b.ratio));
  });
}

// The same of the spatial acceleration, or of the classical one, which has w x v more.
template <class T>
void frame_acceleration_derivatives(const Model& m, const Data<T>& d, Index frame, dynReference reference, bool classical,
                                    T* da_dq, T* da_dv, T* da_da) {
  const FramePose<T> F = frame_pose(m, d, frame);
  const Motion<T> V = frame_velocity(F, d), A = spatial_acceleration_at(d, F.body, F.p), v = express(F, reference, V);
  for (T* X : {da_dq, da_dv, da_da}) clear_columns(m, X);
  auto add = [&](T* X, const Body& b, int k, const Motion<T>& dA, const Motion<T>& dV) DYN_INLINE_LAMBDA {
    if (!X) return;
    Motion<T> da = express(F, reference, dA);
    if (classical) {
      const Motion<T> dv = express(F, reference, dV);
      da.linear += cross(dv.angular, v.linear) + cross(v.angular, dv.linear);
    }
    add6(X + 6 * (b.user_v + k), da, T(b.ratio));
  };
  for_each_carrier(m, d, F, [&](Index i, int k, const Motion<T>& S) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Motion<T> Vp = velocity_at(d, b.parent, F.p), Ap = spatial_acceleration_at(d, b.parent, F.p), dV = cross(Vp, S);
    add(da_dq, b, k, cross(Ap, S) + cross(Vp, dV) + cross(dV, V) + carried(reference, S, A), dV + carried(reference, S, V));
    add(da_dv, b, k, dV + cross(velocity_at(d, i, F.p), S) + cross(S, V), S);
    add(da_da, b, k, S, Motion<T>::zero());
  });
}

// H, 6 x nv x nv, fully written: page k is the derivative of the frame's Jacobian along q (+) e_k t. A step along S_k turns S_j
// when k supports j; it moves the frame, to which LOCAL and LOCAL_WORLD_ALIGNED refer S_j, in any case.
template <class T>
void frame_kinematic_hessian(const Model& m, Data<T>& d, Index frame, dynReference reference, T* H) {
  const FramePose<T> F = frame_pose(m, d, frame);
  const std::ptrdiff_t page = 6 * std::ptrdiff_t(m.n.nv);
  std::fill_n(H, page * m.n.nv, T(0));
  // the reference may be taken beforehand: it moves the product of two motions as it moves the two
  for_each_carrier(m, d, F, [&](Index i, int k, const Motion<T>& S) {
    d.carriers[m.bodies()[i].idx_v + k] = express(F, reference, S) * T(m.bodies()[i].ratio);
  });
  auto put = [&](T* column, const Motion<T>& x) DYN_INLINE_LAMBDA {
    if (m.has_mimic) add6(column, x, T(1));
    else store6(x, column);
  };
  const Body* bodies = m.bodies();
  for (Index i = F.body; i != 0; i = bodies[i].parent)
    for (Index j = bodies[i].idx_v; j < first_dof(m, i + 1); ++j) {
      const std::ptrdiff_t at_j = j - bodies[i].idx_v + bodies[i].user_v;
      const Motion<T> Sj = d.carriers[j];
      for (Index l = i; l != 0; l = bodies[l].parent)
        for (Index k = bodies[l].idx_v; k < first_dof(m, l + 1); ++k) {
          const std::ptrdiff_t at_k = k - bodies[l].idx_v + bodies[l].user_v;
          const Motion<T> Sk = d.carriers[k];
          T *jk = H + 6 * at_j + page * at_k, *kj = H + 6 * at_k + page * at_j;
          if (reference == DYN_REFERENCE_WORLD) put(jk, cross(Sk, Sj));
          if (reference == DYN_REFERENCE_LOCAL && l != i) put(kj, cross(Sk, Sj));  // S_j does not turn S_k of its own body
          if (reference == DYN_REFERENCE_LOCAL_WORLD_ALIGNED) {
            const Motion<T> turned = carried(reference, Sk, Sj);
            put(jk, turned);
            if (l != i) put(kj, Motion<T>{turned.linear, Vec3<T>::zero()});
          }
        }
    }
}

}  // namespace dyn
