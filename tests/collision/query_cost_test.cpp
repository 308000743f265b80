// What a contact query costs, in instructions: of shapes apart, near without contact, overlapping, and at rest on each other. The
// bounds are half as much again as SSE2 takes; wider registers take less.
#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

#include "collision/gap_along.hpp"
#include "collision/manifold.hpp"
#include "collision/plane_manifold.hpp"
#include "collision/poses.hpp"
#include "count.hpp"

namespace dyn_test {
namespace {

using collision::Manifold;

// Builds for debugging and sanitizers have instructions of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(NDEBUG)
constexpr bool counts_apply = false;
#else
constexpr bool counts_apply = true;
#endif

enum Class { Apart = dyn_bench::Apart, Near = dyn_bench::Near, Penetrating = dyn_bench::Penetrating, AtRest };

// Instructions of a query, the mean of the first poses of a class; -1: they cannot be counted.
long cost(Type a, Type b, Class c) {
  constexpr std::size_t count = 40;
  const dyn_bench::PairOfShapes pair = dyn_bench::make_pair(a, b);
  const std::vector<Scene> scenes = c == AtRest ? dyn_bench::at_rest(pair) : pair.scenes[c];
  const long n = bench::instructions([&] {
    Manifold m;
    for (std::size_t i = 0; i < count; ++i)
      collision::contacts(scenes[i].a.shape, scenes[i].A, scenes[i].b.shape, scenes[i].B, 0, workspace(), m);
  });
  return n < 0 ? n : n / long(count);
}

struct QueryBound {
  Type a, b;
  Class c;
  long most;
};
void expect_at_most(std::initializer_list<QueryBound> bounds) {
  if (!counts_apply) GTEST_SKIP() << "of a build without optimisation";
  for (const QueryBound& x : bounds) {
    const long n = cost(x.a, x.b, x.c);
    if (n < 0) GTEST_SKIP() << "this system does not let a process trace its child";
    EXPECT_LE(n, x.most) << name_of(x.a) << " " << name_of(x.b) << ", class " << x.c;
  }
}

// Without a contact, a direction that separates the shapes ends the query.
TEST(QueryCost, SeparatedShapesEndEarly) {
  expect_at_most({{Type::HalfSpace, Type::Convex, Apart, 230}, {Type::HalfSpace, Type::Convex, Near, 660},
                  {Type::Sphere, Type::Box, Apart, 250}, {Type::Sphere, Type::Box, Near, 250},
                  {Type::Sphere, Type::Ellipsoid, Apart, 420}, {Type::Sphere, Type::Ellipsoid, Near, 420},
                  {Type::Capsule, Type::Capsule, Apart, 460}, {Type::Capsule, Type::Capsule, Near, 460},
                  {Type::Box, Type::Box, Apart, 400}, {Type::Box, Type::Box, Near, 1200},
                  {Type::Cylinder, Type::Cylinder, Apart, 1100}, {Type::Cylinder, Type::Cylinder, Near, 11000},
                  {Type::Convex, Type::Convex, Apart, 2400}, {Type::Convex, Type::Convex, Near, 12500}});
}

TEST(QueryCost, SimpleContactsNeedNoSearch) {
  expect_at_most({{Type::HalfSpace, Type::Sphere, Penetrating, 115}, {Type::HalfSpace, Type::Sphere, AtRest, 115},
                  {Type::HalfSpace, Type::Box, Penetrating, 480}, {Type::HalfSpace, Type::Box, AtRest, 600},
                  {Type::HalfSpace, Type::Cylinder, Penetrating, 360}, {Type::HalfSpace, Type::Cylinder, AtRest, 495},
                  {Type::HalfSpace, Type::Convex, Penetrating, 1700}, {Type::HalfSpace, Type::Convex, AtRest, 810},
                  {Type::Sphere, Type::Box, Penetrating, 450}, {Type::Sphere, Type::Box, AtRest, 450},
                  {Type::Capsule, Type::Capsule, Penetrating, 1250}, {Type::Capsule, Type::Capsule, AtRest, 1250},
                  {Type::Box, Type::Box, Penetrating, 4550}, {Type::Box, Type::Box, AtRest, 4600},
                  {Type::Cylinder, Type::Cylinder, AtRest, 7600}});
}

// Faces around a vertex: the list names the face that a search of all planes finds.
TEST(HullFaces, ListChangesNoFeature) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Chance g(seed);
    const Solid s = g.shape(Type::Convex, 1);
    ASSERT_NE(nullptr, s.shape.vertex_faces);
    shape::Shape plain = s.shape;
    plain.vertex_faces = nullptr;
    const shape::Convex listed(s.shape), searched(plain);
    for (int k = 0; k < 50; ++k) {
      const bool along_face = k % 2;
      const Vec n = along_face ? s.hull->hull.normal(Index(g.pick(int(s.hull->hull.faces)))) : g.direction();
      shape::Feature a, b;
      const double band = std::pow(10.0, -g.uniform(0, 9));
      listed.facing(n, band, a), searched.facing(n, band, b);
      ASSERT_EQ(a.count, b.count);
      for (int i = 0; i < a.count; ++i) ASSERT_EQ(a.id[i], b.id[i]);
    }
  }
}

