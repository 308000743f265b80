// Triangle meshes and height fields against the shapes that they represent, and against closed forms.
#include "collision/surfaces.hpp"

namespace dyn_test {
namespace {

using shape::HeightField;
using shape::Triangles;

// A mesh with two triangles a side equals a box.
TEST(Surfaces, MeshOfABoxIsTheBox) {
  Faceted m;
  box_mesh(m, 0.6, 0.8, 1);
  const Solid b = box(0.6, 0.8, 1);
  const Triangles mesh(m.shape);
  const shape::Box whole(b.shape);
  EXPECT_NEAR(whole.solid().m, mesh.solid().m, 1e-15);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(whole.solid().I.d[i], mesh.solid().I.d[i], 1e-15);
  int apart = 0, shallow = 0, inside = 0, tied = 0;
  for (int k = 0; k < samples(4000); ++k) {
    SCOPED_TRACE(k);
    Chance g{std::uint64_t(k)};
    const Vec p = g.direction() * g.uniform(0, 1.2), d = g.direction();
    ASSERT_NEAR(whole.nearest(p).distance, mesh.nearest(p).distance, 1e-14);
    ASSERT_NEAR(whole.nearest(p).unique, mesh.nearest(p).unique, 0);
    const shape::Hit one = whole.ray(p, d), other = mesh.ray(p, d);
    ASSERT_EQ(one.t < shape::infinity, other.t < shape::infinity);
    if (one.t < shape::infinity) {
      ASSERT_NEAR(one.t, other.t, 1e-12);
    }
    const Solid c = g.shape(Type(g.pick(shape::type_count)), 0.3);
    const Pose A = random_pose(g, 2), B = {g.rotation(), A.p + g.direction() * g.uniform(0, 1.5)};
    const Result r = query(m.shape, A, c.shape, B), e = query(b.shape, A, c.shape, B);
    if (e.distance > 0 || c.shape.type == Type::Sphere) {
      ASSERT_NEAR(e.distance, r.distance, 1e-9);
      if (e.unique && r.unique) {
        ASSERT_LE(shape::norm(e.normal - r.normal), 1e-5);
      }
      if (c.shape.type != Type::Sphere && c.shape.type != Type::HalfSpace)
        tied += e.unique && !r.unique;  // two triangles of a side, within rounding
      ++apart;
    } else if (e.distance > -0.02) {  // through one side
      ASSERT_LE(r.distance, 1e-12);
      ASSERT_GE(r.distance, e.distance - 1e-9);
      ++shallow;
    } else if (r.distance < 0) {
      ++inside;
    } else {
      ADD_FAILURE() << "not seen: " << r.distance << " instead of " << e.distance;
    }
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(inside, 100);
  EXPECT_LE(tied, apart / 1000);
}

// A fine mesh approaches a sphere with the square of its angle.
TEST(Surfaces, FineSphereIsNearASphere) {
  for (const Index n : {20, 40, 80}) {
    Faceted s;
    sphere_mesh(s, n, 1);
    const double off = 1 - std::cos(pi / n);
    Chance g{std::uint64_t(n)};
    for (int k = 0; k < 200; ++k) {
      const Solid b = g.shape(Type(g.pick(shape::type_count)), 0.5);
      const Pose A = random_pose(g, 1), B = {g.rotation(), A.p + g.direction() * g.uniform(1.2, 3)};
      const double expected = query(sphere(1).shape, A, b.shape, B).distance, d = query(s.shape, A, b.shape, B).distance;
      if (expected < 0) continue;
      ASSERT_GE(d, expected - 1e-9);
      ASSERT_LE(d, expected + 2 * off);
    }
    EXPECT_NEAR(4 * pi / 3, Triangles(s.shape).volume(), 8 * off);
  }
}

// A flat height field is a box.
TEST(Surfaces, FlatHeightFieldIsABox) {
  Faceted f;
  f.finish_field(std::vector<double>(7 * 6, 0.5), 7, 6, 0.2, 0.3, -0.5);
  const Solid b = box(1.2, 1.5, 1);
  const HeightField field(f.shape);
  const shape::Box whole(b.shape);
  EXPECT_NEAR(whole.solid().m, field.solid().m, 1e-14);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(whole.solid().I.d[i], field.solid().I.d[i], 1e-14);
  for (int k = 0; k < samples(3000); ++k) {
    SCOPED_TRACE(k);
    Chance g{std::uint64_t(k)};
    const Vec p = g.direction() * g.uniform(0, 1.5), d = g.direction();
    ASSERT_NEAR(whole.nearest(p).distance, field.nearest(p).distance, 1e-14);
    const shape::Hit one = whole.ray(p, d), other = field.ray(p, d);
    ASSERT_EQ(one.t < shape::infinity, other.t < shape::infinity);
    if (one.t < shape::infinity) {
      ASSERT_NEAR(one.t, other.t, 1e-12);
    }
    const Solid c = g.shape(Type(g.pick(shape::type_count)), 0.4);
    const Pose A = random_pose(g, 2), B = {g.rotation(), A.p + g.direction() * g.uniform(0, 2)};
    const double expected = query(b.shape, A, c.shape, B).distance, r = query(f.shape, A, c.shape, B).distance;
    if (expected > 0 || c.shape.type == Type::Sphere) {
      ASSERT_NEAR(expected, r, 1e-9);
    } else {
      ASSERT_LE(r, 1e-12);
    }
  }
}

// Coarser levels of a height field's tree contain the finer ones, for any grid size.
TEST(Surfaces, HeightFieldsOfAllSizes) {
  for (const auto& [columns, rows] : {std::pair<Index, Index>{2, 2}, {2, 9}, {3, 2}, {17, 16}, {18, 33}, {1, 5}}) {
    Chance g{std::uint64_t(columns * 100 + rows)};
    Faceted f;
    if (columns < 2) {
      EXPECT_THROW(hills(f, g, columns, rows), dyn::Error);
      continue;
    }
    hills(f, g, columns, rows);
    const Solid ball = sphere(0.05);
    for (int k = 0; k < 100; ++k) {
      const Pose B = {Mat3<double>::identity(), Vec::make(g.uniform(-4, 4), g.uniform(-4, 4), g.uniform(0.3, 3))};
      const double d = query(f.shape, Pose::identity(), ball.shape, B).distance;
      if (d > 0) {
        ASSERT_NEAR(every_piece(f, Pose::identity(), ball.shape, B), d, 1e-9);
      }
    }
  }
}

// A shape inside a mesh is separated by the nearest plane.
TEST(Surfaces, InsideOfAClosedMeshIsAnOverlap) {
  Faceted m, small;
  box_mesh(m, 2, 2, 2);
  sphere_mesh(small, 6, 0.1);
  const Pose A = Pose::identity(), B = {Mat3<double>::identity(), Vec::make(0.5, 0.1, -0.2)};
  const Result r = query(m.shape, A, box(0.2, 0.2, 0.2).shape, B), s = query(m.shape, A, sphere(0.1).shape, B),
               t = query(m.shape, A, small.shape, B), u = query(small.shape, B, m.shape, A);
  EXPECT_EQ(Status::Penetrating, r.status);
  EXPECT_NEAR(-0.6, r.distance, 1e-9);
  EXPECT_NEAR(1, r.normal[0], 1e-9);
  EXPECT_FALSE(r.unique);
  EXPECT_NEAR(-0.6, s.distance, 1e-12);
  EXPECT_NEAR(-0.6, t.distance, 1e-9);
  EXPECT_NEAR(-0.6, u.distance, 1e-9);
  EXPECT_NEAR(-1, u.normal[0], 1e-9);
  EXPECT_EQ(Status::Separated, query(m.shape, A, small.shape, {Mat3<double>::identity(), Vec::make(1.5, 0, 0)}).status);
}

// Contacts know how deep it lies, although each triangle is farther than they ask for.
TEST(Surfaces, ContactsInsideOfAClosedMeshAreDeep) {
  Faceted m;
  box_mesh(m, 2, 2, 2);
  collision::Options limited;
  limited.max_distance = 0.01;
  const Pose B = {Mat3<double>::identity(), Vec::make(0.5, 0.1, -0.2)};
  const Result r = query(m.shape, Pose::identity(), box(0.2, 0.2, 0.2).shape, B, limited);
  EXPECT_NEAR(-0.6, r.distance, 1e-9);
  EXPECT_NEAR(1, r.normal[0], 1e-9);
}

// A limited query finds the same distance within the limit, and a lower bound beyond it.
TEST(Surfaces, LimitedDistanceIsALowerBound) {
  int beyond = 0, within = 0;
  for (int i = 0; i < samples(400); ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i)};
    Faceted field, ring;
    hills(field, g, 12, 9), ring_mesh(ring, 12, 8);
    const Solid s = g.shape(Type(g.pick(shape::type_count)), 0.6);
    const Pose A = {g.rotation(), g.direction()}, B = {g.rotation(), g.direction() * g.uniform(0, 3)};
    for (const Faceted* surface : {&field, &ring})
      for (const double most : {0.0, 0.02, 0.3}) {
        collision::Options limited;
        limited.max_distance = most;
        const Result exact = query(surface->shape, A, s.shape, B), r = query(surface->shape, A, s.shape, B, limited);
        ASSERT_EQ(exact.distance <= most, r.distance <= most);
        if (exact.distance <= most) {
          ASSERT_NEAR(exact.distance, r.distance, 1e-9);
          ++within;
        } else {
          ASSERT_LE(r.distance, exact.distance + exact.residual + 1e-9);
          ++beyond;
        }
      }
  }
  EXPECT_GT(beyond, 100);
  EXPECT_GT(within, 100);
}

// Where a shape touches a surface to rounding, a limited search finds it: a gap of 1e-17 gives no direction.
TEST(Surfaces, ShapesThatTouchAreFoundWithinALimit) {
  collision::Options limited;
  limited.max_distance = 1e-3;
  int touching = 0;
  for (int k = 0; k < samples(400); ++k) {
    SCOPED_TRACE(k);
    Chance g{std::uint64_t(k)};
    std::vector<double> heights(64);
    for (double& x : heights) x = g.uniform(0, 0.2);
    Faceted m;
    m.finish_field(heights, 8, 8, 0.25, 0.25, -0.1);
    const Solid c = g.shape(Type(g.pick(shape::type_count)), 0.1);
    if (c.shape.type == Type::HalfSpace) continue;
    Pose B = {g.rotation(), Vec::make(g.uniform(-0.4, 0.4), g.uniform(-0.4, 0.4), 0.5)};
    for (int n = 0; n < 4; ++n) {
      const Result r = query(m.shape, Pose::identity(), c.shape, B);
      B.p = B.p - r.normal * r.distance;
    }
    for (int n = 0; n < 100; ++n) {
      Pose near = B;
      near.p = near.p + g.direction() * 1e-16;
      const Result r = query(m.shape, Pose::identity(), c.shape, near, limited);
      ASSERT_LE(std::abs(r.distance), 1e-8);
      touching += r.distance == 0 || std::abs(r.distance) < 1e-16;
    }
  }
  EXPECT_GT(touching, 100);
}

// Rounded triangles equal the rounded box, except inside.
TEST(Surfaces, RoundedMeshes) {
  Faceted m;
  box_mesh(m, 1, 1, 1);
  m.shape.radius = 0.1;
  Solid b = box(1, 1, 1);
  b.shape.radius = 0.1;
  for (int k = 0; k < 500; ++k) {
    Chance g{std::uint64_t(k)};
    const Vec o = g.direction() * 2.0, d = g.direction() * 0.6 - o;
    const shape::Hit one = shape::Box(b.shape).ray(o, d), other = Triangles(m.shape).ray(o, d);
    ASSERT_EQ(one.t < shape::infinity, other.t < shape::infinity);
    if (one.t < shape::infinity) {
      ASSERT_NEAR(one.t, other.t, 1e-9);
    }
    const Solid c = g.shape(Type(g.pick(shape::type_count)), 0.4);
    const Pose B = {g.rotation(), g.direction() * 2.0};
    const double expected = query(b.shape, Pose::identity(), c.shape, B).distance;
    if (expected > 0) {
      ASSERT_NEAR(expected, query(m.shape, Pose::identity(), c.shape, B).distance, 1e-9);
    }
  }
}

}  // namespace
}  // namespace dyn_test
