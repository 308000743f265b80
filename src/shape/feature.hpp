// The part of a core's boundary that faces a direction: what contact manifolds are cut from.
#pragma once

#include <cstdint>

#include "base/portable.hpp"
#include "spatial/vec3.hpp"

namespace dyn::shape {

// One corner: a point; two: a straight line; more: a flat face, its corners in order round it. Each corner has a number that it keeps
// when the shape moves.
struct Feature {
  static constexpr int most = 32;
  static constexpr int rim = 8;               // a circle is given by so many corners
  static constexpr double tilted = 1e-3;      // slope from which on one of them is the deepest; fixed to the shape where it lies flat

  int count = 0;
  double curvature_radii = 0;  // of a line: the radius of curvature of the surface across it
  Vec3<double> p[most];
  std::uint16_t id[most];

  void add(const Vec3<double>& x, int number) { p[count] = x, id[count++] = std::uint16_t(number); }
  // a circle about z of radius r at height z that faces n
  void add_rim(const Vec3<double>& n, double r, double z, int first) {
    constexpr double d = 0.70710678118654752;
    static constexpr double c[rim + 2] = {1, d, 0, -d, -1, -d, 0, d, 1, d};
    const double rho = math::hypot(n[0], n[1]);
    const bool turned = rho > tilted * std::abs(n[2]);  // else a coin would roll from corner to corner
    const double x = turned ? r * (n[0] / rho) : r, y = turned ? r * (n[1] / rho) : 0;
    for (int k = 0; k < rim; ++k) {
      const double cosine = c[k], sine = c[(k + 6) % rim];
      add(Vec3<double>::make(x * cosine - y * sine, x * sine + y * cosine, z), first + k);
    }
  }
};

}  // namespace dyn::shape
