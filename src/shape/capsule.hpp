// A segment along z from -size.z to +size.z, rounded by its radius.
#pragma once

#include "shape/shape.hpp"

namespace dyn::shape {

struct Capsule : Solid<Capsule> {
  static constexpr Type type = Type::Capsule;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_CAPSULE;
  static constexpr std::array size_names = {"radius", "length along z between the caps"};
  static constexpr FileForm mjcf = {"capsule", {"size"}, {1, 0.5}}, urdf = {"capsule", {"radius", "length"}, {1, 1}, false};
  static void store(const double* size, Shape& out) { out.size = Vec::make(0, 0, size[1] / 2), out.radius += size[0]; }
  double half, radius;

  explicit Capsule(const Shape& s) : half(s.size[2]), radius(s.radius) {}

  Vec support(const Vec& d) const { return Vec::make(0, 0, std::copysign(half, d[2])); }
  Nearest nearest(const Vec& p) const {
    const Vec c = Vec::make(0, 0, std::clamp(p[2], -half, half)), r = p - c;
    const double d = norm(r);
    if (d == 0) return {c, axis(0), 0, false};
    return {c, r * (1 / d), d, true};
  }
  Flat flat(const Vec& n) const { return {half > 0 && std::abs(n[2]) <= flat_slope, axis(2), Vec::zero()}; }
  void facing(const Vec&, double, Feature& f) const {
    f.add(Vec::make(0, 0, half), 0);
    if (half > 0) f.add(Vec::make(0, 0, -half), 1);
  }
  double extent() const { return half; }

  using Solid::bounds;
  Bounds bounds(const Mat& R) const {
    const Vec h = sizes(R.z) * half;
    return {-h, h};
  }
  // a cylinder and two half balls
  Inertia<double> solid() const {
    const double r2 = radius * radius, cylinder = 6.28318530717958648 * r2 * half, ball = 4.18879020478639098 * r2 * radius;
    const double across = cylinder * (r2 / 4 + half * half / 3) + ball * (r2 * 0.4 + half * half + 0.75 * half * radius);
    return {cylinder + ball, Vec::zero(), Sym3<double>::diagonal(across, across, cylinder * r2 / 2 + ball * r2 * 0.4)};
  }
};

}  // namespace dyn::shape
