// Forward kinematics: placements, velocities, accelerations of all bodies, root to leaves.
// In world axes at each body's origin: omega the angular velocity, vel the velocity of the origin, alpha and acc their
// derivatives.
//   omega = omega_p + omega_J                       vel = vel_p + omega_p x r + vel_J
//   alpha = alpha_p + alpha_J + omega_p x omega_J   acc = acc_p + alpha_p x r + omega_p x (omega_p x r + 2 vel_J) + acc_J
// with J the motion relative to the joint frame, which rotates with the parent.
#pragma once

#include "algorithm/passes.hpp"

namespace dyn {

// Where a pass keeps the velocities and accelerations of the bodies.
template <class T>
struct Motions {
  Vec3<T> *omega, *vel, *alpha, *acc;
};

// Velocity (from level 1 on) and acceleration (level 2) of body i, which R and r place.
template <int level, class J, class T>
DYN_INLINE void move_body(const Body& b, Index i, const Motions<T>& d, const Mat3<T>& R, const Vec3<T>& r, const T* v,
                          const T* a) {
  if constexpr (level >= 1) {
    const Index p = b.parent;
    const Motion<T> vJ = J::velocity(b, R, v + b.idx_v);
    const Vec3<T> wp = d.omega[p], turn = cross(wp, r);
    Vec3<T> w = wp, u = d.vel[p] + turn;
    if constexpr (J::rotates) w += vJ.angular;
    if constexpr (J::translates) u += vJ.linear;
    d.omega[i] = w;
    d.vel[i] = u;
    if constexpr (level >= 2) {
      const Motion<T> aJ = J::acceleration(b, R, v + b.idx_v, a + b.idx_v);
      Vec3<T> dw = d.alpha[p], du = d.acc[p] + cross(dw, r), inner = turn;
      if constexpr (J::rotates) dw += aJ.angular + cross(wp, vJ.angular);
      if constexpr (J::translates) du += aJ.linear, inner += vJ.linear * T(2);
      d.alpha[i] = dw;
      d.acc[i] = du + cross(wp, inner);
    }
  }
}

template <class T, int level>
struct KinematicState : Pose<T> {
  Vec3<T> omega, vel, alpha, acc;
  Vec3<T> velocities, accelerations;  // sums of sizes

  explicit DYN_INLINE KinematicState(const Data<T>& d) : Pose<T>(d) {
    omega = vel = alpha = acc = velocities = accelerations = Vec3<T>::zero();
  }
  DYN_INLINE void enter(const Data<T>& d, Index parent) {
    Pose<T>::enter(d, parent);
    if constexpr (level >= 1) omega = d.omega[parent], vel = d.vel[parent];
    if constexpr (level >= 2) alpha = d.alpha[parent], acc = d.acc[parent];
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
      const Vec3<T> wp = s.omega, turn = cross(wp, r);
      s.vel += turn;
      if constexpr (J::rotates) s.omega += vJ.angular;
      if constexpr (J::translates) s.vel += vJ.linear;
      d.omega[i] = s.omega;
      d.vel[i] = s.vel;
      s.velocities += sizes(s.omega) + sizes(s.vel);
      if constexpr (level >= 2) {
        const Motion<T> aJ = J::acceleration(b, s.R, v + dof, a + dof);
        Vec3<T> inner = turn;
        s.acc += cross(s.alpha, r);
        if constexpr (J::rotates) s.alpha += aJ.angular + cross(wp, vJ.angular);
        if constexpr (J::translates) s.acc += aJ.linear, inner += vJ.linear * T(2);
        s.acc += cross(wp, inner);
        d.alpha[i] = s.alpha;
        d.acc[i] = s.acc;
        s.accelerations += sizes(s.alpha) + sizes(s.acc);
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
