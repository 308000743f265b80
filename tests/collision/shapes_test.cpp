// The contract of every shape: support, nearest point, box, rays and moments agree with each other and with closed forms.
#include "collision/scene.hpp"

namespace dyn_test {
namespace {

template <class F>
void each(Type t, int count, F&& f) {
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    Chance g{std::uint64_t(i) * 8 + std::uint64_t(t)};
    const Solid s = g.shape(t, 1);
    shape::visit(s.shape, [&](const auto& x) { f(x, g, s); });
    if (testing::Test::HasFatalFailure()) return;
  }
}

class Shapes : public testing::TestWithParam<int> {
 protected:
  Type type() const { return Type(GetParam()); }
};

TEST_P(Shapes, SupportPointsLieOnTheBoundaryAndNothingIsBeyond) {
  each(type(), 200, [&]<class S>(const S& x, Chance& g, const Solid&) {
    if constexpr (S::type != Type::HalfSpace) {
      const Vec d = g.direction();
      const Vec s = x.support(d);
      ASSERT_NEAR(0, x.nearest(s).distance, 1e-14);
      ASSERT_LE(shape::norm(s), x.extent() + 1e-14);
      for (int k = 0; k < 50; ++k) ASSERT_LE(dot(d, x.nearest(g.direction() * g.uniform(0, 3)).point), dot(d, s) + 1e-14);
    }
  });
}

TEST_P(Shapes, NearestPointIsOnTheBoundaryAlongTheNormal) {
  each(type(), 500, [&]<class S>(const S& x, Chance& g, const Solid&) {
    const Vec p = g.direction() * g.uniform(0, 2);
    const shape::Nearest n = x.signed_distance(p);
    ASSERT_NEAR(1, shape::norm(n.normal), 1e-13);
    ASSERT_LE(shape::norm(p - n.point - n.normal * n.distance), 1e-13);
    ASSERT_NEAR(0, x.signed_distance(n.point).distance, 1e-13);
    if constexpr (S::type != Type::HalfSpace) {
      // for p outside, the plane through the nearest point supports the shape, so no point is nearer
      if (n.distance > 0) {
        ASSERT_LE(dot(n.normal, x.support(n.normal)) + x.radius - dot(n.normal, n.point), 1e-12);
      }
      // inside, every supporting plane is at least as far
      for (int k = 0; k < 50 && n.distance < 0; ++k) {
        const Vec d = g.direction();
        ASSERT_GE(dot(d, x.support(d)) + x.radius - dot(d, p), -n.distance - 1e-12);
      }
    }
  });
}

TEST_P(Shapes, NearestPointOnAxesAndPlanesOfSymmetry) {
  each(type(), 100, [&]<class S>(const S& x, Chance& g, const Solid&) {
    for (int zeros = 1; zeros < 8; ++zeros) {
      double p[3];
      for (int i = 0; i < 3; ++i) p[i] = zeros >> i & 1 ? 0 : g.uniform(-1.5, 1.5);
      const shape::Nearest n = x.signed_distance(load3(p));
      ASSERT_NEAR(1, shape::norm(n.normal), 1e-13);
      ASSERT_LE(shape::norm(load3(p) - n.point - n.normal * n.distance), 1e-13);
      ASSERT_NEAR(0, x.signed_distance(n.point).distance, 1e-12);
      if constexpr (S::type != Type::HalfSpace) {
        for (int k = 0; k < 50; ++k) {
          const Vec d = g.direction();
          ASSERT_GE(dot(d, x.support(d)) + x.radius - dot(d, load3(p)), -n.distance - 1e-12);
        }
      }
    }
  });
}

TEST_P(Shapes, BoundsAreTight) {
  each(type(), 200, [&]<class S>(const S& x, Chance& g, const Solid&) {
    const Pose X = {g.rotation(), g.direction()};
    const shape::Bounds b = x.bounds(X);
    if constexpr (S::type != Type::HalfSpace) {
      for (int i = 0; i < 3; ++i)
        for (double sign : {-1., 1.}) {
          const Vec n = shape::axis(i) * sign;
          const double h = dot(n, X.act(x.support(transpose_times(X.R, n)))) + x.radius;
          ASSERT_NEAR(h, sign > 0 ? b.upper[i] : -b.lower[i], 1e-14);
        }
    } else {
      ASSERT_EQ(shape::infinity, b.upper[0]);
    }
  });
}

TEST_P(Shapes, RaysMeetTheBoundaryFirstWhereTheySay) {
  int hits = 0;
  each(type(), 500, [&]<class S>(const S& x, Chance& g, const Solid&) {
    const Vec o = g.direction() * g.uniform(0, 3), d = (g.direction() * 0.7 - o) * g.uniform(0.1, 2);
    const shape::Hit hit = x.ray(o, d);
    const bool meets = hit.t < shape::infinity;
    hits += meets;
    if (meets) {
      const shape::Nearest n = x.signed_distance(o + d * hit.t);
      if (hit.t > 0) {
        ASSERT_NEAR(0, n.distance, 1e-12);
      } else {
        ASSERT_LE(n.distance, 1e-12);
      }
      ASSERT_NEAR(1, shape::norm(hit.normal), 1e-12);
      if (hit.t > 0) {
        ASSERT_LE(dot(hit.normal, d), 1e-12);
      }
    }
    for (int k = 0; k < 30; ++k) {
      const double t = (meets ? hit.t : 5) * g.uniform(0, 1);
      ASSERT_GE(x.signed_distance(o + d * t).distance, meets && hit.t == 0 ? -3 : -1e-12);
    }
  });
  EXPECT_GT(hits, 100);
}

// Chords of a grid of rays along z.
TEST_P(Shapes, MomentsAgainstChords) {
  if (type() == Type::HalfSpace) return;
  each(type(), 6, [&]<class S>(const S& x, Chance&, const Solid& s) {
    if constexpr (S::type == Type::Ellipsoid || S::type == Type::Convex)
      if (x.radius > 0) return;
    const int n = 160;
    const double reach = size_of(s);
    const shape::Bounds box = x.bounds(Pose::identity());
    const Vec step = (box.upper - box.lower) * (1.0 / n);
    double m = 0, q[3] = {}, h = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double px = box.lower[0] + (i + 0.5) * step[0], py = box.lower[1] + (j + 0.5) * step[1], area = step[0] * step[1];
        const shape::Hit in = x.ray(Vec::make(px, py, -2 * reach), shape::axis(2)),
                         out = x.ray(Vec::make(px, py, 2 * reach), -shape::axis(2));
        if (!(in.t < shape::infinity && out.t < shape::infinity)) continue;
        const double a = in.t - 2 * reach, b = 2 * reach - out.t, dm = (b - a) * area;
        m += dm, q[0] += dm * px * px, q[1] += dm * py * py, q[2] += area * (b * b * b - a * a * a) / 3,
            h += area * (b * b - a * a) / 2;
      }
    const Inertia<double> Y = x.mass_properties(2);
    const double scale = 2 * m;
    ASSERT_NEAR(2 * m, Y.m, 0.01 * scale);
    ASSERT_NEAR(2 * h, Y.h[2], 0.01 * scale * reach);
    ASSERT_NEAR(2 * (q[1] + q[2]), Y.I.d[0], 0.02 * scale * reach * reach);
    ASSERT_NEAR(2 * (q[0] + q[1]), Y.I.d[2], 0.02 * scale * reach * reach);
  });
}

