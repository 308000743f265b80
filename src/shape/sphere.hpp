// A point, rounded by its radius.
#pragma once

#include "shape/shape.hpp"

namespace dyn::shape {

struct Sphere : Solid<Sphere> {
  static constexpr Type type = Type::Sphere;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_SPHERE;
  static constexpr std::array size_names = {"radius"};
  static constexpr FileForm mjcf = {"sphere", {"size"}}, urdf = {"sphere", {"radius"}};
  static void store(const double* size, Shape& out) { out.radius += size[0]; }
  double radius;

  explicit Sphere(const Shape& s) : radius(s.radius) {}

  Vec support(const Vec&) const { return Vec::zero(); }
  Nearest nearest(const Vec& p) const {
    const double d = norm(p);
    if (d == 0) return {Vec::zero(), axis(2), 0, false};
    return {Vec::zero(), p * (1 / d), d, true};
  }
  Flat flat(const Vec&) const { return {0, Vec::zero(), Vec::zero()}; }
  double extent() const { return 0; }

  using Solid::bounds;
  Bounds bounds(const Mat&) const { return {Vec::zero(), Vec::zero()}; }

  // |o + t d|^2 = r^2, by the root that does not cancel
  Hit ray(const Vec& o, const Vec& d) const {
    const double a = dot(d, d), b = dot(o, d), c = dot(o, o) - radius * radius;
    if (c <= 0) return {0, nearest(o).normal};
    const Vec closest = o - d * (b / a);
    const double h = radius * radius - dot(closest, closest);  // b^2 - a c over a
    if (b >= 0 || h < 0) return {infinity, Vec::zero()};
    const double t = c / (std::sqrt(h * a) - b);
    return {t, (o + d * t) * (1 / radius)};
  }
  Inertia<double> solid() const {
    const double m = 4.18879020478639098 * radius * radius * radius, I = 0.4 * m * radius * radius;  // 4/3 pi
    return {m, Vec::zero(), Sym3<double>::diagonal(I, I, I)};
  }
};

}  // namespace dyn::shape
