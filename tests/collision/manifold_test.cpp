// Contact manifolds: closed forms, properties of every pair, and a reference by sampling.
#include <gtest/gtest.h>

#include <set>

#include "collision/scene.hpp"
#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"

namespace dyn_test {
namespace {

using collision::Contact;
using collision::Manifold;

Manifold manifold(const Scene& s, double margin) {
  Manifold m;
  collision::contacts(s.a.shape, s.A, s.b.shape, s.B, margin, workspace(), m);
  return m;
}
Mat3<double> turn(const Vec& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Mat3<double>::identity() * c + skew(axis) * s + outer(axis, axis) * (1 - c);
}
Solid ground() { return make(Type::HalfSpace, Vec::zero(), 0); }
std::vector<Vec> positions(const Manifold& m) {
  std::vector<Vec> out;
  for (int i = 0; i < m.count; ++i) out.push_back(m.points[i].position);
  return out;
}
// Hausdorff distance from one set to the other, one way.
double apart(const std::vector<Vec>& a, const std::vector<Vec>& b) {
  double worst = 0;
  for (const Vec& x : a) {
    double near = shape::infinity;
    for (const Vec& y : b) near = std::min(near, shape::norm(x - y));
    worst = std::max(worst, near);
  }
  return worst;
}
void expect_points(const Manifold& m, const std::vector<Vec>& expected, double tolerance = 1e-9) {
  EXPECT_EQ(expected.size(), std::size_t(m.count));
  EXPECT_LE(apart(expected, positions(m)), tolerance);
  EXPECT_LE(apart(positions(m), expected), tolerance);
}

TEST(Manifold, BoxOnAPlane) {
  const Scene flat = {ground(), box(2, 4, 6), at(0, 0, 0), at(1, 2, 2.99)};
  const Manifold m = manifold(flat, 0.1);
  expect_points(m, {Vec::make(0, 0, -0.005), Vec::make(2, 0, -0.005), Vec::make(0, 4, -0.005), Vec::make(2, 4, -0.005)});
  EXPECT_NEAR(1, m.normal[2], 1e-15);
  for (int i = 0; i < m.count; ++i) EXPECT_NEAR(-0.01, m.points[i].distance, 1e-14);
  // on an edge, on a corner, in the air
  Scene edge = flat;
  edge.B.R = turn(shape::axis(0), 0.8), edge.B.p = Vec::make(0, 0, 2 * std::sin(0.8) + 3 * std::cos(0.8));
  EXPECT_EQ(2, manifold(edge, 1e-3).count);
  Scene corner = edge;
  corner.B = {turn(shape::axis(0), 0.8) * turn(shape::axis(1), 0.5), Vec::zero()};
  corner.B.p = Vec::make(0, 0, -query(corner).distance);
  EXPECT_EQ(1, manifold(corner, 1e-3).count);
  Scene air = flat;
  air.B.p = Vec::make(0, 0, 3.2);
  EXPECT_EQ(0, manifold(air, 0.1).count);
  EXPECT_EQ(4, manifold(air, 0.3).count);
}

TEST(Manifold, BoxOnABox) {
  Scene s = {box(2, 2, 2), box(2, 2, 2), at(0, 0, 0), at(0, 0, 1.99)};
  expect_points(manifold(s, 0.01),
                {Vec::make(1, 1, 0.995), Vec::make(-1, 1, 0.995), Vec::make(1, -1, 0.995), Vec::make(-1, -1, 0.995)});
  s.B.p = Vec::make(0.5, 1.5, 1.99);
  expect_points(manifold(s, 0.01),
                {Vec::make(1, 1, 0.995), Vec::make(-0.5, 1, 0.995), Vec::make(1, 0.5, 0.995), Vec::make(-0.5, 0.5, 0.995)});
  // rotated by 45 degrees: the corners of an octagon
  s.B = {turn(shape::axis(2), std::acos(-1.0) / 4), Vec::make(0, 0, 1.99)};
  const double t = std::sqrt(2.0) - 1;
  std::vector<Vec> octagon;
  for (double x : {1.0, -1.0})
    for (double y : {t, -t}) octagon.push_back(Vec::make(x, y, 0.995)), octagon.push_back(Vec::make(y, x, 0.995));
  expect_points(manifold(s, 0.01), octagon, 1e-7);
  // a small box over the middle, an edge, a corner
  s.b = box(0.2, 0.2, 0.2), s.B = at(0.3, 0.3, 1.1);
  EXPECT_EQ(4, manifold(s, 0.01).count);
  s.B = at(1, 0.3, 1.1);
  expect_points(manifold(s, 0.01), {Vec::make(1, 0.2, 1), Vec::make(1, 0.4, 1), Vec::make(0.9, 0.2, 1), Vec::make(0.9, 0.4, 1)});
  s.B = at(1, 1, 1.1);
  expect_points(manifold(s, 0.01), {Vec::make(1, 1, 1), Vec::make(1, 0.9, 1), Vec::make(0.9, 1, 1), Vec::make(0.9, 0.9, 1)});
  // crossing edges
  s = {box(2, 2, 2), box(2, 2, 2), {turn(shape::axis(0), std::acos(-1.0) / 4), Vec::zero()},
       {turn(shape::axis(1), std::acos(-1.0) / 4), Vec::make(0, 0, 2 * std::sqrt(2.0) - 0.01)}};
  expect_points(manifold(s, 0.005), {Vec::make(0, 0, std::sqrt(2.0) - 0.005)}, 1e-7);
}

TEST(Manifold, RoundShapes) {
  const double half_turn = std::acos(-1.0);
  // a cylinder on its cap and on its side, a capsule on its side and on its end
  Scene s = {ground(), cylinder(0.5, 2), at(0, 0, 0), at(0, 0, 0.99)};
  Manifold m = manifold(s, 0.1);
  EXPECT_EQ(8, m.count);
  for (int i = 0; i < m.count; ++i) EXPECT_NEAR(0.5, shape::length2(m.points[i].position[0], m.points[i].position[1]), 1e-14);
  s.B = {turn(shape::axis(1), half_turn / 2), Vec::make(0, 0, 0.5)};
  expect_points(manifold(s, 0.1), {Vec::make(1, 0, 0), Vec::make(-1, 0, 0)});
  s.b = capsule(0.5, 2);
  expect_points(manifold(s, 0.1), {Vec::make(1, 0, 0), Vec::make(-1, 0, 0)});
  s.B = at(0, 0, 1.5);
  expect_points(manifold(s, 0.1), {Vec::make(0, 0, 0)});
  s.a = box(1, 4, 2), s.A = at(0, 0, -1), s.B = {turn(shape::axis(1), half_turn / 2), Vec::make(0.2, 0, 0.5)};
  expect_points(manifold(s, 0.1), {Vec::make(0.5, 0, 0), Vec::make(-0.5, 0, 0)});
  // two capsules, parallel and crossed
  s.a = capsule(0.25, 2), s.A = {turn(shape::axis(1), half_turn / 2), Vec::make(0.5, 0, -0.25)};
  expect_points(manifold(s, 0.1), {Vec::make(1.2, 0, 0), Vec::make(-0.5, 0, 0)}, 1e-7);
  s.A.R = turn(shape::axis(0), half_turn / 2);
  expect_points(manifold(s, 0.1), {Vec::make(0.5, 0, 0)}, 1e-7);
  // a cone on its base, on its side, on its apex
  s = {ground(), make(Type::Cone, Vec::make(0.5, 0.5, 1), 0), at(0, 0, 0), at(0, 0, 1)};
  EXPECT_EQ(8, manifold(s, 0.1).count);
  s.B.R = turn(shape::axis(1), half_turn);
  EXPECT_EQ(1, manifold(s, 0.1).count);
  s.B.R = turn(shape::axis(1), half_turn / 2 + std::atan(0.25));
  s.B.p = Vec::zero();
  s.B.p = Vec::make(0, 0, -query(s).distance);
  EXPECT_EQ(2, manifold(s, 0.1).count);
  for (const Solid& round : {sphere(0.5), make(Type::Ellipsoid, Vec::make(0.3, 0.2, 0.5), 0)}) {
    s = {ground(), round, at(0, 0, 0), at(0.7, 0, 0.5)};
    expect_points(manifold(s, 0.1), {Vec::make(0.7, 0, 0)});
  }
  EXPECT_EQ(0, manifold({ground(), ground(), at(0, 0, 0), at(0, 0, -1)}, 1).count);
  // a hull that is a box
  s = {ground(), make_convex(corners(2, 4, 6)), at(0, 0, 0), at(1, 2, 3)};
  expect_points(manifold(s, 0.1), {Vec::make(0, 0, 0), Vec::make(2, 0, 0), Vec::make(0, 4, 0), Vec::make(2, 4, 0)});
}

// Poses near touching: properties of every pair.
struct Sample {
  Scene s;
  Result r;
  double size, margin;
};
template <class F>
void for_each_sample(int count, F&& f) {
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = 0; b < shape::type_count; ++b)
      for (int k = 0; k < count && (a != 0 || b != 0); ++k) {
        static constexpr Case cases[] = {Case::Touching, Case::NearlyTouching, Case::Aligned, Case::Random, Case::Far};
        Sample x;
        x.s = scene(Type(a), Type(b), cases[k % 5], std::uint64_t(k) + 77);
        x.size = std::min(a == 0 ? 1e9 : size_of(x.s.a), b == 0 ? 1e9 : size_of(x.s.b));
        Chance g{std::uint64_t(k)};
        // shallow, apart, deep
        x.r = query(x.s);
        x.s.B.p -= x.r.normal * (x.r.distance - x.size * (k % 3 == 0 ? -1e-3 : k % 3 == 1 ? 1e-3 : -0.05));
        x.r = query(x.s);
        x.margin = x.size * g.uniform(0.002, 0.02);
        SCOPED_TRACE(std::string(name_of(Type(a))) + "-" + name_of(Type(b)) + " " + std::to_string(k));
        f(x);
        if (testing::Test::HasFailure()) return;
      }
}

TEST(Manifold, HoldsOfEveryPair) {
  for_each_sample(samples(200), [](const Sample& x) {
    const Manifold m = manifold(x.s, x.margin);
    EXPECT_EQ(x.r.distance <= x.margin, m.count > 0);
    if (m.count == 0) return;
    const double far = 1e-13 * (shape::norm(x.s.A.p) + shape::norm(x.s.B.p)), tolerance = 2e-6 * x.size + far;
    EXPECT_LE(shape::norm(m.normal - x.r.normal), 1e-12);
    double deepest = shape::infinity;
    for (int i = 0; i < m.count; ++i) {
      const Contact& c = m.points[i];
      deepest = std::min(deepest, c.distance);
      EXPECT_LE(c.distance, x.margin);
      EXPECT_GE(c.distance, x.r.distance - tolerance);
      EXPECT_TRUE(i == 0 || m.points[i - 1].feature < c.feature);
      // on both shapes, or within one that slopes away from the other
      const double a = outside(x.s.a, x.s.A, c.position - m.normal * (c.distance / 2)),
                   b = outside(x.s.b, x.s.B, c.position + m.normal * (c.distance / 2));
      EXPECT_LE(std::max(a, b), tolerance);
      EXPECT_GE(std::min(a, b), x.r.distance - x.margin - tolerance);
    }
    EXPECT_NEAR(x.r.distance, deepest, tolerance);
  });
}

TEST(Manifold, ExchangedAndMoved) {
  int compared = 0, equal_ids = 0, differ = 0;
  for_each_sample(samples(100), [&](const Sample& x) {
    const Manifold m = manifold(x.s, x.margin), other = manifold({x.s.b, x.s.a, x.s.B, x.s.A}, x.margin);
    Chance g(7);
    const Pose X = {g.rotation(), g.direction()};
    const Manifold moved = manifold({x.s.a, x.s.b, X * x.s.A, X * x.s.B}, x.margin);
    // where another normal is equally good, another one may be found
    if (shape::norm(m.normal + other.normal) > 1e-9 || shape::norm(X.R * m.normal - moved.normal) > 1e-9) return;
    auto near_margin = [&](const Manifold& a) {
      for (int i = 0; i < a.count; ++i)
        if (a.points[i].distance > x.margin - 1e-4 * x.size) return true;
      return false;
    };
    if (near_margin(m) || near_margin(other) || near_margin(moved)) return;
    if (m.count == 8) return;                  // may be reduced: ThinnedOut
    if (m.count == 1 && !x.r.unique) return;  // the witness points, one choice of many
    ++compared;
    std::vector<Vec> back;
    for (const Vec& p : positions(moved)) back.push_back(X.act_inverse(p));
    const double tolerance = 3e-5 * x.size;
    // farther points depend on which of two features faces the other shape: a tie at 45 degrees
    auto near = [&](const Manifold& of, std::vector<Vec> points) {
      std::vector<Vec> out;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (of.points[i].distance <= x.r.distance + 0.2 * (x.margin - x.r.distance)) out.push_back(points[i]);
      return out;
    };
    differ += apart(near(m, positions(m)), positions(other)) > tolerance ||
              apart(near(other, positions(other)), positions(m)) > tolerance || apart(near(m, positions(m)), back) > tolerance ||
              apart(near(moved, back), positions(m)) > tolerance;
    bool same = m.count == moved.count;
    for (int i = 0; same && i < m.count; ++i) same = m.points[i].feature == moved.points[i].feature;
    equal_ids += same;
  });
  EXPECT_GT(compared, samples(100) * 20);
  EXPECT_LE(differ, compared / 10000);  // such ties
  EXPECT_GE(equal_ids, compared * 0.98);
}

// Through small motions numbers persist, and points move no more than the shapes.
TEST(Manifold, ContinuousAndPersistent) {
  int kept = 0, all = 0;
  for_each_sample(samples(60), [&](const Sample& x) {
    const double step = 1e-7;
    Chance g{std::uint64_t(x.size * 1e6)};
    const Vec axis = g.direction();
    Scene next = x.s;
    next.B.R = turn(axis, step) * next.B.R, next.B.p += g.direction() * (step * x.size);
    const Manifold m = manifold(x.s, x.margin), n = manifold(next, x.margin);
    if (m.count == 0 || n.count == 0 || shape::norm(m.normal - n.normal) > 1e-4 || !x.r.unique) return;
    for (int i = 0; i < m.count; ++i) {
      if (m.points[i].distance > 0.9 * x.margin) continue;
      ++all;
      for (int k = 0; k < n.count; ++k)
        kept += n.points[k].feature == m.points[i].feature &&
                shape::norm(n.points[k].position - m.points[i].position) < 0.01 * x.size;
    }
  });
  EXPECT_GT(all, 1000);
  EXPECT_GE(kept, all * 0.998);
}

// Two boxes face to face: the points span the overlap found by samples.
TEST(Manifold, SpansTheOverlap) {
  Chance g(5);
  int seen = 0;
  for (int k = 0; k < samples(100); ++k) {
    Scene s = {
        box(g.uniform(0.5, 2), g.uniform(0.5, 2), 1),
        g.pick(2) ? box(g.uniform(0.5, 2), g.uniform(0.5, 2), 1) : make_convex(corners(g.uniform(0.5, 2), g.uniform(0.5, 2), 1)),
        at(0, 0, 0),
        {turn(shape::axis(2), g.uniform(0, 6)), Vec::make(g.uniform(-0.7, 0.7), g.uniform(-0.7, 0.7), 0.999)}};
    const Manifold m = manifold(s, 1e-3);
    if (m.count == 0) continue;  // side by side
    if (m.normal[2] < 0.5) {     // nearly so: sideways is shorter than 1e-3 upwards
      EXPECT_NEAR(0, m.normal[2], 1e-9);
      for (int i = 0; i < m.count; ++i) EXPECT_GT(m.points[i].distance, -1e-3);
      continue;
    }
    ASSERT_NEAR(1, m.normal[2], 1e-9);
    ++seen;
    const int n = 60;
    for (int d = 0; d < 32; ++d) {
      const Vec along = Vec::make(std::cos(d * 0.2), std::sin(d * 0.2), 0);
      double most = -1e9, spanned = -1e9;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          const Vec p = Vec::make(s.a.shape.size[0] * (2.0 * i / n - 1), s.a.shape.size[1] * (2.0 * j / n - 1), 0.4995);
          if (outside(s.b, s.B, p) <= 1e-9) most = std::max(most, dot(along, p));
        }
      for (const Vec& p : positions(m)) spanned = std::max(spanned, dot(along, p));
      EXPECT_GE(spanned, most - 1e-6);
      EXPECT_LE(spanned, most + 2 * 2.0 / n);
    }
  }
  EXPECT_GT(seen, samples(100) / 2);
}