INSTANTIATE_TEST_SUITE_P(All, Shapes, testing::Range(0, shape::type_count),
                         [](const auto& info) { return std::string(name_of(Type(info.param))); });

// Shapes that are equal in the limit have the same moments to the last digits.
TEST(Moments, DegenerateShapesAgree) {
  auto moments = [](const Solid& s) {
    Inertia<double> Y{};
    shape::visit(s.shape, [&](const auto& x) { Y = x.solid(); });
    return Y;
  };
  auto same = [&](const Solid& a, const Solid& b) {
    const Inertia<double> A = moments(a), B = moments(b);
    EXPECT_NEAR(A.m, B.m, 1e-14);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(A.I.d[i], B.I.d[i], 1e-14);
  };
  const double r = 0.7, h = 0.4;
  same(sphere(r), make(Type::Box, Vec::zero(), r));
  same(sphere(r), make(Type::Capsule, Vec::zero(), r));
  same(sphere(r), make(Type::Ellipsoid, Vec::make(r, r, r), 0));
  same(capsule(r, 2 * h), make(Type::Box, Vec::make(0, 0, h), r));
  same(capsule(r, 2 * h), make(Type::Cylinder, Vec::make(0, 0, h), r));
  same(box(1, 2, 3), make_convex(corners(1, 2, 3)));
}
// A cone of unit radius and height 2: pi r^2 h / 3, centroid a quarter of the height up, 3/10 m r^2 about its axis.
TEST(Moments, Cone) {
  Inertia<double> Y{};
  shape::visit(make(Type::Cone, Vec::make(1, 1, 1), 0).shape, [&](const auto& x) { Y = x.solid(); });
  EXPECT_NEAR(2 * pi / 3, Y.m, 1e-14);
  EXPECT_NEAR(-0.5 * Y.m, Y.h[2], 1e-14);
  EXPECT_NEAR(0.3 * Y.m, Y.I.d[2], 1e-14);
}

// Large hulls use hill climbing, small ones test every vertex.
TEST(Hulls, BothSearchesFindTheSameHeight) {
  Chance g(5);
  std::vector<Vec> points;
  for (int i = 0; i < 150; ++i) points.push_back(g.direction());
  const Solid s = make_convex(points);
  ASSERT_EQ(150, s.hull->hull.vertices);
  for (int i = 0; i < 1000; ++i) {
    const Vec d = g.direction();
    double most = -2;
    for (const Vec& p : points) most = std::max(most, dot(p, d));
    EXPECT_NEAR(most, dot(d, shape::Convex(s.shape).support(d)), 1e-15);
  }
}

}  // namespace
}  // namespace dyn_test
