// A deadline by a clock that the test moves.
#include <gtest/gtest.h>

#include "solver/time_limit.hpp"

namespace dyn_test {
namespace {

using dyn::solver::TimeLimit;

double now = 0;
double clock_of_test() { return now; }

struct Limit : TimeLimit {
  Limit() : TimeLimit{} { now = 100; }
  // A step: 2 ms before the solve, then units of `each` s as long as they fit, at most `most`, then `after` s. Returns their number.
  int step(double budget, Unit unit, double size, double each, double after, int most = 1000) {
    began_at = now;
    start(clock_of_test, budget);
    now += 2e-3;
    expect(unit, size);
    int units = 0;
    for (; units < most && !is_up(); ++units) now += each;
    leave();
    now += after;
    took = now - began_at;
    finish();
    return units;
  }
  double began_at = 0, took = 0;
};

TEST(TimeLimit, WithoutABudgetNoClockIsRead) {
  TimeLimit limit{};
  limit.expect(TimeLimit::Unit::Sweep, 10);
  EXPECT_FALSE(limit.is_up());
  EXPECT_TRUE(limit.restarts(1e9));
}

// The first step knows neither the length of a unit nor what follows. All later ones end in time.
TEST(TimeLimit, UnitsAndWhatFollowsThemEndInTime) {
  for (const TimeLimit::Unit unit : {TimeLimit::Unit::Sweep, TimeLimit::Unit::Segments, TimeLimit::Unit::Matrix}) {
    Limit limit;
    limit.step(10e-3, unit, 100, 0.7e-3, 1.1e-3);
    for (int k = 0; k < 20; ++k) {
      EXPECT_GE(limit.step(10e-3, unit, 100, 0.7e-3, 1.1e-3), 8);  // 2 + 9 * 0.7 + 1.1 = 9.4 ms
      EXPECT_LE(limit.took, 10e-3 + 1e-12);
    }
  }
}

// Units of a larger island take longer in proportion to its size.
TEST(TimeLimit, ALargerIslandIsForeseen) {
  Limit limit;
  limit.step(10e-3, TimeLimit::Unit::Segments, 100, 0.1e-3, 0, 5);
  EXPECT_EQ(0, limit.step(10e-3, TimeLimit::Unit::Segments, 10000, 10e-3, 0));
  EXPECT_EQ(0, limit.stopped);  // a sweep may still fit
  limit.step(10e-3, TimeLimit::Unit::Sweep, 10000, 0.5e-3, 0);
  EXPECT_LE(limit.took, 10e-3 + 0.5e-3);
}

// One slow step, as by another process, is forgotten after 44 steps: 0.9^44 = 1 %.
TEST(TimeLimit, ExpensiveUnitsAreForgotten) {
  Limit limit;
  limit.step(10e-3, TimeLimit::Unit::Sweep, 100, 5e-3, 0, 1);
  limit.step(10e-3, TimeLimit::Unit::Sweep, 100, 50e-3, 0, 2);
  EXPECT_EQ(0, limit.step(10e-3, TimeLimit::Unit::Sweep, 100, 1e-3, 0));
  for (int k = 0; k < 44; ++k) limit.step(1, TimeLimit::Unit::Sweep, 100, 1e-3, 0, 2);
  EXPECT_GE(limit.step(10e-3, TimeLimit::Unit::Sweep, 100, 1e-3, 0), 5);
}

// One short unit does not hide that others are long: the next long one is not begun where it does not fit.
TEST(TimeLimit, LongUnitsAreForeseenAfterAShortOne) {
  Limit limit;
  limit.step(1, TimeLimit::Unit::Sweep, 100, 4e-3, 0, 2);
  for (const double each : {4e-3, 1e-3}) limit.step(1, TimeLimit::Unit::Sweep, 100, each, 0, 2);
  EXPECT_EQ(0, limit.step(5e-3, TimeLimit::Unit::Sweep, 100, 4e-3, 0));  // 3 ms are left
}

// Once a sweep does not fit, the rest of the step makes none, however small: islands not begun get one each.
TEST(TimeLimit, StaysUp) {
  Limit limit;
  limit.step(10e-3, TimeLimit::Unit::Sweep, 100, 1e-3, 0);
  limit.start(clock_of_test, 3e-3);
  now += 2.5e-3, limit.expect(TimeLimit::Unit::Sweep, 100);
  EXPECT_TRUE(limit.is_up());
  limit.expect(TimeLimit::Unit::Sweep, 1);
  EXPECT_TRUE(limit.is_up());
  EXPECT_FALSE(limit.restarts(1e-3));
  EXPECT_TRUE(limit.restarts(1e-4));
  EXPECT_FALSE(limit.is_up());
}

}  // namespace
}  // namespace dyn_test
