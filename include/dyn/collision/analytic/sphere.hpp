// A shape (A) against a sphere (B): the point of A nearest to the sphere's centre.
#pragma once

#include "dyn/collision/convex_pair.hpp"
#include "dyn/shape/convex.hpp"
#include "dyn/shape/sphere.hpp"

namespace dyn::collision {

template <class A>
inline Cores sphere_pair(const A& a, const shape::Sphere&, const Pose& X) {
  const shape::Nearest n = a.nearest(X.p);
  return {n.normal, n.point, X.p, n.distance, 0, 0, n.unique};
}

// A hull has many faces: GJK, unless the centre is inside.
inline Cores sphere_pair(const shape::Convex& a, const shape::Sphere& b, const Pose& X, const Options& options) {
  const Difference<shape::Convex, shape::Sphere> d(a, b, X);
  const GjkResult g = gjk(d, a.hull.center - X.p, options, [](const GjkResult&) { return false; });
  if (!g.apart || g.gap > wanted(d, options)) return sphere_pair(a, b, X);
  return {g.v * (-1 / g.norm), g.simplex.point_a(), X.p, g.norm, g.gap, g.iterations, true};
}

}  // namespace dyn::collision
