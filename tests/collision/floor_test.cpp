// Solids on a floor of triangles. Inner edges and vertices must have no effect.
#include "collision/surfaces.hpp"
#include "collision/manifold.hpp"

namespace dyn_test {
namespace {

using collision::Contact;
using collision::Manifold;

constexpr double cell = 0.1, margin = 1e-3;
constexpr Index cells = 40;  // along each side; even, so a vertex lies at the origin

void sheet(Faceted& f) {
  for (Index j = 0; j <= cells; ++j)
    for (Index i = 0; i <= cells; ++i) f.vertex(Vec::make(cell * (i - cells / 2), cell * (j - cells / 2), 0));
  for (Index j = 0; j < cells; ++j)
    for (Index i = 0; i < cells; ++i) {
      const Index a = j * (cells + 1) + i, b = a + cells + 1;
      f.triangle(a, a + 1, b + 1), f.triangle(a, b + 1, b);
    }
  f.finish(false);
}
void field(Faceted& f) {
  f.finish_field(std::vector<double>((cells + 1) * (cells + 1), 0.0), cells + 1, cells + 1, cell, cell, -1);
}
template <class F>
void on_each_floor(F&& f) {
  Faceted floors[2];
  sheet(floors[0]), field(floors[1]);
  for (const Faceted& floor : floors) {
    SCOPED_TRACE(floor.shape.type == Type::HeightField ? "height field" : "mesh");
    f(floor.shape);
  }
}
Manifold manifold(const Shape& a, const Pose& A, const Shape& b, const Pose& B) {
  Manifold m;
  collision::contacts(a, A, b, B, margin, workspace(), m);
  return m;
}
Vec lowest(const Solid& s, const Pose& X) {
  const Vec down = Vec::make(0, 0, -1);
  Vec p = Vec::zero();
  shape::visit(s.shape, [&]<class S>(const S& x) {
    if constexpr (S::type != Type::HalfSpace) p = X.act(x.support(transpose_times(X.R, down))) + down * x.radius;
  });
  return p;
}

// Any solid at any depth, its lowest point over a vertex, an edge, or a triangle: the normal is up.
TEST(Floor, PushesUpwards) {
  on_each_floor([&](const Shape& floor) {
    for (int t = 0; t < shape::type_count; ++t)
      for (int i = 0; i < (Type(t) == Type::HalfSpace ? 0 : 200); ++i) {
        const Type type = Type(t);
        SCOPED_TRACE(std::string(name_of(type)) + " " + std::to_string(i));
        Chance g(std::uint64_t(i) * 16 + std::uint64_t(type));
        const Solid s = g.shape(type, 0.5);
        Pose B = {g.pick(3) ? g.rotation() : g.quarter_turns(), Vec::zero()};
        const double depth = 0.5 * std::pow(10, -g.uniform(1, 5));
        const int over = g.pick(3);
        const Vec target = over == 0   ? Vec::make(0.1, -0.2, -depth)
                           : over == 1 ? Vec::make(0.1, g.uniform(-0.2, 0.2), -depth)
                                       : Vec::make(g.uniform(-0.2, 0.2), g.uniform(-0.2, 0.2), -depth);
        B.p = target - lowest(s, B);
        const Result r = query(floor, Pose::identity(), s.shape, B), back = query(s.shape, B, floor, Pose::identity());
        ASSERT_NEAR(1, r.normal[2], 1e-5);
        ASSERT_NEAR(-depth, r.distance, 1e-6);
        ASSERT_LE(shape::norm(r.point_b - r.point_a - r.normal * r.distance), 1e-9);
        ASSERT_NEAR(-1, back.normal[2], 1e-5);
        ASSERT_NEAR(-depth, back.distance, 1e-6);
        const Manifold m = manifold(floor, Pose::identity(), s.shape, B);
        ASSERT_GT(m.count, 0);
        double deepest = shape::infinity;
        for (int k = 0; k < m.count; ++k) deepest = std::min(deepest, m.points[k].distance);
        ASSERT_NEAR(-depth, deepest, 1e-6);
      }
  });
}

// A box that rocks and slides, as in a simulation, has the same contacts as on a plane.
TEST(Floor, RockingBoxIsThatOnAPlane) {
  const Solid plane = make(Type::HalfSpace, Vec::zero(), 0), crate = box(0.3, 0.4, 0.5);
  on_each_floor([&](const Shape& floor) {
    int points[9] = {}, kept = 0, all = 0;
    Manifold before;
    for (int i = 0; i < 1000; ++i) {
      SCOPED_TRACE(i);
      const double t = 1e-3 * i;
      Pose B = {exp3(Vec::make(0, 0, t)) * exp3(Vec::make(0.002 * std::sin(40 * t), 0.01 * std::sin(70 * t + 1), 0)),
                Vec::zero()};
      B.p = Vec::make(t - 0.5, 0.3 * t, -5e-4 - lowest(crate, B)[2]);
      const Manifold m = manifold(floor, Pose::identity(), crate.shape, B),
                     expected = manifold(plane.shape, Pose::identity(), crate.shape, B);
      ASSERT_NEAR(1, m.normal[2], 1e-9);
      ASSERT_EQ(expected.count, m.count);
      ++points[m.count];
      for (int k = 0; k < m.count; ++k) {
        double apart = shape::infinity, depth = 0;
        for (int j = 0; j < m.count; ++j)
          if (const double d = shape::norm(m.points[k].position - expected.points[j].position); d < apart)
            apart = d, depth = expected.points[j].distance;
        ASSERT_LE(apart, 1e-6);
        ASSERT_NEAR(depth, m.points[k].distance, 1e-6);
      }
      // a point that stays keeps its number
      for (int k = 0; k < m.count && i > 0; ++k)
        for (int j = 0; j < before.count; ++j)
          if (shape::norm(m.points[k].position - before.points[j].position) < 3e-3)
            ++all, kept += m.points[k].feature == before.points[j].feature;
      before = m;
    }
    EXPECT_GT(points[2], 50);
    EXPECT_GT(points[4], 50);
    EXPECT_EQ(all, kept);
  });
}

// A cylinder on its side and on its cap, rolling and turning.
TEST(Floor, CylinderIsThatOnAPlane) {
  const Solid plane = make(Type::HalfSpace, Vec::zero(), 0), drum = cylinder(0.2, 0.5);
  on_each_floor([&](const Shape& floor) {
    for (int i = 0; i < 300; ++i) {
      SCOPED_TRACE(i);
      const double t = 0.01 * i;
      const bool lying = i % 2;
      const Pose B = {exp3(Vec::make(0, 0, t)) *
                          (lying ? exp3(Vec::make(pi / 2, 0, 0)) * exp3(Vec::make(0, 0, 3 * t)) : Mat3<double>::identity()),
                      Vec::make(0.2 * t - 0.3, 0.1 * t, (lying ? 0.2 : 0.25) - 4e-4)};
      const Manifold m = manifold(floor, Pose::identity(), drum.shape, B),
                     expected = manifold(plane.shape, Pose::identity(), drum.shape, B);
      ASSERT_NEAR(1, m.normal[2], 1e-9);
      ASSERT_EQ(lying ? 2 : 8, m.count);
      for (int k = 0; k < m.count; ++k) {
        ASSERT_NEAR(-4e-4, m.points[k].distance, 1e-6);
        if (!lying) continue;
        ASSERT_LE(std::min(shape::norm(m.points[k].position - expected.points[0].position),
                           shape::norm(m.points[k].position - expected.points[1].position)),
                  1e-6);
      }
    }
  });
}

// A stack: the box in the middle keeps its four corners, their order and depths through small motions.
TEST(Floor, StackedBoxesKeepTheirPoints) {
  const Solid crate = box(0.4, 0.4, 0.4);
  Manifold before;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    const Pose A = {exp3(g.direction() * 1e-4), Vec::make(0, 0, 0.2)},
               B = {exp3(Vec::make(0, 0, 0.1)) * exp3(g.direction() * 1e-4), Vec::make(0.05, 0.03, 0.5995)};
    const Manifold m = manifold(crate.shape, A, crate.shape, B);
    ASSERT_NEAR(1, std::abs(m.normal[2]), 1e-6);
    ASSERT_GE(m.count, 4);
    ASSERT_LE(m.count, 8);
    if (i > 0) {
      ASSERT_EQ(before.count, m.count);
    }
    for (int k = 0; k < m.count && i > 0; ++k) {
      ASSERT_EQ(before.points[k].feature, m.points[k].feature);
      ASSERT_LE(shape::norm(before.points[k].position - m.points[k].position), 2e-3);
      // each at its own depth: where the planes of both faces are
      const Vec on_a = A.act_inverse(m.points[k].position - m.normal * (m.points[k].distance / 2)),
                on_b = B.act_inverse(m.points[k].position + m.normal * (m.points[k].distance / 2));
      ASSERT_NEAR(0.2, on_a[2], 1e-9);
      ASSERT_NEAR(-0.2, on_b[2], 1e-9);
    }
    before = m;
  }
}

}  // namespace
}  // namespace dyn_test
