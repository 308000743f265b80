// Rejects pairs before the narrow phase by their bounding spheres about the shapes' origins, and by boxes.
#pragma once

#include "collision/geom.hpp"

namespace dyn::collision {

inline constexpr double bound_rounding = 1e-12;  // of the sizes: shapes that touch are not apart

// Distance from a point to a shape's rounded box.
inline double box_distance(const Geom& g, const Pose& X, const Vec& p) {
  const Vec at = transpose_times(X.R, p - X.p) - g.box_center;
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const double beyond = std::max(0.0, std::abs(at[i]) - g.box_half[i]);
    square += beyond * beyond;
  }
  return std::sqrt(square) - g.shape.radius;
}

// Lower bound of the distance of a shape from a half space.
inline double plane_distance(const Geom& plane, const Pose& P, const Geom& g, const Pose& X) {
  const Vec n = P.R.z;
  const double height = dot(n, X.p - P.p), rounding = bound_rounding * (std::abs(height) + g.bounding_radius);
  if (!g.has_box()) return height - plane.shape.radius - g.bounding_radius - rounding;
  const Vec own = transpose_times(X.R, n);
  double low = height + dot(own, g.box_center) - rounding;
  for (int i = 0; i < 3; ++i) low -= std::abs(own[i]) * g.box_half[i];
  return low - plane.shape.radius - g.shape.radius;
}

// Lower bound of the distance of two shapes, by their bounding spheres; of a half space by its plane.
inline double sphere_lower_bound(const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  const bool plane_a = a.shape.type == shape::Type::HalfSpace, plane_b = b.shape.type == shape::Type::HalfSpace;
  if (plane_a && plane_b) return -shape::infinity;
  if (plane_a) return plane_distance(a, A, b, B);
  if (plane_b) return plane_distance(b, B, a, A);
  const double between = shape::norm(A.p - B.p), reach = a.bounding_radius + b.bounding_radius;
  return between - reach - bound_rounding * (between + reach);
}

// The larger of a bound and that of the shapes' boxes, which walls and links fill better than spheres.
inline double by_boxes(double bound, const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  const double reach = a.bounding_radius + b.bounding_radius;
  if (!(reach < shape::infinity)) return bound;
  const auto beside = [&](const Geom& box, const Pose& X, const Geom& other, const Pose& at) {
    const double beyond = box_distance(box, X, at.p), low = beyond - other.bounding_radius - bound_rounding * (beyond + 2 * reach);
    if (low > 0) bound = std::max(bound, low);  // of points inside, boxes say nothing
  };
  if (a.has_box()) beside(a, A, b, B);
  if (b.has_box()) beside(b, B, a, A);
  return bound;
}

// Lower bound of the distance of two shapes, by all of these.
inline double distance_lower_bound(const Geom& a, const Pose& A, const Geom& b, const Pose& B) {
  return by_boxes(sphere_lower_bound(a, A, b, B), a, A, b, B);
}

}  // namespace dyn::collision
