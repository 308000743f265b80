// Forward dynamics by the articulated-body algorithm (Featherstone 2008, Table 7.1), in world axes at each body's origin
// with accelerations of points: moving an articulated inertia to the parent is a pure translation.
// A joint with several columns is eliminated one column at a time, which is the L D L^T of its D block.
#pragma once

#include "algorithm/rnea.hpp"

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

template <class T>
struct ArticulatedState : Pose<T> {
  Vec3<T> omega;

  explicit DYN_INLINE ArticulatedState(const Data<T>& d) : Pose<T>(d), omega(Vec3<T>::zero()) {}
  DYN_INLINE void enter(const Data<T>& d, Index parent) { Pose<T>::enter(d, parent), omega = d.omega_rnea[parent]; }
  // others than the next body add to this one's IA in memory
  DYN_INLINE void leave(Data<T>& d, Index i) const { d.omega_rnea[i] = omega, d.IA[i] = ArticulatedInertia<T>::zero(); }
};

// What a body passes to its parent.
template <class T>
struct ArticulatedBody {
  ArticulatedInertia<T> IA;
  Force<T> pA;
};

// ddq = M^-1 (tau - C v - g + J^T fext) for a model without mimic joints. Returns 0, or the body whose joint has an
// articulated inertia that is not positive: ddq is then not written. Of part of the trees it is that of each by itself, to the
// last bit.
template <class T, class Part = WholeModel>
Index aba(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, T* ddq, const Part& part = {}) {
  using State = ArticulatedState<T>;
  const State world(d);
  world.leave(d, 0);
  d.f[0] = Force<T>::zero();

  // velocities, velocity-product accelerations c, rigid-body inertias and bias forces
  place_forward(m, d, world, [&]<class J>(Index i, Index dof, const SE3<T>& X, State& s) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    const Vec3<T> r = s.place(d, i, X);
    const Motion<T> vJ = J::velocity(b, s.R, v + dof);
    const Vec3<T> wp = s.omega;
    Vec3<T> w = wp, inner = cross(wp, r);
    Motion<T> c = Motion<T>::zero();
    if constexpr (J::rotates) w += vJ.angular, c.angular = cross(wp, vJ.angular);
    if constexpr (J::translates) inner += vJ.linear * T(2);
    c.linear = cross(wp, inner);
    if constexpr (J::rotates && J::translates) c.linear += J::acceleration(b, s.R, v + dof, d.zero).linear;
    s.omega = w;
    d.c[i] = c;
    const Inertia<T> Y = world_inertia(b, s.R);
    d.Y[i] = Y;
    d.f[i] = {cross(w, cross(w, Y.h)), cross(w, Y.I * w)};
  }, part).done(d);
  if (fext) subtract_external(m, d, fext);

  // articulated inertias IA and bias forces pA, leaves to root
  Index singular = 0;
  using Up = ArticulatedBody<T>;
  backward_chains(
      m, Up{ArticulatedInertia<T>::zero(), Force<T>::zero()},
      [&]<class J>(Index i, Index dof, bool last, Up& up) DYN_INLINE_LAMBDA {
        const Body& b = m.bodies()[i];
        ArticulatedInertia<T> IA = up.IA + ArticulatedInertia<T>::rigid(d.Y[i]);
        if (last) IA = IA + d.IA[i];
        Force<T> pA = up.pA + d.f[i];
        for (int k = J::nv - 1; k >= 0; --k) {
          const Index at = dof + k;
          const Motion<T> s = J::column(b, d.R[i], k);
          const Force<T> U = times_column<J>(IA, s);
          const T D = dot_column<J>(s, U) + d.armature[at];
          if (!(D > T(0)) && !singular) singular = i;
          const T Dinv = T(1) / D, u = tau[at] - dot_column<J>(s, pA);
          IA = IA.minus_outer(U, Dinv);
          pA = pA + U * (u * Dinv);
          d.U[at] = U;
          d.Dinv[at] = Dinv;
          d.ux[at] = u;
        }
        up = {IA.shifted(d.r[i]), shift(pA + IA * d.c[i], d.r[i])};
      },
      [&](Index parent, const Up& up) DYN_INLINE_LAMBDA {
        if (parent) d.IA[parent] = d.IA[parent] + up.IA, d.f[parent] = d.f[parent] + up.pA;
      },
      part);
  if (singular) return singular;

  // accelerations, root to leaves
  d.acc_rnea[0] = -load3(d.world_gravity);
  d.alpha_rnea[0] = Vec3<T>::zero();
  struct Acceleration : Motion<T> {
    DYN_INLINE void enter(const Data<T>& d, Index parent) {
      this->linear = d.acc_rnea[parent], this->angular = d.alpha_rnea[parent];
    }
    DYN_INLINE void leave(Data<T>& d, Index i) const { d.acc_rnea[i] = this->linear, d.alpha_rnea[i] = this->angular; }
  };
  forward_chains(
      m, d, Acceleration{{d.acc_rnea[0], d.alpha_rnea[0]}},
      [&]<class J>(Index i, Index dof, Acceleration& state) DYN_INLINE_LAMBDA {
        Motion<T> a = shift(static_cast<const Motion<T>&>(state), d.r[i]) + d.c[i];
        for (int k = 0; k < J::nv; ++k) {
          const Index at = dof + k;
          ddq[at] = (d.ux[at] - dot(a, d.U[at])) * d.Dinv[at];
          a = a + J::column(m.bodies()[i], d.R[i], k) * ddq[at];
        }
        state = {a};
      },
      part);
  return 0;
}

}  // namespace dyn
