// Forward kinematics: placements, velocities, accelerations of all bodies, root to leaves.
// In world axes at each body's origin: w, u the angular velocity and the velocity of the origin, dw, du their derivatives.
//   w  = w_p + w_J                   u  = u_p + w_p x r + u_J
//   dw = dw_p + dw_J + w_p x w_J     du = du_p + dw_p x r + w_p x (w_p x r + 2 u_J) + du_J
// with J the motion relative to the joint frame, which rotates with the parent.
#pragma once

#include "dyn/algorithm/passes.hpp"

namespace dyn {

// Where a pass keeps the velocities and accelerations of the bodies.
template <class T>
struct Motions {
  Vec3<T> *w, *u, *dw, *du;
};

// Velocity (from level 1 on) and acceleration (level 2) of body i, which R and r place.
template <int level, class J, class T>
DYN_INLINE void move_body(const Body& b, Index i, const Motions<T>& d, const Mat3<T>& R, const Vec3<T>& r, const T* v, const T* a) {
  if constexpr (level >= 1) {
    const Index p = b.parent;
    const Motion<T> vJ = J::velocity(b, R, v + b.idx_v);
    const Vec3<T> wp = d.w[p], turn = cross(wp, r);
    Vec3<T> w = wp, u = d.u[p] + turn;
    if constexpr (J::rotates) w += vJ.angular;
    if constexpr (J::translates) u += vJ.linear;
    d.w[i] = w;
    d.u[i] = u;
    if constexpr (level >= 2) {
      const Motion<T> aJ = J::acceleration(b, R, v + b.idx_v, a + b.idx_v);
      Vec3<T> dw = d.dw[p], du = d.du[p] + cross(dw, r), inner = turn;
      if constexpr (J::rotates) dw += aJ.angular + cross(wp, vJ.angular);
      if constexpr (J::translates) du += aJ.linear, inner += vJ.linear * T(2);
      d.dw[i] = dw;
      d.du[i] = du + cross(wp, inner);
    }
  }
}

// level 0: placements; 1: and velocities; 2: and accelerations. Inputs are d.q, d.v, d.a.
template <int level, class T>
void forward_kinematics(const Model& m, Data<T>& d) {
  place_joints(m, d);
  const T* v = level >= 1 ? d.expand(m, d.v, d.vx) : nullptr;
  const T* a = level >= 2 ? d.expand(m, d.a, d.ax) : nullptr;
  const Motions<T> x = {d.w, d.u, d.dw, d.du};
  forward(m, d.R[0], [&]<class J>(Index i, Mat3<T>& R) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    Vec3<T> r;
    place_body(b, i, d, R, r);
    move_body<level, J>(b, i, x, R, r, v, a);
  });
  d.done(Stage::Position);
  if (level >= 1) d.done(Stage::Velocity);
  if (level >= 2) d.done(Stage::Acceleration);
}

// Makes sure that the stage is fresh.
template <class T>
void ensure_position(const Model& m, Data<T>& d) {
  if (!d.fresh(Stage::Position)) forward_kinematics<0>(m, d);
}
template <class T>
void ensure_velocity(const Model& m, Data<T>& d) {
  if (!d.fresh(Stage::Velocity) || !d.fresh(Stage::Position)) forward_kinematics<1>(m, d);
}
template <class T>
void ensure_acceleration(const Model& m, Data<T>& d) {
  if (!d.fresh(Stage::Acceleration) || !d.fresh(Stage::Velocity) || !d.fresh(Stage::Position)) forward_kinematics<2>(m, d);
}

}  // namespace dyn
