// Rows of a step on the lengths of paths: limits, springs and dampers, and dry friction of tendons, couplings of tendons, and
// actuators.
#include "simulation/path_rows.hpp"

#include "algorithm/constrained/path_row.hpp"

namespace dyn::simulation {

namespace {

struct PathRows {
  const Model& m;
  const Data<double>& d;
  double h, reached;

  bool near(Index path, const dynTendon& t) const {
    const double l = d.path_length[path], unit = m.paths()[path].angular ? 1 : d.step->length;
    const double reach = reached > 0 ? reached
                                     : tuning::speed_growth * h * std::abs(d.path_velocity[path]) + tuning::limit_margin * unit;
    return l - t.range[0] <= reach || t.range[1] - l <= reach;
  }
  // f(row, path) for each row that acts.
  template <class F>
  void for_each(F&& f) const {
    for_each_tendon(m, d, [&](const dynTendon& t, Index k, double, double) {
      const Index first = path_rows_of_tendon * k;
      if (effect::Tendons::is_limited(t) && near(k, t)) f(first, k);
      if (d.path_forces[first + 1].acts || t.armature > 0) f(first + 1, k);
      if (t.friction > 0) f(first + 2, k);
    });
    if (d.acting & DYN_EFFECT_TENDONS)
      for (Index k = 0; k < m.n.couplings; ++k) f(path_rows_of_tendon * m.n.tendons + k, m.n.tendons + k);
    for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
      if (r.path >= 0 && d.path_forces[actuator_row(m, r)].acts) f(actuator_row(m, r), r.path);
    });
  }
};

}  // namespace

bool paths_may_jump(const Model& m, const Data<double>& d) {
  if (!(d.acting & DYN_EFFECT_TENDONS)) return false;
  for (Index k = 0; k < m.n.tendons; ++k)
    if (const dynTendon& t = m.tendons()[k].spec; effect::Tendons::is_limited(t) || t.friction > 0 || t.armature > 0) return true;
  return m.n.couplings > 0;
}

bool paths_inactive(const Model& m, const Data<double>& d, double h) {
  if (m.n.paths == 0) return true;
  bool none = true;
  PathRows{m, d, h, 0}.for_each([&](Index, Index) { none = false; });
  return none;
}

RowKind set_path_row(const Model& m, const Data<double>& d, Index row, Index path, double h, ConstraintInstance<double>& s) {
  s.c = Constraint{};
  s.c.path = path + 1, s.c.type = DYN_CONSTRAINT_TYPE_FRICTION;
  s.rows = 1, s.g1 = 1, s.g2 = 0, s.error[0] = s.acceleration[0] = 0;
  if (path >= m.n.tendons && path < m.n.tendons + m.n.couplings) {
    s.c.type = DYN_CONSTRAINT_TYPE_COUPLING, s.error[0] = d.path_length[path];
    return RowKind::Equality;
  }
  const Index of_tendon = row < path_rows_of_tendon * m.n.tendons ? row % path_rows_of_tendon : 1;
  if (of_tendon == 0) {
    const dynTendon& t = m.tendons()[path].spec;
    const double l = d.path_length[path], below = l - t.range[0], above = t.range[1] - l;
    s.c.type = DYN_CONSTRAINT_TYPE_LIMIT, s.g1 = below <= above ? 1 : -1;
    s.error[0] = std::min(below, above), s.lower[0] = 0, s.upper[0] = HUGE_VAL;
  } else if (of_tendon == 1) {
    const PathForce<double>& f = d.path_forces[row];
    s.c.force = f.force, s.c.stiffness = f.stiffness, s.c.damping = f.damping, s.c.armature = f.armature;
    s.lower[0] = h * f.lower, s.upper[0] = h * f.upper;
  } else {
    const double most = h * m.tendons()[path].spec.friction;
    s.lower[0] = -most, s.upper[0] = most;
  }
  return RowKind::Box;
}

Index list_path_rows(const Model& m, const Data<double>& d, double h, double reached, PathRow* rows) {
  Index count = 0;
  PathRows{m, d, h, reached}.for_each([&](Index row, Index path) {
    if (m.paths()[path].dofs > 0) rows[count++] = {row, path};
  });
  return count;
}

}  // namespace dyn::simulation
