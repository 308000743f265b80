// Gap of two convex shapes along one direction: a lower bound of their distance, for the price of two support points.
#pragma once

#include "shape/list.hpp"

namespace dyn::collision {

// Whether gap_along knows the shape: it is convex and bounded.
inline bool has_support(shape::Type t) { return t != shape::Type::HalfSpace && t < shape::Type::Triangles; }

// Height of the rounded shape along a direction of the world, from its origin.
inline double height_along(const shape::Shape& s, const shape::Pose& X, const shape::Vec& n) {
  const shape::Vec own = transpose_times(X.R, n);
  double height = shape::infinity;
  shape::visit(s, [&]<class S>(const S& x) {
    if constexpr (requires { x.support(own); } && S::type != shape::Type::HalfSpace) height = dot(own, x.support(own)) + x.radius;
  });
  return height;
}

// n: unit, in the world, from A to B. Less than the exact gap by more than rounding.
inline double gap_along(const shape::Shape& a, const shape::Pose& A, const shape::Shape& b, const shape::Pose& B,
                        const shape::Vec& n) {
  const double between = dot(n, B.p - A.p), of_a = height_along(a, A, n), of_b = height_along(b, B, -n);
  return between - of_a - of_b - 1e-12 * (std::abs(between) + std::abs(of_a) + std::abs(of_b));
}

}  // namespace dyn::collision
