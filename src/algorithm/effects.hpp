// What joints do beside their rotors, r(q, v) in M a + nle + r = tau, in the user's coordinates:
//   r = damping v + friction tanh(v / v_s) + stiffness (q (-) reference)
// Dry friction is smoothed: within v_s = DYN_FRICTION_VELOCITY it is nearly viscous. d holds the coefficients of what is switched on.
#pragma once

#include "algorithm/configuration.hpp"
#include "base/portable.hpp"
#include "spatial/explog.hpp"

namespace dyn {

template <class T>
bool resists(const Data<T>& d) {
  return (d.acting & (DYN_EFFECT_DAMPING | DYN_EFFECT_SPRINGS | DYN_EFFECT_FRICTION)) != 0;
}

// f.template operator()<J>(body, e) for every body with a spring: e = q (-) reference. Turns of a continuous joint count.
template <class T, class F>
void for_each_spring(const Model& m, const Data<T>& d, F&& f) {
  if (!(d.acting & DYN_EFFECT_SPRINGS)) return;
  for_each_leader(m, [&]<class J>(const Body& b) {
    if (d.stiffness[b.user_v] == T(0) && J::nq != 1) return;
    T reference[7], e[6];
    for (int k = 0; k < J::nq; ++k) reference[k] = T(m.spring_reference()[b.user_q + k]);
    if constexpr (J::nq == 1)
      e[0] = d.q[b.user_q] - reference[0];
    else
      J::difference(b, reference, d.q + b.user_q, e);
    f.template operator()<J>(b, e);
  });
}

// tau += r
template <class T>
void add_resistance(const Model& m, const Data<T>& d, const T* v, T* tau) {
  using math::tanh;
  if (d.acting & DYN_EFFECT_DAMPING)
    for (Index k = 0; k < m.n.nv; ++k) tau[k] += d.damping[k] * v[k];
  if (d.acting & DYN_EFFECT_FRICTION)
    for (Index k = 0; k < m.n.nv; ++k) tau[k] += d.friction[k] * tanh(v[k] * T(1 / DYN_FRICTION_VELOCITY));
  for_each_spring(m, d, [&]<class J>(const Body& b, const T* e) {
    for (int k = 0; k < J::nv; ++k) tau[b.user_v + k] += d.stiffness[b.user_v + k] * e[k];
  });
}

// dq += dr/dq, nv x nv
template <class T>
void add_spring_derivatives(const Model& m, const Data<T>& d, T* dq) {
  for_each_spring(m, d, [&]<class J>(const Body& b, const T* e) {
    const std::ptrdiff_t at = b.user_v;
    if constexpr (J::nv == 3) {
      const Mat3<T> by_q = Jlog3(load3(e));
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) dq[at + r + m.n.nv * (at + c)] += d.stiffness[at] * by_q(r, c);
    } else {
      dq[at + m.n.nv * at] += d.stiffness[at];
    }
  });
}

// dq += dr/dq, dv += dr/dv
template <class T>
void add_resistance_derivatives(const Model& m, const Data<T>& d, const T* v, T* dq, T* dv) {
  using math::tanh;
  const std::ptrdiff_t diagonal = std::ptrdiff_t(m.n.nv) + 1;
  if (d.acting & DYN_EFFECT_DAMPING)
    for (Index k = 0; k < m.n.nv; ++k) dv[diagonal * k] += d.damping[k];
  if (d.acting & DYN_EFFECT_FRICTION)
    for (Index k = 0; k < m.n.nv; ++k) {
      const T t = tanh(v[k] * T(1 / DYN_FRICTION_VELOCITY));
      dv[diagonal * k] += d.friction[k] * (T(1) - t * t) * T(1 / DYN_FRICTION_VELOCITY);
    }
  add_spring_derivatives(m, d, dq);
}

// Second derivatives of the sum of lambda(k) r_k, nv x nv each, either may be nullptr.
template <class T, class Lambda>
void add_resistance_second_order(const Model& m, const Data<T>& d, const T* v, Lambda&& lambda, T* dqdq, T* dvdv) {
  using math::tanh;
  if (dvdv && d.acting & DYN_EFFECT_FRICTION)
    for (Index k = 0; k < m.n.nv; ++k) {
      constexpr double slope = 1 / DYN_FRICTION_VELOCITY;
      const T t = tanh(v[k] * T(slope));
      dvdv[k + std::ptrdiff_t(m.n.nv) * k] += lambda(k) * d.friction[k] * T(-2 * slope * slope) * t * (T(1) - t * t);
    }
  if (!dqdq) return;
  for_each_spring(m, d, [&]<class J>(const Body& b, const T* e) {
    if constexpr (J::nv == 3) {
      const std::ptrdiff_t at = b.user_v;
      const Vec3<T> w = load3(e);
      const Mat3<T> H = dJlog3(w, Vec3<T>::make(lambda(b.user_v), lambda(b.user_v + 1), lambda(b.user_v + 2))) * Jlog3(w);
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) dqdq[at + r + m.n.nv * (at + c)] += d.stiffness[at] * H(r, c);
    }
  });
}

// Energy of the springs: stiffness |q (-) reference|^2 / 2.
template <class T>
T spring_energy(const Model& m, const Data<T>& d) {
  T twice = T(0);
  for_each_spring(m, d, [&]<class J>(const Body& b, const T* e) {
    for (int k = 0; k < J::nv; ++k) twice += d.stiffness[b.user_v + k] * e[k] * e[k];
  });
  return T(0.5) * twice;
}

// Damping and friction as the coefficient D(v) of v, r = D(v) v: d.armature = armature + h D(d.v).
template <class T>
void implicit_armature(const Model& m, Data<T>& d, const T* armature, T h) {
  using std::abs;
  using math::tanh;
  for (Index k = 0; k < m.n.nv; ++k) {
    d.armature[k] = armature[k];
    if (d.acting & DYN_EFFECT_DAMPING) d.armature[k] += h * d.damping[k];
    if (d.acting & DYN_EFFECT_FRICTION) {
      const T x = d.v[k] * T(1 / DYN_FRICTION_VELOCITY);
      d.armature[k] += h * d.friction[k] * T(1 / DYN_FRICTION_VELOCITY) * (abs(x) < T(1e-9) ? T(1) : tanh(x) / x);
    }
  }
}

}  // namespace dyn
