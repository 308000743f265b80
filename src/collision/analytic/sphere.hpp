// A shape (A) and a sphere (B): the nearest point of A to the sphere's centre p. Orientations of spheres do not matter.
#pragma once

#include "collision/convex_pair.hpp"
#include "shape/convex.hpp"
#include "shape/sphere.hpp"

namespace dyn::collision {

template <class A>
inline Cores sphere_pair(const A& a, const Vec& p) {
  const shape::Nearest n = a.nearest(p);
  return {n.normal, n.point, p, n.distance, 0, 0, n.unique};
}
// p: from the centre of A to that of B; foot: point of A's core nearest to p
inline Cores point_sphere_pair(const Vec& foot, const Vec& p, const Vec& across) {
  const Vec r = p - foot;
  const double d = shape::norm(r);
  return d > 0 ? Cores{r * (1 / d), foot, p, d, 0, 0, true} : Cores{across, foot, p, 0, 0, 0, false};
}

// A hull has many faces: use GJK unless the centre is inside.
inline Cores sphere_pair(const shape::Convex& a, const shape::Sphere& b, const Vec& p, const Options& options) {
  Difference<shape::Convex, shape::Sphere> d(a, b, {Mat::identity(), p});
  d.limit(options.max_distance);
  const GjkResult g = gjk(d, a.hull.center - p, options, [](const GjkResult&) { return false; });
  if (g.beyond) return beyond(g.v * (-1 / g.norm), g.norm - g.gap);
  if (!g.apart || g.gap > wanted(d, options)) return sphere_pair(a, p);
  return {g.v * (-1 / g.norm), g.simplex.point_a(), p, g.norm, g.gap, g.iterations, true};
}

}  // namespace dyn::collision
