// Overlapping shapes whose depth is that of one point of a shape inside the other. The point's own depth bounds the depth of the
// shapes from below, and the heights of the two supports bound it from above. Where a corner, a rim or a face presses into a face
// or a smooth side, both are equal, and no search is needed.
#pragma once

#include "collision/any_core.hpp"
#include "collision/cores.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace detail {

// Support point along n; of several, the one nearest to a target.
template <class S>
DYN_INLINE Vec support_near(const S& s, const Vec& n, const Vec&) {
  return s.support(n);
}
DYN_INLINE Vec support_near(const shape::Box& s, const Vec& n, const Vec& target) {
  constexpr double flat = 1e-11;
  const Vec corner = shape::with_sign(s.half, n), size = sizes(n), inner = shape::greater(shape::lesser(target, s.half), -s.half);
  return Vec::make(size[0] > flat ? corner[0] : inner[0], size[1] > flat ? corner[1] : inner[1],
                   size[2] > flat ? corner[2] : inner[2]);
}
DYN_INLINE Vec support_near(const shape::Cylinder& s, const Vec& n, const Vec& target) {
  constexpr double flat = 1e-11;
  const double sine2 = n[0] * n[0] + n[1] * n[1], z = std::copysign(s.half, n[2]);
  if (sine2 <= flat * flat) {
    const double rho = shape::length2(target[0], target[1]), scale = rho > s.r ? s.r / rho : 1;
    return Vec::make(target[0] * scale, target[1] * scale, z);
  }
  const double scale = s.r / std::sqrt(sine2);
  return Vec::make(n[0] * scale, n[1] * scale, std::abs(n[2]) <= flat ? std::clamp(target[2], -s.half, s.half) : z);
}

template <bool is_curved>
Vec support_near(const AnyCore<is_curved>& s, const Vec& n, const Vec& target) {
  return s.template get<Vec>([&](const auto& x) { return support_near(x, n, target); });
}

struct DeepestPoint {
  Vec normal, point, on_solid;  // outward of the solid; in its frame
  double depth, residual;
  bool unique;
};

// X: pose of the other shape in the solid's frame, and Rt its transposed rotation; n: the first direction, outward of the solid.
// Returns false if the solid holds no such point.
template <class S, class O>
bool deepest_point(const S& solid, const O& other, const Pose& X, const Mat& Rt, Vec n, double enough, DeepestPoint& out) {
  const Vec target = -(Rt * X.p);  // the solid's origin in the other shape
  const auto point_along = [&](const Vec& m) { return X.act(support_near(other, Rt * -m, target)); };
  Vec b = point_along(n);
  for (int i = 0; i < 3; ++i) {
    const shape::Nearest near = solid.nearest(b);
    if (!(near.distance < 0) && i > 0) return false;
    n = near.normal;
    const Vec next = point_along(n);
    const double below = dot(n, b - next);
    if (below <= enough && near.distance < 0) {
      out = {n, b, near.point, -near.distance, std::max(below, 0.0), near.unique};
      return true;
    }
    b = next;
  }
  return false;
}

}  // namespace detail

// n: a direction from A to B. The heights may differ by rounding alone: the normal is uncertain by the root of their difference.
// Returns false if the depth is not that of a point, or the shapes are apart.
template <class D>
bool deepest_point_pair(const D& d, const Vec& n, Cores& c) {
  const double enough = d.rounding();
  detail::DeepestPoint found;
  if (d.A_.short_nearest && detail::deepest_point(d.A_, d.B_, d.X, d.Rt, n, enough, found)) {
    c = {found.normal, found.on_solid, found.point, -found.depth - found.residual, found.residual, 0, found.unique};
    return true;
  }
  if (d.B_.short_nearest && detail::deepest_point(d.B_, d.A_, {d.Rt, -(d.Rt * d.X.p)}, d.X.R, d.Rt * -n, enough, found)) {
    c = {d.X.R * -found.normal, d.X.act(found.point), d.X.act(found.on_solid), -found.depth - found.residual, found.residual,
         0, found.unique};
    return true;
  }
  return false;
}

}  // namespace dyn::collision
