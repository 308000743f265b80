// Finds the constraints, limits and contacts that act in a step, with their rows and propagated columns.
#include "algorithm/constrained/constrained_dynamics.hpp"
#include "simulation/path_rows.hpp"

namespace dyn::simulation {

namespace {

void root_velocities(const Model& m, Data<double>& d, const double* v) {
  static constexpr Index sizes[] = {1, 1, 1, 1, 3, 6};  // degrees of freedom by BodyType
  Workspace& w = *d.step;
  w.root_velocity[0] = Motion<double>::zero();
  with_unbatched_trees(d, [&](const auto& part) {
    part.for_each_group(m, [&](const Trees& t) {
      for (Index i = t.first; i < t.end; ++i) {
        const Body& b = m.bodies()[i];
        Motion<double> V = w.root_velocity[b.parent];
        for (Index k = b.idx_v, end = k + sizes[Index(b.type)]; k < end; ++k) V = V + d.S[k] * v[k];
        w.root_velocity[i] = V;
      }
    });
  });
}

struct Finder {
  const Model& m;
  Data<double>& d;
  Workspace& w;
  const double* v;  // free
  double h;
  Index count = 0, added = 0;  // active constraints; those of w.instances
  double min_distance = shape::infinity;  // between any two shapes

  // Row of the nearer limit: gap >= 0.
  void limit(ConstraintInstance<double>& s, double q, double lower, double upper) const {
    const bool low = q - lower <= upper - q;
    s.g1 = low ? 1 : -1, s.g2 = 0;
    s.error[0] = low ? q - lower : upper - q;
    s.lower[0] = 0, s.upper[0] = HUGE_VAL;
  }
  ActiveConstraint& append(ConstraintInstance<double>& s, RowKind kind, Index index) {
    const bool joints = between_joints(s.c.type);
    auto tree = [&](Index body, Index dof) { return body == 0 ? -1 : w.tree_of[joints ? body_of_dof(m, dof) : body]; };
    const Index tree1 = tree(s.c.body1, s.c.v1), tree2 = tree(s.c.body2, s.c.v2);
    return w.active[count++] = {&s, {}, 0, s.rows, 0, kind, index, tree1, tree2, 0, false, false};
  }
  ConstraintInstance<double>& next() { return w.instances[added]; }
  void append_limit(Index index) { keep_rows(m, d, next(), append(next(), RowKind::Box, index)), ++added; }

