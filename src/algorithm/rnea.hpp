// Inverse dynamics by the recursive Newton-Euler algorithm (Featherstone 2008, Table 5.1), in world axes at each body's
// origin with accelerations of points instead of spatial ones:
//   f = m (a + dw x c + w x (w x c))      n = I dw + w x I w + m c x a
// I and c of the body's frame, where they are constant. Gravity is an acceleration of the world by -g.
#pragma once

#include "algorithm/effects.hpp"

namespace dyn {

// f -= fext, which is given on each joint's body in the joint's own frame.
template <class T>
void subtract_external(const Model& m, Data<T>& d, const T* fext) {
  for (Index j = 1; j < m.n.joints; ++j) {
    const JointRecord& joint = m.joints()[j];
    const Mat3<T> R = d.R[joint.last_body] * cast<T>(joint.C);
    const Force<T> f = load_force(fext + 6 * j);
    d.f[joint.last_body] = d.f[joint.last_body] - Force<T>{R * f.linear, R * f.angular};
  }
}

template <class T>
struct NewtonEulerState : Pose<T> {
  Vec3<T> omega, alpha, acc;

  explicit DYN_INLINE NewtonEulerState(const Data<T>& d)
      : Pose<T>(d), omega(Vec3<T>::zero()), alpha(Vec3<T>::zero()), acc(-load3(d.world_gravity)) {}
  DYN_INLINE void enter(const Data<T>& d, Index parent) {
    Pose<T>::enter(d, parent);
    omega = d.omega_rnea[parent], alpha = d.alpha_rnea[parent], acc = d.acc_rnea[parent];
  }
  DYN_INLINE void leave(Data<T>& d, Index i) const { d.omega_rnea[i] = omega, d.alpha_rnea[i] = alpha, d.acc_rnea[i] = acc; }
};

// tau = M a + C v + g - J^T fext for expanded v and a; fext 6 x njoints in joint frames, or nullptr. tau is expanded.
template <class T>
void rnea(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext, T* tau) {
  using State = NewtonEulerState<T>;
  const State world(d);
  world.leave(d, 0);
  d.f[0] = Force<T>::zero();

  place_forward(m, d, world, [&]<class J>(Index i, Index dof, const SE3<T>& X, State& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Vec3<T> r = s.place(d, i, X);

    // velocity and acceleration of the body
    const Motion<T> vJ = J::velocity(b, s.R, v + dof);
    const Motion<T> aJ = J::acceleration(b, s.R, v + dof, a + dof);
    const Vec3<T> wp = s.omega;
    Vec3<T> w = wp, dw = s.alpha, acc = s.acc + cross(dw, r), inner = cross(wp, r);
    if constexpr (J::rotates) w += vJ.angular, dw += aJ.angular + cross(wp, vJ.angular);
    if constexpr (J::translates) acc += aJ.linear, inner += vJ.linear * T(2);
    acc += cross(wp, inner);
    s.omega = w, s.alpha = dw, s.acc = acc;

    // force that the motion takes
    const Mat3<T> Rt = transpose(s.R);
    const Vec3<T> h = s.R * cast<T>(b.h), wB = Rt * w;
    const Mat3<T> I = cast<T>(b.I);
    const Vec3<T> n = I * (Rt * dw) + cross(wB, I * wB);
    d.f[i] = {acc * T(b.m) + cross(dw, h) + cross(w, cross(w, h)), s.R * n + cross(h, acc)};
  }).done(d);

  if (fext) subtract_external(m, d, fext);

  // forces across the joints
  backward_chains(m, Force<T>::zero(), [&]<class J>(Index i, Index dof, bool, Force<T>& up) DYN_INLINE_LAMBDA {
    const Force<T> f = d.f[i] + up;
    J::project(m.bodies()[i], d.R[i], f, tau + dof);
    up = shift(f, d.r[i]);
  }, [&](Index parent, const Force<T>& up) DYN_INLINE_LAMBDA { d.f[parent] = d.f[parent] + up; });
}

// The same in the user's coordinates.
template <class T>
void rigid_inverse_dynamics(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext, T* tau) {
  rnea(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax), fext, m.has_mimic ? d.taux : tau);
  if (m.has_mimic) d.reduce(m, d.taux, tau);
}

// And with all effects.
template <class T>
void inverse_dynamics(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext, T* tau) {
  rigid_inverse_dynamics(m, d, v, a, fext, tau);
  if constexpr (branches_by_state<T>)
    if (resists(d)) add_resistance(m, d, v, tau);
  for (Index k = 0; k < m.n.nv; ++k) tau[k] += d.armature[k] * a[k];
}

}  // namespace dyn
