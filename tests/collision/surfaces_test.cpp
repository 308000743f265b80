// Triangle meshes and height fields: every query against brute force over all pieces.
#include "collision/surfaces.hpp"

namespace dyn_test {
namespace {

using shape::HeightField;
using shape::Triangles;

// f(faceted, chance) for several surfaces of both kinds.
template <class F>
void each_surface(F&& f) {
  for (int kind = 0; kind < 3; ++kind) {
    SCOPED_TRACE(kind == 0 ? "ring" : kind == 1 ? "sheet" : "hills");
    Chance g{std::uint64_t(kind) + 77};
    Faceted s;
    if (kind == 0) ring_mesh(s, 14, 7);
    if (kind == 1) {
      hills(s, g, 9, 8);
      s.finish(false);
    }
    if (kind == 2) hills(s, g, 9, 8);
    f(s, g);
    if (testing::Test::HasFatalFailure()) return;
  }
}
template <class F>
void with(const Faceted& s, F&& f) {
  if (s.shape.type == Type::Triangles) f(Triangles(s.shape));
  else f(HeightField(s.shape));
}

TEST(Surfaces, DistanceToConvexShapesIsTheLeastOfAllPieces) {
  int inside = 0, apart = 0, meeting = 0, through = 0;
  each_surface([&](const Faceted& s, Chance& g) {
    for (int type = 0; type < shape::type_count; ++type)
      for (int k = 0; k < samples(120); ++k) {
        const Type t = Type(type);
        SCOPED_TRACE(testing::Message() << name_of(t) << " " << k);
        const Solid b = g.shape(t, g.pick(2) ? g.uniform(0.02, 0.2) : g.uniform(0.2, 0.8));
        const Pose A = random_pose(g, 3), B = {g.rotation(), A.p + g.direction() * g.uniform(0, 3)};
        const Result r = query(s.shape, A, b.shape, B), back = query(b.shape, B, s.shape, A);
        ASSERT_EQ(r.distance, back.distance);
        ASSERT_LE(shape::norm(r.normal + back.normal) + shape::norm(r.point_a - back.point_b), 1e-12);
        ASSERT_NEAR(1, shape::norm(r.normal), 1e-12);
        ASSERT_LE(shape::norm(r.point_b - r.point_a - r.normal * r.distance), 1e-9);
        ASSERT_NE(Status::Failed, r.status);
        const double expected = every_piece(s, A, b.shape, B);
        // closed meshes have further properties
        if (s.tree.closed && (t == Type::Sphere || expected > 0) && r.distance < 0 && r.distance < expected - 1e-9) {
          ++inside;
          continue;
        }
        if (s.shape.type == Type::HeightField && t == Type::Sphere && r.distance < 0) continue;  // decided by the centre: below
        // deeper, where the way out of one piece leads into the next
        if (expected < 0 && r.distance < expected - 1e-3 * size_of(b)) {
          ASSERT_GE(query(s.shape, A, b.shape, {B.R, B.p - r.normal * r.distance}).distance, -1e-7);
          ++through;
          continue;
        }
        // minimality of the depth is certain to 1e-3 (EPA)
        ASSERT_NEAR(expected, r.distance, r.distance > 0 ? 1e-9 : 1e-3 * size_of(b));
        (r.distance > 0 ? apart : meeting)++;
      }
  });
  EXPECT_LT(through, meeting / 2);
  EXPECT_GT(inside, 5);
  EXPECT_GT(apart, 200);
  EXPECT_GT(meeting, 100);
}

TEST(Surfaces, DistanceToSurfacesIsTheLeastOfAllPairs) {
  int apart = 0, meeting = 0;
  for (int k = 0; k < 30; ++k) {
    SCOPED_TRACE(k);
    Chance g{std::uint64_t(k) + 5};
    Faceted a, b;
    ring_mesh(a, 9, 5);
    if (k % 2) ring_mesh(b, 6, 4, 0.5, 0.2);
    else hills(b, g, 5, 4);
    const Pose A = random_pose(g, 2), B = {g.rotation(), A.p + g.direction() * g.uniform(0, 3)};
    double expected = shape::infinity;
    shape::Facet f;
    for (Index t = 0; t < b.count(); ++t) {
      b.piece(t, f);
      expected = std::min(expected, every_piece(a, A, f.shape(0), {B.R, B.act(f.origin)}));
    }
    const Result r = query(a.shape, A, b.shape, B), back = query(b.shape, B, a.shape, A);
    ASSERT_NEAR(r.distance, back.distance, 1e-9);
    if (expected > 0 && r.distance < 0) continue;  // one inside the other
    ASSERT_NEAR(expected, r.distance, 1e-9);
    ASSERT_LE(shape::norm(r.point_b - r.point_a - r.normal * r.distance), 1e-9);
    (r.distance > 0 ? apart : meeting)++;
  }
  EXPECT_GT(apart, 8);
  EXPECT_GT(meeting, 5);
}

// Solid angles of all triangles sum to 4 pi inside and zero outside (Van Oosterom, Strackee 1983).
bool wound(const Faceted& s, const Vec& p) {
  double sum = 0;
  for (Index t = 0; t < s.count(); ++t) {
    const Vec a = s.corner(t, 0) - p, b = s.corner(t, 1) - p, c = s.corner(t, 2) - p;
    const double x = shape::norm(a), y = shape::norm(b), z = shape::norm(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return std::abs(sum) > 2 * pi;
}

TEST(Surfaces, NearestPointAgainstAllTriangles) {
  int inside = 0;
  each_surface([&](const Faceted& s, Chance& g) {
    for (int k = 0; k < 1000; ++k) {
      const Vec p = g.direction() * g.uniform(0, 2);
      double expected = shape::infinity;
      for (Index t = 0; t < s.count(); ++t)
        expected =
            std::min(expected, shape::norm(p - shape::nearest_of_triangle(s.corner(t, 0), s.corner(t, 1), s.corner(t, 2), p)));
      with(s, [&]<class S>(const S& x) {
        const shape::Nearest n = x.nearest(p);
        ASSERT_NEAR(1, shape::norm(n.normal), 1e-12);
        ASSERT_LE(shape::norm(p - n.point - n.normal * n.distance), 1e-12);
        if constexpr (S::type == Type::Triangles) {
          ASSERT_NEAR(expected, std::abs(n.distance), 1e-12);
          if (!x.closed()) {
            ASSERT_GE(n.distance, 0);
          } else {
            ASSERT_EQ(wound(s, p), n.distance < 0);
          }
        } else {
          ASSERT_LE(std::abs(n.distance), expected + 1e-12);
          ASSERT_EQ(x.inside(p), n.distance < 0);
          ASSERT_NEAR(0, x.nearest(n.point).distance, 1e-12);
        }
        inside += n.distance < 0;
      });
    }
  });
  EXPECT_GT(inside, 100);
}

TEST(Surfaces, RaysAgainstAllTriangles) {
  int hits = 0;
  each_surface([&](const Faceted& s, Chance& g) {
    for (int k = 0; k < 1000; ++k) {
      const Vec o = g.direction() * g.uniform(0, 3), d = (g.direction() * 0.9 - o) * g.uniform(0.1, 2);
      double expected = shape::infinity;
      for (Index t = 0; t < s.count(); ++t) {
        const Vec corner[] = {s.corner(t, 0), s.corner(t, 1), s.corner(t, 2)};
        expected = std::min(expected, shape::cross_triangle(corner, o, d).t);
      }
      with(s, [&]<class S>(const S& x) {
        const shape::Hit hit = x.ray(o, d);
        if (x.closed() && x.nearest(o).distance <= 0) {
          ASSERT_EQ(0, hit.t);
          return;
        }
        if constexpr (S::type == Type::HeightField) {
          ASSERT_LE(hit.t, expected * (1 + 1e-12));
          if (hit.t < shape::infinity) {
            ASSERT_NEAR(0, x.nearest(o + d * hit.t).distance, 1e-12);
          }
        } else if (expected == shape::infinity) {
          ASSERT_EQ(expected, hit.t);
        } else {
          ASSERT_NEAR(expected, hit.t, 1e-12 * (1 + expected));
        }
        if (hit.t < shape::infinity) {
          ++hits;
          ASSERT_LE(dot(hit.normal, d), 1e-12);
          ASSERT_NEAR(1, shape::norm(hit.normal), 1e-12);
        }
      });
    }
  });
  EXPECT_GT(hits, 500);
}

TEST(Surfaces, SupportAndBoundsAgainstAllVertices) {
  each_surface([&](const Faceted& s, Chance& g) {
    for (int k = 0; k < 200; ++k) {
      const Vec d = g.direction();
      double most = -shape::infinity;
      for (std::size_t v = 0; v < s.vertices.size(); v += 3) {
        const Vec p = load3(s.vertices.data() + v);
        most = std::max(most, dot(d, p));
        if (s.shape.type == Type::HeightField) most = std::max(most, dot(d, Vec::make(p[0], p[1], s.grid.bottom)));
      }
      with(s, [&](const auto& x) {
        ASSERT_NEAR(most, dot(d, x.support(d)), 1e-14);
        const Pose X = random_pose(g, 1);
        ASSERT_NEAR(x.bounds(X).upper[0],
                    X.p[0] + dot(x.support(transpose_times(X.R, shape::axis(0))), transpose_times(X.R, shape::axis(0))), 1e-14);
      });
    }
  });
}

// Derivative of the distance by the motion of B, from normal and witness points.
TEST(Surfaces, GradientAgainstDifferences) {
  int compared = 0, flagged = 0;
  each_surface([&](const Faceted& s, Chance& g) {
    for (int k = 0; k < samples(600); ++k) {
      const Solid b = g.shape(Type(g.pick(shape::type_count)), 0.5);
      const Pose A = random_pose(g, 2), B = {g.rotation(), A.p + g.direction() * g.uniform(0.3, 2.5)};
      const Result r = query(s.shape, A, b.shape, B);
      if (!r.unique) {
        ++flagged;
        continue;
      }
      const Vec v = g.direction(), w = g.direction();
      auto at = [&](double t) {
        const Eigen::AngleAxisd turn(t, Eigen::Vector3d(w[0], w[1], w[2]));
        const Eigen::Matrix3d R = turn.toRotationMatrix();
        const Mat3<double> T = {Vec::make(R(0, 0), R(1, 0), R(2, 0)), Vec::make(R(0, 1), R(1, 1), R(2, 1)),
                                Vec::make(R(0, 2), R(1, 2), R(2, 2))};
        return query(s.shape, A, b.shape, {T * B.R, B.p + v * t}).distance;
      };
      const double h = 1e-5, central = (at(h) - at(-h)) / (2 * h), wide = (at(2 * h) - at(-2 * h)) / (4 * h);
      if (std::abs(central - wide) > 1e-4) continue;  // a kink is near
      ++compared;
      ASSERT_NEAR(dot(r.normal, v + cross(w, r.point_b - B.p)), central, 1e-4) << name_of(b.shape.type) << " at " << r.distance;
    }
  });
  EXPECT_GT(compared, 1000);
  RecordProperty("flagged", flagged);
}

}  // namespace
}  // namespace dyn_test
