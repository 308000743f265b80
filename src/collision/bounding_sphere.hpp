// Which pairs need no narrow phase: balls about the shapes' origins that are farther apart than asked.
#pragma once

#include "collision/geom.hpp"

namespace dyn::collision {

// Of a point to a box.
inline double box_distance(const Geom& box, const Pose& X, const Vec& p) {
  const Vec at = transpose_times(X.R, p - X.p);
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const double beyond = std::max(0.0, std::abs(at[i]) - box.shape.size[i]);
    square += beyond * beyond;
  }
  return std::sqrt(square) - box.shape.radius;
}

// A lower bound of the distance of two shapes.
inline double distance_at_least(const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  const bool plane_a = a.shape.type == shape::Type::HalfSpace, plane_b = b.shape.type == shape::Type::HalfSpace;
  if (plane_a && plane_b) return -shape::infinity;
  if (plane_a) return dot(A.R.z, B.p - A.p) - a.shape.radius - b.reach;
  if (plane_b) return dot(B.R.z, A.p - B.p) - b.shape.radius - a.reach;
  double distance = shape::norm(A.p - B.p) - a.reach - b.reach;
  // walls fill little of their balls
  constexpr double large = 4;
  if (a.shape.type == shape::Type::Box && a.reach > large * b.reach) distance = std::max(distance, box_distance(a, A, B.p) - b.reach);
  if (b.shape.type == shape::Type::Box && b.reach > large * a.reach) distance = std::max(distance, box_distance(b, B, A.p) - a.reach);
  return distance;
}

}  // namespace dyn::collision
