// Effects as a data has them: coefficients of those that are switched on, and a bit for each that acts.
#pragma once

#include "model/data.hpp"

namespace dyn {

// Fills in the coefficients of the effects that are switched on.
template <class T>
void apply_effects(const Model& m, Data<T>& d) {
  const struct {
    std::uint32_t bit;
    const double* from;
    T* to;
  } rows[] = {{DYN_EFFECT_ARMATURE, m.armature(), d.armature}, {DYN_EFFECT_DAMPING, m.damping(), d.damping},
              {DYN_EFFECT_SPRINGS, m.stiffness(), d.stiffness}, {DYN_EFFECT_FRICTION, m.friction(), d.friction}};
  d.acting = d.pushed;
  const auto on = [&](Index joint, std::uint32_t bit) { d.acting |= d.effects[joint] & bit; };
  for (Index k = 0; k < m.n.actuators && d.has(DYN_PART_SIMULATION); ++k) on(m.actuators()[k].spec.joint, DYN_EFFECT_ACTUATORS);
  for (Index k = 0; k < m.n.gravity_compensations && d.has(DYN_PART_SIMULATION); ++k) on(m.gravity_compensations()[k].joint, DYN_EFFECT_GRAVITY_COMPENSATION);
  for (Index k = 0; k < m.n.drag_boxes && d.has(DYN_PART_SIMULATION); ++k) on(m.drag_boxes()[k].joint, DYN_EFFECT_FLUID);
  for (Index j = 1; j < m.n.joints; ++j)
    for (Index k = m.joints()[j].idx_v, end = k + m.joints()[j].nv; k < end; ++k)
      for (const auto& r : rows) {
        if (!r.to) continue;
        r.to[k] = d.effects[j] & r.bit ? T(r.from[k]) : T(0);
        if (r.to[k] != T(0)) d.acting |= r.bit;
      }
  for (Index k = 0; k < m.n.limits; ++k)
    if (d.effects[m.bodies()[m.limits()[k].body].joint] & DYN_EFFECT_LIMITS) d.acting |= DYN_EFFECT_LIMITS;
  const bool rests = d.has(DYN_PART_SIMULATION) && !m.has_mimic && m.n.slots + m.n.contacts + m.n.limits > 0;
  for (Index j = 1; rests && j < m.n.joints; ++j) on(j, DYN_EFFECT_SLEEPING);
}

}  // namespace dyn
