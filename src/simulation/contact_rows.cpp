// Rows of a contact. Its frame has the normal, from A to B, as z.
#include "shape/material.hpp"
#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

// Two tangents of n (Duff et al. 2017, "Building an orthonormal basis, revisited").
void across(const Vec3<double>& n, Vec3<double>& x, Vec3<double>& y) {
  const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
  x = Vec3<double>::make(1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]);
  y = Vec3<double>::make(b, sign + n[1] * n[1] * a, -n[1]);
}

// Free normal velocity; positive: the contact opens.
double opening_speed(const Data<double>& d, const dynContact& c, Index a, Index b) {
  const Vec3<double> at = load3(c.position);
  return dot(load3(c.normal), velocity_at(d, b, at) - velocity_at(d, a, at));
}

// Closing distance per step below which a touching contact gets no impulse. It absorbs what tolerances left of earlier impulses.
// Drift is bounded: a contact becomes active when it overlaps by more than `slop`.
double standstill(const Data<double>& d, double reach, double h) {
  const double g = shape::norm(load3(d.world_gravity));
  return std::min(tuning::idle::closing * reach, g > 0 ? tuning::idle::fall * g * h * h : shape::infinity);
}

// Returns whether the contact needs no impulse: it is open at the end of the step, or touches and stays at rest.
bool is_idle(const Data<double>& d, const dynContact& c, const ContactLaw& law, double h) {
  const Workspace& w = *d.step;
  if (w.closed_gap > 0 || w.ledger.open || is_soft(law.material)) return false;
  const collision::Geom &a = d.geoms[law.geom_a], &b = d.geoms[law.geom_b];
  const double opening = h * opening_speed(d, c, a.body, b.body), gap = std::max(0.0, c.distance);
  if (c.distance + opening < -tuning::slop * w.length) return false;
  return law.material.restitution > 0 ? c.distance + opening > 0
                                      : gap + opening >= -standstill(d, std::min(a.bounding_radius, b.bounding_radius), h);
}

// Returns whether no impulse along the normal moves anything: joints let the bodies slide along one another only. Then an impulse
// from rounding would be one of any size.
bool has_immovable_normal(const Model& m, const Data<double>& d, const ActiveConstraint& x, const PropagatedRows& of) {
  using P = Simd<double, row_lanes>;
  const double* Dinv = inverse_pivots(m, d);
  P sum = P::zero();
  for (Index n = 0; n < x.support_count; ++n) {
    const P y = P::load(of.Y + row_lanes * n);
    sum = sum + y * y * Dinv[of.support[n]];
  }
  double most = 0;
  for (Index r = 0; r < std::min(x.rows, Index(3)); ++r) most = std::max(most, sum[int(r)]);
  return !(sum[int(normal_row(x.rows))] > tuning::immovable_normal * most);
}

}  // namespace

void init_contact(const Model& m, Data<double>& d, Index contact, double h) {
  Workspace& w = *d.step;
  const dynContact& c = w.contacts[contact].contact;
  ContactLaw& law = w.laws[contact];
  const bool listed = c.pair >= 0;
  const Index a = law.geom_a = listed ? m.pairs()[c.pair].a : collision::geom_of_shape(m, c.shape_a),
              b = law.geom_b = listed ? m.pairs()[c.pair].b : collision::geom_of_shape(m, c.shape_b);
  const Index own = listed ? m.pairs()[c.pair].material() : 0;
  law.material = own ? m.materials()[own - 1] : shape::combined(w.materials[a], w.materials[b]);
  law.rows = shape::contact_rows(law.material);
  law.idle = is_idle(d, c, law, h);
}

void fit_contact_rows(const Model& m, Data<double>& d) {
  Workspace& w = *d.step;
  Index rows = 0;
  for (Index k = 0; k < w.contact_count; ++k) rows += w.laws[k].rows;
  while (rows > contact_row_capacity(m)) {
    Index shallowest = 0;
    for (Index k = 1; k < w.contact_count; ++k)
      if (w.contacts[k].contact.distance > w.contacts[shallowest].contact.distance) shallowest = k;
    rows -= w.laws[shallowest].rows, ++w.report.dropped;
    std::copy(w.contacts + shallowest + 1, w.contacts + w.contact_count, w.contacts + shallowest);
    std::copy(w.laws + shallowest + 1, w.laws + w.contact_count, w.laws + shallowest);
    --w.contact_count;
  }
}

const ConstraintInstance<double>& contact_wrenches(const Model& m, Data<double>& d, const ActiveConstraint& x) {
  Workspace& w = *d.step;
  const ContactLaw& law = w.laws[x.index];
  ConstraintInstance<double>& s = w.instances[step_instances(m)];
  s.c.type = DYN_CONSTRAINT_TYPE_POINT, s.rows = law.rows;
  s.c.body1 = d.geoms[law.geom_b].body, s.c.body2 = d.geoms[law.geom_a].body;
  const Vec3<double> at = load3(w.contacts[x.index].contact.position);
  auto fill = [&](Index body, double sign, double* lanes) {
    std::fill_n(lanes, 6 * row_lanes, 0.0);
    if (!body) return;
    const Vec3<double> arm = at - (d.p[body] - d.rel[body]);
    for (Index k = 0; k < law.rows; ++k) {
      const Vec3<double> axis = law.axis(k) * sign;
      store_lane(k < 3 ? Force<double>{axis, cross(arm, axis)} : Force<double>{Vec3<double>::zero(), axis}, lanes, int(k));
    }
  };
  fill(s.c.body1, 1, s.F1), fill(s.c.body2, -1, s.F2);
  return s;
}

PropagatedRows propagate_anew(const Model& m, Data<double>& d, const ActiveConstraint& x, int slot) {
  Workspace& w = *d.step;
  const std::ptrdiff_t at = columns(m) + slot * std::ptrdiff_t(m.n.carriers);
  Index* const support = w.support + at;
  double* const Y = w.Y + row_lanes * at;
  if (!x.s) contact_wrenches(m, d, x);
  propagate_rows(m, d, x.s ? *x.s : w.instances[step_instances(m)], support, Y);
  return {support, Y};
}

void assemble_contact(const Model& m, Data<double>& d, ActiveConstraint& x) {
  Workspace& w = *d.step;
  const dynContact& c = w.contacts[x.index].contact;
  ContactLaw& law = w.laws[x.index];
  law.axes[2] = load3(c.normal);
  across(law.axes[2], law.axes[0], law.axes[1]);
  const Vec3<double> slip = surface_velocity(d, law.geom_b) - surface_velocity(d, law.geom_a);
  for (int k = 0; k < 2; ++k) law.slip[k] = dot(law.axes[k], slip);

  contact_wrenches(m, d, x);
  ConstraintInstance<double>& s = w.instances[step_instances(m)];
  using Six = SixEights<double>;
  (Six::load(s.F1).dot(w.root_velocity[s.c.body1]) + Six::load(s.F2).dot(w.root_velocity[s.c.body2])).store(law.rate);
  ensure_columns(m, d, s.c.body1), ensure_columns(m, d, s.c.body2);
  const Index before = w.stored;
  keep_rows(m, d, s, x);
  const PropagatedRows made{w.support + before, w.Y + row_lanes * std::ptrdiff_t(before)};
  if (has_immovable_normal(m, d, x, made)) x.support_count = 0, x.kept = made, w.stored = before;
}

}  // namespace dyn::simulation
