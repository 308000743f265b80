// A half-space (A) and a shape with support points (B): the deepest point below the plane.
#pragma once

#include "collision/convex_pair.hpp"
#include "shape/half_space.hpp"

namespace dyn::collision {

template <class B>
inline Cores half_space_pair(const shape::HalfSpace&, const B& b, const Pose& X, bool says_unique) {
  const Vec n = shape::axis(2), in_b = transpose_times(X.R, -n);
  const Vec deepest = X.act(b.support(in_b));
  const double height = deepest[2];
  return {n, deepest - n * height, deepest, height, 0, 0, says_unique && b.flat(in_b).dimension == 0};
}

}  // namespace dyn::collision