  void constraints() {
    if (active_rows(m, d) == 0) return;
    ensure_all_columns(m, d);
    evaluate_rows(m, d, v, static_cast<const double*>(nullptr));
    if (w.options.contact_model == DYN_CONTACT_MODEL_AS_FILE) [[unlikely]]
      for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index) { set_file_rows(m, d, s, v); });
    for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index k) {
      const bool box = one_sided(s.c.type);
      if (s.c.type == DYN_CONSTRAINT_TYPE_LIMIT) limit(s, d.q[s.c.q1], s.c.lower, s.c.upper), s.rate[0] = box_rate(m, d, s, v);
      if (s.c.type == DYN_CONSTRAINT_TYPE_FRICTION) s.lower[0] = -h * s.c.force, s.upper[0] = h * s.c.force, s.error[0] = 0;
      ActiveConstraint& x = append(s, box ? RowKind::Box : RowKind::Equality, -1);
      propagate_rows(m, d, s, supporting_dofs_of(m, d, k), propagated_jacobian_of(m, d, k));
      x.kept = {supporting_dofs_of(m, d, k), propagated_jacobian_of(m, d, k)}, x.support_count = s.support_count;
    });
  }
  void limits() {
    std::swap(w.limit_forces, w.previous_limit_forces);
    std::fill_n(w.limit_forces, w.limits, 0.0);
    if (!(d.acting & DYN_EFFECT_LIMITS)) return;
    double fast = 0;
    for (Index k = 0; k < m.n.limits && w.closed_gap > 0; ++k) {
      const LimitRecord& r = m.limits()[k];
      fast = std::max(fast, is_ball(m, r) ? ball_speed(r, v) : std::abs(v[r.dof]));
    }
    const double reached = w.closed_gap > 0 ? contact_margin(w, h, fast, 0.0) : HUGE_VAL;
    for (Index k = 0; k < m.n.limits; ++k) {
      const LimitRecord& r = m.limits()[k];
      if (is_ball(m, r)) {
        ball(r, k, w.closed_gap > 0 ? reached : tuning::limit_margin);
        continue;
      }
      const double q = d.q[r.q], lower = m.lower_limit()[r.q], upper = m.upper_limit()[r.q];
      const double near = w.closed_gap > 0 ? reached : tuning::limit_margin * unit_of(m, w, r),
                   reach = tuning::speed_growth * h * std::abs(v[r.dof]) + near;
      if (q - lower > reach && upper - q > reach) [[likely]] continue;
      if (!(d.effects[m.bodies()[r.body].joint] & DYN_EFFECT_LIMITS) || w.sleep.sleeps(r.body)) continue;
      ConstraintInstance<double>& s = next();
      s.c = Constraint{};
      s.c.type = DYN_CONSTRAINT_TYPE_LIMIT, s.c.body1 = r.body, s.c.v1 = r.dof, s.c.q1 = r.q;
      s.rows = 1;
      limit(s, q, lower, upper);
      s.rate[0] = box_rate(m, d, s, v);
      append_limit(k);
    }
  }
  void friction() {
    for (Index k = 0; k < m.n.nv; ++k) {
      if (!(d.friction[k] > 0)) continue;
      const Index body = body_of_dof(m, k);
      if (w.sleep.sleeps(body)) continue;
      ConstraintInstance<double>& s = next();
      s.c = Constraint{};
      s.c.type = DYN_CONSTRAINT_TYPE_FRICTION, s.c.body1 = body, s.c.v1 = k;
      s.rows = 1, s.g1 = 1, s.g2 = 0, s.error[0] = 0, s.rate[0] = v[k];
      s.lower[0] = -h * d.friction[k], s.upper[0] = h * d.friction[k];
      append_limit(-1);
    }
  }
  void ball(const LimitRecord& r, Index k, double near) {
    const BallGap x = ball_gap(m, d, r, v);
    if (x.gap > tuning::speed_growth * h * ball_speed(r, v) + near) return;
    if (!(d.effects[m.bodies()[r.body].joint] & DYN_EFFECT_LIMITS) || w.sleep.sleeps(r.body)) return;
    ConstraintInstance<double>& s = next();
    s.c = Constraint{};
    s.c.type = DYN_CONSTRAINT_TYPE_LIMIT, s.c.joint_type = DYN_JOINT_TYPE_SPHERICAL, s.c.body1 = r.body, s.c.v1 = r.dof,
    s.c.q1 = r.q, s.c.axis = -x.axis;
    s.rows = 1, s.g1 = 1, s.g2 = 0;
    s.error[0] = x.gap, s.lower[0] = 0, s.upper[0] = HUGE_VAL;
    s.rate[0] = box_rate(m, d, s, v);
    append_limit(k);
  }
  void paths() {
    if (m.n.path_rows == 0 || !(d.acting & driving_effects)) return;
    double fast = 0;
    for (Index k = 0; k < m.n.tendons && w.closed_gap > 0; ++k) fast = std::max(fast, std::abs(d.path_velocity[k]));
    const double reached = w.closed_gap > 0 ? contact_margin(w, h, fast, 0.0) : 0;
    bool columns = false;
    std::ptrdiff_t stored = simulation::columns(m) + 2 * std::ptrdiff_t(m.n.carriers);
    for (Index k = 0, rows = list_path_rows(m, d, h, reached, w.path_rows); k < rows; ++k) {
      if (!columns) ensure_all_columns(m, d), columns = true;
      const auto [row, path] = w.path_rows[k];
      ConstraintInstance<double>& s = next();
      const RowKind kind = set_path_row(m, d, row, path, h, s);
      Index* const support = w.support + stored;
      double* const Y = w.Y + row_lanes * stored;
      s.rate[0] = path_rate(m, d, s, v);
      propagate_path(m, d, s, support, Y);
      // its first and its last tree; islands.cpp knows of those between them
      const auto tree = [&](Index n) {
        return w.tree_of[body_of_dof(m, m.has_mimic ? m.own_v()[support[n]] : support[n])];
      };
      const Index number = kind == RowKind::Box ? m.n.limits + row : -1;
      w.active[count++] = {&s, {support, Y}, s.support_count, s.rows, 0, kind, number, tree(s.support_count - 1), tree(0), 0,
                           false, false};
      ++added, stored += s.support_count;
    }
  }
  void contacts() {
    if (m.n.contacts == 0) return;
    find_contacts(m, d, h, min_distance);
    for (Index k = 0; k < w.contact_count; ++k) init_contact(m, d, k, h);
    if (w.options.contact_model == DYN_CONTACT_MODEL_AS_FILE) [[unlikely]] keep_touching(m, w);
    fit_contact_rows(m, d);
    const auto tree = [&](Index geom) { return d.geoms[geom].body == 0 ? -1 : w.tree_of[d.geoms[geom].body]; };
    for (Index k = 0; k < w.contact_count; ++k) {
      const ContactLaw& law = w.laws[k];
      w.active[count++] = {nullptr, {}, 0, law.rows, 0, RowKind::Contact, k, tree(law.geom_b), tree(law.geom_a), 0, false, false};
    }
  }
};

}  // namespace

