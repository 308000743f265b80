#include "simulation/island.hpp"

#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/constrained/redundant_rows.hpp"

namespace dyn::simulation {

namespace {

// Speed at which a gap may close: exactly within the step.
// In steps that follow from an accuracy a closed gap may not close, and an open one may close freely (bounded by 10 max speed).
// In steps without a tolerance the gaps that the solver's residual leaves stay: closing them would be the next step's residual.
// Otherwise velocities would depend on gaps that are errors, and on the step. Hysteresis: an active contact opens at a larger
// gap.
double gap_bias(const Island& x, double gap, double rate, bool pressed) {
  if (x.w.closed_gap == 0) return pressed && gap <= x.slack ? 0 : std::max(0.0, gap) / x.h;
  const bool stays_closed = pressed && (gap <= x.w.reopen_gap || gap + x.h * rate <= x.w.closed_gap);
  return gap <= x.w.closed_gap || stays_closed ? 0 : tuning::free_closing * x.fast;
}

// Records by how far and how long a newly met contact passed closed_gap within the step.
void record_contact_overshoot(const Island& x, double gap, double before) {
  const double passed = std::min(x.w.closed_gap - gap, -before * x.h);
  if (passed > x.w.overshoot) x.w.overshoot = passed, x.w.overshoot_time = passed / -before;
}

// With gains: the acceleration that they ask for. Without: zero velocity; errors are removed by the position correction.
void fill_equality(const Island& x, const ConstraintInstance<double>& s) {
  const bool gains = s.c.stiffness > 0 || s.c.damping > 0;
  for (Index r = 0; r < s.rows; ++r) {
    const Index i = s.first + r;
    x.g[i] = s.dropped >> r & 1 ? 0 : s.rate[r];
    x.bias[i] = gains ? x.h * s.c.stiffness * s.error[r] - std::max(0.0, 1 - x.h * s.c.damping) * s.rate[r] : 0;
    x.lambda[i] = x.compliance[i] = x.v_minus[i] = 0;
  }
}

// PathForce as a soft row: l' + lambda / W = (h f + (h D + a) l'_0) / W, W = h^2 K + h D + a. Without any of them: friction.
void fill_path_force(const Island& x, const ActiveConstraint& a) {
  const Constraint& c = a.s->c;
  const Index i = a.s->first;
  const double kept = x.h * c.damping + c.armature, W = x.h * x.h * c.stiffness + kept;
  x.bias[i] = 0, x.lambda[i] = x.h * x.w.previous_limit_forces[a.index];
  if (!(W > 0)) return;
  x.compliance[i] = 1 / W;
  x.bias[i] = -(x.h * c.force + kept * path_rate(x.m, x.d, *a.s, x.v_before)) / W;
}

void fill_box(const Island& x, const ActiveConstraint& a, Index k) {
  const ConstraintInstance<double>& s = *a.s;
  const Index i = a.first;
  x.g[i] = s.rate[0], x.bias[i] = gap_bias(x, s.error[0], s.rate[0], false);
  x.lower[k] = s.lower[0], x.upper[k] = s.upper[0];
  x.compliance[i] = x.v_minus[i] = 0;
  if (s.c.type != DYN_CONSTRAINT_TYPE_LIMIT && of_path(s.c)) return fill_path_force(x, a);
  if (x.w.closed_gap > 0 && s.c.type == DYN_CONSTRAINT_TYPE_LIMIT)
    record_contact_overshoot(x, s.error[0], box_rate(x.m, x.d, s, x.v_before));
  x.lambda[i] = a.index < 0 ? 0 : x.h * std::max(0.0, s.g1 * x.w.previous_limit_forces[a.index]);
}

// At the beginning of the step.
Motion<double> velocity(const Island& x, Index body) {
  return body_motion(x.m, x.d, body, x.v_before, static_cast<const double*>(nullptr)).V;
}

// Normal velocity at the beginning of the step and its change by the step's own acceleration.
// If the world supports the island, the change is the sum over both bodies; otherwise that of their relative motion.
struct Approach {
  double before, gained;
};
Approach approach(const Island& x, const ActiveConstraint& slot, Index normal) {
  using Six = SixEights<double>;
  const ConstraintInstance<double>& s = contact_wrenches(x.m, x.d, slot);
  const auto along = [&](const double* F, const Motion<double>& V) { return Six::load(F).dot(V)[int(normal)]; };
  const double first = along(s.F1, velocity(x, s.c.body1)), second = along(s.F2, velocity(x, s.c.body2));
  const double by_first = along(s.F1, x.w.root_velocity[s.c.body1]) - first,
               by_second = along(s.F2, x.w.root_velocity[s.c.body2]) - second;
  return {first + second, x.supported ? std::abs(by_first) + std::abs(by_second) : std::abs(by_first + by_second)};
}

// Rolling bodies with an error in the gap lose or gain distance at the rate at which they turn. Overlaps are no such errors: what
// opened them at their own rate would turn bodies ever faster.
double rolling_gap_rate(const Island& x, const ContactLaw& law, double gap) {
  if (x.w.closed_gap == 0) return 0;
  const collision::Geom &a = x.d.geoms[law.geom_a], &b = x.d.geoms[law.geom_b];
  const auto turns = [&](Index body) {
    const Vec3<double> w = velocity(x, body).angular;
    return std::sqrt(dot(w, w));
  };
  const double most = tuning::search::near * std::min(a.bounding_radius, b.bounding_radius);
  return std::max(gap, -most) * (turns(b.body) + turns(a.body));
}

void fill_contact(Island& x, const ActiveConstraint& slot, Index k) {
  const dynContactForce& f = x.w.contacts[slot.index];
  const ContactLaw& law = x.w.laws[slot.index];
  const dynMaterial& material = law.material;
  const double gap = f.contact.distance;
  x.friction[k] = material.friction, x.torsion[k] = material.torsion, x.rolling[k] = material.rolling, x.restitution[k] = 0;
  for (Index r = 0; r < slot.rows; ++r) {
    const Index i = slot.first + r;
    x.g[i] = law.rate[r] + (r < 2 && slot.rows > 1 ? law.slip[r] : 0);
    x.lambda[i] = x.h * dot(law.axis(r), load3(r < 3 ? f.force_on_b : f.moment_on_b));
    x.bias[i] = x.compliance[i] = x.v_minus[i] = 0;
  }
  const Index normal = normal_row(slot.rows), n = slot.first + normal;
  const bool pressed = is_active(f);
  x.bias[n] = gap_bias(x, gap, law.rate[normal], pressed) + rolling_gap_rate(x, law, gap);
  if (is_soft(material)) {
    const double total = x.h * material.stiffness + material.damping;
    x.compliance[n] = 1 / (x.h * total),
    x.bias[n] = gap > 0 ? gap / x.h : material.stiffness * gap / total;  // the damper acts only while shapes touch
  } else if (material.restitution > 0 && (x.w.closed_gap > 0 ? gap <= x.w.closed_gap : gap + x.h * law.rate[normal] <= 0)) {
    const auto [before, gained] = approach(x, slot, normal);
    // slower approach is rest, not an impact: gravity in one step makes it, or it would not rebound above closed_gap
    const double least = x.w.closed_gap > 0 ? std::max(x.w.closed_gap, std::sqrt(2 * x.w.closed_gap * gained / x.h))
                                              : std::min(2 * gained, tuning::island::impact_speed * slow_speed(x.d, x.h));
    if (before < -least)
      x.restitution[k] = material.restitution, x.v_minus[n] = before, x.bias[n] = 0, x.bounces = true;
  }
  if (x.w.closed_gap > 0 && !pressed && !is_soft(material)) record_contact_overshoot(x, gap, approach(x, slot, normal).before);
  x.w.report.penetration = std::max(x.w.report.penetration, -gap);
}

}  // namespace

void Island::assign_rows() {
  for (Index k = 0; k < constraint_count; ++k) {
    ActiveConstraint& x = constraint(k);
    x.first = rows, rows += x.rows;
    if (x.s) x.s->first = x.first;
    supported = supported || (std::min(x.tree1, x.tree2) < 0 && !(x.s && between_joints(x.s->c.type)));
    if (x.kind == RowKind::Equality) equalities += x.rows;
    else if (x.kind == RowKind::Box) ++boxes;
    else w.contact_rows[contacts++] = x.rows;
  }
}

void Island::fill() {
  if (!is_as_file()) [[likely]] drop_redundant();
  if (is_exact()) tolerance = w.has_tolerance() ? w.tolerance() : tuning::island::fine;
  if (!is_exact()) slack = tuning::island::slack * shape::norm(load3(d.world_gravity)) * h * h;
  for (Index k = 0; k < constraint_count && w.closed_gap > 0; ++k)
    for (Index r = 0; r < constraint(k).rows; ++r) fast = std::max(fast, std::abs(rates_of(w, constraint(k))[r]));
  for (Index k = 0, in_boxes = 0, in_contacts = 0; k < constraint_count; ++k) {
    const ActiveConstraint& x = constraint(k);
    if (x.kind == RowKind::Equality) fill_equality(*this, *x.s);
    else if (x.kind == RowKind::Box) fill_box(*this, x, in_boxes++);
    else fill_contact(*this, x, in_contacts++);
  }
  if (is_as_file()) [[unlikely]] fill_as_file();
  enough = w.has_tolerance() || contacts == 0 ? tolerance : tuning::island::tolerance;
  if (bounces) tolerance = enough = std::min(tolerance, tuning::island::fine);  // else impacts may gain energy
}

// Impulses that stopped small motion in the step before are wrong once the bodies stand: accepted as a guess, they would set them
// in motion again, to be stopped in the next step, and so on.
double Island::wanted(double residual, double usual) const {
  using namespace tuning::island;
  if (!(residual <= usual && residual > solver::tuning::round_off)) return usual;
  const double slow = standing * residual * fastest;
  for (Index k = 0; k < constraint_count; ++k) {
    const Index* const support = rows_of(k).support;
    for (Index n = 0; n < constraint(k).support_count; ++n)
      if (!(std::abs(v_before[support[n]]) * (is_length(m, support[n]) ? 1 : w.length) < slow)) return usual;
  }
  return gain * residual;
}

// Leaves out rows of equalities that are redundant but for a misalignment, which would lock the mechanism.
void Island::drop_redundant() {
  Index count = 0;
  for (Index k = 0; k < constraint_count; ++k) {
    const ActiveConstraint& x = constraint(k);
    if (x.kind == RowKind::Equality && is_rigid_equality(x.s->c))
      d.equality_rows[count++] = {x.s, x.kept.support, const_cast<double*>(x.kept.Y)};
  }
  dropped = count > 0 && d.misalignment[0] > 0 ? drop_redundant_rows(m, d, count, d.misalignment[0]) : 0;
}

void Island::keep_all() {
  for (Index k = 0; dropped > 0 && k < constraint_count; ++k)
    if (constraint(k).s) constraint(k).s->dropped = 0;
}

void Island::clear_supporting_dofs() const {
  for (Index k = 0; k < constraint_count; ++k) {
    const Index* const support = rows_of(k).support;
    for (Index n = 0; n < constraint(k).support_count; ++n) by_dof[support[n]] = 0;
  }
}

// by_dof += Y^T lambda
void Island::scatter_all() const {
  for (Index k = 0; k < constraint_count; ++k) scatter(constraint(k), lambda + constraint(k).first);
}

}  // namespace dyn::simulation
