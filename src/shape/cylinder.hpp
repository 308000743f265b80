// A cylinder about z: radius size.x, half length size.z.
#pragma once

#include "shape/revolution.hpp"

namespace dyn::shape {

struct Cylinder : Solid<Cylinder> {
  static constexpr Type type = Type::Cylinder;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_CYLINDER;
  static constexpr std::array size_names = {"radius", "length along z"};
  static constexpr FileForm mjcf = {"cylinder", {"size"}, {1, 0.5}}, urdf = {"cylinder", {"radius", "length"}};
  static void store(const double* size, Shape& out) { out.size = Vec::make(size[0], size[0], size[1] / 2); }
  static constexpr bool curved = true, has_faces = true, short_nearest = true;
  double r, half, radius;

  explicit Cylinder(const Shape& s) : r(s.size[0]), half(s.size[2]), radius(s.radius) {}

  Vec support(const Vec& d) const {
    return on_rim(d, r, std::copysign(half, d[2]));
  }
  Nearest nearest(const Vec& p) const {
    const Meridian m(p);
    const double side = r - m.rho, cap = half - std::abs(p[2]);
    if (side >= 0 && cap >= 0) {
      if (cap <= side)
        return {Vec::make(p[0], p[1], std::copysign(half, p[2])), axis(2) * std::copysign(1.0, p[2]), -cap,
                cap < side && p[2] != 0};
      return {m.point(r, p[2]), m.out, -side, m.rho > 0};
    }
    return m.outside(std::min(m.rho, r), std::clamp(p[2], -half, half));
  }
  Vec support_on_piece(const Vec& from, const Vec& n) const { return on_rim(n, r, from[2]); }
  CurvatureRadii curvature_radii(const Vec&, const Vec& n, const Vec& u, const Vec& v) const {
    return rim_curvature_radii(n, u, v, r);
  }
  Flat flat(const Vec& n) const {
    if (n[0] * n[0] + n[1] * n[1] <= flat_slope * flat_slope) return {2, axis(0), axis(1)};
    return {std::abs(n[2]) <= flat_slope, axis(2), Vec::zero()};
  }
  Face face(const Vec& n) const { return {std::abs(n[2]) > face_cosine, axis(2) * std::copysign(1.0, n[2])}; }
  bool under_face(const Vec&, const Vec& p) const { return p[0] * p[0] + p[1] * p[1] <= r * r; }
  // A cap, or the generatrix that faces n.
  void facing(const Vec& n, double, Feature& f) const {
    if (n[2] * n[2] >= n[0] * n[0] + n[1] * n[1]) return f.add_rim(n, r, std::copysign(half, n[2]), n[2] > 0 ? 0 : Feature::rim);
    f.add(on_rim(n, r, half), 2 * Feature::rim), f.add(on_rim(n, r, -half), 2 * Feature::rim + 1);
    f.curvature_radius = r;
  }
  double extent() const { return length2(r, half); }

  using Solid::bounds;
  Bounds bounds(const Mat& R) const {
    const Vec h = sizes(R.z) * half + rim_half_extents(R.z) * r;
    return {-h, h};
  }
  Inertia<double> solid() const {
    const Side side = {r, -half, r, half};
    return revolve(side, radius);
  }
};

}  // namespace dyn::shape
