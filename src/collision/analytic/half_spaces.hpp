// Two half-spaces. The distance is finite only if their planes are parallel and face each other; otherwise no translation
// separates them.
#pragma once

#include "collision/convex_pair.hpp"
#include "shape/half_space.hpp"

namespace dyn::collision {

inline Cores half_space_pair(const shape::HalfSpace&, const shape::HalfSpace&, const Pose& X) {
  const Vec n = shape::axis(2), m = X.R.z;
  const Vec foot = X.p - n * X.p[2];
  const bool facing = shape::norm(n + m) <= shape::flat_slope;
  return {n, foot, X.p, facing ? X.p[2] : -shape::infinity, 0, 0, false};
}

}  // namespace dyn::collision
