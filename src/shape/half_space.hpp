// All points below the plane z = 0 of its frame; the surface normal is +z. It has no support point and no volume.
#pragma once

#include "shape/shape.hpp"

namespace dyn::shape {

struct HalfSpace : Solid<HalfSpace> {
  static constexpr Type type = Type::HalfSpace;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_HALF_SPACE;
  double radius;

  explicit HalfSpace(const Shape& s) : radius(s.radius) {}

  Nearest nearest(const Vec& p) const { return {Vec::make(p[0], p[1], 0), axis(2), p[2], true}; }
  Flat flat(const Vec&) const { return {2, axis(0), axis(1)}; }
  double extent() const { return infinity; }
  Inertia<double> solid() const { return Inertia<double>::zero(); }

  // Bounded only if its normal is an axis of the world.
  Bounds bounds(const Pose& X) const {
    double lower[3] = {-infinity, -infinity, -infinity}, upper[3] = {infinity, infinity, infinity};
    for (int i = 0; i < 3; ++i) {
      if (X.R.z[i] == 1) upper[i] = X.p[i] + radius;
      if (X.R.z[i] == -1) lower[i] = X.p[i] - radius;
    }
    return {load3(lower), load3(upper)};
  }
  Hit ray(const Vec& origin, const Vec& direction) const {
    const double height = origin[2] - radius;
    if (height <= 0) return {0, axis(2)};
    if (direction[2] >= 0) return {infinity, Vec::zero()};
    return {-height / direction[2], axis(2)};
  }
};

}  // namespace dyn::shape
