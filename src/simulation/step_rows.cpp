// The linearised step (step_linearisation.hpp): the rows that press, and the derivatives of their velocities.
#include "simulation/step_linearisation.hpp"

namespace dyn::simulation {

// Contacts and limits that press. Returns why they are not covered, or nullptr.
const char* StepJacobian::find_rows() {
  for (Index k = 0; k < x.modes.count; ++k) {
    if (x.modes.modes[k] == DYN_CONTACT_MODE_OPEN) continue;
    const ContactLaw& law = w.laws[k];
    if (law.rows > 3) return "a contact has torsion or rolling friction";
    const collision::Geom &a = d.geoms[law.geom_a], &b = d.geoms[law.geom_b];
    const auto flat = [](const collision::Geom& g) { return g.shape.type == shape::Type::HalfSpace; };
    if (!flat(a) && !flat(b) &&
        x.modes.contacts[k].contact.distance > tuning::search::touching * std::min(a.bounding_radius, b.bounding_radius))
      return "shapes that were apart at the beginning of the step meet";
    const bool friction = law.rows == 3 && law.material.friction > 0;
    if (rows + 3 > jacobian_rows(m)) return "too many rows";
    JacobianContact& c = y.contacts[contacts++];
    c.contact = k, c.body_a = a.body, c.body_b = b.body, c.first = rows;
    c.position = load3(x.modes.contacts[k].contact.position), c.force = load3(x.modes.contacts[k].force_on_b) * h;
    c.slip_a = surface_velocity(d, law.geom_a), c.slip_b = surface_velocity(d, law.geom_b);
    if (!contact_geometry(m, d, x.modes.contacts[k].contact, law, c.geometry))
      return "a contact point has no counterpart where its shapes move";
    const auto add = [&](Index axis) {
      y.rows[rows++] = {axis == 2 ? JacobianRowKind::Normal : JacobianRowKind::Stick, contacts - 1, axis,
                        dot(c.force, law.axes[axis])};
    };
    add(2);
    if (friction) add(0), add(1);
  }
  for (Index k = 0; k < m.n.limits; ++k) {
    if (w.limit_forces[k] == 0) continue;
    if (rows == jacobian_rows(m)) return "too many rows";
    y.rows[rows++] = {JacobianRowKind::Limit, k, 0, std::abs(w.limit_forces[k]) * h};
  }
  return find_equalities();
}

void StepJacobian::find_twists(const double* of, Motion<double>* out) const {
  const double* const v = d.expand(m, of, d.ax);
  out[0] = Motion<double>::zero();
  for (Index i = 1; i < m.n.bodies; ++i) {
    Motion<double> V = out[m.bodies()[i].parent];
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) V = V + d.S[k] * v[k];
    out[i] = V;
  }
}

// J, and E: the derivative of the row's velocity and bias by q and v at fixed v'.
void StepJacobian::differentiate_contact(JacobianContact& c) const {
  const ContactLaw& law = w.laws[c.contact];
  const Index count = law.rows == 3 && law.material.friction > 0 ? 3 : 1;
  const Motion<double> U = relative(c, y.twists);
  c.relative = U;
  const Vec3<double> slip = c.slip_b - c.slip_a;
  for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>& parent, bool of_b) {
    const Motion<double> by = moved(c, S, of_b);
    const Index body = of_b ? c.body_b : c.body_a;
    const double sign = of_b ? 1 : -1;
    const Motion<double> own = shift(parent - y.twists[body], c.position - root(body));
    const Vec3<double> change = cross(own, S).linear * sign + cross(U.angular, by.linear);
    for (Index r = 0; r < count; ++r) {
      const Index axis = y.rows[c.first + r].axis;
      const Vec3<double>& e = law.axes[axis];
      const Vec3<double> belt = axis == 2 ? Vec3<double>::zero() : slip,
                         turned = axis == 2 ? belt : cross(S.angular, of_b ? c.slip_b : c.slip_a) * sign;
      J(c.first + r)[user_dof(m, j)] += ratio(j) * sign * dot(e, S.linear);
      E(c.first + r)[user_dof(m, j)] += ratio(j) * (dot(e, change + turned) + dot(cross(by.angular, e), U.linear + belt));
    }
  });
  std::copy_n(E(c.first), nv, y.rate + nv * c.first);
  add_bias(c, law);
  if (count == 1) return;
  const double t[2] = {dot(law.axes[0], U.linear + slip), dot(law.axes[1], U.linear + slip)};
  c.sliding = std::sqrt(t[0] * t[0] + t[1] * t[1]);
  if (!(c.sliding > tuning::derivatives::still)) return;
  for (int k = 0; k < 2; ++k) c.direction[k] = t[k] / c.sliding, y.rows[c.first + 1 + k].kind = JacobianRowKind::Slide;
}

