// Every pair of shapes in random and adversarial poses: no failure, valid witness points, a supporting plane, the least depth.
#include <cstdio>

#include "collision/every_pair.hpp"
#include "collision/newton_refine.hpp"
#include "collision/survey.hpp"

namespace dyn_test::survey_test {
namespace {

struct Tally {
  long poses = 0, failed = 0, wrong = 0, deeper = 0;
  double witness = 0, plane = 0, depth = 0;
  std::string first;  // description of the first violation
};

bool closed_form(Type a, Type b) {
  const Type low = std::min(a, b), high = std::max(a, b);
  return low <= Type::Sphere || (low <= Type::Box && high <= Type::Box);
}

void take(Tally& t, const Scene& s, Case c, int seed, double tol) {
  const Result r = query(s);
  const Faults f = faults(s, r);
  const bool wrong = f.witness > tol || f.plane > tol, deeper = f.depth > 1e-3;
  ++t.poses, t.failed += f.failed, t.wrong += wrong, t.deeper += deeper;
  if (f.failed) return;
  t.witness = std::max(t.witness, f.witness), t.plane = std::max(t.plane, f.plane), t.depth = std::max(t.depth, f.depth);
  if ((wrong || deeper) && t.first.size() < 300) {
    char text[160];
    std::snprintf(text, sizeof text, "; %s %d: distance %.3g, witness %.1e, plane %.1e, depth %.1e", name_of(c), seed, r.distance,
                  f.witness, f.plane, f.depth);
    t.first += text;
  }
}

void survey(std::pair<Type, Type> pair, int random, int adversarial) {
  const double tol = closed_form(pair.first, pair.second) ? 1e-9 : 1e-6;
  for (int c = 0; c < int(Case::count); ++c) {
    Tally t;
    const int count = Case(c) == Case::Random ? random : (adversarial + int(Case::count) - 2) / (int(Case::count) - 1);
    for (int i = 0; i < count; ++i) take(t, scene(pair.first, pair.second, Case(c), std::uint64_t(i)), Case(c), i, tol);
    if (random > 5000)
      std::printf("%-20s %-20s %-16s %7ld poses: %ld failed, %ld wrong, %ld deeper; witness %.1e, plane %.1e, depth %.1e\n",
                  name_of(pair.first), name_of(pair.second), name_of(Case(c)), t.poses, t.failed, t.wrong, t.deeper, t.witness,
                  t.plane, t.depth);
    EXPECT_EQ(0, t.failed) << name_of(Case(c)) << t.first;
    EXPECT_EQ(0, t.wrong) << name_of(Case(c)) << t.first;
    EXPECT_EQ(0, t.deeper) << name_of(Case(c)) << t.first;
  }
}

class Survey : public testing::TestWithParam<std::pair<Type, Type>> {};
TEST_P(Survey, Sample) { survey(GetParam(), samples(300), samples(300)); }
INSTANTIATE_TEST_SUITE_P(All, Survey, testing::ValuesIn(pairs()), pair_name);

// 10^5 random and 10^4 adversarial poses a pair.
class SlowSurvey : public testing::TestWithParam<std::pair<Type, Type>> {};
TEST_P(SlowSurvey, All) { survey(GetParam(), samples(100000), std::min(samples(100000), 10000)); }
INSTANTIATE_TEST_SUITE_P(All, SlowSurvey, testing::ValuesIn(pairs()), pair_name);

// Of three pieces on one line, Newton's iteration drops the middle one, in any order, and keeps the weighted mean. The weights
// of both ends stay positive.
struct Points {
  Mat3<double> Rt = Mat3<double>::identity();
  double small = 1;
  collision::Vertex support_on_piece(const collision::Vertex& p, const Vec&, const Vec&) const { return p; }
};
TEST(NewtonRefine, MiddleOfThreePointsOnALineIsDropped) {
  const Vec n = shape::axis(2), low = Vec::make(-1, 0.5, 0.3), along = Vec::make(2, 1, 0);
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const Points d;
  for (const auto& order : orders)
    for (const double middle : {0.1, 0.5, 0.9}) {
      const double at[3] = {0, middle, 1}, weight[3] = {0.2, 0.5, 0.3};
      collision::detail::Pieces<Points> p{&d, {}, {}, 3, {}, {}, 0, 0, {}, {}, 0, true, false};
      Vec mean = Vec::zero();
      for (int i = 0; i < 3; ++i) {
        const Vec w = low + along * at[order[i]];
        p.s[i] = {w, w, Vec::zero()}, p.weight[i] = weight[order[i]], mean += w * p.weight[i];
      }
      p.evaluate(n);
      ASSERT_EQ(2, p.size);
      EXPECT_NEAR(1, shape::norm(p.s[1].w - p.s[0].w) / shape::norm(along), 1e-15);
      EXPECT_NEAR(1, p.weight[0] + p.weight[1], 1e-15);
      EXPECT_GT(std::min(p.weight[0], p.weight[1]), 0);
      EXPECT_LE(shape::norm(p.y - mean), 1e-15);
      EXPECT_NEAR(-0.3, p.f, 1e-15);
    }
}

}  // namespace
}  // namespace dyn_test::survey_test
