// Steps of the length that the caller sets. Those of higher order keep order 3 through contacts and limits that last, and are
// divided where something meets.
#pragma once

#include "integrator/implicit_midpoint.hpp"
#include "simulation/advance.hpp"
#include "simulation/energy_guard.hpp"

namespace dyn::integrator {

template <class T>
Index one_euler_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, bool springs) {
  if constexpr (std::is_same_v<T, double>)
    if (d.step->sleep.enabled) return euler_step_of_awake(m, d, s, h, springs);
  return euler_step(m, d, s, h, springs);
}

template <class T>
DYN_INLINE Index counted_euler_step(const Model& m, Data<T>& d, const Stages<T>& s, T h, bool springs, dynStepReport& report) {
  return report.evaluations += 1, one_euler_step(m, d, s, h, springs);
}

// An explicit step, unless springs, damping or gains make it unstable. Loops may make a joint heavier than it is by itself: there
// the energy decides.
template <class Tableau, class T>
Index stable_explicit_step(const Model& m, Data<T>& d, const Stages<T>& s, T h) {
  if (const Index joint = explicit_step<Tableau>(m, d, s, h, record_stages(m, d))) return joint;
  if constexpr (std::is_same_v<T, double>)
    if (d.step && (d.step->failed_joint = simulation::unstable_joint(m, d, h, Tableau::stability, d.step->stable_dt))) {
      if (active_rows(m, d) == 0) return unstable;
      d.step->rows_add_energy = true;
    }
  return 0;
}

// Of the solves of rows since the call began.
struct SolveQuality {
  double residual;
  std::int32_t unsolved;
};

template <class T>
SolveQuality solve_quality(const Data<T>& d) {
  if constexpr (std::is_same_v<T, double>)
    if (d.step) return {d.step->report.residual, d.step->report.unsolved};
  return {};
}

// What the energy guard asks of the rows of a step.
inline void begin_row_work(simulation::Workspace& w) { w.rows_add_energy = w.corrected = false, w.rows_work = 0; }

// A step of h through rows that last: order 3 (extrapolated.hpp). Returns false, with the state as before, where a gap closes
// within the step, velocities jump at its beginning, an overlap is deep, or the substeps disagree. Steps with a
// deadline take one solve.
inline bool step_through_lasting_rows(const Model& m, Data<double>& d, const Stages<double>& s, double h, const Events<double>& x,
                                      double closed, dynStepReport& report) {
  simulation::Workspace& w = *d.step;
  const bool lasts = x.meets >= h && h * x.closing <= closed && x.beyond <= tuning::deep * closed;
  if (!lasts || !x.has_few_rows() || w.options.time_budget > 0) return false;
  double error;
  // along a curved surface contacts open within the step, by less than what gravity closes
  const double reopen = std::max(simulation::tuning::reopen_factor * closed, gravity_fall(d, h));
  Extrapolated extrapolated(m, d, s, closed, reopen, simulation::tuning::island::fine);
  const SolveQuality before = solve_quality(d);
  const Index failed = extrapolated.step(h, error);
  report.evaluations += Extrapolated::evaluations;
  const double fast = std::max(largest(d.v, m.n.nv), h * largest(static_cast<const double*>(d.ddq), m.n.nv));
  if (failed || w.overshoot > closed || !(error <= tuning::lasting_error * fast)) {
    extrapolated.restore(), begin_row_work(w), simulation::reset_impulse_work(d);
    w.report.residual = before.residual, w.report.unsolved = before.unsolved;
    return ++report.rejected, false;
  }
  return report.error_estimate += error, true;
}

