// Forward kinematics: placements, velocities, accelerations of all bodies, root to leaves.
// In world axes at each body's origin: w, u the angular velocity and the velocity of the origin, dw, du their derivatives.
//   w  = w_p + w_J                   u  = u_p + w_p x r + u_J
//   dw = dw_p + dw_J + w_p x w_J     du = du_p + dw_p x r + w_p x (w_p x r + 2 u_J) + du_J
// with J the motion relative to the joint frame, which rotates with the parent.
#pragma once

#include "algorithm/passes.hpp"

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

template <class T, int level>
struct KinematicState : Pose<T> {
  Vec3<T> w, u, dw, du;
  Vec3<T> velocities, accelerations;  // sums of sizes

  explicit DYN_INLINE KinematicState(const Data<T>& d) : Pose<T>(d) { w = u = dw = du = velocities = accelerations = Vec3<T>::zero(); }
  DYN_INLINE void enter(const Data<T>& d, Index parent) {
    Pose<T>::enter(d, parent);
    if constexpr (level >= 1) w = d.w[parent], u = d.u[parent];
    if constexpr (level >= 2) dw = d.dw[parent], du = d.du[parent];
  }
  DYN_INLINE void done(Data<T>& d) const {
    Pose<T>::done(d);
    if (level >= 1) d.extent[1] = velocities[0] + velocities[1] + velocities[2], d.mark_fresh(Stage::Velocity);
    if (level >= 2) d.extent[2] = accelerations[0] + accelerations[1] + accelerations[2], d.mark_fresh(Stage::Acceleration);
  }
};

// level 0: placements; 1: and velocities; 2: and accelerations. Inputs are d.q, d.v, d.a.
template <int level, class T>
void forward_kinematics(const Model& m, Data<T>& d) {
  const T* v = level >= 1 ? d.expand(m, d.v, d.vx) : nullptr;
  const T* a = level >= 2 ? d.expand(m, d.a, d.ax) : nullptr;
  using State = KinematicState<T, level>;
  place_forward(m, d, State(d), [&]<class J>(Index i, Index dof, const SE3<T>& X, State& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Vec3<T> r = s.place(d, i, X);
    if constexpr (level >= 1) {
      const Motion<T> vJ = J::velocity(b, s.R, v + dof);
      const Vec3<T> wp = s.w, turn = cross(wp, r);
      s.u += turn;
      if constexpr (J::rotates) s.w += vJ.angular;
      if constexpr (J::translates) s.u += vJ.linear;
      d.w[i] = s.w;
      d.u[i] = s.u;
      s.velocities += sizes(s.w) + sizes(s.u);
      if constexpr (level >= 2) {
        const Motion<T> aJ = J::acceleration(b, s.R, v + dof, a + dof);
        Vec3<T> inner = turn;
        s.du += cross(s.dw, r);
        if constexpr (J::rotates) s.dw += aJ.angular + cross(wp, vJ.angular);
        if constexpr (J::translates) s.du += aJ.linear, inner += vJ.linear * T(2);
        s.du += cross(wp, inner);
        d.dw[i] = s.dw;
        d.du[i] = s.du;
        s.accelerations += sizes(s.dw) + sizes(s.du);
      }
    }
  }).done(d);
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