// A hull on a plane: the heights of all vertices name the same corners as a search from the lowest one.
TEST(HullFaces, HeightsChangeNoContact) {
  int several = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Chance g(seed);
    const Solid s = g.shape(Type::Convex, 1);
    if (s.hull->hull.vertices > collision::detail::few_vertices) continue;
    const Pose X = {g.rotation(), g.direction()};
    const shape::Convex hull(s.shape);
    // most often with a face on the plane, or nearly
    const Vec down = seed % 4 ? hull.hull.normal(Index(g.pick(int(hull.hull.faces)))) + g.direction() * (seed % 2 ? 1e-3 : 0)
                              : g.direction();
    const Vec m = -down * (1 / shape::norm(down)), n = X.R * m;
    const double size = hull.extent(), same = collision::same_point * size, eps = collision::coincident * size;
    const double depth = size * std::pow(10.0, -g.uniform(0.5, 6)), height = -dot(m, hull.support(-m)) - depth;
    Manifold a, b;
    collision::detail::PlaneContacts to_a = {n, 0, 0, true, a}, to_b = {n, 0, 0, true, b};
    const bool found = collision::detail::hull_contacts(hull, X, m, height, 0.05, same, eps, to_a);
    ASSERT_EQ(collision::detail::facing_contacts(hull, X, m, height, 0.05, same, eps, to_b), found);
    if (!found) continue;
    ASSERT_EQ(b.count, a.count);
    several += a.count > 1;
    for (int i = 0; i < a.count; ++i) {
      EXPECT_EQ(b.points[i].feature, a.points[i].feature);
      EXPECT_NEAR(b.points[i].distance, a.points[i].distance, 1e-14 * size);
      EXPECT_LE(shape::norm(b.points[i].position - a.points[i].position), 1e-14 * (size + shape::norm(X.p)));
    }
  }
  EXPECT_GT(several, 500);
}

// The gap along any direction is a lower bound of the distance.
TEST(QueryCost, GapAlongADirectionIsALowerBound) {
  for (int a = 1; a < shape::type_count; ++a)
    for (int b = a; b < shape::type_count; ++b)
      for (std::uint64_t i = 0; i < 60; ++i) {
        const Scene s = scene(Type(a), Type(b), Case(i % std::uint64_t(Case::count)), i);
        const Result r = query(s);
        const double size = std::min(size_of(s.a), size_of(s.b));
        Chance g(i);
        const auto gap = [&](const Vec& n) { return collision::gap_along(s.a.shape, s.A, s.b.shape, s.B, n); };
        EXPECT_LE(gap(g.direction()), r.distance + r.residual + 1e-9 * size);
        EXPECT_LE(gap(r.normal), r.distance + r.residual + 1e-9 * size);
        // the normal's own error turns it away from the best direction: the loss is of second order in it, at the larger shape
        const double loss = 1e-6 * std::max(size_of(s.a), size_of(s.b));
        if (r.distance > 0.01 * size) {
          EXPECT_NEAR(gap(r.normal), r.distance, r.residual + loss);
        }
      }
}

// The gap is known of bounded convex shapes. A half-space has no height along most directions. Of a surface it would be the gap
// of its hull.
TEST(QueryCost, GapIsKnownOfBoundedConvexShapes) {
  for (int t = 0; t < shape::type_count; ++t) EXPECT_EQ(Type(t) != Type::HalfSpace, collision::has_support(Type(t))) << t;
  for (const Type t : {Type::Triangles, Type::HeightField}) EXPECT_FALSE(collision::has_support(t));
}

// A limited query finds the same distance within the limit, and a lower bound beyond it.
TEST(QueryCost, LimitedDistanceIsALowerBound) {
  for (int a = 1; a < shape::type_count; ++a)
    for (int b = a; b < shape::type_count; ++b)
      for (std::uint64_t i = 0; i < 60; ++i) {
        const Scene s = scene(Type(a), Type(b), Case(i % std::uint64_t(Case::count)), i);
        const double size = std::min(size_of(s.a), size_of(s.b));
        for (const double k : {0.0, 0.01, 0.3}) {
          collision::Options limited;
          limited.max_distance = k * size;
          const Result exact = query(s), r = query(s, limited);
          if (r.distance <= limited.max_distance)
            EXPECT_EQ(exact.distance, r.distance);
          else
            EXPECT_LE(r.distance, exact.distance + exact.residual + 1e-9 * size);
          EXPECT_EQ(exact.distance <= limited.max_distance, r.distance <= limited.max_distance);
        }
      }
}

}  // namespace
}  // namespace dyn_test
