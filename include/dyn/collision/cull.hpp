// Which pairs need no narrow phase: balls about the shapes' origins that are farther apart than asked.
#pragma once

#include "dyn/collision/geom.hpp"

namespace dyn::collision {

// A lower bound of the distance of two shapes.
inline double distance_at_least(const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  const bool plane_a = a.shape.type == shape::Type::HalfSpace, plane_b = b.shape.type == shape::Type::HalfSpace;
  if (plane_a && plane_b) return -shape::infinity;
  if (plane_a) return dot(A.R.z, B.p - A.p) - a.shape.radius - b.reach;
  if (plane_b) return dot(B.R.z, A.p - B.p) - b.shape.radius - a.reach;
  return shape::norm(A.p - B.p) - a.reach - b.reach;
}

}  // namespace dyn::collision
