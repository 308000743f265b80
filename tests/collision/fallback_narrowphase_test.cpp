// libccd compared with the primary method on overlaps and depths, and as the fallback.
#include <cstdio>

#include "collision/survey.hpp"
#include "collision/ccd.hpp"

namespace dyn_test {
namespace {

// Where the two differ, shows which is right. Along our normal the overlap equals our depth; along libccd's it is at least as
// large. A larger depth of libccd is not minimal, a smaller one does not separate.
TEST(Second, NeverBeatsOurDepth) {
  if (!collision::ccd_available()) GTEST_SKIP() << "no libccd.so.2";
  int seen = 0, larger = 0, smaller_ones = 0;
  for (int a = int(Type::Capsule); a < shape::type_count; ++a)
    for (int b = a; b < shape::type_count; ++b)
      for (int i = 0; i < 60; ++i) {
        SCOPED_TRACE(testing::Message() << name_of(Type(a)) << ' ' << name_of(Type(b)) << ' ' << i);
        const Scene s = scene(Type(a), Type(b), i % 2 ? Case::Random : Case::Deep, std::uint64_t(i));
        const Result r = query(s);
        collision::FallbackResult found;
        const bool overlaps = collision::ccd_overlap(s.a.shape, s.A, s.b.shape, s.B, 1e-6, found);
        if (std::abs(r.distance) > 1e-3 * smaller(s)) {
          EXPECT_EQ(r.distance < 0, overlaps) << r.distance;
        }
        if (!overlaps || r.distance > 0) continue;
        ++seen;
        EXPECT_NEAR(-r.distance, overlap(s, r.normal), 1e-9 * smaller(s));
        EXPECT_GE(overlap(s, found.normal), -r.distance - 1e-9 * smaller(s));
        larger += found.depth > -r.distance + 1e-3 * smaller(s), smaller_ones += found.depth < -r.distance - 1e-3 * smaller(s);
      }
  EXPECT_GT(seen, 400);
  std::printf("of %d overlaps libccd finds %d deeper and %d less deep by a thousandth of the size\n", seen, larger, smaller_ones);
}

// The tolerance is relative, 1e-8 of squared lengths. So the depth is the overlap along its normal to 1e-4 of the smaller size,
// at any scale.
TEST(Second, DepthScalesWithTheShapes) {
  if (!collision::ccd_available()) GTEST_SKIP() << "no libccd.so.2";
  for (const double scale : {1e-6, 1e-3, 0.5, 1.0, 20.0, 1e6}) {
    int seen = 0;
    for (const Type a : {Type::Capsule, Type::Cylinder, Type::Cone})
      for (const Type b : {Type::Cone, Type::Ellipsoid})
        for (int i = 0; i < 20; ++i) {
          SCOPED_TRACE(testing::Message() << name_of(a) << ' ' << name_of(b) << ' ' << i << ' ' << scale);
          Scene s = scene(a, b, Case::Random, std::uint64_t(i));
          s.A.p = s.A.p * scale, s.B.p = s.B.p * scale;
          for (Solid* x : {&s.a, &s.b}) x->shape.size = x->shape.size * scale, x->shape.radius *= scale;
          if (query(s).distance > -0.05 * smaller(s)) continue;
          collision::FallbackResult found;
          ASSERT_TRUE(collision::ccd_overlap(s.a.shape, s.A, s.b.shape, s.B, 1e-6, found));
          EXPECT_NEAR(overlap(s, found.normal), found.depth, 1.1e-4 * smaller(s));
          ++seen;
        }
    EXPECT_GT(seen, 20);
  }
}

// libccd's EPA went on for seconds where a capsule lies along a box.
TEST(Second, EndsWhereFacesAreParallel) {
  if (!collision::ccd_available()) GTEST_SKIP() << "no libccd.so.2";
  const Solid capsule = make(Type::Capsule, Vec::make(0, 0, 0.5), 0.5), box = make(Type::Box, Vec::make(1, 2, 1), 0);
  const Pose at_origin = Pose::identity(), at = {at_origin.R, Vec::make(1, -2, 1.5)};
  collision::FallbackResult found;
  ASSERT_TRUE(collision::ccd_overlap(capsule.shape, at_origin, box.shape, at, 1e-9, found));
  EXPECT_NEAR(0.5, found.depth, 2e-3);  // what a bounded number of faces reaches
}

TEST(Second, AskedFirstItsAnswerHolds) {
  if (!collision::ccd_available()) GTEST_SKIP() << "no libccd.so.2";
  collision::Options o;
  o.fallback = collision::ccd_overlap, o.fallback_first = true, o.tolerance = 1e-3;
  int second = 0;
  for (int a = int(Type::Capsule); a < shape::type_count; ++a)
    for (int b = std::max(a, int(Type::Cylinder)); b < shape::type_count; ++b)
      for (int i = 0; i < 60; ++i) {
        SCOPED_TRACE(testing::Message() << name_of(Type(a)) << ' ' << name_of(Type(b)) << ' ' << i);
        const Scene s = scene(Type(a), Type(b), Case::Random, std::uint64_t(i));
        const Result r = query(s, o);
        ASSERT_NE(Status::Failed, r.status);
        second += r.from_fallback;
        const Faults f = faults(s, r, false);
        ASSERT_LE(f.witness, 3e-3);
        ASSERT_LE(f.plane, 3e-3);
      }
  EXPECT_GT(second, 20);  // its position is seldom within a thousandth of both
}

// Failed queries are passed to the fallback.
bool stubborn(const Shape&, const Pose&, const Shape&, const Pose&, double, collision::FallbackResult& out) {
  out = {shape::axis(0), Vec::make(0.95, 0, 0), 0.1};
  return true;
}
bool liar(const Shape&, const Pose&, const Shape&, const Pose&, double, collision::FallbackResult& out) {
  out = {shape::axis(0), Vec::make(0.5, 0, 0), 0.9};
  return true;
}
TEST(Second, IsMeasured) {
  const Scene s = {cylinder(1, 2),
                   make(Type::Ellipsoid, Vec::make(1, 2, 3), 0),
                   Pose::identity(),
                   {Mat3<double>::identity(), Vec::make(1.9, 0, 0)}};
  collision::Options o;
  o.fallback = stubborn, o.fallback_first = true;
  EXPECT_TRUE(query(s, o).from_fallback);
  EXPECT_NEAR(-0.1, query(s, o).distance, 1e-12);
  o.fallback = liar;
  EXPECT_FALSE(query(s, o).from_fallback);
  EXPECT_NEAR(-0.1, query(s, o).distance, 1e-9);
  // if both fail, the status says so
  o.fallback_first = false, o.fallback = stubborn, o.accepted = o.tolerance = -1;
  EXPECT_EQ(Status::Failed, query(s, o).status);
}

}  // namespace
}  // namespace dyn_test
