// Forward dynamics by the articulated-body algorithm (Featherstone 2008, Table 7.1), in world axes at each body's origin
// with accelerations of points: moving an articulated inertia to the parent is a pure translation.
// A joint with several columns is eliminated one column at a time, which is the L D L^T of its D block.
#pragma once

#include "dyn/algorithm/rnea.hpp"

namespace dyn {

// IA s, with what is zero in the columns of J left out.
template <class J, class T>
DYN_INLINE Force<T> times_column(const ArticulatedInertia<T>& IA, const Motion<T>& s) {
  if constexpr (!J::translates)
    return {IA.H * s.angular, IA.I * s.angular};
  else if constexpr (!J::rotates)
    return {IA.M * s.linear, transpose_times(IA.H, s.linear)};
  else
    return IA * s;
}
// s^T f
template <class J, class T>
DYN_INLINE T dot_column(const Motion<T>& s, const Force<T>& f) {
  if constexpr (!J::translates)
    return dot(s.angular, f.angular);
  else if constexpr (!J::rotates)
    return dot(s.linear, f.linear);
  else
    return dot(s, f);
}

// ddq = M^-1 (tau - C v - g + J^T fext) for a model without mimic joints. Returns 0, or the body whose joint has an
// articulated inertia that is not positive: ddq is then not written.
template <class T>
Index aba(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, T* ddq) {
  place_joints(m, d);

  // velocities, velocity-product accelerations c, rigid-body inertias and bias forces
  forward(m, d.R[0], [&]<class J>(Index i, Mat3<T>& R) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Index p = b.parent;
    Vec3<T> r;
    place_body(b, i, d, R, r);
    const Motion<T> vJ = J::velocity(b, R, v + b.idx_v);
    const Vec3<T> wp = d.wd[p];
    Vec3<T> w = wp, inner = cross(wp, r);
    Motion<T> c = Motion<T>::zero();
    if constexpr (J::rotates) w += vJ.angular, c.angular = cross(wp, vJ.angular);
    if constexpr (J::translates) inner += vJ.linear * T(2);
    c.linear = cross(wp, inner);
    if constexpr (J::rotates && J::translates) c.linear += J::acceleration(b, R, v + b.idx_v, d.zero).linear;
    d.wd[i] = w;
    d.c[i] = c;
    const Inertia<T> Y = world_inertia(b, R);
    d.IA[i] = ArticulatedInertia<T>::rigid(Y);
    d.f[i] = {cross(w, cross(w, Y.h)), cross(w, Y.I * w)};
  });
  if (fext) subtract_external(m, d, fext);

  // articulated inertias IA and bias forces pA, leaves to root
  Index singular = 0;
  d.IA[0] = ArticulatedInertia<T>::zero();
  d.f[0] = Force<T>::zero();
  struct Articulated {
    ArticulatedInertia<T> IA;
    Force<T> pA;
  };
  using UpA = Up<Articulated>;
  backward(m, UpA{{ArticulatedInertia<T>::zero(), Force<T>::zero()}}, [&]<class J>(Index i, UpA& up) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    ArticulatedInertia<T> IA = d.IA[i];
    Force<T> pA = d.f[i];
    if (up.chain) IA = IA + up.x.IA, pA = pA + up.x.pA;
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      const Motion<T> s = J::column(b, d.R[i], k);
      const Force<T> U = times_column<J>(IA, s);
      const T D = dot_column<J>(s, U) + T(m.armature()[at]);
      if (!(D > T(0))) singular = i;
      const T Dinv = T(1) / D, u = tau[at] - dot_column<J>(s, pA);
      IA = IA.minus_outer(U, Dinv);
      pA = pA + U * (u * Dinv);
      d.U[at] = U;
      d.Dinv[at] = Dinv;
      d.ux[at] = u;
    }
    const Index p = b.parent;
    up.chain = p == i - 1;
    if (p == 0) return;
    up.x = {IA.shifted(d.r[i]), shift(pA + IA * d.c[i], d.r[i])};
    if (!up.chain) d.IA[p] = d.IA[p] + up.x.IA, d.f[p] = d.f[p] + up.x.pA;
  });
  if (singular) return singular;

  // accelerations, root to leaves
  d.ac[0] = Vec3<T>::make(T(-m.gravity[0]), T(-m.gravity[1]), T(-m.gravity[2]));
  forward(m, Motion<T>{d.ac[0], d.al[0]}, [&]<class J>(Index i, Motion<T>& a) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Index p = b.parent;
    if (p != i - 1) a = {d.ac[p], d.al[p]};
    a = shift(a, d.r[i]) + d.c[i];
    for (int k = J::nv - 1; k >= 0; --k) {
      const Index at = b.idx_v + k;
      ddq[at] = (d.ux[at] - dot(a, d.U[at])) * d.Dinv[at];
      a = a + J::column(b, d.R[i], k) * ddq[at];
    }
    d.ac[i] = a.linear;
    d.al[i] = a.angular;
  });
  d.done(Stage::Position);
  return 0;
}

}  // namespace dyn
