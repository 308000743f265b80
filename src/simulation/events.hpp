// What a step meets in which smooth methods lose their order: gaps that close, limits, shapes that pass each other.
#pragma once

#include "base/portable.hpp"
#include "integrator/step_control.hpp"
#include "simulation/semi_implicit_euler.hpp"

namespace dyn::integrator {

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

}  // namespace dyn::integrator
