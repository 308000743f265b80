// Steps whose lengths follow from the error asked for: an embedded Runge-Kutta method with error per unit step
// (Hairer, Norsett, Wanner 1993, II.4), so local errors add up to at most `accuracy` over the duration.
#pragma once

#include "base/portable.hpp"
#include "integrator/implicit_midpoint.hpp"
#include "integrator/runge_kutta.hpp"
#include "integrator/settled_rows.hpp"
#include "integrator/step_control.hpp"
#include "simulation/energy_guard.hpp"
#include "simulation/extrapolated.hpp"
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

// Advances d by duration. accuracy 0: to rounding. A step may use up to three times its share of the error if earlier steps left
// it. Returns 0, the joint whose forward dynamics failed, or no_step_left, also after max_steps; the state is then that of
// report.time.
template <class Tableau, class T>
Index advance_to_accuracy(const Model& m, Data<T>& d, const Stages<T>& s, T duration, T accuracy, dynStepReport& report,
                          std::int64_t max_steps = std::numeric_limits<std::int64_t>::max()) {
  T h = duration, t = 0, left = 0;
  if (const Index joint = project_to_constraints(m, d))
    return joint;  // initial velocities that violate the constraints jump at once
  if (const Index joint = first_step(m, d, s, Tableau::order, std::max(accuracy, RoundingFloor<T>::of_motion(m, d)), duration, h))
    return joint;
  report.evaluations += 2;
  // of what the accuracy allows, or of accelerations that keep half of their digits
  const T max_noise = std::max(accuracy / T(tuning::growth * duration), std::sqrt(std::numeric_limits<T>::epsilon()));
  RoundingFloor<T> rounding{active_rows(m, d) > 0, max_noise};
  StepSizeController<T> controller{T(1) / (Tableau::order - 1), accuracy == T(0),
                                   T(rounding.held ? tuning::max_factor_rows : tuning::max_factor)};
  SingularityRetry<T> passing{max_noise, h};
  while (t < duration) {
    const bool last = h >= duration - t - duration * T(tuning::shortest_step);
    if (last) h = duration - t;
    if (!(h > duration * T(tuning::shortest_step)) || report.steps + report.rejected >= max_steps) return no_step_left;
    forget_stages(d);
    Index joint = explicit_step<Tableau>(m, d, s, h, record_stages(m, d));
    report.evaluations += Tableau::stages;
    const T share = accuracy / T(tuning::growth) * (h / duration), allowed = std::max(share, rounding(m, d, s, h));
    const T most = rounding.held ? allowed : std::max(allowed, share + std::min(left, tuning::saved_shares * share));
    T error = std::numeric_limits<T>::infinity(), raw = T(0), moved = T(0);
    if (!joint) joint = finish_step<Tableau>(m, d, s, h, most, error, raw, moved);
    if (rounding.held && !joint &&
        passing.again(error, raw, moved, most,
                      std::max(tuning::usual_share * share, T(tuning::usual_rounding) * RoundingFloor<T>::of_motion(m, d)), h)) {
      h = std::min(h, duration - t);
      s.undo(m, d);
      ++report.rejected;
      continue;
    }
    if (error <= passing.allowed(most, h)) {
      t = last ? duration : t + h;
      left = std::max(T(0), left + share - error);
      ++report.steps, report.time = t, report.error_estimate += std::max(error, T(tuning::projection_error) * moved);
      report.smallest_dt = report.steps == 1 ? h : std::min(report.smallest_dt, h);
      record_ledger_step(m, d, h);
      rounding.accept(), passing.accept(h);
      h *= controller.accept(error / allowed);
    } else {
      if (joint && h * T(tuning::min_factor) < duration * T(tuning::shortest_step)) return joint;
      if (!joint) rounding.reject(error, h), s.undo(m, d);
      ++report.rejected, passing.tries = 0;
      h *= controller.reject(error / allowed);
    }
  }
  note_smooth_forces(m, d);
  return 0;
}

// What a step of h meets so that smooth methods lose their order.
template <class T>
struct Events {
  bool jumps = false;  // contacts, limits, dry friction or open constraints act
  T until;  // time, at most h, at which the first open gap reaches `closed` at its speed, or shapes may have passed each other
  T depth = T(0), beyond = T(0);  // of the deepest contact; the same of limits, too
  T closing = T(0);  // largest speed at which closed gaps close
  T meets;           // as `until`, with accelerations, exactly to gap 0
  bool touches = false;  // a gap is closed
  Index rows = 0;    // of the largest island

