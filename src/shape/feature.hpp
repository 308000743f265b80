// The part of a core's boundary that faces a direction. Contact manifolds are cut from features.
#pragma once

#include <cstdint>

#include "base/portable.hpp"
#include "spatial/vec3.hpp"

namespace dyn::shape {

// One corner: a point; two: a line; more: a flat face with its corners in order. Each corner keeps its number while the shape
// moves.
struct Feature {
  static constexpr int most = 32;
  static constexpr int rim = 8;               // corners that represent a circle
  static constexpr double diagonal = 0.70710678118654752;  // cosine between neighbours on the rim
  static constexpr double tilted = 1e-3;      // above this slope one corner is the deepest; below, corners are fixed to the shape

  int count = 0;
  double curvature_radius = 0;  // of a line: radius of curvature of the surface across it, m; 0: it differs along the line
  Vec3<double> p[most];
  std::uint16_t id[most];

  void add(const Vec3<double>& x, int number) { p[count] = x, id[count++] = std::uint16_t(number); }
  // Circle about z of radius r at height z.
  void add_rim(const Vec3<double>& n, double r, double z, int first) {
    constexpr double d = diagonal;
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
