// Ray cast: the first collision shape that a ray hits.
#pragma once

#include "model/data.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

struct RayHit {
  double t;    // hit at origin + t direction; infinite: none
  Index geom;  // -1: none
  Vec normal;  // outward, in the world
};

// Uses d.geom_poses as they are (place_geoms). Tests geoms for which `counts(geom)` is true.
template <class Counts>
RayHit cast(const Model& m, const Data<double>& d, const Vec& origin, const Vec& direction, double far, Counts&& counts) {
  RayHit best = {far, -1, Vec::zero()};
  const double dd = dot(direction, direction);
  for (Index k = 0; k < m.n.geoms; ++k) {
    const Geom& g = d.geoms[k];
    const Pose& X = d.geom_poses[k];
    if (!counts(k)) continue;
    // skip if the bounding sphere is behind, beyond the best hit, or off the ray
    const Vec to = X.p - origin;
    const double along = dot(to, direction) / dd;
    const double past = dot(to, to) - along * along * dd, radius = g.bounding_radius * (1 + 1e-12);
    if (past > radius * radius + 1e-12 * dot(to, to) || (along < 0 && dot(to, to) > radius * radius)) continue;
    if ((along - best.t) * (along - best.t) * dd > radius * radius && along > best.t) continue;
    shape::visit(g.shape, [&](const auto& s) {
      const shape::Hit h = s.ray(X.act_inverse(origin), transpose_times(X.R, direction));
      if (h.t < best.t || (h.t == best.t && best.geom < 0 && h.t < shape::infinity)) best = {h.t, k, X.R * h.normal};
    });
  }
  if (best.geom < 0) best.t = shape::infinity;
  return best;
}

}  // namespace dyn::collision