// More than eight corners: two drums cap to cap. The deepest point stays, and most of the area.
TEST(Manifold, ThinnedOut) {
  for (double angle : {0.1, 0.3, 0.35})
    for (double tilt : {0.0, 1e-3}) {
      Scene s = {cylinder(1, 1),
                 cylinder(1, 1),
                 at(0, 0, 0),
                 {turn(shape::axis(1), tilt) * turn(shape::axis(2), angle), Vec::make(0.01, 0.02, 0.999)}};
      const Manifold m = manifold(s, 0.1);
      EXPECT_EQ(8, m.count);
      double deepest = 1, reach = 0;
      for (int i = 0; i < m.count; ++i) deepest = std::min(deepest, m.points[i].distance);
      EXPECT_NEAR(query(s).distance, deepest, 1e-6);
      for (int d = 0; d < 64; ++d) {
        double most = 0;
        for (const Vec& p : positions(m)) most = std::max(most, dot(p, Vec::make(std::cos(d * 0.1), std::sin(d * 0.1), 0)));
        reach = d == 0 ? most : std::min(reach, most);
      }
      EXPECT_GT(reach, 0.8);
    }
}

// An axis along the normal is a point. So a capsule that stands, or leans by a sine below 0.05, touches as the ball at its
// lower end does, however large the margin. A capsule without length is a ball at any turn.
TEST(Manifold, StandingCapsuleIsTheBallAtItsEnd) {
  const Solid stick = capsule(0.25, 1), point = capsule(0.25, 0), ball = sphere(0.25), grounds[] = {ground(), capsule(0.25, 2)};
  const Pose poses[] = {at(0, 0, 0), {turn(shape::axis(1), pi / 2), Vec::make(0, 0, -0.25)}};  // the other capsule lies along x
  const auto expect_one = [](const Scene& s, const Vec& center) {
    const Manifold m = manifold(s, 3);  // more than the length
    ASSERT_EQ(1, m.count);
    EXPECT_NEAR(center[2] - 0.25, m.points[0].distance, 1e-12);
    EXPECT_LE(shape::norm(m.points[0].position - Vec::make(center[0], center[1], (center[2] - 0.25) / 2)), 1e-12);
  };
  for (int k = 0; k < 2; ++k)
    for (const double lean : {0.0, 0.01, 0.04})
      for (const double turned : {0.0, pi})
        for (const double x : {0.0, 0.97}) {  // over the middle, and near an end
          SCOPED_TRACE(testing::Message() << k << ' ' << lean << ' ' << turned << ' ' << x);
          const Mat3<double> R = turn(shape::axis(1), lean) * turn(shape::axis(0), turned);
          const Vec end = Vec::make(x, 0, 0.24);
          const Pose B = {R, end + R.z * (turned > 0 ? -0.5 : 0.5)};
          expect_one({grounds[k], stick, poses[k], B}, end), expect_one({stick, grounds[k], B, poses[k]}, end);
          expect_one({grounds[k], ball, poses[k], {R, end}}, end);
          if (k == 0) expect_one({grounds[k], point, poses[k], {R * turn(shape::axis(0), 1.2), end}}, end);
        }
}

