// Tests that queries of shapes and of the broad phase allocate and lock nothing.
#include "capi/surfaces.hpp"
#include "capi/support.hpp"
#include "rt/interposed.hpp"

namespace dyn_test {
namespace {

// Shapes by themselves, and the broad phase through a life of its boxes.
TEST(Allocations, NoneInShapesAndTheBroadPhase) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  dynGeometry box, drum;
  dyn_geometry_init(&box), dyn_geometry_init(&drum);
  box.type = DYN_SHAPE_TYPE_BOX, box.size[0] = box.size[1] = box.size[2] = 1;
  drum.type = DYN_SHAPE_TYPE_CYLINDER, drum.size[0] = drum.size[1] = 1;
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Y[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0.9},
               motion[6] = {0, 0, -1, 1, 0, 0}, *const point = motion;
  dynBroadPhase* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_broad_phase_new(1000, 100000, 0.01, &b));
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  dynRayHit hit{};
  dynClosestPoint near{};
  dynImpact impact{};
  hit.struct_size = sizeof hit, near.struct_size = sizeof near, impact.struct_size = sizeof impact;
  const long before = allocations, locked = locks;
  int count = 0, id = 0;
  std::int64_t pairs = 0;
  dyn_geometry_contacts(with<dynGeometryPair>({0, &box, &drum, X, Y, nullptr, nullptr}), 0.1, 0, contacts, &count);
  EXPECT_GT(count, 2);
  dyn_geometry_ray(&drum, X, motion + 3, motion, &hit), dyn_geometry_closest_point(&drum, X, point, &near);
  dyn_geometry_sweep(with<dynGeometryPair>({0, &box, &drum, X, Y, nullptr, motion}), 1, 0, &impact);
  for (int step = 0; step < 20; ++step) {
    for (int k = 0; k < 1000; ++k) {
      const double lower[3] = {0.03 * k + 0.02 * step * (k % 7), 0.01 * ((k * step) % 50), 0},
                   upper[3] = {lower[0] + 0.1, lower[1] + 0.1, 0.1};
      if (step == 0)
        dyn_broad_phase_insert(b, lower, upper, &id);
      else if (k % step == 0)
        dyn_broad_phase_update(b, k, lower, upper);
    }
    EXPECT_EQ(DYN_OK, dyn_broad_phase_pairs(b, nullptr, 0, &pairs));
    EXPECT_GT(pairs, 0);
    const double lower[3] = {0, 0, 0}, upper[3] = {9, 9, 9};
    dyn_broad_phase_query(b, lower, upper, &id, 1, &count), dyn_broad_phase_ray(b, lower, upper, 1, &id, 1, &count);
  }
  for (int k = 0; k < 1000; k += 3) dyn_broad_phase_remove(b, k);
  EXPECT_EQ(DYN_OK, dyn_broad_phase_pairs(b, nullptr, 0, &pairs));
  EXPECT_EQ(before, allocations);
  EXPECT_EQ(locked, locks);
  dyn_broad_phase_free(b);
}

// Every pair of types of shapes, apart, touching, overlapping, at one place; each by itself under rays and points; and what is
// refused.
TEST(Allocations, NoneInAnyPairOfShapes) {
  if (sanitized) GTEST_SKIP() << "sanitizers have their own allocator";
  const Surfaces surfaces;
  const std::vector<dynGeometry> shapes = shapes_of(surfaces);
  dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
  dynDistance d{};
  dynRayHit hit{};
  dynClosestPoint near{};
  dynImpact impact{};
  d.struct_size = sizeof d, hit.struct_size = sizeof hit, near.struct_size = sizeof near, impact.struct_size = sizeof impact;
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, motion[6] = {0.1, 0, -1, 0, 0.2, 0}, up[3] = {0.1, 0.2, 1},
               skew[12] = {};
  int queries = 0;
  for (const dynGeometry& a : shapes)
    for (const dynGeometry& b : shapes)
      for (const double z : {3., 1., 0.3, 0., -0.2}) {
        double Y[12] = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.05, 0.02, z};
        if (z == 0) std::copy(X, X + 12, Y);
        const long before = allocations, locked = locks;
        int count = 0;
        const dynStatus status = dyn_geometry_distance(&a, X, &b, Y, nullptr, &d);
        dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, nullptr}), 0.05, 0, contacts, &count);
        dyn_geometry_sweep(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, motion}), 1, 0, &impact);
        dyn_geometry_ray(&b, Y, motion, up, &hit), dyn_geometry_closest_point(&b, Y, motion, &near);
        dyn_geometry_distance(&a, X, &b, nullptr, nullptr, &d), dyn_geometry_distance(&a, skew, &b, Y, nullptr, &d);
        EXPECT_EQ(before, allocations) << int(a.type) << " and " << int(b.type) << " at " << z << ": " << dyn_last_error();
        EXPECT_EQ(locked, locks) << int(a.type) << " and " << int(b.type) << " at " << z;
        EXPECT_EQ(DYN_OK, status);
        ++queries;
      }
  EXPECT_GE(queries, 5 * 81);
}

}  // namespace
}  // namespace dyn_test
