// Inverse dynamics by the recursive Newton-Euler algorithm (Featherstone 2008, Table 5.1), in world axes at each body's
// origin with accelerations of points instead of spatial ones:
//   f = m (a + dw x c + w x (w x c))      n = I dw + w x I w + m c x a
// I and c of the body's frame, where they are constant. Gravity is an acceleration of the world by -g.
#pragma once

#include "dyn/algorithm/passes.hpp"

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

// tau = M a + C v + g - J^T fext for expanded v and a; fext 6 x njoints in joint frames, or nullptr. tau is expanded.
template <class T>
void rnea(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext, T* tau) {
  place_joints(m, d);
  d.ac[0] = Vec3<T>::make(T(-m.gravity[0]), T(-m.gravity[1]), T(-m.gravity[2]));
  d.f[0] = Force<T>::zero();

  forward(m, d.R[0], [&]<class J>(Index i, Mat3<T>& R) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Index p = b.parent;
    Vec3<T> r;
    place_body(b, i, d, R, r);

    // velocity and acceleration of the body
    const Motion<T> vJ = J::velocity(b, R, v + b.idx_v);
    const Motion<T> aJ = J::acceleration(b, R, v + b.idx_v, a + b.idx_v);
    const Vec3<T> wp = d.wd[p];
    Vec3<T> w = wp, dw = d.al[p], acc = d.ac[p] + cross(dw, r), inner = cross(wp, r);
    if constexpr (J::rotates) w += vJ.angular, dw += aJ.angular + cross(wp, vJ.angular);
    if constexpr (J::translates) acc += aJ.linear, inner += vJ.linear * T(2);
    acc += cross(wp, inner);
    d.wd[i] = w;
    d.al[i] = dw;
    d.ac[i] = acc;

    // force that the motion takes
    const Mat3<T> Rt = transpose(R);
    const Vec3<T> h = R * cast<T>(b.h), wB = Rt * w;
    const Mat3<T> I = cast<T>(b.I);
    const Vec3<T> n = I * (Rt * dw) + cross(wB, I * wB);
    d.f[i] = {acc * T(b.m) + cross(dw, h) + cross(w, cross(w, h)), R * n + cross(h, acc)};
  });

  if (fext) subtract_external(m, d, fext);

  // forces across the joints
  backward(m, Up<Force<T>>{Force<T>::zero()}, [&]<class J>(Index i, Up<Force<T>>& up) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    Force<T> f = d.f[i];
    if (up.chain) f = f + up.x;
    J::project(b, d.R[i], f, tau + b.idx_v);
    up.x = shift(f, d.r[i]);
    up.chain = b.parent == i - 1;
    if (!up.chain) d.f[b.parent] = d.f[b.parent] + up.x;
  });
  d.done(Stage::Position);
}

// The same in the user's coordinates, rotor inertias included.
template <class T>
void inverse_dynamics(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext, T* tau) {
  rnea(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax), fext, m.has_mimic ? d.taux : tau);
  if (m.has_mimic) d.reduce(m, d.taux, tau);
  for (Index k = 0; k < m.n.nv; ++k) tau[k] += T(m.armature()[k]) * a[k];
}

}  // namespace dyn
