// Rejects pairs before the narrow phase by their bounding spheres about the shapes' origins.
#pragma once

#include "collision/geom.hpp"

namespace dyn::collision {

// Distance from a point to a rounded box.
inline double box_distance(const Geom& box, const Pose& X, const Vec& p) {
  const Vec at = transpose_times(X.R, p - X.p);
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const double beyond = std::max(0.0, std::abs(at[i]) - box.shape.size[i]);
    square += beyond * beyond;
  }
  return std::sqrt(square) - box.shape.radius;
}

// Lower bound of the distance of two shapes.
inline double distance_lower_bound(const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  const bool plane_a = a.shape.type == shape::Type::HalfSpace, plane_b = b.shape.type == shape::Type::HalfSpace;
  if (plane_a && plane_b) return -shape::infinity;
  if (plane_a) return dot(A.R.z, B.p - A.p) - a.shape.radius - b.bounding_radius;
  if (plane_b) return dot(B.R.z, A.p - B.p) - b.shape.radius - a.bounding_radius;
  double distance = shape::norm(A.p - B.p) - a.bounding_radius - b.bounding_radius;
  // a wall fills little of its bounding sphere: use the box itself
  constexpr double large = 4;
  if (a.shape.type == shape::Type::Box && a.bounding_radius > large * b.bounding_radius)
    distance = std::max(distance, box_distance(a, A, B.p) - b.bounding_radius);
  if (b.shape.type == shape::Type::Box && b.bounding_radius > large * a.bounding_radius)
    distance = std::max(distance, box_distance(b, B, A.p) - a.bounding_radius);
  return distance;
}

}  // namespace dyn::collision