  // Large islands would be solved too often.
  bool has_few_rows() const { return rows > 0 && rows <= simulation::tuning::island::exact_rows; }
};
// Time in which a gap is passed at this speed and its growth per second; infinity: never.
inline double passing_time(double gap, double speed, double growth) {
  const double square = speed * speed + 2 * growth * gap, sum = square > 0 ? speed + std::sqrt(square) : 0;
  return sum > 0 ? 2 * gap / sum : HUGE_VAL;
}
inline double gravity_fall(const Data<double>& d, double h) { return shape::norm(load3(d.world_gravity)) * h * h / 2; }
// Gap that counts as closed in steps of h.
template <class T>
T lasting_gap(const Model& m, const Data<T>& d, T h) {
  if constexpr (std::is_same_v<T, double>)
    return std::max({tuning::lasting_gap * gravity_fall(d, h), simulation::tuning::slop * (d.step ? d.step->length : 1),
                     tuning::closed_rounding * RoundingFloor<double>::of_state(m, d)});
  else return T(0);
}
inline Index most_island_rows(const simulation::Workspace& w, Index slots) {
  Index most = 0, rows = 0;
  for (Index k = 0; k < slots; ++k) {
    const simulation::ActiveConstraint& x = w.active[w.order[k]];
    rows = x.rows + (k > 0 && w.active[w.order[k - 1]].island == x.island ? rows : 0), most = std::max(most, rows);
  }
  return most;
}
template <class T>
Events<T> find_events(const Model& m, Data<T>& d, const Stages<T>& s, T h, T closed) {
  Events<T> x{.until = h, .meets = h};
  if constexpr (std::is_same_v<T, double>) {
    d.step->time_to_pass = HUGE_VAL;
    if (!simulation::has_constraints(m, d) || constrained_forward_dynamics(m, d)) return x;
    if (is_open(m, d)) return x.jumps = true, x;
    if (!simulation::may_jump(m, d)) return x;
    for (Index k = 0; k < m.n.nv; ++k) s.y[k] = d.v[k] + h * d.ddq[k];
    const T* const v = d.expand(m, static_cast<const T*>(d.v), d.ax);
    const Index slots = simulation::find_constraints(m, d, s.y, h);
    const T* const v_free = d.expand(m, static_cast<const T*>(s.y), d.vx);
    for (Index k = 0; k < slots; ++k) {
      const simulation::ActiveConstraint& a = d.step->active[k];
      if (a.kind == simulation::RowKind::Equality) continue;
      x.jumps = true;
      x.beyond = std::max(x.beyond, -simulation::gap_of(*d.step, a));
      if (a.kind == simulation::RowKind::Contact) x.depth = std::max(x.depth, -simulation::gap_of(*d.step, a));
      const T gap = simulation::gap_of(*d.step, a) - closed, fast = simulation::approach_speed(m, d, a, v);
      if (!(gap > 0)) x.closing = std::max(x.closing, fast), x.touches = true;
      else
        x.meets = std::min(x.meets, passing_time(gap + closed, fast, (simulation::approach_speed(m, d, a, v_free) - fast) / h));
      if (gap > 0 && gap < x.until * fast) x.until = (gap + T(tuning::arrival) * closed) / fast;  // slightly longer, to arrive
    }
    x.until = std::min(x.until, d.step->time_to_pass), x.meets = std::min(x.meets, d.step->time_to_pass);
    x.rows = most_island_rows(*d.step, slots);
  }
  return x;
}

