// How many steps, rejected steps and evaluations an accuracy costs, and how honest their error estimate is. More or fewer by a
// tenth are a change of step control.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

void expect_about(double stated, double found, double share = 0.1) { EXPECT_NEAR(stated, found, share * stated + 1); }

dynStepReport advanced(Simulation& run, double accuracy, double duration) {
  run.options.accuracy = accuracy;
  EXPECT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options)) << dyn_last_error();
  EXPECT_EQ(DYN_OK, dyn_advance(run.m, run.d, duration)) << dyn_last_error();
  return run.report();
}

struct Pendulum : Simulation {
  Pendulum(dynIntegrator by, double dt, const Numbers& at, const Numbers& rates = {0, 0})
      : Simulation(robot("double_pendulum"), dt) {
    EXPECT_EQ(DYN_OK, dyn_data_set_effects(m, d, 0, DYN_EFFECT_ARMATURE));
    integrate_by(*this, by);
    set(at, rates);
  }
};

TEST(StepWork, OfSmoothMotion) {
  const struct {
    dynIntegrator by;
    double accuracy;
    int steps;
  } cases[] = {{DYN_INTEGRATOR_RK45, 1e-3, 51},     {DYN_INTEGRATOR_RK45, 1e-6, 275},     {DYN_INTEGRATOR_RK45, 1e-9, 1563},
               {DYN_INTEGRATOR_REFERENCE, 1e-3, 25}, {DYN_INTEGRATOR_REFERENCE, 1e-6, 62}, {DYN_INTEGRATOR_REFERENCE, 1e-9, 161}};
  std::int64_t rejected = 0;
  for (const auto& x : cases) {
    Pendulum run(x.by, 1e-3, {1, 2}, {0.5, -1});
    const dynStepReport r = advanced(run, x.accuracy, 2);
    expect_about(x.steps, double(r.steps));
    rejected += r.rejected;
    // local errors may grow by four until the end
    EXPECT_LT(r.error_estimate, 0.3 * x.accuracy);
    EXPECT_GT(r.error_estimate, 0.05 * x.accuracy);
  }
  EXPECT_LE(rejected, 24);
  EXPECT_GE(rejected, 12);
}

// Steps to rounding: errors below it are none.
TEST(StepWork, OfTheReference) {
  Pendulum small(DYN_INTEGRATOR_REFERENCE, 0.05, {1e-9, 0}), large(DYN_INTEGRATOR_REFERENCE, 0.1, {1, 2}, {0.5, -1});
  double of_small = 0, of_large = 0;
  for (int k = 0; k < 10; ++k) {
    small.steps(1), large.steps(1);
    of_small += double(small.report().evaluations), of_large += double(large.report().evaluations);
  }
  expect_about(380, of_small), expect_about(4016, of_large);
}

// A step of the reference that would need more than a hundred thousand is refused.
TEST(StepWork, OfStiffReferencesIsBounded) {
  for (const double rate : {3e3, 6e3}) {  // 73,000 and 145,000 steps
    const double none[3] = {0, 0, 0}, stiffness = rate * rate;
    Builder b;
    ASSERT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec slide("slide", DYN_JOINT_TYPE_PRISMATIC);
    slide.stiffness = &stiffness;
    Simulation run(b.joint(slide).body("mass", "slide", 1, {0, 0, 0}).finish(), 1);
    integrate_by(run, DYN_INTEGRATOR_REFERENCE);
    run.set({1}, {0});
    EXPECT_EQ(rate < 4e3 ? DYN_OK : DYN_ERROR_NUMERIC, dyn_step(run.m, run.d)) << rate;
  }
}

// A ball that overlaps the ground by 3 cm is pushed out at 1 m/s: a smooth motion, in long steps. Only its end needs short ones, which
// are no shorter than 0.1 ms while the overlap is 100 times what counts as closed.
TEST(StepWork, OfOverlap) {
  const struct {
    double accuracy, steps, rejected;
  } cases[] = {{1e-3, 4, 0}, {1e-4, 13, 13}, {1e-6, 22, 15}};
  for (const auto& x : cases) {
    Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.5)).finish());
    run.place({{0, 0, 0.07}});
    const dynStepReport r = advanced(run, x.accuracy, 0.1);
    expect_about(x.steps, double(r.steps)), expect_about(x.rejected, double(r.rejected));
    EXPECT_NEAR(0.1, run.q[2], x.accuracy);
  }
}

