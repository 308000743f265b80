// Jacobians and their time variation. Column j of the world Jacobian is S_j = [l; w] of a body at p, referred to the world's
// origin: [l + p x w; w]; S is constant in its body, so that its derivative is V x S, V the body's spatial velocity.
#pragma once

#include "algorithm/crba.hpp"

namespace dyn {

template <class T>
DYN_INLINE void add6(T* column, const Motion<T>& s, T ratio) {
  for (int x = 0; x < 3; ++x) column[x] += s.linear[x] * ratio, column[3 + x] += s.angular[x] * ratio;
}

// Column k of body i at the world's origin.
template <class J, class T>
DYN_INLINE Motion<T> world_column(const Body& b, const Data<T>& d, Index i, int k) {
  Motion<T> s = J::column(b, d.R[i], k);
  if constexpr (J::rotates) s.linear = s.linear + cross(d.p[i], s.angular);
  return s;
}
// Spatial velocity of body i at the world's origin.
template <class T>
DYN_INLINE Motion<T> world_velocity(const Data<T>& d, Index i) {
  return {d.vel[i] + cross(d.p[i], d.omega[i]), d.omega[i]};
}

// d.J, 6 x nv.
template <class T>
void joint_jacobians(const Model& m, Data<T>& d) {
  ensure_position(m, d);
  if (m.has_mimic)
    for (Index k = 0; k < 6 * m.n.nv; ++k) d.J[k] = T(0);
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    for (int k = 0; k < J::nv; ++k) {
      const Motion<T> s = world_column<J>(b, d, i, k);
      T* column = d.J + 6 * (b.user_v + k);
      if (m.has_mimic)
        add6(column, s, T(b.ratio));
      else
        store6(s, column);
    }
  });
  d.mark_fresh(Stage::Jacobians);
}

// d.dJ, 6 x nv; and d.J.
template <class T>
void joint_jacobians_time_variation(const Model& m, Data<T>& d) {
  ensure_velocity(m, d);
  joint_jacobians(m, d);
  for (Index k = 0; k < 6 * m.n.nv; ++k) d.dJ[k] = T(0);
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Motion<T> V = world_velocity(d, i);
    for (int k = 0; k < J::nv; ++k) add6(d.dJ + 6 * (b.user_v + k), cross(V, world_column<J>(b, d, i, k)), T(b.ratio));
  });
  d.mark_fresh(Stage::DJacobians);
}

// Where a frame is and how it moves.
template <class T>
struct FramePose {
  Index body;
  Mat3<T> R;   // R_WF
  Vec3<T> p;   // p_WF
  Vec3<T> o;   // from the body's origin to the frame's, W
};
template <class T>
inline FramePose<T> frame_pose(const Model& m, const Data<T>& d, Index frame) {
  const FrameRecord& f = m.frames()[frame];
  const Vec3<T> o = d.R[f.place] * cast<T>(f.X.p);
  return {f.body, d.R[f.place] * cast<T>(f.X.R), d.p[f.place] + o, o};
}

// A motion known at the frame's origin in world axes, in the asked reference.
template <class T>
inline Motion<T> express(const FramePose<T>& F, dynReference reference, const Motion<T>& s) {
  if (reference == DYN_REFERENCE_WORLD) return {s.linear + cross(F.p, s.angular), s.angular};
  if (reference == DYN_REFERENCE_LOCAL) return {transpose_times(F.R, s.linear), transpose_times(F.R, s.angular)};
  return s;
}

template <class T>
inline Motion<T> frame_velocity(const FramePose<T>& F, const Data<T>& d) {
  const Vec3<T> w = d.omega[F.body];
  return {d.vel[F.body] + cross(w, F.o), w};
}
// second derivative of the origin's position, angular acceleration
template <class T>
inline Motion<T> frame_classical_acceleration(const FramePose<T>& F, const Data<T>& d) {
  const Vec3<T> w = d.omega[F.body], dw = d.alpha[F.body];
  return {d.acc[F.body] + cross(dw, F.o) + cross(w, cross(w, F.o)), dw};
}

// X_WF, 12 numbers.
template <class T>
void frame_placement(const Model& m, const Data<T>& d, Index frame, T* X) {
  const FramePose<T> F = frame_pose(m, d, frame);
  store_se3(SE3<T>{F.R, F.p}, X);
}
template <class T>
void frame_velocity(const Model& m, const Data<T>& d, Index frame, dynReference reference, T* velocity) {
  const FramePose<T> F = frame_pose(m, d, frame);
  store6(express(F, reference, frame_velocity(F, d)), velocity);
}
// The spatial acceleration is the classical one less w x v of the frame's origin (Featherstone 2008, 2.50). Referred to the
// world's origin, the classical one is that of the point of the body that passes there.
template <class T>
void frame_acceleration(const Model& m, const Data<T>& d, Index frame, dynReference reference, bool classical, T* acceleration) {
  const FramePose<T> F = frame_pose(m, d, frame);
  const Motion<T> v = frame_velocity(F, d);
  Motion<T> a = frame_classical_acceleration(F, d);
  a.linear -= cross(v.angular, v.linear);
  a = express(F, reference, a);
  if (classical) {
    const Motion<T> V = express(F, reference, v);
    a.linear += cross(V.angular, V.linear);
  }
  store6(a, acceleration);
}

// J of a frame, 6 x nv, fully written.
template <class T>
void frame_jacobian(const Model& m, const Data<T>& d, Index frame, dynReference reference, T* J_out) {
  const FramePose<T> F = frame_pose(m, d, frame);
  for (Index k = 0; k < 6 * m.n.nv; ++k) J_out[k] = T(0);
  for (Index i = F.body; i != 0; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    const Vec3<T> to_frame = F.p - d.p[i];
    visit(b.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k)
        add6(J_out + 6 * (b.user_v + k), express(F, reference, shift(J::column(b, d.R[i], k), to_frame)), T(b.ratio));
    });
  }
}

// dJ/dt of a frame, 6 x nv, fully written.
//   WORLD:               V_i x S_i
//   LOCAL_WORLD_ALIGNED: the derivative of S_i moved to the frame's origin, which itself moves
//   LOCAL:               that of R^T S_i, as seen from the turning frame
template <class T>
void frame_jacobian_time_variation(const Model& m, const Data<T>& d, Index frame, dynReference reference, T* dJ_out) {
  const FramePose<T> F = frame_pose(m, d, frame);
  const Motion<T> VF = frame_velocity(F, d);
  for (Index k = 0; k < 6 * m.n.nv; ++k) dJ_out[k] = T(0);
  for (Index i = F.body; i != 0; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    const Vec3<T> to_frame = F.p - d.p[i];
    const Motion<T> V = shift(Motion<T>{d.vel[i], d.omega[i]}, to_frame);  // of body i at the frame's origin
    visit(b.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k) {
        const Motion<T> s = shift(J::column(b, d.R[i], k), to_frame);
        Motion<T> ds = cross(V, s);  // at a fixed point
        if (reference == DYN_REFERENCE_LOCAL_WORLD_ALIGNED) ds.linear += cross(s.angular, VF.linear);
        if (reference == DYN_REFERENCE_LOCAL) ds = ds - cross(VF, s);
        add6(dJ_out + 6 * (b.user_v + k), express(F, reference, ds), T(b.ratio));
      }
    });
  }
}

}  // namespace dyn
