// What steps note beside the state: powers and work of the ledger, forces on frames.
#pragma once

#include "simulation/frame_forces.hpp"
#include "simulation/semi_implicit_euler.hpp"

namespace dyn::integrator {

template <class T>
void record_ledger_step(const Model& m, Data<T>& d, T h) {
  if constexpr (std::is_same_v<T, double>)
    if (simulation::has_open_ledger(d)) simulation::record_step(m, d, h);
}

// Records the powers at the stages of a step.
template <class T>
auto record_stages(const Model& m, Data<T>& d) {
  return [&](T share) {
    if constexpr (std::is_same_v<T, double>)
      if (simulation::has_open_ledger(d)) [[unlikely]] simulation::record_powers(m, d, share);
  };
}
template <class T>
void forget_stages(Data<T>& d) {
  if constexpr (std::is_same_v<T, double>)
    if (simulation::has_open_ledger(d)) simulation::reset_impulse_work(d);
}

template <class T>
Index project_step(const Model& m, Data<T>& d) {
  if constexpr (std::is_same_v<T, double>)
    if (simulation::has_open_ledger(d) && active_rows(m, d) > 0) {
      const double before = simulation::ledger_potential(m, d);
      const Index failed = project_to_constraints(m, d);
      return simulation::record_projection(m, d, before), failed;
    }
  return project_to_constraints(m, d);
}

// At the end of smooth motion: forces of constraints there.
template <class T>
void note_smooth_forces(const Model& m, Data<T>& d) {
  if constexpr (std::is_same_v<T, double>)
    if (d.step && d.step->frame_forces && active_rows(m, d) > 0 && !constrained_forward_dynamics(m, d)) [[unlikely]]
      simulation::note_frame_forces(m, d);
}

}  // namespace dyn::integrator
