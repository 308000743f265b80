// Rows of all constraints: errors, wrenches, and their first and second rates at given velocities and accelerations.
#pragma once

#include "constraint/list.hpp"
#include "joint/list.hpp"
#include "model/data.hpp"

namespace dyn {

// f(constraint, slot) for the active ones.
template <class T, class F>
DYN_INLINE void for_each_constraint(const Model& m, Data<T>& d, F&& f) {
  for (Index s = 0; s < m.n.slots; ++s)
    if (d.slots[s].rows) f(d.slots[s], s);
}
template <class T>
Index active_rows(const Model& m, const Data<T>& d) {
  Index n = 0;
  for (Index s = 0; s < m.n.slots; ++s) n += d.slots[s].rows;
  return n;
}
// Spatial velocity and acceleration of a body at its tree's root: V = sum S v, A = sum (S a) + V x S v, with each joint's V that
// of its own body. Summed from the leaf: (sum over i of V_i x J_i) = sum over j of J_j x (sum of the J_i beyond j).
template <class T>
struct BodyMotion {
  Motion<T> V, A;
};
template <class T>
DYN_INLINE BodyMotion<T> body_motion(const Model& m, const Data<T>& d, Index i, const T* v, const T* a) {
  static constexpr Index sizes[] = {1, 1, 1, 1, 3, 6};  // in the order of BodyType
  BodyMotion<T> x{Motion<T>::zero(), Motion<T>::zero()};
  for (const Body* b; i != 0; i = b->parent) {
    b = &m.bodies()[i];
    Motion<T> J = Motion<T>::zero();
    for (Index k = b->idx_v, end = k + sizes[Index(b->type)]; k < end; ++k) {
      J = J + d.S[k] * v[k];
      if (a) x.A = x.A + d.S[k] * a[k];
    }
    x.A = x.A + cross(J, x.V);
    x.V = x.V + J;
  }
  return x;
}

// A frame on a body: its pose and the motion of its origin.
template <class T>
struct MovingFrame {
  Mat3<T> R;
  Vec3<T> p, x;          // origin: in the world, and from the tree's root
  Vec3<T> v, w, a, dw;
};
template <class T>
DYN_INLINE MovingFrame<T> moving_frame(const Model& m, const Data<T>& d, Index body, const SE3<double>& X, const T* v,
                                       const T* a) {
  const Vec3<T> o = Vec3<T>::zero();
  if (body == 0) return {cast<T>(X.R), cast<T>(X.p), cast<T>(X.p), o, o, o, o};
  const Vec3<T> offset = d.R[body] * cast<T>(X.p);
  MovingFrame<T> F{d.R[body] * cast<T>(X.R), d.p[body] + offset, d.rel[body] + offset, o, o, o, o};
  if (v) {
    const BodyMotion<T> M = body_motion(m, d, body, v, a);
    F.w = M.V.angular, F.v = M.V.linear + cross(F.w, F.x);
    F.dw = M.A.angular, F.a = M.A.linear + cross(F.dw, F.x) + cross(F.w, F.v);
  }
  return F;
}

// B relative to A, and the rates of v and w.
template <class T>
struct RelativeMotion {
  Relative<T> X;
  Vec3<T> dv, dw;
};
template <class T>
DYN_INLINE RelativeMotion<T> relative_motion(const MovingFrame<T>& A, const MovingFrame<T>& B) {
  const Mat3<T> Rt = transpose(A.R);
  const Vec3<T> r = B.p - A.p, turned = cross(A.w, r), v = B.v - A.v - turned;
  const Vec3<T> dv = B.a - A.a - cross(A.dw, r) - cross(A.w, turned) - cross(A.w, v) * T(2);
  return {{Rt * r, Rt * v, Rt * (B.w - A.w), Rt * B.R}, Rt * dv, Rt * (B.dw - A.dw - cross(A.w, B.w))};
}

template <class T>
DYN_INLINE void store_lane(const Force<T>& f, T* lanes, int i) {
  for (int x = 0; x < 3; ++x) lanes[row_lanes * x + i] = f.linear[x], lanes[row_lanes * (3 + x) + i] = f.angular[x];
}

template <class T>
DYN_INLINE void evaluate_frames(const Model& m, const Data<T>& d, ConstraintInstance<T>& s, const T* v, const T* a) {
  const MovingFrame<T> A = moving_frame(m, d, s.c.body2, s.c.X2, v, a), B = moving_frame(m, d, s.c.body1, s.c.X1, v, a);
  const RelativeMotion<T> X = relative_motion(A, B);
  const Vec3<T> at2 = A.x + (B.p - A.p);  // B's origin from the root of A's tree
  visit_frame_constraint(s.c.type, [&]<class K>() DYN_INLINE_LAMBDA {
    K::evaluate(s.c, X.X, [&](int i, const Vec3<T>& f, const Vec3<T>& t, T error, T extra, auto&&...) DYN_INLINE_LAMBDA {
      const Vec3<T> force = A.R * f, moment = A.R * t;
      if (s.c.body1) store_lane(Force<T>{force, moment + cross(B.x, force)}, s.F1, i);
      if (s.c.body2) store_lane(Force<T>{-force, -moment - cross(at2, force)}, s.F2, i);
      s.error[i] = error;
      s.rate[i] = dot(f, X.X.v) + dot(t, X.X.w);
      s.acceleration[i] = dot(f, X.dv) + dot(t, X.dw) + extra;
    });
  });
}

template <class T>
DYN_INLINE void evaluate_joints(const Data<T>& d, ConstraintInstance<T>& s, const T* v, const T* a) {
  visit_joint_constraint(s.c.type, [&]<class K>() DYN_INLINE_LAMBDA {
    const T q1 = d.q[s.c.q1], q2 = s.c.body2 ? d.q[s.c.q2] : T(0);
    const JointRow<T> row = K::evaluate(s.c, q1, q2);
    s.error[0] = row.error, s.g1 = row.g1, s.g2 = row.g2;
    if constexpr (requires { K::bounds(s.c, q1, s.lower[0], s.upper[0]); }) K::bounds(s.c, q1, s.lower[0], s.upper[0]);
    if (!v) return;
    const T v2 = s.c.body2 ? v[s.c.v2] : T(0);
    s.rate[0] = row.g1 * v[s.c.v1] + row.g2 * v2;
    s.acceleration[0] = (a ? row.g1 * a[s.c.v1] + (s.c.body2 ? row.g2 * a[s.c.v2] : T(0)) : T(0)) + row.curvature * v2 * v2;
  });
}

// Needs placements and the columns S at the trees' roots. v, a: expanded. v null: rates are not computed. a null: a = 0.
template <class T>
void evaluate_rows(const Model& m, Data<T>& d, const T* v, const T* a) {
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    if (between_joints(s.c.type)) evaluate_joints(d, s, v, a);
    else evaluate_frames(m, d, s, v, a);
  });
}

}  // namespace dyn
