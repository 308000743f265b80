// Solves the contact problems of a step, island by island, and corrects the configuration.
#include <algorithm>

#include "algorithm/constrained/delassus.hpp"
#include "algorithm/constrained/redundant_rows.hpp"
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

// Work of the impulses: lambda (g + c) / 2. Gains and restitution ask for -lambda bias; belts give lambda slip.
void note_work(const Island& x) {
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
  if (!(work <= asked + (accept::energy + accept::energy_by_tolerance * x.tolerance) * size)) x.w.rows_add_energy = true;
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
    accelerated_sweeps(report);
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

// Returns whether a row's error is an angle.
bool Island::is_angle(const ActiveConstraint& x, Index row) const {
  const ConstraintInstance<double>& s = *x.s;
  if (of_path(s.c)) return m.paths()[s.c.path - 1].angular;
  if (between_joints(s.c.type)) return m.bodies()[body_of_dof(m, s.c.v1)].type != BodyType::Prismatic;
  const auto pulls = [&](const double* F, Index body) {
    return body && (F[row] != 0 || F[row_lanes + row] != 0 || F[2 * row_lanes + row] != 0);
  };
  return !pulls(s.F1, s.c.body1) && !pulls(s.F2, s.c.body2);
}

// Position error at the end of the step, without friction.
// In steps that follow from an accuracy: the error where the step ends (simulation/extrapolated.hpp), less half of h times
// the closing rate of rolling surfaces, once for each drift. That part is no error: it falls as h^2, and extrapolation
// over steps of different lengths would turn it into one.
// Rows as the file has them are springs: no error is theirs to correct.
bool Island::correct() {
  if (is_as_file()) [[unlikely]] return false;
  const double most = correction_speed(d, h) * h / w.length;  // of the length scale, or rad
  const double ahead = w.closed_gap > 0 ? 0 : h, moved = w.closed_gap > 0 ? 0.5 * h * w.drift_count : 0;
  double largest = 0;
  bool far = false;  // an equality is further off than a step corrects
  auto part = [&](double wrong, double unit) {
    largest = std::max(largest, std::abs(wrong) / unit);
    return std::clamp(tuning::island::correction * wrong, -most * unit, most * unit);
  };
  auto one_sided = [&](double gap, double unit) { return gap < 0 ? part(gap, unit) : gap; };
  for (Index k = 0, in_boxes = 0; k < constraint_count; ++k) {
    ActiveConstraint& x = constraint(k);
    double over[2] = {1, 1};  // an equality's largest length and angle over what a step corrects: errors keep their directions
    for (Index r = 0; r < x.rows; ++r) {
      const Index i = x.first + r;
      double wrong = 0;
      if (x.kind == RowKind::Equality && !(x.s->c.stiffness > 0 || x.s->c.damping > 0)) {
        if (dropped > 0 || !(x.s->dropped >> r & 1)) {
          const bool angle = is_angle(x, r);
          wrong = x.s->error[r] + ahead * c[i];
          const double size = std::abs(wrong) / (angle ? 1 : w.length);
          wrong *= tuning::island::correction;
          largest = std::max(largest, size), over[angle] = std::max(over[angle], tuning::island::correction * size / most);
        }
      } else if (x.kind == RowKind::Box && x.s->c.type == DYN_CONSTRAINT_TYPE_LIMIT) {
        wrong = one_sided(x.s->error[0] + ahead * c[i] + w.closed_gap, is_angle(x, r) ? 1 : w.length);
      } else if (x.kind == RowKind::Box) {
        lower[in_boxes] = upper[in_boxes] = w.blocks[k].lower = w.blocks[k].upper = 0;
      } else if (x.kind == RowKind::Contact && r == normal_row(x.rows)) {
        const double rate = w.laws[x.index].rate[r];
        const double gap = w.contacts[x.index].contact.distance + ahead * c[i] + w.closed_gap + moved * std::max(0.0, -rate);
        wrong = is_soft(w.laws[x.index].material) ? std::max(gap, most * w.length) : one_sided(gap, w.length);
      }
      g[i] = compliance[i] = 0, bias[i] = wrong;
    }
    in_boxes += x.kind == RowKind::Box;
    x.far = over[0] > 1 || over[1] > 1, far |= x.far;
    if (!x.far) continue;
    for (Index r = 0; r < x.rows; ++r) bias[x.first + r] /= over[is_angle(x, r)];
  }
  if (!(largest > tuning::slop)) return false;
  if (dropped > 0) share_errors(m, d, bias);
  if (!has_room_for_matrix() || equalities == 0) correct_by_sweeps();
  else solve_displacement(far), scatter_all();
  return true;
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
    note_work(island);
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
