// A step of the length that the caller sets, repeated where it gains energy that nothing explains.
#pragma once

#include "simulation/fixed_step.hpp"

namespace dyn::integrator {

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