BallGap ball_gap(const Model& m, const Data<double>& d, const LimitRecord& r, const double* v) {
  const double* const q = d.q + r.q - 3;
  const double lower = m.lower_limit()[r.q], most = 2 * math::atan2(std::sqrt(1 - lower * lower), lower);
  const Vec3<double> u = load3(q), turning = load3(v + r.dof);
  const double size = shape::norm(u), w = q[3];
  const double speed = shape::norm(turning);
  return {most - 2 * math::atan2(size, std::abs(w)), size > 0    ? u * ((w < 0 ? -1 : 1) / size)
                                                     : speed > 0 ? turning * (1 / speed)
                                                                 : u};
}

double approach_speed(const Model& m, const Data<double>& d, const ActiveConstraint& x, const double* v) {
  if (x.kind == RowKind::Box) return -box_rate(m, d, *x.s, v);
  const dynContact& c = d.step->contacts[x.index].contact;
  const ContactLaw& law = d.step->laws[x.index];
  const auto speed = [&](Index body) {
    const Motion<double> V = body_motion(m, d, body, v, static_cast<const double*>(nullptr)).V;
    return dot(load3(c.normal), velocity_at(d, body, load3(c.position), V));
  };
  return speed(d.geoms[law.geom_a].body) - speed(d.geoms[law.geom_b].body);
}

void record_overshoot(const Model& m, Data<double>& d, const double* dq, double closed) {
  Workspace& w = *d.step;
  const double *const moved = d.expand(m, dq, d.ax), *const v = d.expand(m, static_cast<const double*>(d.v), d.vx);
  for (Index k = 0; k < w.constraint_count; ++k) {
    const ActiveConstraint& x = w.active[k];
    const double gap = gap_of(w, x) - closed;
    if (x.kind == RowKind::Equality || gap <= 0 || (x.kind == RowKind::Contact && is_active(w.contacts[x.index]))) continue;
    const double passed = approach_speed(m, d, x, moved) - gap;
    if (passed > w.overshoot) w.overshoot = passed, w.overshoot_time = passed / approach_speed(m, d, x, v);
  }
}

Index find_constraints(const Model& m, Data<double>& d, const double* v_free, double h) {
  const double* v = d.expand(m, v_free, d.vx);
  const bool some_sleep = d.step->sleep.any_asleep;  // the advancement cache does not know sleeping bodies
  if (!some_sleep && m.n.contacts == 0 && active_rows(m, d) == 0 && limits_inactive(m, d, v, h) && paths_inactive(m, d, h) &&
      !has_friction_rows(d)) {
    if (d.step->limits > 0) std::fill_n(d.step->limit_forces, d.step->limits, 0.0);
    return update_advancement_cache(m, d, v, h, shape::infinity), 0;
  }
  if (!m.has_mimic) with_unbatched_trees(d, [&](const auto& part) { articulated_columns(m, d, part); });
  root_velocities(m, d, v);
  d.step->stored = 0, d.invalidate(Stage::Distances);  // rows lie in the results of pairs (workspace.cpp)
  Finder find{m, d, *d.step, v, h};
  find.constraints(), find.limits();
  if (has_friction_rows(d)) [[unlikely]] find.friction();
  find.paths(), find.contacts();
  const bool none = !some_sleep && find.count == 0 && active_rows(m, d) == 0 && !has_friction_rows(d);
  update_advancement_cache(m, d, v, h, none ? find.min_distance : 0);
  order_by_islands(m, d, find.count);
  return find.count;
}

}  // namespace dyn::simulation
