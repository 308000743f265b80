// From a contact point to the rows of a slot: the contact's frame has its normal as z, from A to B.
#include "dyn/constraint/rows.hpp"
#include "dyn/simulation/material.hpp"
#include "dyn/simulation/step.hpp"

namespace dyn::simulation {

namespace {

// Two unit vectors across n (Duff et al. 2017, "Building an orthonormal basis, revisited").
void across(const Vec3<double>& n, Vec3<double>& x, Vec3<double>& y) {
  const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
  x = Vec3<double>::make(1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]);
  y = Vec3<double>::make(b, sign + n[1] * n[1] * a, -n[1]);
}

Vec3<double> surface_velocity(const Data<double>& d, Index geom) { return d.geom_poses[geom].R * load3(d.step->materials[geom].surface_velocity); }

}  // namespace

void contact_slot(const Model& m, const Data<double>& d, Index contact, Slot<double>& s) {
  Workspace& w = *d.step;
  const dynContact& c = w.contacts[contact].contact;
  ContactLaw& law = w.laws[contact];
  const auto geom = [&](Index shape) { return Index(std::lower_bound(m.geoms(), m.geoms() + m.n.geoms, shape, [](const GeomRecord& g, Index s) { return g.shape < s; }) - m.geoms()); };
  const bool listed = c.pair >= 0;
  const Index a = listed ? m.pairs()[c.pair].a : geom(c.shape_a), b = listed ? m.pairs()[c.pair].b : geom(c.shape_b);
  const Index own = listed ? m.pairs()[c.pair].material() : 0;
  law.material = own ? m.materials()[own - 1] : combined(w.materials[a], w.materials[b]);
  law.rows = contact_rows(law.material);
  law.axes[2] = load3(c.normal);
  across(law.axes[2], law.axes[0], law.axes[1]);
  const Vec3<double> slip = surface_velocity(d, b) - surface_velocity(d, a);
  for (int k = 0; k < 2; ++k) law.slip[k] = dot(law.axes[k], slip);

  const Vec3<double> at = load3(c.position);
  s.c.type = DYN_CONSTRAINT_POINT;
  s.c.body1 = d.geoms[b].body, s.c.body2 = d.geoms[a].body;
  s.rows = law.rows;
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
}

}  // namespace dyn::simulation
