// What joints do beside their rotors, r(q, v) in M a + nle + r = tau, in the user's coordinates: the sum of the laws of
// src/effect that are switched on. d holds their coefficients.
#pragma once

#include "algorithm/configuration.hpp"
#include "algorithm/tree_groups.hpp"
#include "base/scalar.hpp"
#include "effect/list.hpp"

namespace dyn {

template <class T>
bool resists(const Data<T>& d) {
  return (d.acting & resisting_effects) != 0;
}

// f.template operator()<E>(c) for each law of the velocity that acts; c: its coefficients.
template <class T, class F>
DYN_INLINE void for_each_velocity_law(const Data<T>& d, F&& f) {
  for_each_effect([&]<class E>() DYN_INLINE_LAMBDA {
    if constexpr (effect::OfVelocity<E>)
      if (d.acting & E::bit) f.template operator()<E>(E::of(d));
  });
}

// f.template operator()<E, J>(body, c, e) for each law of the configuration that acts, at each body that has it: c its
// coefficients there, e the displacement.
template <class T, class F>
void for_each_configuration_law(const Model& m, const Data<T>& d, F&& f) {
  for_each_effect([&]<class E>() {
    if constexpr (effect::OfConfiguration<E>) {
      if (!(d.acting & E::bit)) return;
      for_each_leader(m, [&]<class J>(const Body& b) {
        const T* const c = E::of(d) + b.user_v;
        if (c[0] == T(0) && J::nq != 1) return;
        T e[6];
        E::template displacement<J>(m, b, d.q, e);
        f.template operator()<E, J>(b, c, static_cast<const T*>(e));
      });
    }
  });
}

// tau += r
template <class T, class Part>
void add_resistance(const Model& m, const Data<T>& d, const T* v, T* tau, const Part& part) {
  for_each_velocity_law(d, [&]<class E>(const T* c) {
    for_each_dof_range(m, part, [&](Index first, Index end) {
      for (Index k = first; k < end; ++k) tau[k] += E::force(c[k], v[k]);
    });
  });
  for_each_configuration_law(
      m, d, [&]<class E, class J>(const Body& b, const T* c, const T* e) { E::template add_force<J>(c, e, tau + b.user_v); });
}
template <class T>
void add_resistance(const Model& m, const Data<T>& d, const T* v, T* tau) {
  add_resistance(m, d, v, tau, WholeModel{});
}

// dq += dr/dq, nv x nv
template <class T>
void add_resistance_by_q(const Model& m, const Data<T>& d, T* dq) {
  for_each_configuration_law(m, d, [&]<class E, class J>(const Body& b, const T* c, const T* e) {
    const std::ptrdiff_t at = b.user_v;
    E::template add_slope<J>(c, e, dq + at + m.n.nv * at, m.n.nv);
  });
}

// dq += dr/dq, dv += dr/dv
template <class T>
void add_resistance_derivatives(const Model& m, const Data<T>& d, const T* v, T* dq, T* dv) {
  const std::ptrdiff_t diagonal = std::ptrdiff_t(m.n.nv) + 1;
  for_each_velocity_law(d, [&]<class E>(const T* c) {
    for (Index k = 0; k < m.n.nv; ++k) dv[diagonal * k] += E::slope(c[k], v[k]);
  });
  add_resistance_by_q(m, d, dq);
}

// Second derivatives of the sum of lambda(k) r_k, nv x nv each, either may be nullptr.
template <class T, class Lambda>
void add_resistance_second_order(const Model& m, const Data<T>& d, const T* v, Lambda&& lambda, T* dqdq, T* dvdv) {
  const std::ptrdiff_t diagonal = std::ptrdiff_t(m.n.nv) + 1;
  if (dvdv)
    for_each_velocity_law(d, [&]<class E>(const T* c) {
      if constexpr (requires { E::curvature(*c, *v); })
        for (Index k = 0; k < m.n.nv; ++k) dvdv[diagonal * k] += E::curvature(lambda(k) * c[k], v[k]);
    });
  if (!dqdq) return;
  for_each_configuration_law(m, d, [&]<class E, class J>(const Body& b, const T* c, const T* e) {
    if constexpr (J::nv == 3) {
      const Vec3<T> by = Vec3<T>::make(lambda(b.user_v), lambda(b.user_v + 1), lambda(b.user_v + 2));
      E::template add_curvature<J>(c, e, by, dqdq + diagonal * b.user_v, m.n.nv);
    }
  });
}

// Energy of the springs, J.
template <class T>
T spring_energy(const Model& m, const Data<T>& d) {
  T twice = T(0);
  for_each_configuration_law(
      m, d, [&]<class E, class J>(const Body&, const T* c, const T* e) { twice += E::template twice_energy<J>(c, e); });
  return T(0.5) * twice;
}

// Laws of the velocity as r = D(v) v: d.armature = armature + h D(d.v).
template <class T, class Part>
void implicit_armature(const Model& m, Data<T>& d, const T* armature, T h, const Part& part) {
  for_each_dof_range(m, part, [&](Index first, Index end) {
    std::copy(armature + first, armature + end, d.armature + first);
    for_each_velocity_law(d, [&]<class E>(const T* c) {
      for (Index k = first; k < end; ++k) d.armature[k] += E::secant(h * c[k], d.v[k]);
    });
  });
}

}  // namespace dyn
