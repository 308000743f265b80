// Gradient of the distance against central differences, for every pair.
#include <cstdio>

#include "collision/every_pair.hpp"
#include "collision/gradient.hpp"

namespace dyn_test {
namespace {

Pose moved(const Pose& X, const Vec& linear, const Vec& angular) { return {exp3(angular) * X.R, X.p + linear}; }

// Differences over steps from 1e-5 down. Takes the first that gives the slope to 1e-6, else the best, and returns its error.
// Where the nearest point changes its piece within a step, the second derivative jumps. Then one-sided differences count if the
// other side is off by no more than a second derivative allows.
double error(const Scene& s, double slope, int k) {
  collision::Options exact;
  exact.tolerance = 1e-15;
  auto at = [&](double t) {
    const Vec e = shape::axis(k % 3) * t, none = Vec::zero();
    Scene m = s;
    Pose& X = k < 6 ? m.A : m.B;
    X = k % 6 < 3 ? moved(X, e, none) : moved(X, none, e);
    return query(m, exact).distance;
  };
  const double here = at(0), arm = 1 + std::min(size_of(s.a), size_of(s.b)), max_bend = arm * arm / std::abs(here);
  double least = shape::infinity;
  for (double h = 1e-5; h > 5e-10 && least > 1e-6; h /= 10) {
    const double up = at(h), up2 = at(2 * h), down = at(-h), down2 = at(-2 * h), central = (up - down) / (2 * h),
                 far = (up2 - down2) / (4 * h);
    // Richardson extrapolation cancels the third derivative
    least = std::min(least, std::abs(central + (central - far) / 3 - slope));
    auto one_sided = [&](double near, double twice, double other, double step) {
      if (std::abs((here - other) / step - slope) <= max_bend * h)
        least = std::min(least, std::abs((4 * near - 3 * here - twice) / (2 * step) - slope));
    };
    one_sided(up, up2, down, h), one_sided(down, down2, up, -h);
  }
  return least;
}

struct Tally {
  long poses = 0, smooth = 0;
};

void compare(const Scene& s, Tally& tally) {
  const Result r = query(s);
  ++tally.poses;
  if (!r.unique) return;
  ++tally.smooth;
  const collision::Gradient g = collision::gradient(r, s.A.p, s.B.p);
  for (int k = 0; k < 12; ++k) {
    const Force<double>& f = k < 6 ? g.a : g.b;
    const Vec& part = k % 6 < 3 ? f.linear : f.angular;
    ASSERT_LE(error(s, part[k % 3], k), 1e-6) << "along " << k << ": " << part[k % 3] << "; distance " << r.distance;
  }
}

void compare(Type a, Type b, Case c, int count, Tally& tally) {
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(std::string(name_of(c)) + ' ' + std::to_string(i));
    compare(scene(a, b, c, std::uint64_t(i)), tally);
  }
}

void compare_all(std::pair<Type, Type> pair, int random) {
  Tally plain, hard;
  compare(pair.first, pair.second, Case::Random, random, plain);
  for (Case c : {Case::Touching, Case::NearlyTouching, Case::Deep}) compare(pair.first, pair.second, c, random / 10, hard);
  std::printf("%-12s %-12s smooth: %ld of %ld random poses, %ld of %ld touching, nearly touching, and deep ones\n",
              name_of(pair.first), name_of(pair.second), plain.smooth, plain.poses, hard.smooth, hard.poses);
  EXPECT_GE(plain.smooth, 0.99 * double(plain.poses));
}

class Gradients : public testing::TestWithParam<std::pair<Type, Type>> {};
TEST_P(Gradients, CentralDifferences) { compare_all(GetParam(), samples(200)); }

// An apex deep in a cone, above a part of its base that no triangle of the polytope covers: the point there is below it.
TEST(Gradients, PointsBetweenTheRimAndTheTriangles) {
  const Scene deep = scene(Type::Cone, Type::Cone, Case::Random, 46298);
  Tally tally;
  for (int k = -10; k <= 10; ++k) {
    SCOPED_TRACE(k);
    Scene s = deep;
    s.B = moved(s.B, shape::axis(k < 0 ? 0 : 1) * (1e-5 * k), Vec::zero());
    compare(s, tally);
  }
  EXPECT_GE(tally.smooth, 15);  // rounding flags one or two
}

// 10^5 random poses a pair.
class SlowGradients : public testing::TestWithParam<std::pair<Type, Type>> {};
TEST_P(SlowGradients, CentralDifferences) { compare_all(GetParam(), samples(100000)); }

TEST(Flags, ParallelFacesAndEdgesAndCoincidentCentresAreNotSmooth) {
  auto at = [](double x, double y, double z) { return Pose{Mat3<double>::identity(), Vec::make(x, y, z)}; };
  EXPECT_FALSE(query({box(1, 1, 1), box(1, 1, 1), at(0, 0, 0), at(0, 0, 1.5)}).unique);
  EXPECT_FALSE(query({capsule(0.1, 1), capsule(0.1, 1), at(0, 0, 0), at(0.5, 0, 0.2)}).unique);
  EXPECT_TRUE(query({capsule(0.1, 1), capsule(0.1, 1), at(0, 0, 0), at(0.5, 0, 1.2)}).unique);
  EXPECT_FALSE(query({capsule(0.1, 1), box(1, 1, 1), at(0, 0, 0), at(1, 0, 0.2)}).unique);
  EXPECT_FALSE(query({cylinder(0.1, 1), cylinder(0.1, 1), at(0, 0, 0), at(0, 0, 3)}).unique);
  EXPECT_FALSE(query({sphere(1), sphere(2), at(0, 0, 0), at(0, 0, 0)}).unique);
  EXPECT_FALSE(query({sphere(1), box(2, 2, 2), at(0, 0, 0), at(0, 0, 0)}).unique);
  EXPECT_FALSE(query({box(1, 1, 1), box(2, 2, 2), at(0, 0, 0), at(0, 0, 0)}).unique);
  EXPECT_TRUE(query({sphere(1), box(2, 2, 2), at(0, 0, 0), at(0, 0, 2)}).unique);
}

INSTANTIATE_TEST_SUITE_P(All, Gradients, testing::ValuesIn(pairs()), pair_name);
INSTANTIATE_TEST_SUITE_P(All, SlowGradients, testing::ValuesIn(pairs()), pair_name);

}  // namespace
}  // namespace dyn_test
