// Solids of revolution about z (cylinder, cone), in the half plane (rho, z) through a point.
#pragma once

#include "base/portable.hpp"
#include "shape/shape.hpp"

namespace dyn::shape {

// The half plane through p: distance rho from the axis, unit direction `out` away from it.
struct Meridian {
  double rho;
  Vec out, p;

  explicit Meridian(const Vec& p)
      : rho(length2(p[0], p[1])), out(rho > 0 ? Vec::make(p[0] / rho, p[1] / rho, 0) : axis(0)), p(p) {}
  Vec point(double r, double z) const { return out * r + axis(2) * z; }
  // Result for p outside, where (r, z) is the nearest point.
  Nearest outside(double r, double z) const {
    const double dr = rho - r, dz = p[2] - z, d = length2(dr, dz);
    return {point(r, z), out * (dr / d) + axis(2) * (dz / d), d, true};
  }
};

// Support point of a circle of radius r at height z.
inline Vec on_rim(const Vec& n, double r, double z) {
  const double rho = length2(n[0], n[1]), scale = r / rho;
  return rho > 0 ? Vec::make(n[0] * scale, n[1] * scale, z) : Vec::make(r, 0, z);
}

// Derivative of on_rim: one radius of curvature r / |(n_x, n_y)|, along the circle.
DYN_INLINE CurvatureRadii rim_curvature_radii(const Vec& n, const Vec& u, const Vec& v, double r) {
  const double rho2 = n[0] * n[0] + n[1] * n[1];
  if (rho2 == 0) return {0, 0, 0};
  // components along the tangent, times rho
  const double tu = n[0] * u[1] - n[1] * u[0], tv = n[0] * v[1] - n[1] * v[0], scale = r / (rho2 * std::sqrt(rho2));
  return {scale * tu * tu, scale * tu * tv, scale * tv * tv};
}

// Half extents of a unit circle about z along the world's axes; z is given in the world.
inline Vec rim_half_extents(const Vec& z) {
  auto half_extent = [](double c) { return std::sqrt(std::max(0.0, 1 - c * c)); };
  return Vec::make(half_extent(z[0]), half_extent(z[1]), half_extent(z[2]));
}

// A straight generatrix from (r0, z0) up to (r1, z1).
struct Side {
  double r0, z0, r1, z1;
};

// Moments at density 1 of the solid of revolution of the side, closed by flat discs and rounded by `radius`:
//   m = pi int r^2 dz,  first moment pi int r^2 z dz,  int x^2 = int y^2 = pi/4 int r^4 dz,  int z^2 = pi int r^2 z^2 dz
// The meridian is an arc about each end of the side and the side itself, offset by the radius. Eight Gauss points are exact on
// the side (polynomials). On a quarter of an arc (trigonometric polynomials of degree 5) they are exact to the last digits.
inline Inertia<double> revolve(const Side& side, double radius) {
  static constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  static constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  constexpr double pi = 3.14159265358979324;
  double m = 0, mz = 0, rr = 0, zz = 0;
  // curve(s, r, z, dz) for s in [-1, 1]
  auto along = [&](auto&& curve) {
    for (int i = 0; i < 8; ++i) {
      double r, z, dz;
      curve(i < 4 ? x[i] : -x[i - 4], r, z, dz);
      const double dm = pi * r * r * dz * w[i % 4];
      m += dm, mz += dm * z, zz += dm * z * z, rr += dm * r * r / 4;
    }
  };
  const double length = length2(side.r1 - side.r0, side.z1 - side.z0);
  const double nr = (side.z1 - side.z0) / length, nz = (side.r0 - side.r1) / length, slope = math::atan2(nz, nr);
  along([&](double s, double& r, double& z, double& dz) {
    const double t = (1 + s) / 2;
    r = side.r0 + t * (side.r1 - side.r0) + radius * nr, z = side.z0 + t * (side.z1 - side.z0) + radius * nz,
    dz = (side.z1 - side.z0) / 2;
  });
  auto arc = [&](double r0, double z0, double from, double to) {
    const double quarter = (to - from) / 4;
    for (int k = 0; k < 4; ++k)
      along([&](double s, double& r, double& z, double& dz) {
        const double a = from + quarter * (k + (1 + s) / 2);
        r = r0 + radius * math::cos(a), z = z0 + radius * math::sin(a), dz = radius * math::cos(a) * quarter / 2;
      });
  };
  if (radius > 0) arc(side.r0, side.z0, -pi / 2, slope), arc(side.r1, side.z1, slope, pi / 2);
  return {m, axis(2) * mz, Sym3<double>::diagonal(rr + zz, rr + zz, 2 * rr)};
}

}  // namespace dyn::shape
