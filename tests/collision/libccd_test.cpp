// Known errors of libccd (its issues 17, 30, 51, 55, 71). Its tolerance acts on squared lengths. Coincident centres and extreme
// sizes take a quarter of a second. Contact positions on large boxes and degenerate triangles are wrong.
#include "collision/survey.hpp"
#include "collision/manifold.hpp"

namespace dyn_test {
namespace {

std::vector<std::pair<Type, Type>> convex_pairs() {
  std::vector<std::pair<Type, Type>> p;
  for (int a = int(Type::Sphere); a < shape::type_count; ++a)
    for (int b = a; b < shape::type_count; ++b) p.push_back({Type(a), Type(b)});
  return p;
}

// The error is at most the tolerance times the smaller size, for any tolerance.
TEST(Libccd, ToleranceIsALength) {
  for (const auto& [a, b] : convex_pairs())
    for (int i = 0; i < 40; ++i) {
      const Scene s = scene(a, b, i % 2 ? Case::Random : Case::NearlyTouching, std::uint64_t(i));
      collision::Options o;
      o.tolerance = 1e-15;
      const double exact = query(s, o).distance;
      for (o.tolerance = 1e-2; o.tolerance > 1e-13; o.tolerance /= 10)
        ASSERT_NEAR(exact, query(s, o).distance, o.tolerance * smaller(s) + 1e-13)
            << name_of(a) << ' ' << name_of(b) << ' ' << i << ", tolerance " << o.tolerance;
    }
}

TEST(Libccd, CoincidentCentresAndSizeRatiosTakeFewSteps) {
  collision::Options o;
  o.tolerance = 1e-12;
  for (const auto& [a, b] : convex_pairs())
    for (Case c : {Case::Coincident, Case::Ratio, Case::Touching})
      for (int i = 0; i < 100; ++i) {
        const Result r = query(scene(a, b, c, std::uint64_t(i)), o);
        ASSERT_NE(Status::Failed, r.status) << name_of(a) << ' ' << name_of(b) << ' ' << name_of(c) << ' ' << i;
        ASSERT_LE(r.iterations, 300) << name_of(a) << ' ' << name_of(b) << ' ' << name_of(c) << ' ' << i;
      }
}

// Corners of a small box far from the centre of a large one, not a point near the large one's centre.
TEST(Libccd, ContactPositionsOnALargeBox) {
  const Solid cubes[] = {box(0.2, 0.2, 0.2), make_convex(corners(0.2, 0.2, 0.2))},
              grounds[] = {box(200, 200, 2), make_convex(corners(200, 200, 2))};
  for (const Solid& cube : cubes)
    for (const Solid& ground : grounds) {
      collision::Manifold m;
      collision::contacts(ground.shape, at(0, 0, -1), cube.shape, at(83, -71, 0.1 - 1e-4), 0, workspace(), m);
      ASSERT_EQ(4, m.count);
      EXPECT_NEAR(1, m.normal[2], 1e-12);
      for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(0.1, std::abs(m.points[i].position[0] - 83), 1e-9);
        EXPECT_NEAR(0.1, std::abs(m.points[i].position[1] + 71), 1e-9);
        EXPECT_NEAR(-0.5e-4, m.points[i].position[2], 1e-9);
        EXPECT_NEAR(-1e-4, m.points[i].distance, 1e-12);
      }
    }
}

// Hulls a millionth thick, also of nearly collinear points: tiny faces and triangles.
TEST(Libccd, NeedlesAndFlakes) {
  for (const double thin : {1e-3, 1e-6})
    for (int i = 0; i < 100; ++i) {
      Chance g{std::uint64_t(i)};
      std::vector<Vec> p;
      for (int k = 0; k < 8; ++k) p.push_back(hadamard(g.direction(), Vec::make(1, i % 2 ? thin : 0.7, thin)));
      const Solid flake = make_convex(p);
      for (const Solid& other :
           {box(0.5, 0.4, 0.3), cylinder(0.2, 0.5), make(Type::Ellipsoid, Vec::make(0.2, 0.3, 0.4), 0), flake}) {
        Scene s = {flake, other, {g.rotation(), Vec::zero()}, {g.rotation(), g.direction() * g.uniform(0.5, 2)}};
        const Result r = query(s);
        const Faults f = faults(s, r, false);
        ASSERT_FALSE(f.failed) << i;
        ASSERT_LE(f.witness, 1e-6) << i;
        ASSERT_LE(f.plane, 1e-6) << i;
        ASSERT_LE(std::abs(shape::norm(r.point_b - r.point_a) - std::abs(r.distance)), 1e-6) << i;
      }
    }
}

}  // namespace
}  // namespace dyn_test
