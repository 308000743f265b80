// Steps whose lengths follow from the error asked for: an embedded Runge-Kutta method with error per unit step
// (Hairer, Norsett, Wanner 1993, II.4), so local errors add up to at most `accuracy` over the duration.
#pragma once

#include "integrator/runge_kutta.hpp"
#include "integrator/settled_rows.hpp"
#include "integrator/step_control.hpp"
#include "integrator/stepping.hpp"
#include "simulation/events.hpp"
#include "simulation/extrapolated.hpp"
#include "simulation/step_records.hpp"

namespace dyn::integrator {

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

// The same where velocities may jump. Steps without contact use the tableau.
template <class Tableau>
Index advance_through_contact(const Model& m, Data<double>& d, const Stages<double>& s, double duration, double accuracy,
                              dynStepReport& report) {
  const double closed =
      std::max(tuning::closed_share * accuracy, tuning::closed_rounding * RoundingFloor<double>::of_state(m, d));
  Extrapolated extrapolated(m, d, s, closed, simulation::tuning::reopen_factor * closed);
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
    const bool rows = events.jumps, near = d.step->time_to_pass < HUGE_VAL;
    // how deep overlaps open is no smooth motion: normals turn, others meet
    const bool opens = events.beyond > tuning::deep * closed;
    const double least = opens ? std::max(smallest, tuning::push_step) : smallest;
    h = std::min(h, std::max(events.until, least));
    const bool last = h >= duration - t - duration * tuning::shortest_step, cut = h < whole;
    double error = 0, allowed = std::max(accuracy * (h / duration), RoundingFloor<double>::of_state(m, d)),
           power = 1.0 / (Tableau::order - 1);
    Index joint = 0;
    if (rows) {
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
    if (error <= allowed || (rows && h <= least)) {
      if (rows && error > allowed) extrapolated.three_steps();
      t = last ? duration : t + h;
      ++report.steps, report.time = t;
      report.error_estimate += opens && error > allowed ? extrapolated.error_of_timing() : error;
      report.smallest_dt = report.steps == 1 ? h : std::min(report.smallest_dt, h);
      record_ledger_step(m, d, h);
      noise.accept();
      if (!rows) note_smooth_forces(m, d);
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
        h = std::max(h - d.step->overshoot_time * (1 - tuning::arrival * closed / d.step->overshoot), least);
        continue;
      }
    }
    const double factor = error > 0 ? tuning::safety * math::pow(allowed / error, power) : tuning::max_factor;
    h *= error < HUGE_VAL ? std::clamp(factor, tuning::min_factor, rows ? tuning::max_factor_contacts : tuning::max_factor)
                          : tuning::min_factor;
    if (rows) h = std::max(h, least);
  }
  return 0;
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

}  // namespace dyn::integrator
