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

}  // namespace dyn
