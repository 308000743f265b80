// What rejects pairs before the narrow phase: lower bounds of distances, and boxes that hold the shapes.
#include <gtest/gtest.h>

#include "collision/analytic/boxes.hpp"
#include "collision/bounding_sphere.hpp"
#include "collision/every_pair.hpp"
#include "collision/pair_search.hpp"

namespace dyn_test {
namespace {

collision::Geom geom(const Solid& s) {
  collision::Geom g{};
  g.shape = s.shape, g.X = at(0, 0, 0);
  collision::set_bounds(g);
  return g;
}

class Bound : public testing::TestWithParam<std::pair<Type, Type>> {};
INSTANTIATE_TEST_SUITE_P(Pairs, Bound, testing::ValuesIn(pairs()), pair_name);

TEST_P(Bound, IsNoMoreThanTheDistance) {
  for (int c = 0; c < int(Case::count); ++c)
    for (int k = 0; k < samples(40); ++k) {
      const Scene s = scene(GetParam().first, GetParam().second, Case(c), std::uint64_t(k));
      const double bound = collision::distance_lower_bound(geom(s.a), s.A, geom(s.b), s.B), found = query(s).distance,
                   size = std::max(size_of(s.a), size_of(s.b));
      // where they touch there is no rounding to spare, whatever the processor's
      EXPECT_LE(bound, found + (found == 0 ? 0 : 1e-10 * size)) << name_of(Case(c)) << " " << k;
    }
}

// The box of a shape, which is inflated by 1e-9 of its size, reaches as far as the shape along each axis.
TEST(Bounds, BoxesHoldShapes) {
  for (int t = 1; t < shape::type_count; ++t)
    for (int k = 0; k < samples(200); ++k) {
      Chance g{std::uint64_t(100 * k + t)};
      const Solid s = g.shape(Type(t), 1, 1);
      const Pose X = {g.rotation(), g.direction()};
      const shape::Bounds b = collision::inflated_bounds(geom(s), X, 0);
      for (int i = 0; i < 3; ++i) {
        EXPECT_LE(reach(s, X, shape::axis(i)), b.upper[i]) << name_of(Type(t)) << " " << k;
        EXPECT_LE(reach(s, X, -shape::axis(i)), -b.lower[i]) << name_of(Type(t)) << " " << k;
      }
    }
}

// A box or hull that lies flat on a plane or on another is not apart from it.
TEST(Bounds, FacesThatTouchAreNotApart) {
  for (int k = 0; k < samples(200); ++k) {
    Chance g{std::uint64_t(k + 1)};
    const Vec half = Vec::make(g.uniform(0.1, 3), g.uniform(0.1, 3), g.uniform(0.1, 3));
    const Pose X = {g.rotation(), g.direction() * g.uniform(0, 100)};
    const Solid plane = make(Type::HalfSpace, Vec::zero(), 0);
    for (const Solid& s : {make(Type::Box, half, 0), make_convex(corners(2 * half[0], 2 * half[1], 2 * half[2]))}) {
      const Pose above = X * at(0, 0, half[2]);
      EXPECT_LE(collision::distance_lower_bound(geom(plane), X, geom(s), above), 0);
      EXPECT_LE(collision::distance_lower_bound(geom(s), X, geom(s), X * at(2 * half[0], 0, 0)), 0);
    }
  }
}

// Over a plane the bound is the height of the lowest corner, less 1e-12 of the sizes for rounding: of grains as of hills.
TEST(Bounds, PlaneDistanceIsThatOfTheLowestCorner) {
  const Solid plane = make(Type::HalfSpace, Vec::zero(), 0);
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (int k = 0; k < samples(50); ++k) {
      Chance g{std::uint64_t(k + 1)};
      const Vec half = Vec::make(g.uniform(0.1, 1), g.uniform(0.1, 1), g.uniform(0.1, 1)) * scale;
      const Pose X = {g.rotation(), g.direction() * scale};
      double lowest = shape::infinity;
      for (const Vec& c : corners(2 * half[0], 2 * half[1], 2 * half[2])) lowest = std::min(lowest, X.act(c)[2]);
      for (const Solid& s : {make(Type::Box, half, 0), make_convex(corners(2 * half[0], 2 * half[1], 2 * half[2]))}) {
        const double bound = collision::distance_lower_bound(geom(plane), at(0, 0, 0), geom(s), X);
        EXPECT_LE(bound, lowest) << scale << ' ' << k;
        EXPECT_GE(bound, lowest - 4e-12 * scale) << scale << ' ' << k;
      }
    }
}

// So far away that no distance is a number, an axis is still one of theirs.
TEST(Bounds, BoxesWhoseDistanceIsNoNumberHaveAnAxis) {
  for (const double far : {1e200, 1e308, double(INFINITY), double(NAN)}) {
    const Pose X = {at(0, 0, 0).R, Vec::make(far, -far, far)};
    const Vec half = Vec::make(1, 1, 1);
    const collision::BoxAxis axis = collision::BoxAxes(half, half, X, X.R).best(1e-10);
    EXPECT_TRUE(axis.i >= -1 && axis.i < 3 && axis.j >= -1 && axis.j < 3 && axis.i + axis.j > -2)
        << far << " " << axis.i << " " << axis.j;
  }
}

}  // namespace
}  // namespace dyn_test
