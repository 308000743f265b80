// The gradient of the distance against central differences, for every pair.
#include "collision/scene.hpp"
#include "dyn/collision/gradient.hpp"

namespace dyn_test {
namespace {

Pose moved(const Pose& X, const Vec& linear, const Vec& angular) { return {exp3(angular) * X.R, X.p + linear}; }

void compare(Type a, Type b, Case c, int count, int& smooth) {
  const double h = 1e-5;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const Scene s = scene(a, b, c, std::uint64_t(i));
    const Result r = query(s);
    if (!r.unique) continue;
    ++smooth;
    const collision::Gradient g = collision::gradient(r, s.A.p, s.B.p);
    int kinks = 0;
    for (int k = 0; k < 12; ++k) {
      const Vec e = shape::axis(k % 3), none = Vec::zero();
      auto at = [&](double t) {
        Scene m = s;
        Pose& X = k < 6 ? m.A : m.B;
        X = k % 6 < 3 ? moved(X, e * t, none) : moved(X, none, e * t);
        return query(m).distance;
      };
      const Force<double>& f = k < 6 ? g.a : g.b;
      const double slope = dot(k % 6 < 3 ? f.linear : f.angular, e);
      const double forward = (at(h) - r.distance) / h, backward = (r.distance - at(-h)) / h, far = (at(2 * h) - at(-2 * h)) / (4 * h);
      const double central = (forward + backward) / 2;
      // Richardson: the third derivative cancels
      const double difference = central + (central - far) / 3;
      // a change of feature within the step
      if (std::abs(forward - backward) > 1e-2 || std::abs(central - far) > 1e-5) {
        ++kinks;
        continue;
      }
      ASSERT_NEAR(slope, difference, 1e-5);
    }
    ASSERT_LE(kinks, 12);
  }
}

class Gradients : public testing::TestWithParam<std::pair<Type, Type>> {};

TEST_P(Gradients, CentralDifferences) {
  int smooth = 0;
  compare(GetParam().first, GetParam().second, Case::Random, samples(200), smooth);
  EXPECT_GE(smooth, samples(200) / 2);
  compare(GetParam().first, GetParam().second, Case::Touching, samples(200) / 10, smooth);
  compare(GetParam().first, GetParam().second, Case::Deep, samples(200) / 10, smooth);
}

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

std::vector<std::pair<Type, Type>> pairs() {
  std::vector<std::pair<Type, Type>> p;
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = std::max(a, 1); b < shape::type_count; ++b) p.push_back({Type(a), Type(b)});
  return p;
}
INSTANTIATE_TEST_SUITE_P(All, Gradients, testing::ValuesIn(pairs()),
                         [](const auto& info) { return std::string(name_of(info.param.first)) + "_" + name_of(info.param.second); });

}  // namespace
}  // namespace dyn_test