// Of the normal row: see fill_contact (island.cpp).
void StepJacobian::add_bias(JacobianContact& c, const ContactLaw& law) const {
  const double gap = x.modes.contacts[c.contact].contact.distance;
  if (x.modes.modes[c.contact] == DYN_CONTACT_MODE_IMPACT) return add_restitution(c, law);
  const dynMaterial& material = law.material;
  const double total = h * material.stiffness + material.damping;
  const double by_gap = gap > 0 ? 1 / h : is_soft(material) ? material.stiffness / total : 0;
  if (by_gap != 0) add_gap(c, by_gap, E(c.first));
}

// to += factor times the derivative of the gap by q.
void StepJacobian::add_gap(const JacobianContact& c, double factor, double* to) const {
  const ContactGeometry& g = c.geometry;
  for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>&, bool of_b) {
    const double by = dot(g.by_step.gap, S.linear) + dot(g.by_turn.gap, S.angular);
    to[user_dof(m, j)] += (of_b ? factor : -factor) * ratio(j) * by;
  });
}

void StepJacobian::add_restitution(JacobianContact& c, const ContactLaw& law) const {
  const double e = law.material.restitution;
  c.approach = dot(load3(x.modes.contacts[c.contact].contact.normal), relative(c, y.twists_before).linear);
  add_normal_rate(c, y.twists_before, e, E(c.first), nullptr);
  add_row(E(c.first) + nv, J(c.first), e, nv);
}

// rate += factor times the derivative by q of the normal velocity that the twists make; J += the normal row.
void StepJacobian::add_normal_rate(const JacobianContact& c, const Motion<double>* twists, double factor, double* rate,
                                   double* J) const {
  const Vec3<double> n = load3(x.modes.contacts[c.contact].contact.normal);
  const Motion<double> U = relative(c, twists);
  for_each_dof(c, twists, [&](Index j, const Motion<double>& S, const Motion<double>& parent, bool of_b) {
    const Motion<double> by = moved(c, S, of_b);
    const Index body = of_b ? c.body_b : c.body_a;
    const double sign = of_b ? 1 : -1;
    const Motion<double> own = shift(parent - twists[body], c.position - root(body));
    const Vec3<double> change = cross(own, S).linear * sign + cross(U.angular, by.linear);
    rate[user_dof(m, j)] += factor * ratio(j) * (dot(n, change) + dot(cross(by.angular, n), U.linear));
    if (J) J[user_dof(m, j)] += ratio(j) * sign * dot(n, S.linear);
  });
}

void StepJacobian::differentiate_rows() const {
  std::fill_n(y.J, rows * nv, 0.0), std::fill_n(y.E, rows * 2 * nv, 0.0), std::fill_n(y.rate, rows * nv, 0.0);
  for (Index k = 0; k < contacts; ++k) differentiate_contact(y.contacts[k]);
  for (Index r = 0; r < rows; ++r) {
    if (y.rows[r].kind != JacobianRowKind::Limit) continue;
    const LimitRecord& limit = m.limits()[y.rows[r].of];
    const bool low = w.limit_forces[y.rows[r].of] > 0;
    const double gap = low ? x.q[limit.q] - m.lower_limit()[limit.q] : m.upper_limit()[limit.q] - x.q[limit.q];
    const Index dof = user_dof(m, limit.dof);
    J(r)[dof] = low ? 1 : -1;
    if (gap > 0) E(r)[dof] = J(r)[dof] / h;
  }
  if (equalities > 0) add_equality_rows(), differentiate_equality_rates();
}

// impulse = J^T lambda, before J exists.
void StepJacobian::sum_impulses(double* impulse) const {
  std::fill_n(impulse, nv, 0.0);
  for (Index k = 0; k < contacts; ++k) {
    const JacobianContact& c = y.contacts[k];
    for_each_dof(c, y.twists, [&](Index j, const Motion<double>& S, const Motion<double>&, bool of_b) {
      impulse[user_dof(m, j)] += (of_b ? 1 : -1) * ratio(j) * dot(c.force, S.linear);
    });
  }
}

}  // namespace dyn::simulation
