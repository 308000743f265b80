// Steps in time, declared. simulation/guarded_step.hpp and simulation/advance.hpp define them, for a step may meet contacts;
// simulation/advance.cpp instantiates them for double.
#pragma once

#include "model/data.hpp"

namespace dyn {

// Numbers that a step keeps: q at its beginning, the state there and in a stage, and its rate in up to 12 stages.
inline std::ptrdiff_t integrator_stage_count(std::ptrdiff_t nq, std::ptrdiff_t nv, std::ptrdiff_t na) {
  return nq + (2 * nv + na) * (2 + 12);
}

namespace integrator {

inline constexpr Index not_converged = -1;  // of the implicit midpoint rule
inline constexpr Index no_step_left = -2;   // steps became shorter than time can tell apart
inline constexpr Index energy_gained = -3;  // the step adds kinetic energy that nothing explains (Workspace::failed_joint)
inline constexpr Index unstable = -4;  // springs, damping or gains make the explicit method unstable (failed_joint, stable_dt)
// start: the state at the beginning of the step, as in Data::backup, with which the energy guard repeats it; nullptr: no guard.
template <class T> Index step(const Model&, Data<T>&, dynIntegrator, T h, dynStepReport&, const T* start = nullptr);
template <class T> Index advance(const Model&, Data<T>&, dynIntegrator, T duration, T accuracy, dynStepReport&);

}  // namespace integrator
}  // namespace dyn
