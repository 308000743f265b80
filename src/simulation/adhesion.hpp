// Moment arms of actuators that pull a link to what it touches: the mean over its contacts of the normal that points away from
// the link.
#pragma once

#include "algorithm/actuators.hpp"
#include "collision/bounding_sphere.hpp"
#include "collision/manifold.hpp"
#include "collision/pairs.hpp"
#include "collision/surface_distance.hpp"
#include "simulation/workspace.hpp"

namespace dyn::simulation {

// Calls f(contact points of two shapes) of the tested pairs of a link that touch. geom_poses must be known.
template <class F>
void for_each_touched(const Model& m, const Data<double>& d, Index link, F&& f) {
  collision::Workspace workspace;
  const double touching = tuning::slop * d.step->length;
  collision::Options near;
  near.max_distance = touching;
  const auto look = [&](Index a, Index b) {
    const auto on = [&](Index geom) { return m.shapes()[m.geoms()[geom].shape].frame == link; };
    if (!on(a) && !on(b)) return;
    const collision::Geom &A = d.geoms[a], &B = d.geoms[b];
    if (collision::distance_lower_bound(A, d.geom_poses[a], B, d.geom_poses[b]) > touching) return;
    const collision::Result r = collision::distance(A.shape, d.geom_poses[a], B.shape, d.geom_poses[b], workspace, near);
    if (!(r.distance <= touching)) return;
    collision::Manifold out;
    if (collision::is_surface(A.shape.type) || collision::is_surface(B.shape.type)) {
      out.normal = r.normal, out.count = 1, out.points[0].position = (r.point_a + r.point_b) * 0.5;
    } else {
      collision::contacts(A.shape, d.geom_poses[a], B.shape, d.geom_poses[b], touching, workspace, out);
    }
    f(a, b, out);
  };
  for (Index k = 0; k < m.n.pairs; ++k)
    if (d.pair_states[k] == DYN_PAIR_REASON_TESTED) look(m.pairs()[k].a, m.pairs()[k].b);
  for (Index a = 0; !lists_pairs(m) && a < m.n.geoms; ++a)
    for (Index b = a + 1; b < m.n.geoms; ++b) {
      const Index one = d.geoms[a].body, two = d.geoms[b].body;
      const bool related = one == two || m.bodies()[one].parent == two || m.bodies()[two].parent == one;
      if (!related && masks_allow(d.geom_masks[a], d.geom_masks[b])) look(a, b);
    }
}

inline void measure_adhesion(const Model& m, Data<double>& d, Index path, Index link) {
  const PathRecord& p = m.paths()[path];
  const Index* const dofs = m.path_dofs() + p.first_dof;
  for (Index i = 0; i < p.dofs; ++i) d.path_row[dofs[i]] = 0;
  Index count = 0;
  for_each_touched(m, d, link, [&](Index a, Index b, const collision::Manifold& out) {
    for (int i = 0; i < out.count; ++i, ++count) {
      const Vec3<double> x = out.points[i].position;
      add_pair(m, d, out.normal, Vec3<double>::zero(), PathPoint<double>{x, d.geoms[a].body},
               PathPoint<double>{x, d.geoms[b].body}, d.path_row);
    }
  });
  for (Index i = 0; i < p.dofs; ++i) d.path_moment[p.first_dof + i] = count > 0 ? d.path_row[dofs[i]] / count : 0;
}

inline void measure_adhesions(const Model& m, Data<double>& d) {
  if (m.n.adhesions == 0 || m.n.geoms == 0) return;
  collision::place_geoms(m, d);
  for (Index k = 0; k < m.n.actuators; ++k)
    if (const ActuatorRecord& r = m.actuators()[k]; r.spec.transmission == DYN_TRANSMISSION_BODY)
      measure_adhesion(m, d, r.path, r.spec.frame);
}

}  // namespace dyn::simulation
