// Solves the contact problems of a step, island by island, and corrects the configuration.
#include <algorithm>

#include "algorithm/constrained/delassus.hpp"
#include "simulation/frame_forces.hpp"
#include "simulation/island.hpp"
#include "simulation/ledger.hpp"

namespace dyn::simulation {

namespace {

// Calls f(first of w.order, one past the last) for each island.
template <class F>
void for_each_island(const Workspace& w, Index slots, F&& f) {
  for (Index begin = 0, end; begin < slots; begin = end) {
    end = begin + 1;
    while (end < slots && w.active[w.order[end]].island == w.active[w.order[begin]].island) ++end;
    f(begin, end);
  }
}

// Puts the contacts that do not close within the step last; their forces are then zero. Impulses may make a tree as fast as the
// trees that it touches.
void drop_open(const Model& m, Data<double>& d, double h, Index begin, Index end) {
  Workspace& w = *d.step;
  if (w.closed_gap > 0) return;
  double *const own = w.tree_speeds, *const near = own + m.n.bodies;
  const auto each = [&](auto&& f) {
    for (Index k = begin; k < end; ++k)
      if (ActiveConstraint& x = w.active[w.order[k]]; x.kind == RowKind::Contact) f(x, w.laws[x.index]);
  };
  const auto at = [](double* of, Index tree) { return tree < 0 ? 0 : of[tree]; };
  const auto raise = [](double* of, Index tree, double speed) {
    if (tree >= 0) of[tree] = std::max(of[tree], speed);
  };
  each([&](const ActiveConstraint& x, const ContactLaw&) {
    for (Index tree : {x.tree1, x.tree2})
      if (tree >= 0) own[tree] = near[tree] = 0;
  });
  each([&](const ActiveConstraint& x, const ContactLaw& law) {
    const double speed = std::max(w.speeds[law.geom_a], w.speeds[law.geom_b]);
    raise(own, x.tree1, speed), raise(own, x.tree2, speed);
  });
  each([&](const ActiveConstraint& x, const ContactLaw&) {
    const double speed = std::max(at(own, x.tree1), at(own, x.tree2));
    raise(near, x.tree1, speed), raise(near, x.tree2, speed);
  });
  bool some = false;
  each([&](ActiveConstraint& x, const ContactLaw& law) {
    const double radius = std::min(d.geoms[law.geom_a].bounding_radius, d.geoms[law.geom_b].bounding_radius);
    const double fast = std::max(at(near, x.tree1), at(near, x.tree2));
    x.open = w.contacts[x.index].contact.distance > tuning::speed_growth * h * fast + tuning::search::touching * radius;
    if (x.open) some = true, copy_force(w.contacts[x.index], nullptr);
  });
  if (!some) return;
  for (Index k = begin, acting = begin; k < end; ++k)  // the others behind those that act, which keep their order
    if (!w.active[w.order[k]].open) std::swap(w.order[acting++], w.order[k]);
}

// Returns whether all contacts of an island are idle; their forces are then zero. Otherwise assembles their rows.
bool skip_idle(const Model& m, Data<double>& d, double h, Index begin, Index end) {
  Workspace& w = *d.step;
  bool idle = true;
  drop_open(m, d, h, begin, end);
  for (Index k = begin; idle && k < end; ++k) {
    const ActiveConstraint& x = w.active[w.order[k]];
    idle = x.kind == RowKind::Contact && (w.laws[x.index].idle || x.open);
  }
  for (Index k = begin; k < end; ++k) {
    ActiveConstraint& x = w.active[w.order[k]];
    x.idle = idle || x.open;
    if (!x.idle && x.kind == RowKind::Contact) assemble_contact(m, d, x);
    if (!idle) continue;
    copy_force(w.contacts[x.index], nullptr);
    w.report.penetration = std::max(w.report.penetration, -w.contacts[x.index].contact.distance);
  }
  return idle;
}

// Moves contacts that nothing can move behind the others, without forces. Returns the end of the others.
Index set_immovable_contacts_aside(Workspace& w, Index begin, Index end) {
  Index acting = begin;
  for (Index k = begin; k < end; ++k) {
    const ActiveConstraint& x = w.active[w.order[k]];
    if (x.kind != RowKind::Contact || x.support_count > 0) std::swap(w.order[acting++], w.order[k]);
  }
  for (Index k = acting; k < end; ++k) copy_force(w.contacts[w.active[w.order[k]].index], nullptr);
  return acting;
}

// What the spring of a soft contact gives in a step of h at whose end its gap opens by the rate.
double released(const Workspace& w, const ActiveConstraint& a, double rate, double h) {
  const double gap = w.contacts[a.index].contact.distance;
  const auto stored = [&](double x) { return x < 0 ? w.laws[a.index].material.stiffness * x * x / 2 : 0; };
  return std::max(0.0, stored(gap) - stored(gap + h * rate));
}

// Work of the impulses: lambda (g + c) / 2. Gains and restitution ask for -lambda bias; belts give lambda slip. What it is for
// impulses with a large residual says nothing: the energies are compared.
void note_work(const Island& x, double residual) {
  namespace accept = solver::tuning::accept;
  double work = 0, size = 0, asked = 0, belts = 0;
  for (Index i = 0; i < x.rows; ++i) {
    work += x.lambda[i] * (x.g[i] + x.c[i]) / 2, size += std::abs(x.lambda[i] * x.g[i]);
    asked += std::max(0.0, -x.lambda[i] * x.bias[i]);
  }
  for (Index k = 0; k < x.constraint_count; ++k)
    if (const ActiveConstraint& a = x.constraint(k); a.kind == RowKind::Contact) {
      const Index n = a.first + normal_row(a.rows);
      if (is_soft(x.w.laws[a.index].material))
        asked += released(x.w, a, x.c[n], x.h) - std::max(0.0, -x.lambda[n] * x.bias[n]);
      for (Index r = 0; a.rows > 1 && r < 2; ++r) belts += std::abs(x.lambda[a.first + r] * x.w.laws[a.index].slip[r]);
    }
  x.w.rows_work += asked + belts;
  if (residual > accept::max_residual || !(work <= asked + (accept::energy + accept::energy_by_tolerance * x.tolerance) * size))
    x.w.rows_add_energy = true;
}

// No coordinate moves further than `max_displacement`: contacts near an axis, or rows that move little, ask for more.
bool shorten(const Model& m, const Data<double>& d, double* dq) {
  const double most = tuning::max_displacement;
  double largest = 0;
  for_each_impulse_range(m, d, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) largest = std::max(largest, std::abs(dq[k]));
  });
  if (largest <= most * std::min(1.0, d.step->length)) return false;
  largest = 0;
  for_each_impulse_range(m, d, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) largest = std::max(largest, std::abs(dq[k]) / (is_length(m, k) ? d.step->length : 1));
  });
  if (largest <= most) return false;
  for_each_impulse_range(m, d, [&](Index first, Index end) {
    for (Index k = first; k < end; ++k) dq[k] *= most / largest;
  });
  return true;
}

}  // namespace