// A face seen edge-on is its upper edge, whichever of its corners comes first.
TEST(Manifold, FaceSeenEdgeOnIsItsUpperEdge) {
  const Vec square[] = {Vec::make(-1, 0, -1), Vec::make(1, 0, -1), Vec::make(1, 0, 1), Vec::make(-1, 0, 1)};
  const collision::ContactPlane plane(shape::axis(2), Vec::make(0, 0, 0.5));
  for (int first = 0; first < 4; ++first)
    for (const double towards : {1.0, -1.0}) {
      shape::Feature face{};
      for (int k = 0; k < 4; ++k) face.add(square[(first + k) % 4], 10 + (first + k) % 4);
      collision::PlanarFeature line;
      collision::project(face, at(0, 0, 0), plane, towards, line);
      ASSERT_EQ(2, line.count);
      EXPECT_EQ(towards > 0 ? 12 : 10, line.p[0].id);
      EXPECT_EQ(towards > 0 ? 13 : 11, line.p[1].id);
      for (const collision::Corner& c : {line.p[0], line.p[1]}) {
        const Vec& corner = square[c.id - 10];
        EXPECT_NEAR(dot(plane.u, corner), c.x, 1e-15);
        EXPECT_NEAR(dot(plane.v, corner), c.y, 1e-15);
        EXPECT_NEAR(towards - 0.5, line.height(c.x, c.y), 1e-15);
      }
    }
}