// The same where velocities may jump. Steps without contact use the tableau.
template <class Tableau>
Index advance_through_contact(const Model& m, Data<double>& d, const Stages<double>& s, double duration, double accuracy,
                              dynStepReport& report) {
  const double closed =
      std::max(tuning::closed_share * accuracy, tuning::closed_rounding * RoundingFloor<double>::of_state(m, d));
  Extrapolated extrapolated(m, d, s, closed, simulation::tuning::reopen_factor * closed);
  const double deep =
      tuning::deep * closed;  // deeper initial overlap is removed by fixed-length steps, which have no limit on depth
  // with active rows: below it errors no longer fall
  const double smallest =
      std::max(tuning::smallest_share * std::min(accuracy, 1.0) * std::min(duration, 1.0), tuning::smallest * duration);
  const double longer = std::max(1.0, std::cbrt(tuning::accuracy_scale * accuracy));  // of order 3
  double h = std::min(duration, tuning::first_step * longer), t = 0;
  SolverNoise noise;
  while (t < duration) {
    const double whole = h = std::min(h, duration - t);
    if (!(h > duration * tuning::shortest_step)) return no_step_left;
    const Events<double> events = find_events(m, d, s, h, closed);
    const bool rows = events.jumps, near = d.step->time_to_pass<HUGE_VAL, sunk = events.depth> deep;
    h = std::min(h, sunk ? tuning::push_step * longer : std::max(events.until, smallest));
    const bool last = h >= duration - t - duration * tuning::shortest_step, cut = h < whole && !sunk;
    double error = 0, allowed = std::max(accuracy * (h / duration), RoundingFloor<double>::of_state(m, d)),
           power = 1.0 / (Tableau::order - 1);
    Index joint = 0;
    if (sunk) {
      joint = euler_step(m, d, s, h, false);
      report.evaluations += 2, error = std::min(allowed, events.depth);
    } else if (rows) {
      allowed = std::max({allowed, tuning::closed_error * closed, noise.level}), power = 1.0 / Extrapolated::order;
      joint = extrapolated.step(h, error);
      report.evaluations += Extrapolated::evaluations;
    } else {
      forget_stages(d);
      joint = explicit_step<Tableau>(m, d, s, h, record_stages(m, d));
      report.evaluations += Tableau::stages + 1;
      if (double raw, moved; !joint) joint = finish_step<Tableau>(m, d, s, h, allowed, error, raw, moved);
    }
    if (joint) {
      if (h * tuning::min_factor < duration * tuning::shortest_step) return joint;
      ++report.rejected, h *= tuning::min_factor;
      continue;
    }
    if (near && !rows && h > smallest && error <= allowed &&
        find_events(m, d, s, smallest, closed).depth > closed) {  // the step cut through a corner
      s.undo(m, d);
      ++report.rejected, h /= 2;
      continue;
    }
    if (error <= allowed || (rows && h <= smallest)) {
      if (rows && !sunk && error > allowed) extrapolated.three_steps();
      t = last ? duration : t + h;
      ++report.steps, report.time = t, report.error_estimate += error;
      report.smallest_dt = report.steps == 1 ? h : std::min(report.smallest_dt, h);
      record_ledger_step(m, d, h);
      noise.accept();
      if (!rows && !sunk) note_smooth_forces(m, d);
      if (cut) {  // the step was cut at an event: continue with the length before
        h = whole;
        continue;
      }
    } else {
      if (rows) {
        extrapolated.restore();
        noise.reject(error, h, closed);
      } else {
        s.undo(m, d);
      }
      ++report.rejected;
      if (rows && error == 2 * d.step->overshoot && d.step->overshoot_time > 0 &&
          d.step->overshoot_time < h) {  // the contact was found too late
        h = std::max(h - d.step->overshoot_time * (1 - tuning::arrival * closed / d.step->overshoot), smallest);
        continue;
      }
    }
    const double factor = error > 0 ? tuning::safety * math::pow(allowed / error, power) : tuning::max_factor;
    h *= error < HUGE_VAL ? std::clamp(factor, tuning::min_factor, rows ? tuning::max_factor_contacts : tuning::max_factor)
                          : tuning::min_factor;
    if (rows) h = std::max(h, smallest);
  }
  return 0;
}

// Fixed steps leave out rows that are redundant up to a misalignment anew in each evaluation; others settle them at their
// beginning.
template <class T>
DYN_INLINE void begin_rows(const Model& m, Data<T>& d, bool fixed) {
  if constexpr (std::is_same_v<T, double>) {
    if (m.n.slots == 0) return;
    keep_all_rows(m, d), d.misalignment[0] = fixed ? misalignment_tolerance : 0;
    if (!fixed) settle_redundant_rows(m, d);
  }
}

// Order 5 with RK45, order 8 with any other integrator.
template <class T>
Index advance(const Model& m, Data<T>& d, dynIntegrator integrator, T duration, T accuracy, dynStepReport& report) {
  const Stages<T> s(m, d);
  begin_rows(m, d, false);
  const auto by = [&]<class Tableau>() {
    if constexpr (std::is_same_v<T, double>)
      if (simulation::may_jump(m, d) || (simulation::has_constraints(m, d) && find_events(m, d, s, duration, 0.0).jumps))
        return advance_through_contact<Tableau>(m, d, s, duration, accuracy, report);
    return advance_to_accuracy<Tableau>(m, d, s, duration, accuracy, report);
  };
  const Index failed =
      integrator == DYN_INTEGRATOR_RK45 ? by.template operator()<DormandPrince5>() : by.template operator()<DormandPrince8>();
  keep_all_rows(m, d);
  return failed;
}

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

// A step of h by an integrator of higher order, where nothing jumps. Returns 0, the joint whose forward dynamics failed, not_converged, no_step_left or unstable.
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

template <class T>
T recorded_time(const Data<T>& d) {
  if constexpr (std::is_same_v<T, double>) return d.step ? d.step->recorded_time : 0;
  else return T(0);
}

