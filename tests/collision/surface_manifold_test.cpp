// Contact points of meshes and height fields equal those of the convex shapes they approximate, however fine the mesh.
#include "collision/surfaces.hpp"
#include "collision/manifold.hpp"

namespace dyn_test {
namespace {

using collision::Contact;
using collision::Manifold;

Manifold manifold(const Shape& a, const Pose& A, const Shape& b, const Pose& B, double margin) {
  Manifold m;
  collision::contacts(a, A, b, B, margin, workspace(), m);
  return m;
}
double farthest_alone(const Manifold& a, const Manifold& b) {
  double worst = 0;
  for (int i = 0; i < a.count; ++i) {
    double near = shape::infinity;
    for (int j = 0; j < b.count; ++j) near = std::min(near, shape::norm(a.points[i].position - b.points[j].position));
    worst = std::max(worst, near);
  }
  return worst;
}
void expect_same(const Manifold& a, const Manifold& b, double tolerance) {
  EXPECT_EQ(a.count, b.count);
  EXPECT_LE(farthest_alone(a, b), tolerance);
  EXPECT_LE(farthest_alone(b, a), tolerance);
}
// Properties of every manifold.
void expect_valid(const Manifold& m, const Result& r, double margin, double tolerance) {
  ASSERT_EQ(r.distance <= margin, m.count > 0);
  ASSERT_LE(m.count, Manifold::most);
  double deepest = shape::infinity;
  for (int i = 0; i < m.count; ++i) {
    const Contact& c = m.points[i];
    deepest = std::min(deepest, c.distance);
    ASSERT_LE(c.distance, margin);
    ASSERT_GE(c.distance, r.distance - tolerance);
    ASSERT_TRUE(i == 0 || m.points[i - 1].feature <= c.feature);
  }
  if (m.count > 0) {
    ASSERT_NEAR(r.distance, deepest, tolerance);
  }
}

// A square of n x n cells about the origin, two triangles each; open.
void sheet(Faceted& f, Index n, double size) {
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i) f.vertex(Vec::make(size * (double(i) / n - 0.5), size * (double(j) / n - 0.5), 0));
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + n + 1;
      f.triangle(a, a + 1, b + 1), f.triangle(a, b + 1, b);
    }
  f.finish(false);
}

TEST(SurfaceManifold, BoxOnAFineSheetHasFourCorners) {
  Faceted floor;
  sheet(floor, 40, 8);
  const Solid crate = box(2, 3, 1);
  for (double height : {0.5 - 1e-3, 0.5, 0.5 + 1e-3})
    for (double angle : {0.0, 0.3, 1.1}) {
      SCOPED_TRACE(testing::Message() << height << ' ' << angle);
      const Pose B = {exp3(Vec::make(0, 0, angle)), Vec::make(0.03, 0.07, height)};
      const Manifold m = manifold(floor.shape, at(0, 0, 0), crate.shape, B, 0.01);
      expect_same(m, manifold(make(Type::HalfSpace, Vec::zero(), 0).shape, at(0, 0, 0), crate.shape, B, 0.01), 1e-6);
      EXPECT_EQ(4, m.count);
      const Manifold exchanged = manifold(crate.shape, B, floor.shape, at(0, 0, 0), 0.01);
      expect_same(m, exchanged, 1e-6);
    }
}

TEST(SurfaceManifold, FlatHeightFieldIsAPlane) {
  Faceted field;
  field.finish_field(std::vector<double>(31 * 31, 0.25), 31, 31, 0.2, 0.2, -1);
  const Solid plane = make(Type::HalfSpace, Vec::zero(), 0),
              solids[] = {box(1, 2, 1), cylinder(0.5, 1), make(Type::Cone, Vec::make(0.5, 0.5, 0.5), 0)};
  for (const Solid& s : solids) {
    const Pose B = at(0.03, 0.04, 0.25 + 0.5 - 2e-3);
    const Manifold m = manifold(field.shape, at(0, 0, 0), s.shape, B, 0.01);
    expect_same(m, manifold(plane.shape, at(0, 0, 0.25), s.shape, B, 0.01), 1e-6);
    EXPECT_EQ(s.shape.type == Type::Box ? 4 : 8, m.count);
  }
}

// From both sides, and on each other.
TEST(SurfaceManifold, MeshOfABoxIsTheBox) {
  Faceted mesh;
  box_mesh(mesh, 1, 1.5, 2);
  const Solid same = make_convex(corners(1, 1.5, 2)), other = box(0.8, 1.1, 0.9);
  Faceted other_mesh;
  box_mesh(other_mesh, 0.8, 1.1, 0.9);
  for (int i = 0; i < samples(200); ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    const Pose A = {g.rotation(), g.direction()};
    const double angle = g.uniform(0, 6), x = g.uniform(-0.5, 0.5), y = g.uniform(-0.5, 0.5), gap = g.uniform(-1, 1) * 5e-3;
    const Pose B = A * Pose{exp3(Vec::make(0, 0, angle)), Vec::make(x, y, 1 + 0.45 + gap)};
    const Manifold expected = manifold(same.shape, A, other.shape, B, 0.01);
    ASSERT_GE(expected.count, 3);
    expect_same(manifold(mesh.shape, A, other.shape, B, 0.01), expected, 1e-5);
    expect_same(manifold(other.shape, B, mesh.shape, A, 0.01), expected, 1e-5);
    expect_same(manifold(mesh.shape, A, other_mesh.shape, B, 0.01), expected, 1e-5);
  }
}

TEST(SurfaceManifold, HoldsOnHills) {
  for (int i = 0; i < samples(200); ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    Faceted field, ring;
    hills(field, g, 12, 9), ring_mesh(ring, 12, 8);
    const Solid s = g.shape(Type(g.pick(shape::type_count)), 0.6);
    const Faceted& surface = g.pick(2) ? field : ring;
    Pose A = {g.rotation(), g.direction()}, B = {g.rotation(), g.direction() * 0.3};
    const Result far = query(surface.shape, A, s.shape, B);
    if (!std::isfinite(far.distance) || far.distance < 0) continue;
    B.p -= far.normal * (far.distance - g.uniform(-1, 1) * 1e-2);
    const Result r = query(surface.shape, A, s.shape, B);
    expect_valid(manifold(surface.shape, A, s.shape, B, 0.02), r, 0.02, 1e-5);
    const Manifold both = manifold(field.shape, A, ring.shape, B, 0.02);
    expect_valid(both, query(field.shape, A, ring.shape, B), 0.02, 1e-5);
  }
}

// A box that slides over a fine sheet keeps its points and their names.
TEST(SurfaceManifold, PointsKeepTheirNames) {
  Faceted floor;
  sheet(floor, 10, 4);
  const Solid crate = box(1, 1, 1);
  Manifold before;
  for (int i = 0; i < 200; ++i) {
    const Pose B = {exp3(Vec::make(0, 0, 0.2)), Vec::make(-0.5 + 0.005 * i, 0.1, 0.4999)};
    const Manifold m = manifold(floor.shape, at(0, 0, 0), crate.shape, B, 0.01);
    ASSERT_EQ(4, m.count);
    int kept = 0;
    for (int k = 0; k < 4 && i > 0; ++k) {
      kept += m.points[k].feature == before.points[k].feature;
      EXPECT_LE(shape::norm(m.points[k].position - before.points[k].position), 0.006);
    }
    if (i > 0) {
      EXPECT_EQ(4, kept) << i;
    }
    before = m;
  }
}

}  // namespace
}  // namespace dyn_test
