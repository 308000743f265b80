// Effects as a data has them: coefficients of those that are switched on, and a bit for each that acts.
#pragma once

#include "effect/list.hpp"
#include "model/data.hpp"

namespace dyn {

// d's coefficients of E: the model's at joints where it is switched on, else zero.
template <class E, class T>
void apply_coefficients(const Model& m, Data<T>& d) {
  T* const to = E::of(d);
  if (!to) return;
  const double* const from = E::of(m);
  for (Index j = 1; j < m.n.joints; ++j)
    for (Index k = m.joints()[j].idx_v, end = k + m.joints()[j].nv; k < end; ++k) {
      to[k] = d.effects[j] & E::bit ? T(from[k]) : T(0);
      if (to[k] != T(0)) d.acting |= E::bit;
    }
}

// After Data::effects or Data::pushed changed.
template <class T>
void apply_effects(const Model& m, Data<T>& d) {
  d.acting = d.pushed;
  for_each_effect([&]<class E>() {
    if constexpr (effect::HasCoefficient<E>) apply_coefficients<E>(m, d);
    else if (d.has(E::part)) E::for_each_joint(m, [&](Index joint) { d.acting |= d.effects[joint] & E::bit; });
  });
}

// Switches between the effects of algorithms called alone and those of steps, where they differ.
template <class T>
void switch_effects(const Model& m, Data<T>& d, bool steps) {
  bool differs = false;
  for (Index j = 0; j < m.n.joints; ++j) {
    const std::uint32_t chosen = d.chosen_effects[j];
    const std::uint32_t stated = m.simulation()->effects | (chosen & DYN_EFFECT_SLEEPING);
    const std::uint32_t now = steps && (chosen & DYN_EFFECT_AS_STATED) ? stated : chosen & std::uint32_t(DYN_EFFECT_ALL);
    differs |= now != d.effects[j], d.effects[j] = now;
  }
  if (differs) apply_effects(m, d);
}

// State of a named configuration.
template <class T>
void set_to_configuration(const Model& m, Data<T>& d, Index k) {
  const auto copy = [](const double* from, Index n, T* to) {
    for (Index i = 0; to && i < n; ++i) to[i] = T(from[i]);
  };
  const double *v = m.configuration_state(k), *u = v + m.n.nv, *act = u + m.n.nu;
  copy(m.configurations() + std::ptrdiff_t(k) * m.n.nq, m.n.nq, d.q), copy(v, m.n.nv, d.v), copy(u, m.n.nu, d.ctrl),
      copy(act, m.n.na, d.act);
  for (Index i = 0; i < m.n.nv; ++i) d.a[i] = d.tau_applied[i] = T(0);
  d.time[0] = T(act[m.n.na]);
}

}  // namespace dyn