// A tilted box whose edge is 2 cm below the ground: redundant contacts open unevenly, in steps of 0.1 ms, however fine the accuracy.
TEST(StepWork, OfUnevenOverlap) {
  Simulation run(Scene().ground().box("box", 1, {0.2, 0.2, 0.1}, material(0.5)).finish());
  const double tilt = 0.1;
  run.set({0, 0, 0.03 + 0.1 * std::sin(tilt), 0, std::sin(tilt / 2), 0, std::cos(tilt / 2)}, Numbers(6, 0));
  const dynStepReport r = advanced(run, 1e-6, 0.005);
  EXPECT_EQ(50, r.steps);
  EXPECT_NEAR(1e-4, r.smallest_dt, 1e-12);
}

// A turning box falls flat on the ground: four impacts at once take the shortest step, a thousandth of accuracy and duration.
TEST(StepWork, OfAFlatImpact) {
  Simulation run(Scene().shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5))
                     .box("box", 1, {0.2, 0.2, 0.1}, material(0.5)).finish());
  run.set({0, 0, 0.06, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 5});
  EXPECT_NEAR(1e-3 * 1e-5 * 0.1, advanced(run, 1e-5, 0.1).smallest_dt, 1e-13);
}

// A ball starts to roll. The first step follows from the accuracy: 10 ms at 1e-3. A tenth of it would take 60 evaluations.
TEST(StepWork, OfABallThatStartsToRoll) {
  Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.5)).finish());
  run.set({0, 0, 0.1, 0, 0, 0, 1}, {0.3, 0, 0, 0, 0, 0});
  const dynStepReport r = advanced(run, 1e-3, 0.05);
  EXPECT_NEAR(36, double(r.evaluations), 8);
}

// A ball that bounces for 20 s: time tells the shortest steps apart, and steps at impacts are as short.
TEST(StepWork, OfFineAccuracyOverALongTime) {
  double shortest = 1;  // over the duration: an impact of many, rounding decides which, needs the shortest step
  for (const auto& [duration, steps] : {std::pair(1.0, 125), {20.0, 1023}}) {
    Simulation run(Scene().shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0, 0.8))
                       .sphere("ball", 1, 0.1, material(0.2, 0.8)).finish());
    run.place({{0, 0, 0.3}});
    const dynStepReport r = advanced(run, 1e-11, duration);
    expect_about(steps, double(r.steps));
    shortest = std::min(shortest, r.smallest_dt / duration);
  }
  EXPECT_LT(shortest, 3e-12);
}

// A ball rolls into another: gaps close as fast as they may, closed ones stay closed, and shapes that are about to pass each
// other shorten the steps.
TEST(StepWork, OfBallsThatMeet) {
  Simulation run(Scene().shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5))
                     .sphere("a", 1, 0.05, material(0.5)).sphere("b", 1, 0.05, material(0.5)).finish());
  run.set({0, 0, 0.05, 0, 0, 0, 1, 0.15, 0, 0.05, 0, 0, 0, 1}, {1, 0.3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const dynStepReport r = advanced(run, 1e-5, 0.3);
  expect_about(125, double(r.steps)), expect_about(2172, double(r.iterations), 0.15);
}

// A rolling ball: the solver's tolerance follows the accuracy.
TEST(StepWork, OfRolling) {
  const struct {
    double accuracy;
    int steps, iterations;
  } cases[] = {{1e-3, 13, 73}, {1e-5, 27, 78}, {1e-8, 128, 215}, {1e-10, 363, 282}, {1e-12, 899, 472}};
  for (const auto& x : cases) {
    Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.2)).finish());
    run.set({0, 0, 0.1, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 0});
    const dynStepReport r = advanced(run, x.accuracy, 0.5);
    expect_about(x.steps, double(r.steps)), expect_about(x.iterations, double(r.iterations), 0.15);
  }
}

// The same 1 km away: gaps of 256 roundings of the place count as closed, whatever the accuracy.
TEST(StepWork, OfRollingFarAway) {
  for (const double accuracy : {1e-10, 1e-12}) {
    Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.2)).finish());
    run.set({1000, 0, 0.1, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 0});
    expect_about(172, double(advanced(run, accuracy, 0.5).steps));
  }
}

}  // namespace
}  // namespace dyn_test
