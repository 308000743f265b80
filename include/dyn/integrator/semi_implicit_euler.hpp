// Euler steps: the velocity first, then the configuration with the new velocity.
//   v' = v + h ddq(q, v')      q' = q (+) h v'
// First order. What resists the velocity is taken at v', so that no coefficient is too large for the step: (M + h D) ddq = tau - nle.
// So are the gains of actuators (simulation/actuators.hpp).
#pragma once

#include "dyn/integrator/chart.hpp"
#include "dyn/integrator/free_flight.hpp"
#include "dyn/simulation/step.hpp"

namespace dyn::integrator {

// From the free velocity to that at the end of the step. true: the configuration is to be corrected, too, by s.f.
template <class T>
bool meet_rows(const Model& m, Data<T>& d, const Stages<T>& s, T h) {
  if constexpr (std::is_same_v<T, double>) {
    if (simulation::all_clear(m, d, h)) return false;
    if (const Index slots = simulation::find_slots(m, d, d.v, h)) return simulation::solve_slots(m, d, slots, s.y0 + m.n.nv, h, d.v, s.f);
  }
  return false;
}

// d.ddq under tau with the actuators at the end of a step of h; d.armature is added to. Returns 0 or the joint whose forward dynamics failed.
template <class T>
Index driven_dynamics(const Model& m, Data<T>& d, const T* tau, T h) {
  const T* fext = simulation::forces_on_bodies(m, d);
  if (!(d.acting & DYN_EFFECT_ACTUATORS)) return forward_dynamics(m, d, d.v, tau, fext, d.ddq);
  simulation::ImplicitActuators<T> actuators(m, d, h);
  for (int k = 0;; ++k) {
    if (const Index joint = forward_dynamics(m, d, d.v, actuators.apply(tau), fext, d.ddq)) return joint;
    if (k == 3) return 0;
    actuators.withdraw();  // with the stiffness of those that are not held
    if (!actuators.saturate(d.ddq)) return 0;
  }
}

// springs: they, too, are taken at the end of the step: implicit_fast, (M + h D + h^2 K) ddq = tau - nle - h K v. Without, the energy of
// oscillations stays bounded (symplectic); with, no stiffness is too large. Returns 0, or the joint whose forward dynamics failed: the state
// is then as before.
template <class T>
Index euler_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, bool springs) {
  T* const armature = d.armature;
  const T* tau = d.tau_applied;
  const std::uint32_t acting = d.acting, implicit = std::uint32_t(DYN_EFFECT_DAMPING) | DYN_EFFECT_FRICTION | DYN_EFFECT_ACTUATORS | (springs ? std::uint32_t(DYN_EFFECT_SPRINGS) : 0u);
  if (d.acting & implicit) {
    d.armature = d.net + m.n.nv;
    implicit_armature(m, d, armature, h);
    if (springs && (d.acting & DYN_EFFECT_SPRINGS)) {
      for (Index k = 0; k < m.n.nv; ++k) {
        d.armature[k] += h * h * d.stiffness[k];
        s.y[k] = d.tau_applied[k] - h * d.stiffness[k] * d.v[k];
      }
      tau = s.y;
    }
    d.acting |= DYN_EFFECT_ARMATURE;
  }
  const Index joint = driven_dynamics(m, d, tau, h);
  d.armature = armature, d.acting = acting;
  if (joint) return joint;
  s.begin(m, d);
  T* hv = s.y;
  for (Index k = 0; k < m.n.nv; ++k) d.v[k] += h * d.ddq[k];
  free_flight(m, s.y0 + m.n.nv, d.ddq, h, d.v);
  const bool corrected = simulation::has_rows(m, d) && meet_rows(m, d, s, h);
  for (Index k = 0; k < m.n.nv; ++k) hv[k] = h * d.v[k] + (corrected ? s.f[k] : T(0));
  integrate(m, d.q, hv, d.q);
  end_flight(m, s.q0, h, corrected ? s.f : nullptr, d.q, d.v);
  simulation::advance_filters(m, d, s.y0 + 2 * m.n.nv, h);
  return 0;
}

}  // namespace dyn::integrator