void Island::impulses(dynContactReport& report) {
  prepare_blocks();
  report.residual = HUGE_VAL;
  const double asked = tolerance;
  if (is_as_file() && solve_as_file(report)) [[unlikely]] {
    residual();  // sets by_dof and c
  } else if (bounces && !has_room_for_matrix()) {
    solve_restitution(report);
  } else if (uses_sweeps_only()) {
    accelerated_sweeps(w.max_iterations(), report);
  } else if (!bounces && !is_exact() && has_runs()) {
    solve_to_default(report);
  } else if (accept_guess(report)) {
    if (relaxation_is_due() && relax(tolerance)) residual();
  } else if (report.residual <= asked && relax(tolerance)) {
    residual();  // bodies stand: other solvers would leave what rounding leaves of redundant impulses
  } else {
    if (w.time_is_up() || bounces || !sparse() || !(newton(report, false) || report.residual <= asked)) solve_exactly(report);
    report.residual = std::max(report.residual, inconsistency);
    residual();  // sets by_dof and c for the best impulses
  }
  if (report.residual == HUGE_VAL && !is_as_file()) [[unlikely]] solve_without_guess(report);
  w.limit.leave();
  for (Index k = 0; k < constraint_count; ++k) {
    const ActiveConstraint& x = constraint(k);
    if (x.kind != RowKind::Contact) {
      if (x.kind == RowKind::Box && x.index >= 0) w.limit_forces[x.index] = x.s->g1 * lambda[x.first] / h;
      if (x.kind == RowKind::Equality && w.frame_forces) [[unlikely]] note_frame_forces(*this, x);
      continue;
    }
    dynContactForce& f = w.contacts[x.index];
    const ContactLaw& law = w.laws[x.index];
    Vec3<double> force = Vec3<double>::zero(), moment = force;
    for (Index r = 0; r < x.rows; ++r) {
      Vec3<double>& sum = r < 3 ? force : moment;
      sum = sum + law.axis(r) * (lambda[x.first + r] / h);
    }
    store3(force, f.force_on_b), store3(moment, f.moment_on_b);
  }
}