// A step of h by an integrator of higher order, where nothing jumps. Returns 0, the joint whose forward dynamics failed,
// not_converged, no_step_left or unstable.
template <class T>
Index smooth_step(const Model& m, Data<T>& d, const Stages<T>& s, dynIntegrator integrator, T h, dynStepReport& report) {
  Index failed = 0;
  switch (integrator) {
    case DYN_INTEGRATOR_SEMI_IMPLICIT_EULER:
    case DYN_INTEGRATOR_IMPLICIT_FAST: break;
    case DYN_INTEGRATOR_RK4: failed = stable_explicit_step<Classical>(m, d, s, h), report.evaluations += Classical::stages; break;
    case DYN_INTEGRATOR_RK45:
      failed = stable_explicit_step<DormandPrince5>(m, d, s, h), report.evaluations += DormandPrince5::stages;
      if (!failed) report.error_estimate += step_error(DormandPrince5(), m, d, s, h, false);
      break;
    case DYN_INTEGRATOR_IMPLICIT_MIDPOINT:
      failed = implicit_midpoint_step(m, d, s, h, report.evaluations, record_stages(m, d));
      break;
    case DYN_INTEGRATOR_REFERENCE: {
      dynStepReport inner{};
      failed = advance_to_accuracy<DormandPrince8>(m, d, s, h, T(0), inner, tuning::reference_steps);
      report.evaluations += inner.evaluations, report.rejected += inner.rejected, report.error_estimate += inner.error_estimate;
      break;
    }
  }
  if (!failed) failed = project_step(m, d), note_smooth_forces(m, d);
  return failed;
}

// The step up to where something meets, in which nothing jumps, and the jump there, in a short step of order 1. Returns the time
// that they took; 0, with the state as before, where nothing meets within the step or something else jumps.
inline double step_through_jump(const Model& m, Data<double>& d, const Stages<double>& s, dynIntegrator integrator, double h,
                                const Events<double>& x, double closed, dynStepReport& report) {
  simulation::Workspace& w = *d.step;
  const double jump = tuning::jump_share * h;
  const bool at_once = h * x.closing > closed;
  double part = at_once ? 0 : x.meets;
  if (integrator == DYN_INTEGRATOR_REFERENCE || w.options.time_budget > 0 || !x.has_few_rows() || !(part < h - jump)) return 0;
  if (!at_once) {
    for (int tries = tuning::jump_tries; x.touches && !step_through_lasting_rows(m, d, s, part, x, closed, report);) {
      if (--tries == 0 || !(w.overshoot > closed && w.overshoot_time < part)) return 0;
      part -= w.overshoot_time;
    }
    if (!x.touches && smooth_step(m, d, s, integrator, part, report)) return s.undo(m, d), begin_row_work(w), 0;
    record_ledger_step(m, d, part);
  }
  begin_rows(m, d, true);
  if (counted_euler_step(m, d, s, jump, true, report)) return part;
  return record_ledger_step(m, d, jump), part + jump;
}

// A step of h by an integrator of higher order. Where something jumps, and order 3 does not last, the rest has order 1.
template <class T>
[[gnu::noinline]] Index higher_order_step(const Model& m, Data<T>& d, const Stages<T>& s, dynIntegrator integrator, T h,
                                          dynStepReport& report) {
  const T closed = lasting_gap(m, d, h);
  Events<T> events = find_events(m, d, s, h, closed);
  if (!events.jumps) return smooth_step(m, d, s, integrator, h, report);
  if constexpr (std::is_same_v<T, double>) {
    simulation::Workspace& w = *d.step;
    w.overshoot = 0;
    if (step_through_lasting_rows(m, d, s, h, events, closed, report)) return 0;
    // what no gap foretold, as of a corner that turns to the ground
    if (w.overshoot > closed && w.overshoot_time < h) events.meets = h - w.overshoot_time;
    h -= w.recorded_time = step_through_jump(m, d, s, integrator, h, events, closed, report);
    if (w.recorded_time > 0 &&
        step_through_lasting_rows(m, d, s, h, find_events(m, d, s, h, closed), closed, report))
      return 0;
  }
  begin_rows(m, d, true);
  return counted_euler_step(m, d, s, h, true, report);
}

// One step of h by the integrator. Returns 0, the joint whose forward dynamics failed, not_converged, no_step_left or unstable.
template <class T>
Index single_step(const Model& m, Data<T>& d, const Stages<T>& s, dynIntegrator integrator, T h, dynStepReport& report) {
  if constexpr (std::is_same_v<T, double>)
    if (d.step) begin_row_work(*d.step), d.step->recorded_time = 0;
  begin_rows(m, d, integrator != DYN_INTEGRATOR_REFERENCE);
  const bool implicit_springs = integrator == DYN_INTEGRATOR_IMPLICIT_FAST;
  const Index failed = implicit_springs || integrator == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER
                           ? counted_euler_step(m, d, s, h, implicit_springs, report)
                           : higher_order_step(m, d, s, integrator, h, report);
  keep_all_rows(m, d);
  return failed;
}

}  // namespace dyn::integrator
