// Limits of the sum of the actuators on a joint or a tendon. On a tendon all are scaled; a joint gets what is beyond its limit
// back, as a force of its own.
#pragma once

#include "algorithm/paths.hpp"
#include "effect/list.hpp"

namespace dyn {

// Calls f(actuator, number) for those that are switched on.
template <class T, class F>
void for_each_actuator(const Model& m, const Data<T>& d, F&& f) {
  if (!(d.acting & DYN_EFFECT_ACTUATORS)) return;
  for (Index k = 0; k < m.n.actuators; ++k)
    if (d.effects[m.actuators()[k].spec.joint] & DYN_EFFECT_ACTUATORS) f(m.actuators()[k], k);
}

inline bool on_tendon(const ActuatorRecord& r) { return r.spec.transmission == DYN_TRANSMISSION_TENDON; }

// What gravity compensation gives a degree of freedom; placements must be known.
template <class T>
T held_weight(const Model& m, const Data<T>& d, Index dof) {
  T sum = T(0);
  if (!(d.acting & DYN_EFFECT_GRAVITY_COMPENSATION)) return sum;
  for (Index k = 0; k < m.n.gravity_compensations; ++k) {
    const GravityCompensation& w = m.gravity_compensations()[k];
    if (!(d.effects[w.joint] & DYN_EFFECT_GRAVITY_COMPENSATION)) continue;
    const Vec3<T> force = load3(d.world_gravity) * T(-w.mass), x = d.p[w.body] + d.R[w.body] * cast<T>(w.at);
    for (Index i = w.body; i != 0; i = m.bodies()[i].parent) {
      const Body& b = m.bodies()[i];
      visit(b.type, [&]<class J>() {
        if (dof < b.user_v || dof >= b.user_v + J::nv) return;
        const Motion<T> s = J::column(b, d.R[i], dof - b.user_v);
        sum += T(b.ratio) * (dot(s.linear, force) + dot(s.angular, cross(x - d.p[i], force)));
      });
    }
  }
  return sum;
}

// Sets d.force_sums: of each limit, what a joint gets back, or what scales the forces on a tendon; then whether it is reached.
// force(actuator, number): on a joint its torque within its own range, on a tendon f before its range.
template <class T, class Force>
void take_force_limits(const Model& m, Data<T>& d, Force&& force) {
  T* const sums = d.force_sums;
  std::fill_n(sums, 2 * m.n.force_limits, T(0));
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index k) {
    if (r.limit >= 0) sums[2 * r.limit] += force(r, k);
  });
  for (Index k = 0; k < m.n.force_limits; ++k) {
    const ForceLimitRecord& limit = m.force_limits()[k];
    const T weight = limit.with_weight ? held_weight(m, d, limit.dof) : T(0), sum = sums[2 * k];
    const T within = std::clamp(sum + weight, T(limit.range[0]), T(limit.range[1])) - weight;
    sums[2 * k + 1] = T(within != sum);
    sums[2 * k] = limit.joint >= 0 ? within - sum : sum != T(0) ? within / sum : T(1);
  }
}

// tau += what joints get back
template <class T>
void add_beyond_limits(const Model& m, const Data<T>& d, T* tau) {
  for (Index k = 0; k < m.n.force_limits; ++k)
    if (m.force_limits()[k].joint >= 0) tau[m.force_limits()[k].dof] += d.force_sums[2 * k];
}

}  // namespace dyn
