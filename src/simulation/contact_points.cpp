// Which contact points a step may meet.
#include <utility>

#include "dyn/collision/cull.hpp"
#include "dyn/collision/pair_contacts.hpp"
#include "dyn/simulation/step.hpp"

namespace dyn::simulation {

namespace {

using collision::Geom;
using collision::Manifold;
using collision::Pose;

// No point of the shape is faster.
double fastest(const Data<double>& d, Index geom) {
  const Geom& g = d.geoms[geom];
  if (g.body == 0) return 0;
  const Vec3<double> u = velocity_at(d, g.body, d.geom_poses[geom].p), &w = d.step->root_velocity[g.body].angular;
  const double reach = g.reach < shape::infinity ? g.reach : 0;
  return shape::norm(u) + shape::norm(w) * reach;
}

// Lists by pairs, then by features.
bool before(const dynContact& a, const dynContact& b) { return a.pair != b.pair ? a.pair < b.pair : a.feature < b.feature; }

// Appends; beyond the room the shallowest goes.
void append(const Model& m, Workspace& w, const dynContact& c) {
  if (w.contact_count == m.n.contacts) {
    ++w.report.dropped;
    Index shallowest = 0;
    for (Index k = 1; k < w.contact_count; ++k)
      if (w.contacts[k].contact.distance > w.contacts[shallowest].contact.distance) shallowest = k;
    if (!(c.distance < w.contacts[shallowest].contact.distance)) return;
    std::copy(w.contacts + shallowest + 1, w.contacts + w.contact_count, w.contacts + shallowest);
    --w.contact_count;
  }
  dynContactForce& f = w.contacts[w.contact_count++];
  f = {};
  f.contact = c;
}

// What the same contact exerted in the step before is the guess.
void carry_over(Workspace& w) {
  Index k = 0;
  for (Index i = 0; i < w.contact_count; ++i) {
    dynContactForce& f = w.contacts[i];
    while (k < w.before_count && before(w.before[k].contact, f.contact)) ++k;
    if (k == w.before_count || before(f.contact, w.before[k].contact)) continue;
    std::copy_n(w.before[k].force_on_b, 3, f.force_on_b), std::copy_n(w.before[k].moment_on_b, 3, f.moment_on_b);
  }
}

// The ball that a body's points at a distance of `reach` from it stay in: chains of revolute and spherical joints keep their lengths.
struct Ball {
  Vec3<double> center;
  double radius;
};
Ball within(const Model& m, const Data<double>& d, Index geom) {
  const Geom& g = d.geoms[geom];
  if (g.body == 0) return {g.X.p, g.reach};
  double radius = shape::norm(g.X.p) + g.reach;
  for (Index i = g.body;; i = m.bodies()[i].parent) {
    const Body& b = m.bodies()[i];
    if (b.type != BodyType::Revolute && b.type != BodyType::RevoluteUnbounded && b.type != BodyType::Spherical) return {d.p[i], shape::infinity};
    if (b.parent == 0) return {d.p[i], radius};
    radius += shape::norm(d.p[i] - d.p[b.parent]);
  }
}

// Pairs that are tested and can ever meet, and their shapes.
void find_pairs(const Model& m, const Data<double>& d) {
  Workspace& w = *d.step;
  w.pair_count = w.geom_count = 0;
  std::fill_n(w.speeds, m.n.geoms, 0.0);
  for (Index k = 0; k < m.n.pairs; ++k) {
    if (d.pair_states[k] != DYN_PAIR_TESTED) continue;
    const Index a = m.pairs()[k].a, b = m.pairs()[k].b;
    const Ball A = within(m, d, a), B = within(m, d, b);
    const double near = 0.02 * std::min(d.geoms[a].reach, d.geoms[b].reach);
    if (!(shape::norm(A.center - B.center) * (1 - 1e-9) > A.radius + B.radius + near)) w.pairs[w.pair_count++] = k, w.speeds[a] = w.speeds[b] = 1;
  }
  for (Index k = 0; k < m.n.geoms; ++k)
    if (w.speeds[k] > 0) w.geoms[w.geom_count++] = k;
}

}  // namespace

Index find_contacts(const Model& m, Data<double>& d, double h, double& between) {
  Workspace& w = *d.step;
  std::swap(w.contacts, w.before);
  w.before_count = w.contact_count, w.contact_count = 0;
  if (w.pair_count < 0) find_pairs(m, d);
  for (Index i = 0; i < w.geom_count; ++i) {
    const Index k = w.geoms[i];
    d.geom_poses[k] = SE3<double>{d.R[d.geoms[k].body], d.p[d.geoms[k].body]} * d.geoms[k].X;
    w.speeds[k] = fastest(d, k);
  }
  double fast = 0;
  for (Index i = 0; i < w.geom_count; ++i) fast = std::max(fast, w.speeds[w.geoms[i]]);
  const double most = within_reach(w, h, fast);
  Manifold found;
  between = shape::infinity;
  for (Index n = 0; n < w.pair_count; ++n) {
    const Index k = w.pairs[n];
    const Index ia = m.pairs()[k].a, ib = m.pairs()[k].b;
    const Geom &a = d.geoms[ia], &b = d.geoms[ib];
    const Pose &A = d.geom_poses[ia], &B = d.geom_poses[ib];
    // impulses of the step change velocities: shapes this near one another always count
    const double near = std::min(0.02 * std::min(a.reach, b.reach), most), margin = near + 1.5 * h * (w.speeds[ia] + w.speeds[ib]);
    if (!(near < shape::infinity)) continue;
    const double distance = collision::distance_at_least(a, A, b, B);
    between = std::min(between, distance - near);
    if (distance > margin) continue;
    collision::contacts(a.shape, A, b.shape, B, margin, *d.collision_workspace, found);
    for (int i = 0; i < found.count; ++i) {
      const auto& point = found.points[i];
      const double closing = dot(found.normal, velocity_at(d, b.body, point.position) - velocity_at(d, a.body, point.position));
      if (point.distance > near && point.distance + h * closing > 0) continue;
      dynContact c = collision::contact_of(found, i);
      c.pair = int(k), c.shape_a = int(m.geoms()[ia].shape), c.shape_b = int(m.geoms()[ib].shape);
      append(m, w, c);
    }
  }
  carry_over(w);
  return w.contact_count;
}

}  // namespace dyn::simulation