// Repeats a step that gained energy: with another contact solver, then in 2, 4, .. parts. Each part is checked.
// Returns 0, or energy_gained with the joint that has most of it. Where no time is left for that, the step stays as it was.
// before: without this step.
inline Index repeat_without_gain(const Model& m, Data<double>& d, const Stages<double>& s, dynIntegrator integrator, double h,
                                 dynStepReport& report, const double* start, const SolveQuality& before) {
  using namespace simulation;
  namespace guard = simulation::tuning::guard;
  if (!moves(m, d, h)) return 0;
  const bool first_order = integrator == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || integrator == DYN_INTEGRATOR_IMPLICIT_FAST ||
                           d.step->constraint_count > 0;
  const double share = first_order ? guard::share : guard::high_order_share;
  Workspace& w = *d.step;
  w.ends_fast = true;
  const auto swap_states = [&] {
    double* const kept = const_cast<double*>(start);
    with_active_trees(d, [&](const auto& part) {
      part.for_each_group(m, [&](const Trees& t) {
        std::swap_ranges(d.q + t.q, d.q + t.q_end, kept + t.q), std::swap_ranges(d.v + t.v, d.v + t.v_end, kept + m.n.nq + t.v);
      });
    });
  };
  const StepEnergy last = step_energy(m, d, s.f);
  swap_states();
  const StepEnergy first = step_energy(m, d, s.f);
  swap_states();
  const EnergyGain nothing{0, first.kinetic, first.springs, 0};
  EnergyGain sum = nothing;
  add_gain(m, d, first, last, start + m.n.nq, h, !first_order, sum);
  const double so_far = w.growth;
  const auto accept = [&](double most, double most_growth) {
    const double growth = sum.growth(so_far);
    if (sum.exceeds(most) || growth > std::max(most_growth, so_far)) return false;
    return w.growth = growth, true;
  };
  if (accept(share, guard::growth)) return 0;
  const dynContactSolverType solver = w.options.solver;
  const Index joint = last.fastest;
  const auto begin_again = [&] {
    with_active_trees(d, [&](const auto& part) {
      part.for_each_group(m, [&](const Trees& t) {
        std::copy(start + t.q, start + t.q_end, d.q + t.q), std::copy(start + m.n.nq + t.v, start + m.n.nq + t.v_end, d.v + t.v);
      });
    });
    std::copy_n(start + m.n.nq + 3 * m.n.nv, m.n.na, d.act);
    w.report.residual = before.residual, w.report.unsolved = before.unsolved;
    ++report.rejected, reset_impulse_work(d), forget_forces(w);
  };
  const double once = w.limit.elapsed();
  const int first_halving = w.constraint_count > 0 ? 0 : 1;
  for (int k = first_halving; k <= guard::halvings; ++k) {
    if (!w.limit.restarts(once * ((1 << k) + 1))) {
      if (k == first_halving) return 0;
      return begin_again(), single_step(m, d, s, integrator, h, report);
    }
    begin_again();
    if (k == 0)
      w.options.solver = solver == DYN_CONTACT_SOLVER_TYPE_ADMM ? DYN_CONTACT_SOLVER_TYPE_NEWTON : DYN_CONTACT_SOLVER_TYPE_ADMM;
    const double part = h / (1 << k);
    StepEnergy from = first;
    bool good = true;
    sum = nothing;
    for (int i = 0; i < 1 << k && good; ++i) {
      good = single_step(m, d, s, integrator, part, report) == 0;
      if (!good) break;
      const StepEnergy to = step_energy(m, d, s.f);
      add_gain(m, d, from, to, s.y0 + m.n.nv, part, !first_order, sum), from = to;
      good = !sum.exceeds(guard::part_share);
    }
    w.options.solver = solver;
    if (good && (k < guard::halvings ? accept(share, guard::growth) : accept(guard::part_share, guard::most_growth))) return 0;
  }
  w.failed_joint = joint;
  return energy_gained;
}

template <class T>
Index step(const Model& m, Data<T>& d, dynIntegrator integrator, T h, dynStepReport& report, const T* start) {
  const Stages<T> s(m, d);
  const SolveQuality before = solve_quality(d);
  Index failed = single_step(m, d, s, integrator, h, report);
  if constexpr (std::is_same_v<T, double>)
    if (!failed && start && simulation::may_gain_energy(m, d, h) && simulation::energy_numbers(m) <= 12 * s.n) [[unlikely]]
      failed = repeat_without_gain(m, d, s, integrator, h, report, start, before);
  if (failed) return failed;
  ++report.steps, report.time += h, report.smallest_dt = report.steps == 1 ? h : std::min(report.smallest_dt, h);
  // what inner steps recorded is there already
  record_ledger_step(m, d, integrator == DYN_INTEGRATOR_REFERENCE ? T(0) : h - recorded_time(d));
  return 0;
}

}  // namespace dyn::integrator
