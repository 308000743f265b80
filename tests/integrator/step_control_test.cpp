// Lengths of steps that follow from an accuracy: the first one, those after accepted, rejected and failed ones, the last one; and
// errors that are rounding.
#include "common/random_tree.hpp"
#include "common/work.hpp"
#include "simulation/guarded_step.hpp"

namespace dyn_test {
namespace {

using namespace integrator;

// A mass of 1 kg on a spring, 1 m from its rest: x = cos(rate t).
struct Oscillator {
  ModelPtr model;
  Work<double> w;
  Stages<double> stages;
  explicit Oscillator(double rate) : model(build(rate)), w(*model), stages(*model, w.d) {
    w.q(std::vector{1.0}).v(std::vector{0.0});
  }
  static ModelPtr build(double rate) {
    Tree t;
    t.gravity = V3::Zero();
    JointSpec s;
    s.name = "slide", s.type = DYN_JOINT_TYPE_PRISMATIC, s.stiffness = {rate * rate};
    t.joints.push_back(s);
    BodySpec b;
    b.name = "mass", b.parent = "slide";
    t.bodies.push_back(b);
    return t.build();
  }
  double first_step_of(int order, double tolerance, double longest) {
    double h = 0;
    EXPECT_EQ(0, first_step(*model, w.d, stages, order, tolerance, longest, h));
    return h;
  }
  template <class Tableau>
  double error_of_step(double h) {
    EXPECT_EQ(0, explicit_step<Tableau>(*model, w.d, stages, h));
    return step_error(Tableau(), *model, w.d, stages, h, false);
  }
};

// The first step's error is below the tolerance, but not by more than what a few steps make up for.
TEST(FirstStep, ErrorIsAStatedShareOfTheTolerance) {
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    Oscillator five(1), eight(1);
    const double e5 = five.error_of_step<DormandPrince5>(five.first_step_of(DormandPrince5::order, tolerance, 1e3)),
                 e8 = eight.error_of_step<DormandPrince8>(eight.first_step_of(DormandPrince8::order, tolerance, 1e3));
    EXPECT_LT(e5, 3e-2 * tolerance);
    EXPECT_GT(e5, 2e-3 * tolerance);
    EXPECT_LT(e8, 1e-3 * tolerance);
    EXPECT_GT(e8, 1e-4 * tolerance);
  }
}

// It is no longer than the time in which the state changes by its size, nor than the duration.
TEST(FirstStep, IsBoundedByTheTimeScale) {
  for (const double rate : {10.0, 1000.0}) {
    Oscillator x(rate);
    EXPECT_NEAR(1 / (rate * rate), x.first_step_of(5, 1e9, 1e3), 1e-12);
    EXPECT_EQ(1e-9, x.first_step_of(5, 1e9, 1e-9));
  }
}

// Steps whose error is (h / H)^p of the allowed one, from a given length until it is near H.
struct Controlled {
  double h;
  int accepted = 0, rejected = 0;
  StepSizeController<double> control;
  Controlled(double first, double power, bool alone = false)
      : h(first), control{1 / power, alone, integrator::tuning::max_factor}, p(power) {}
  void step() {
    const double ratio = std::pow(h, p);
    if (ratio <= 1) ++accepted, h *= control.accept(ratio);
    else ++rejected, h *= control.reject(ratio);
  }

