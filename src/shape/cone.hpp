// A cone about z: base of radius size.x at z = -size.z, apex at z = +size.z.
#pragma once

#include "shape/revolution.hpp"

namespace dyn::shape {

struct Cone : Solid<Cone> {
  static constexpr Type type = Type::Cone;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_CONE;
  static constexpr std::array size_names = {"radius", "length along z"};
  static void store(const double* size, Shape& out) { out.size = Vec::make(size[0], size[0], size[1] / 2); }
  static constexpr bool curved = true, has_faces = true, short_nearest = true;
  double r, half, radius;

  explicit Cone(const Shape& s) : r(s.size[0]), half(s.size[2]), radius(s.radius) {}

  Vec support(const Vec& d) const {
    const double rho = length2(d[0], d[1]);
    if (2 * half * d[2] >= r * rho) return Vec::make(0, 0, half);
    return on_rim(d, r, -half);
  }
  Nearest nearest(const Vec& p) const {
    const Meridian m(p);
    const double slant = length2(r, 2 * half), nr = 2 * half / slant,
                 nz = r / slant;  // (nr, nz): normal of the side in the half plane
    const double side = nr * m.rho + nz * (p[2] - half), base = -half - p[2];
    if (side <= 0 && base <= 0) {
      if (base >= side) return {Vec::make(p[0], p[1], -half), -axis(2), base, base > side};
      return {m.point(m.rho - side * nr, p[2] - side * nz), m.out * nr + axis(2) * nz, side, m.rho > 0};
    }
    // nearest point on the side (s from the apex) and on the base
    const double s = std::clamp((m.rho * r + (half - p[2]) * 2 * half) / slant, 0.0, slant);
    const double rho_s = s * r / slant, z_s = half - s * 2 * half / slant, rho_b = std::min(m.rho, r);
    const bool on_side = length2(m.rho - rho_s, p[2] - z_s) <= length2(m.rho - rho_b, base);
    if (on_side && s > 0 && s < slant) return {m.point(rho_s, z_s), m.out * nr + axis(2) * nz, side, true};
    return on_side ? m.outside(rho_s, z_s) : m.outside(rho_b, -half);
  }
  Vec support_on_piece(const Vec& from, const Vec& n) const { return from[2] > 0 ? from : on_rim(n, r, -half); }
  CurvatureRadii curvature_radii(const Vec& from, const Vec& n, const Vec& u, const Vec& v) const {
    return from[2] > 0 ? CurvatureRadii{0, 0, 0} : rim_curvature_radii(n, u, v, r);
  }
  Flat flat(const Vec& n) const {
    const double rho = length2(n[0], n[1]), slant = length2(r, 2 * half);
    if (rho <= flat_slope) return {n[2] < 0 ? 2 : 0, axis(0), axis(1)};
    const bool side = std::abs(2 * half * n[2] - r * rho) <= flat_slope * slant;
    return {side, Vec::make(n[0] / rho * r, n[1] / rho * r, -2 * half) * (1 / slant), Vec::zero()};
  }
  Face face(const Vec& n) const { return {n[2] < -face_cosine, -axis(2)}; }
  bool under_face(const Vec&, const Vec& p) const { return p[0] * p[0] + p[1] * p[1] <= r * r; }
  // The base or the generatrix (apex to rim), whichever faces n more.
  void facing(const Vec& n, double, Feature& f) const {
    const double rho = length2(n[0], n[1]), slant = length2(r, 2 * half);
    if (-n[2] * slant >= 2 * half * rho + r * n[2]) return f.add_rim(n, r, -half, 0);
    f.add(axis(2) * half, Feature::rim);
    if (rho > flat_slope) f.add(on_rim(n, r, -half), Feature::rim + 1);
  }
  double extent() const { return length2(r, half); }

  using Solid::bounds;
  Bounds bounds(const Mat& R) const {
    const Vec apex = R.z * half, half_extent = rim_half_extents(R.z) * r;
    return {lesser(apex, -apex - half_extent), greater(apex, half_extent - apex)};
  }
  Inertia<double> solid() const {
    const Side side = {r, -half, 0, half};
    return revolve(side, radius);
  }
};

}  // namespace dyn::shape
