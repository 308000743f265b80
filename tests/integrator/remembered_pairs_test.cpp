// What Clearances keeps of pairs of shapes that were apart: of nearly all, and precisely.
#include <gtest/gtest.h>

#include "model/data.hpp"
#include "simulation/clearances.hpp"

namespace dyn_test {
namespace {

using namespace dyn;

// For so many shapes at the origin.
struct Remembered : simulation::Clearances {
  explicit Remembered(Index shapes) {
    Model m{};
    m.n.geoms = shapes, m.n.pairs = shapes * (shapes - 1) / 2;
    for_each_array(m, [&]<class T>(T*& array, std::ptrdiff_t count) {
      memory.emplace_back(std::size_t(count) * sizeof(T));
      array = reinterpret_cast<T*>(memory.back().data());
    });
  }
  std::vector<std::vector<std::byte>> memory;
};

// There is room for three times the pairs that come near at once. Four places a bucket lose 35 of 8192 by chance, two 240,
// eight none.
TEST(RememberedPairs, FewDisplaceEachOther) {
  const Index shapes = 512, near = 16;
  Remembered all(shapes);
  for (Index a = 0; a < shapes; ++a)
    for (Index k = 1; k <= near; ++k) all.learn(a, (a + k) % shapes, 1, shape::Vec::zero());
  int lost = 0;
  for (Index a = 0; a < shapes; ++a)
    for (Index k = 1; k <= near; ++k) lost += !all.find(a, (a + k) % shapes);
  EXPECT_NEAR(35, lost, 25);
}

// The direction that separated two balls 1 m apart is off by 5e-5 at most, so the gap along it is short by 1e-9 m.
TEST(RememberedPairs, DirectionsAreKeptTo15Bits) {
  Remembered pair(2);
  collision::Geom balls[2] = {};
  for (collision::Geom& g : balls) g.shape.type = shape::Type::Sphere, g.shape.radius = 0.1;
  double shortest = 1;
  for (int k = 0; k < 200; ++k) {
    const double z = (k + 0.5) / 100 - 1, turn = 2.4 * k, r = std::sqrt(1 - z * z);
    const shape::Vec n = shape::Vec::make(r * std::cos(turn), r * std::sin(turn), z);
    const shape::Pose poses[2] = {{shape::Mat::identity(), shape::Vec::zero()}, {shape::Mat::identity(), n}};
    pair.learn(0, 1, 0.8, n);
    shortest = std::min(shortest, pair.bound_along_axis(*pair.find(0, 1), balls, poses, 0));
  }
  EXPECT_LT(shortest, 0.8);
  EXPECT_GT(shortest, 0.8 - 2e-9);
  EXPECT_LT(shortest, 0.8 - 1e-10);  // four bytes a component would be a waste
}

}  // namespace
}  // namespace dyn_test