 private:
  double p;
};

TEST(StepSize, SettlesBelowTheLongestStepAllowed) {
  for (const double power : {4.0, 7.0})
    for (const bool alone : {false, true}) {
      Controlled x(0.5, power, alone);
      for (int k = 0; k < 50; ++k) x.step();
      const double settled = x.h;
      x.step();
      EXPECT_NEAR(settled, x.h, 1e-3 * settled);
      EXPECT_GT(settled, 0.75);
      EXPECT_LT(settled, 0.95);
      EXPECT_LE(x.rejected, 1);
    }
}

// By factors of up to five.
TEST(StepSize, GrowsAndShrinksWithinSixSteps) {
  for (const double power : {4.0, 7.0}) {
    Controlled small(1e-4, power), large(1e4, power);
    while (small.h < 0.5 && small.accepted < 20) small.step();
    EXPECT_GE(small.accepted, 5);
    EXPECT_LE(small.accepted, 7);
    EXPECT_EQ(0, small.rejected);
    while (large.accepted == 0 && large.rejected < 20) large.step();
    EXPECT_GE(large.rejected, 6);
    EXPECT_LE(large.rejected, 7);
  }
}

// A step after a rejected one does not grow: its length has just proved too large.
TEST(StepSize, DoesNotGrowAfterARejectedStep) {
  StepSizeController<double> x{0.25, false, 5};
  EXPECT_LT(x.reject(2), 1);
  EXPECT_LE(x.accept(1e-3), 1);
  EXPECT_GT(x.accept(1e-3), 1);
}

// Nothing is known of a step that failed: the next one is as short as the controller makes it.
TEST(StepSize, FailedStepsAreFollowedByShortOnes) {
  StepSizeController<double> x{0.25, false, 5};
  const double least = x.reject(1e300);
  EXPECT_EQ(least, x.reject(HUGE_VAL));
  EXPECT_EQ(least, x.reject(std::nan("")));
  EXPECT_LE(least, 0.25);
  EXPECT_GE(least, 0.1);
}

// A step adds a few units in the last place to the state; states near zero count as a millimetre or milliradian.
TEST(RoundingFloor, IsAFewUnitsInTheLastPlace) {
  const double ulp = std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(4, RoundingFloor<double>::of(1) / ulp, 3);
  EXPECT_NEAR(4e3, RoundingFloor<double>::of(1e3) / ulp, 3e3);
  EXPECT_NEAR(4e-3, RoundingFloor<double>::of(0) / ulp, 3e-3);
}

// Below a 256th of that, errors of one step are none, however short the step is: accelerations add nothing to it.
TEST(RoundingFloor, OfAShortStepIsAShareOfTheStates) {
  Oscillator x(1);
  x.error_of_step<DormandPrince8>(1e-9);
  const RoundingFloor<double> floor{false, 0};
  EXPECT_NEAR(1.0 / 256, floor(*x.model, x.w.d, x.stages, 1e-9) / RoundingFloor<double>::of(1), 0.3 / 256);
}

// Uniform motion without errors: steps of 1 s, the time in which the state changes by its size, and a rest.
dynStepReport coast(double duration) {
  Oscillator x(0);
  x.w.v(std::vector{1.0});
  dynStepReport report{};
  EXPECT_EQ(0, (advance_to_accuracy<DormandPrince8>(*x.model, x.w.d, x.stages, duration, 1e9, report)));
  EXPECT_EQ(duration, report.time);
  return report;
}

// A rest of less than 1e-13 of the duration belongs to the last step.
TEST(LastStep, HasNoRestOfRounding) {
  EXPECT_EQ(1, coast(1).steps);
  EXPECT_EQ(1, coast(1 + 4e-14).steps);
  EXPECT_EQ(2, coast(1 + 4e-13).steps);
}

// Steps shorter than that are refused: time would hardly tell them apart.
TEST(LastStep, ShorterStepsAreRefused) {
  const auto steps = [](double length) {
    Oscillator x(std::sqrt(1 / length));  // the time scale of v
    dynStepReport report{};
    EXPECT_EQ(no_step_left, (advance_to_accuracy<DormandPrince8>(*x.model, x.w.d, x.stages, 1.0, 1e9, report, 3)));
    return report.steps;
  };
  EXPECT_EQ(0, steps(4e-14));
  EXPECT_EQ(3, steps(4e-13));
}

// Tries of a step near a singular configuration, with errors in units of the allowed one.
struct Singular {
  SingularityRetry<double> retry{0, 1};
  double h = 1;
  bool again(double error, double raw, double moved, double usual_move = 1e9) {
    return retry.again(error, raw, moved, 1, usual_move, h);
  }
};

// What suggests a singularity: the step is inaccurate without the projection, or the projection changes v more than usual; and
// v changes by more than the error.
TEST(SingularityRetry, NeedsAnUnusualProjection) {
  EXPECT_TRUE(Singular().again(100, 300, 3000));
  EXPECT_FALSE(Singular().again(100, 30, 3000));
  EXPECT_TRUE(Singular().again(100, 30, 3000, 1000));
  EXPECT_FALSE(Singular().again(100, 300, 300));
}

// A step whose error is less than thirty times the allowed one crosses the singularity.
TEST(SingularityRetry, AcceptsAStepOfSomeError) {
  const auto second = [](double error) {
    Singular x;
    EXPECT_TRUE(x.again(1e3, 1e6, 1e6));
    return x.again(error, 0, 0);
  };
  EXPECT_FALSE(second(10));
  EXPECT_TRUE(second(100));
  Singular x;
  EXPECT_EQ(1, x.retry.allowed(1, 1));
  EXPECT_TRUE(x.again(1e3, 1e6, 1e6));
  EXPECT_GT(x.retry.allowed(1, 1), 10);
  EXPECT_LT(x.retry.allowed(1, 1), 100);
}

// Lengths around the ordinary one, each different; then the best of them again. Without a good one, shorter steps follow.
TEST(SingularityRetry, TriesLengthsAroundTheOrdinaryOne) {
  for (const bool some_good : {false, true}) {
    Singular x;
    std::vector<double> lengths;
    for (int k = 0; k < x.retry.most; ++k) {
      ASSERT_TRUE(x.again(some_good && k == 2 ? 20 : 1e3, 1e6, 1e6));
      EXPECT_GT(x.h, 0.6);
      EXPECT_LT(x.h, 1.7);
      for (const double other : lengths) EXPECT_GT(std::abs(x.h - other), 0.1);
      lengths.push_back(x.h);
    }
    EXPECT_EQ(some_good, x.again(1e3, 1e6, 1e6));
    if (some_good) {
      EXPECT_EQ(lengths[1], x.h);
    }
    EXPECT_FALSE(x.again(1e3, 1e6, 1e6));
  }
}

// Steps that lead into the singularity after no length was good. best: error of the best of those.
double forced_from(double best) {
  constexpr double limit = 30, start = 1;
  Singular x;
  for (int k = 0; k < x.retry.most; ++k) EXPECT_TRUE(x.again((k == 2 ? best : 1e4) * limit, 1e9, 1e9));
  EXPECT_FALSE(x.again(1e4 * limit, 1e9, 1e9));
  for (x.retry.tries = 0, x.h = start; x.h > 1e-6;) {
    const double h = x.h;
    if (x.again(1e4 * limit, 1e9, 1e9)) {
      EXPECT_GT(x.h, 0.6) << "a length that was tried";
      EXPECT_GE(x.retry.allowed(1, x.h), best * limit);
      return h;
    }
    x.retry.tries = 0, x.h = 0.9 * h;
  }
  return 0;
}

// Where steps become a twentieth of the ordinary one, one that was tried before counts, if its error is less than a hundred times
// what crosses a singularity.
TEST(SingularityRetry, TheBestStepCountsWhereShorterOnesLeadIntoTheSingularity) {
  EXPECT_GT(forced_from(30), 0.02);
  EXPECT_LT(forced_from(30), 0.1);
  EXPECT_EQ(0, forced_from(300));
}

}  // namespace
}  // namespace dyn_test
