// Modes of contacts in derivatives of steps: what is degenerate at a switch, and what is not.
#include "simulation/step_derivatives.hpp"

namespace dyn_test {
namespace {

// A ball that slides at the speed at which it begins to roll, and one that just touches the ground at the end of the step.
TEST(StepDerivatives, SwitchesAreDegenerate) {
  int found = 0;
  for (int k = -49; k <= 49; ++k) {
    Stepper run(ball_on_ground(0.5));
    const double off = 2e-8 * k;  // m; degenerate within 1e-6
    run.set(upright(0, 0, 0.1 + off), {0.1, 0, 0, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(1, x.degenerate[0]) << off;
    EXPECT_EQ(1, x.report.degenerate);
    found += x.degenerate[0];
  }
  EXPECT_EQ(99, found);
}

// A slider on the ground that is pushed with the largest friction, more or less 1e-6 of it.
Model slider_on_ground(double friction) {
  const std::string mu = std::to_string(friction),
                    text = "<mujoco><worldbody><geom type='plane' size='1 1 1' friction='" + mu +
                           "'/><body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint type='slide' "
                           "axis='0 0 1'/><geom type='sphere' size='0.1' mass='2' friction='" +
                           mu + "'/></body></worldbody></mujoco>";
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}
TEST(StepDerivatives, TheLargestFrictionIsASwitch) {
  constexpr double mu = 0.4, largest = mu * 2 * 9.81;
  for (int k = -50; k <= 50; ++k) {
    const double push = largest * (1 + 1.9e-8 * k), angle = 0.13 * k;
    Stepper run(slider_on_ground(mu));
    run.set({0, 0, 0.1 - 1e-5}, {}, {push * std::cos(angle), push * std::sin(angle), 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(1, x.degenerate[0]) << k;
  }
  for (int k = 1; k <= 50; ++k)
    for (const bool slides : {false, true}) {
      const double push = largest * (slides ? 1 + 2e-3 * k : 1 - 1e-5 * k), angle = 0.13 * k;
      SCOPED_TRACE(push / largest);
      Stepper run(slider_on_ground(mu));
      run.set({0, 0, 0.1 - 1e-5}, {}, {push * std::cos(angle), push * std::sin(angle), 0});
      const Derivatives x = slides ? run.agree(1e-6, true, 1e-9) : run.analytic();
      ASSERT_EQ(1u, x.modes.size());
      EXPECT_EQ(slides ? DYN_CONTACT_MODE_SLIDE : DYN_CONTACT_MODE_STICK, x.modes[0]);
      EXPECT_EQ(0, x.degenerate[0]);
    }
}

// Twelve feet in the ground hold one degree of freedom: their forces are open in 35 ways of 36, its motion in none.
TEST(StepDerivatives, ManyFeetHoldOneDegreeOfFreedom) {
  std::string text = "<mujoco><worldbody><geom type='plane' size='1 1 1'/><body><joint type='slide' axis='0 0 1'/>";
  for (int k = 0; k < 12; ++k)
    text += "<geom type='sphere' size='0.1' mass='1' pos='" + std::to_string(0.5 * k) + " 0 0.1'/>";
  text += "</body></worldbody></mujoco>";
  for (const double overlap : {1e-9, 1e-5, 1e-3, 1e-2}) {
    SCOPED_TRACE(overlap);
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
    Stepper run{Model(m)};
    run.set({-overlap}, {});
    const Derivatives x = run.agree(1e-6, overlap > 1e-6, 1e-9);
    ASSERT_EQ(12u, x.modes.size());
    EXPECT_NEAR(0, x.A[3], 1e-12);  // of v' by v
  }
}

// Slower than 1e-9 m/s is rounding.
TEST(StepDerivatives, SlidingByNanometresIsSliding) {
  constexpr double mu = 0.4;
  for (const bool slides : {false, true}) {
    Stepper run(slider_on_ground(mu));
    run.set({0, 0, 0.1 - 1e-5}, {slides ? 5e-9 : 5e-10, 0, 0}, {mu * 2 * 9.81, 0, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(slides ? DYN_CONTACT_MODE_SLIDE : DYN_CONTACT_MODE_STICK, x.modes[0]) << x.v[0];
    EXPECT_EQ(1, x.degenerate[0]);
  }
}

// A ball whose gap closes at the end of the step, more or less 1e-7 m: it meets the ground or not.
TEST(StepDerivatives, TheEndOfAFlightIsASwitch) {
  for (int k = -50; k <= 50; ++k) {
    Stepper run(ball_on_ground(0.5));
    const double h = run.options.dt, speed = 0.5 + 0.01 * k;
    run.set(upright(0, 0, 0.1 + speed * h + 9.81 * h * h + 1e-11 * k), {0.2, 0, -speed, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size()) << k;
    EXPECT_EQ(1, x.degenerate[0]) << k;
  }
}

TEST(StepDerivatives, ModesThatHoldAreNotDegenerate) {
  for (int k = 1; k <= 50; ++k) {
    Stepper run(ball_on_ground(0.5));
    run.set(upright(0, 0, 0.1 - 1e-5 * k), {0.1, 0, 0, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    EXPECT_EQ(0, x.report.degenerate) << k;
  }
}

// A ball that rebounds from where it touches: its impact is no switch, however light the ball is.
TEST(StepDerivatives, ImpactsOfLightBallsAreNotDegenerate) {
  for (const double mass : {1.0, 1e-7}) {
    Scene scene;
    scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0))
        .sphere("ball", mass, 0.1, material(0, 0.7));
    Stepper run(scene.finish());
    run.set(upright(0, 0, 0.1 + 1e-8), {0, 0, -1, 0, 0, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(DYN_CONTACT_MODE_IMPACT, x.modes[0]) << mass;
    EXPECT_EQ(0, x.degenerate[0]) << mass;
  }
}

}  // namespace
}  // namespace dyn_test
