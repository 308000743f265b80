// Every pair of shapes at random and adversarial poses: an answer always, and proof that it is the right one. The witness points lie on the
// two shapes and are the distance apart along the normal; the planes across the normal through them separate the shapes (which proves the
// distance); and no other direction of many has a smaller depth.
#include "collision/scene.hpp"

namespace dyn_test {
namespace {

struct Pair {
  Type a, b;
};
std::vector<Pair> pairs() {
  std::vector<Pair> p;
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = a; b < shape::type_count; ++b)
      if (b > 0) p.push_back({Type(a), Type(b)});
  return p;
}

// -h(n), h the support function of A - B: the signed distance is its largest value
double separation(const Scene& s, const Vec& n) { return -reach(s.a, s.A, n) - reach(s.b, s.B, -n); }

// the largest separation of many directions, improved by a random walk
double search(const Scene& s, const Vec& start, Chance& g) {
  Vec best = start;
  double most = separation(s, start);
  auto consider = [&](const Vec& d) {
    const Vec n = d * (1 / shape::norm(d));
    const double x = separation(s, n);
    if (x > most) most = x, best = n;
    return x >= most;
  };
  for (int i = 0; i < 200; ++i) consider(g.direction());
  for (double step = 0.1; step > 1e-5;)
    if (!consider(best + g.direction() * step)) step *= 0.9;
  return most;
}

void check(const Scene& s, const Result& r, double size, Chance& g) {
  const double large = std::max(size_of(s.a), size_of(s.b)), far = shape::norm(s.A.p) + shape::norm(s.B.p);
  const double tol = 1e-6 * size + 1e-14 * (large + far);
  ASSERT_NE(Status::Failed, r.status);
  ASSERT_TRUE(std::isfinite(r.distance));
  ASSERT_NEAR(1, shape::norm(r.normal), 1e-12);
  ASSERT_NEAR(0, outside(s.a, s.A, r.point_a), tol);
  ASSERT_NEAR(0, outside(s.b, s.B, r.point_b), tol);
  ASSERT_LE(shape::norm(r.point_b - r.point_a - r.normal * r.distance), tol);
  if (s.a.shape.type == Type::HalfSpace) {
    // its normal is the only one
    ASSERT_NEAR(0, shape::norm(r.normal - s.A.R.z), 1e-15);
    ASSERT_NEAR(r.distance, -reach(s.b, s.B, -r.normal) + dot(r.normal, s.A.p) * -1 - s.a.shape.radius, tol);
    return;
  }
  ASSERT_NEAR(r.distance, separation(s, r.normal), tol);
  if (r.distance < 0) {
    ASSERT_LE(search(s, r.normal, g), r.distance + tol);
  }
}

class Pairs : public testing::TestWithParam<Pair> {};

TEST_P(Pairs, OptimalInEveryCase) {
  const auto [a, b] = GetParam();
  for (int c = 0; c < int(Case::count); ++c) {
    const int n = c == 0 ? samples(2000) : samples(2000) / 10;
    for (int i = 0; i < n; ++i) {
      SCOPED_TRACE(std::string(name_of(Case(c))) + " " + std::to_string(i));
      const Scene s = scene(a, b, Case(c), std::uint64_t(i));
      Chance g{std::uint64_t(i)};
      check(s, query(s), std::min(size_of(s.a), size_of(s.b)), g);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(Pairs, ExchangedShapesExchangeTheAnswer) {
  const auto [a, b] = GetParam();
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Scene s = scene(a, b, Case::Random, std::uint64_t(i));
    const Result r = query(s), e = query({s.b, s.a, s.B, s.A});
    ASSERT_NEAR(r.distance, e.distance, 1e-9);
    ASSERT_EQ(r.status, e.status);
    if (r.unique && e.unique && r.distance > 0) {
      ASSERT_LE(shape::norm(r.normal + e.normal), 1e-5);
      ASSERT_LE(shape::norm(r.point_a - e.point_b), 1e-5);
    }
  }
}

TEST_P(Pairs, MovedTogetherNothingChanges) {
  const auto [a, b] = GetParam();
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Scene s = scene(a, b, Case::Random, std::uint64_t(i));
    Chance g{std::uint64_t(i)};
    const Result r = query(s);
    const Pose X = {g.rotation(), g.direction() * 10.0};
    s.A = X * s.A, s.B = X * s.B;
    const Result m = query(s);
    ASSERT_NEAR(r.distance, m.distance, 1e-9);
    if (r.unique && m.unique && r.distance > 0) {
      ASSERT_LE(shape::norm(X.R * r.normal - m.normal), 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Pairs, testing::ValuesIn(pairs()), [](const auto& info) {
  return std::string(name_of(info.param.a)) + "_" + name_of(info.param.b);
});

}  // namespace
}  // namespace dyn_test
