// The smoothed projection onto a cone that is its own dual, and its derivatives, also where nothing moves along the surface.
#include "solver/smoothed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/simd.hpp"

namespace dyn::solver {
namespace {

constexpr int rows = 3;
using Lanes = Simd<double, 4>;

struct Vector {
  double x[rows];
};

// normal, and along the surface
Vector value(const Smoothed& smooth, const Vector& z) {
  const auto p = smooth.cone<rows>(z.x);
  return {{p.normal, p.along * p.direction[0], p.along * p.direction[1]}};
}

// Column j of the derivative.
Vector derivative(const Smoothed& smooth, const Vector& z, int j) {
  const auto p = smooth.cone<rows>(z.x);
  const double* const d = p.direction;
  if (j == 0) return {{p.own, p.mixed * d[0], p.mixed * d[1]}};
  Vector out{{p.mixed * d[j - 1], 0, 0}};
  for (int i = 1; i < rows; ++i) out.x[i] = (i == j) * p.across + (p.own - p.across) * d[i - 1] * d[j - 1];
  return out;
}

// Inside, outside, on the surface, on the axis, at the apex; rounding alone along the surface.
std::vector<Vector> points() {
  std::vector<Vector> out{{{0, 0, 0}}, {{1, 0, 0}}, {{-1, 0, 0}}, {{-1e6, 0, 0}}, {{1e-9, 0, 0}}, {{-1, 1e-20, 0}}, {{-1, 0, -1e-12}},
                          {{2, 1e-17, 1e-17}}, {{1, 0.6, -0.8}}, {{-1, 0.6, 0.8}}, {{0, 1e-8, 0}}};
  std::mt19937 random(7);
  std::normal_distribution<double> draw;
  for (int k = 0; k < 50; ++k) out.push_back({{draw(random), draw(random), draw(random)}});
  return out;
}

// g(z) - g(-z) = z, so P(z) - P(-z) = z. Both lie in the cone.
TEST(Smoothed, WhatIsProjectedIsTheDifferenceOfTwoProjections) {
  for (const double eps : {1e-12, 1e-3, 0.5})
    for (const Vector& z : points()) {
      const Smoothed smooth{eps};
      const Vector up = value(smooth, z), down = value(smooth, {{-z.x[0], -z.x[1], -z.x[2]}});
      const double size = std::abs(z.x[0]) + std::hypot(z.x[1], z.x[2]) + eps;
      for (int i = 0; i < rows; ++i) EXPECT_NEAR(up.x[i] - down.x[i], z.x[i], 1e-14 * size) << eps << " " << z.x[0] << " " << z.x[1];
      EXPECT_LE(std::hypot(up.x[1], up.x[2]), up.x[0] + 1e-14 * size);
    }
}

// Central differences of h err by about h^2 / eps^2 and by rounding over h.
TEST(Smoothed, DerivativesAreThoseOfTheProjection) {
  const Smoothed smooth{0.1};
  const double h = 1e-5;
  for (const Vector& z : points())
    for (int j = 0; j < rows; ++j) {
      Vector up = z, down = z;
      up.x[j] += h, down.x[j] -= h;
      const Vector above = value(smooth, up), below = value(smooth, down), own = derivative(smooth, z, j);
      const double tolerance = 1e-7 + 1e-15 * std::abs(z.x[0]) / h;
      for (int i = 0; i < rows; ++i) EXPECT_NEAR(own.x[i], (above.x[i] - below.x[i]) / (2 * h), tolerance) << z.x[0] << " " << z.x[1];
    }
}

TEST(Smoothed, LanesAreAsOneByOne) {
  const std::vector<Vector> all = points();
  const Smoothed smooth{1e-3};
  for (std::size_t k = 0; k + 4 <= all.size(); ++k) {
    Lanes z[rows];
    for (int i = 0; i < rows; ++i) z[i] = Lanes(all[k].x[i], all[k + 1].x[i], all[k + 2].x[i], all[k + 3].x[i]);
    const auto of = smooth.cone<rows>(z);
    for (int lane = 0; lane < 4; ++lane) {
      const auto own = smooth.cone<rows>(all[k + std::size_t(lane)].x);
      const double size = std::abs(all[k + std::size_t(lane)].x[0]) + 4;
      EXPECT_NEAR(of.normal[lane], own.normal, 1e-15 * size);
      EXPECT_NEAR(of.along[lane], own.along, 1e-15 * size);
      EXPECT_NEAR(of.own[lane], own.own, 1e-14);
      EXPECT_NEAR(of.mixed[lane], own.mixed, 1e-14);
      EXPECT_NEAR(of.across[lane], own.across, 1e-9) << all[k + std::size_t(lane)].x[0];
    }
  }
}

}  // namespace
}  // namespace dyn::solver
