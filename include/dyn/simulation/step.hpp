// Steps of smooth dynamics: constant generalised forces, no constraint. Rotations are integrated on the group.
#pragma once

#include "dyn/algorithm/forward_dynamics.hpp"

namespace dyn {

// v' = v + h ddq(q, v'), q' = q (+) h v'. First order; the energy of oscillations stays bounded. Damping and dry friction, D(v) v, take
// v', so that no coefficient is too large for the step: (M + h D) ddq = tau - nle.
// Reads and writes d.q, d.v. Returns 0 or the joint whose forward dynamics failed (the state is then as before).
template <class T>
Index step_semi_implicit_euler(const Model& m, Data<T>& d, T h) {
  T* const armature = d.armature;
  const std::uint32_t acting = d.acting;
  if (d.acting & (DYN_EFFECT_DAMPING | DYN_EFFECT_FRICTION)) {
    d.armature = d.net + m.n.nv;
    implicit_armature(m, d, armature, h);
    d.acting |= DYN_EFFECT_ARMATURE;
  }
  const Index joint = forward_dynamics(m, d, d.v, d.tau_applied, static_cast<const T*>(nullptr), d.ddq);
  d.armature = armature, d.acting = acting;
  if (joint) return joint;
  T* hv = d.stepper;
  for (Index k = 0; k < m.n.nv; ++k) d.v[k] += h * d.ddq[k], hv[k] = h * d.v[k];
  integrate(m, d.q, hv, d.q);
  return 0;
}

// The classical Runge-Kutta method of order 4 in exponential coordinates u of q = q0 (+) u, so that the order holds for
// rotations, too (Munthe-Kaas 1999; Hairer, Lubich, Wanner 2006, IV.8.2).
template <class T>
Index step_rk4(const Model& m, Data<T>& d, T h) {
  const Index nq = m.n.nq, nv = m.n.nv;
  T *q0 = d.stepper, *v0 = q0 + nq, *u = v0 + nv, *du = u + nv, *sum_u = du + nv, *sum_v = sum_u + nv;
  constexpr T node[4] = {T(0), T(0.5), T(0.5), T(1)}, weight[4] = {T(1) / 6, T(1) / 3, T(1) / 3, T(1) / 6};
  for (Index k = 0; k < nq; ++k) q0[k] = d.q[k];
  for (Index k = 0; k < nv; ++k) v0[k] = d.v[k], sum_u[k] = sum_v[k] = T(0);
  for (int stage = 0; stage < 4; ++stage) {
    for (Index k = 0; k < nv; ++k) {
      u[k] = stage ? h * node[stage] * du[k] : T(0);
      if (stage) d.v[k] = v0[k] + h * node[stage] * d.ddq[k];
    }
    if (stage) integrate(m, q0, u, d.q);
    if (const Index joint = forward_dynamics(m, d, d.v, d.tau_applied, static_cast<const T*>(nullptr), d.ddq)) {
      for (Index k = 0; k < nq; ++k) d.q[k] = q0[k];
      for (Index k = 0; k < nv; ++k) d.v[k] = v0[k];
      return joint;
    }
    chart_rate(m, u, d.v, du);
    for (Index k = 0; k < nv; ++k) sum_u[k] += weight[stage] * du[k], sum_v[k] += weight[stage] * d.ddq[k];
  }
  for (Index k = 0; k < nv; ++k) u[k] = h * sum_u[k], d.v[k] = v0[k] + h * sum_v[k];
  integrate(m, q0, u, d.q);
  return 0;
}

}  // namespace dyn