bool solve_constraints(const Model& m, Data<double>& d, Index slots, const double* v_before, double h, double* v, double* dq) {
  Workspace& w = *d.step;
  bool corrected = false, pushed = false;
  Index islands = 0, rows = 0;
  for_each_island(w, slots, [&](Index begin, Index end) { ++islands, pushed |= !skip_idle(m, d, h, begin, end); });
  for (Index k = 0; k < slots; ++k) rows += w.active[k].open ? 0 : w.active[k].rows;
  w.report.islands = std::max(w.report.islands, islands), w.report.rows = std::max(w.report.rows, rows);
  w.report.contacts = std::max(w.report.contacts, w.contact_count);
  if (!pushed) return false;

  v_before = d.expand(m, v_before, d.ax);
  double *impulse = d.constraint_step, *displacement = d.constraint_ddq;
  for_each_impulse_range(m, d, [&](Index v, Index v_end) {
    std::fill(impulse + v, impulse + v_end, 0.0), std::fill(displacement + v, displacement + v_end, 0.0);
  });
  for_each_island(w, slots, [&](Index begin, Index end) {
    if (w.active[w.order[begin]].idle) return;
    const auto acts = [&](Index k) { return !w.active[k].idle; };
    const Index awake = Index(std::find_if_not(w.order + begin, w.order + end, acts) - w.order);
    const Index acting = set_immovable_contacts_aside(w, begin, awake);
    if (acting == begin) return;
    Island island{m, d, w, w.order + begin, acting - begin, h, v_before};
    island.assign_rows(), island.fill();
    dynContactReport report{};
    island.by_dof = impulse, island.impulses(report);
    note_work(island, report.residual);
    if (w.ledger.open) record_impulses(island);
    island.by_dof = displacement, corrected |= island.correct();
    island.keep_all();
    w.report.iterations += report.iterations + report.newton_steps;
    w.report.residual = std::max(w.report.residual, report.residual), w.report.unsolved += report.residual > w.tolerance();
  });
  if (corrected)
    with_active_trees(
        d, [&](const auto& part) { part.for_each_group(m, [&](const Trees& t) { std::fill(dq + t.v, dq + t.v_end, 0.0); }); });
  for_each_impulse_range(m, d, [&](Index first, Index end) {
    scatter(m, d, impulse, first, end);
    for (Index k = first; k < end; ++k) v[k] += impulse[k];
    if (!corrected) return;
    scatter(m, d, displacement, first, end);
    std::copy(displacement + first, displacement + end, dq + first);
  });
  w.corrected |= corrected;
  if (corrected && shorten(m, d, dq)) w.rows_add_energy = true;
  return corrected;
}

}  // namespace dyn::simulation