// The corner of a core that faces n and has a number, in the core's axes. Returns false if there is none.
bool corner_of(const Shape& s, const Vec& n, std::uint32_t number, Vec& out) {
  if (s.type == Type::Box)
    return out = hadamard(s.size, Vec::make(number & 1 ? 1 : -1, number & 2 ? 1 : -1, number & 4 ? 1 : -1)), number < 8;
  if (s.type == Type::Convex) return number < std::uint32_t(s.hull->vertices) && (out = s.hull->vertex(Index(number)), true);
  shape::Feature f;
  shape::visit(s, [&]<class S>(const S& x) {
    if constexpr (S::type != Type::HalfSpace) x.facing(n, 0, f);
  });
  for (int k = 0; k < f.count; ++k)
    if (f.id[k] == number) return out = f.p[k], true;
  return false;
}

// A point of contact lies on the corner or edge that it names, seen along the normal. One that names an edge is not at its end.
TEST(Manifold, PointsLieOnThePartsThatTheyName) {
  int named[shape::type_count][2] = {};  // corners, edges
  for_each_sample(samples(60), [&](const Sample& x) {
    const Manifold m = manifold(x.s, x.margin);
    const double same = 1e-5 * x.size, rounding = 1e-9 * x.size + 1e-13 * (shape::norm(x.s.A.p) + shape::norm(x.s.B.p));
    for (int i = 0; i < m.count; ++i)
      for (const bool of_a : {true, false}) {
        const Shape& s = (of_a ? x.s.a : x.s.b).shape;
        const Pose& X = of_a ? x.s.A : x.s.B;
        const std::uint32_t part = std::uint32_t(m.points[i].feature >> (of_a ? 32 : 0)), first = part >> 16,
                            last = part & 0xffff;
        if (part == 0xffffffff || s.type == Type::HalfSpace) continue;
        const Vec n = transpose_times(X.R, of_a ? m.normal : -m.normal), p = X.act_inverse(m.points[i].position);
        Vec a, b;
        ASSERT_TRUE(corner_of(s, n, first, a) && corner_of(s, n, last, b)) << first << ' ' << last;
        const auto across = [&](const Vec& v) { return v - n * dot(n, v); };
        const Vec e = across(b - a), r = across(p - a);
        const double ee = dot(e, e), t = ee > 0 ? std::clamp(dot(r, e) / ee, 0.0, 1.0) : 0;
        EXPECT_LE(shape::norm(r - e * t), same + rounding) << first << ' ' << last;
        if (first != last) {
          EXPECT_GE(std::min(shape::norm(r), shape::norm(r - e)), same - rounding) << first << ' ' << last;
        }
        ++named[int(s.type)][first != last];
      }
  });
  for (const Type t : {Type::Box, Type::Capsule, Type::Cylinder, Type::Cone, Type::Convex})
    for (int edge = 0; edge < 2; ++edge) EXPECT_GT(named[int(t)][edge], 20) << name_of(t) << ' ' << edge;
}

}  // namespace
}  // namespace dyn_test
