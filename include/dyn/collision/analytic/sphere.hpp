// A shape (A) against a sphere (B): the point of A nearest to the sphere's centre.
#pragma once

#include "dyn/collision/convex_pair.hpp"
#include "dyn/shape/sphere.hpp"

namespace dyn::collision {

template <class A>
inline Cores sphere_pair(const A& a, const shape::Sphere&, const Pose& X) {
  const shape::Nearest n = a.nearest(X.p);
  return {n.normal, n.point, X.p, n.distance, 0, 0, n.unique};
}

}  // namespace dyn::collision
