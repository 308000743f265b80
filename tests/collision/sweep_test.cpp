// Sweeps: closed forms, bullets through thin walls, and dense sampling.
#include <gtest/gtest.h>

#include "collision/scene.hpp"
#include "collision/sweep.hpp"

namespace dyn_test {
namespace {

using collision::Impact;
using collision::Moving;

Moving moving(const Solid& s, const Vec& p, const Vec& v, const Vec& w = Vec::zero(),
              const Mat3<double>& R = Mat3<double>::identity()) {
  return {s.shape, {R, p}, v, w};
}
Impact sweep(const Moving& a, const Moving& b, double duration, double margin = 0) {
  collision::SweepOptions o;
  o.margin = margin;
  return collision::sweep(a, b, duration, workspace(), o);
}
const Vec still = Vec::zero();

TEST(Sweep, ClosedForms) {
  // balls head on, and a miss
  Impact i = sweep(moving(sphere(0.5), Vec::make(0, 0, 0), Vec::make(1, 0, 0)),
                   moving(sphere(0.5), Vec::make(5, 0, 0), Vec::make(-1, 0, 0)), 10);
  EXPECT_EQ(Impact::Status::Hit, i.status);
  EXPECT_NEAR(2, i.time, 1e-6);
  EXPECT_NEAR(1, i.result.normal[0], 1e-12);
  i = sweep(moving(sphere(0.5), still, Vec::make(1, 0, 0)), moving(sphere(0.5), Vec::make(5, 0.8, 0), still), 10);
  EXPECT_NEAR(5 - std::sqrt(1 - 0.64), i.time, 1e-6);
  EXPECT_EQ(Impact::Status::None,
            sweep(moving(sphere(0.5), still, Vec::make(1, 0, 0)), moving(sphere(0.5), Vec::make(5, 1.001, 0), still), 10).status);
  EXPECT_EQ(Impact::Status::None,
            sweep(moving(sphere(0.5), still, Vec::make(1, 0, 0)), moving(sphere(0.5), Vec::make(5, 0, 0), still), 3.99).status);
  // with a margin
  EXPECT_NEAR(3.9,
              sweep(moving(sphere(0.5), still, Vec::make(1, 0, 0)), moving(sphere(0.5), Vec::make(5, 0, 0), still), 10, 0.1).time,
              1e-6);
  // overlapping from the start
  EXPECT_EQ(0, sweep(moving(box(1, 1, 1), still, still), moving(box(1, 1, 1), Vec::make(0.5, 0, 0), still), 1).time);
  // a rod that turns about its middle into a wall: the tip is at cos(t)
  i = sweep(moving(capsule(0.1, 2), still, still, Vec::make(0, 1, 0)), moving(box(1, 10, 10), Vec::make(0.7 + 0.5, 0, 0), still),
            3);
  EXPECT_EQ(Impact::Status::Hit, i.status);
  EXPECT_NEAR(std::asin(0.6), i.time, 1e-5);
  // a ball that spins beside a wall
  EXPECT_EQ(Impact::Status::None, sweep(moving(sphere(0.5), still, still, Vec::make(0, 0, 100)),
                                        moving(box(1, 9, 9), Vec::make(1.0001, 0, 0), still), 100)
                                      .status);
  // a box that slides over a floor
  EXPECT_EQ(Impact::Status::None, sweep(moving(box(1, 1, 1), Vec::make(0, 0, 0.50001), Vec::make(100, 0, 0)),
                                        moving(make(Type::HalfSpace, still, 0), still, still), 100)
                                      .status);
}

TEST(Sweep, BulletsThroughThinWalls) {
  Chance g(3);
  for (int k = 0; k < 1000; ++k) {
    const double speed = std::pow(10.0, g.uniform(0, 4)), thick = std::pow(10.0, -g.uniform(2, 6));
    const Solid bullet = g.shape(Type(1 + g.pick(shape::type_count - 1)), 0.01);
    const Vec aim = Vec::make(g.uniform(-0.4, 0.4), g.uniform(-0.4, 0.4), 0),
              from = aim + Vec::make(g.uniform(-1, 1), g.uniform(-1, 1), 2);
    const Vec v = (aim - from) * (speed / 2);
    const Impact i = sweep(moving(bullet, from, v, g.direction() * g.uniform(0, 10), g.rotation()),
                           moving(box(2, 2, thick), still, still), 2.5 / speed);
    ASSERT_EQ(Impact::Status::Hit, i.status) << k;
    EXPECT_NEAR(i.result.distance, 0, 1e-6);
    EXPECT_LE(std::abs(i.time - 2 / speed), 0.03 / std::abs(v[2]) + 1e-9);
  }
}

// Any contact found by sampling the motion is found earlier by the sweep.
TEST(Sweep, NoTunnelling) {
  int hits = 0, undecided = 0;
  const int count = samples(10000);
  for (int k = 0; k < count; ++k) {
    Chance g{std::uint64_t(k + 11)};
    const Solid sa = g.shape(Type(1 + g.pick(shape::type_count - 1)), 1),
                sb = g.shape(Type(1 + g.pick(shape::type_count - 1)), std::pow(10.0, g.uniform(-2, 0)), g.pick(3) ? 1 : 1e-2);
    const Vec from = g.direction() * 3.0, past = g.direction() * 0.5;
    const Moving a = moving(sa, from, (past - from) * g.uniform(0.5, 2), g.direction() * g.uniform(0, 6), g.rotation());
    const Moving b =
        moving(sb, g.direction() * 0.5, g.direction() * g.uniform(0, 1), g.direction() * g.uniform(0, 6), g.rotation());
    const Impact i = sweep(a, b, 1);
    hits += i.status == Impact::Status::Hit, undecided += i.status == Impact::Status::Undecided;
    if (i.status == Impact::Status::Hit && i.time > 0) {
      EXPECT_LE(std::abs(i.result.distance), 2e-7 * 2);
    }
    for (int t = 0; t <= 200; ++t) {
      const double time = t / 200.0;
      if (time >= i.time && i.status != Impact::Status::None) break;
      const Scene s = {sa, sb, a.at(time), b.at(time)};
      ASSERT_GT(query(s).distance, -1e-9) << k << " at " << time << " hit " << i.time;
    }
  }
  EXPECT_GT(hits, count / 5);
  EXPECT_LE(undecided, count / 200);
}

}  // namespace
}  // namespace dyn_test
