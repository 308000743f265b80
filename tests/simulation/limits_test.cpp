// Joint limits in steps: hinges and ball joints.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

void bob(Builder& b, const char* joint) {
  const double com[3] = {0, 0, -1}, I[9] = {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3};
  EXPECT_EQ(DYN_OK, dyn_builder_add_body(b, "bob", joint, nullptr, 1, com, I)) << dyn_last_error();
}

Model pendulum(double lower, double upper) {
  Builder b;
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  hinge.about(0, 1, 0), hinge.lower = &lower, hinge.upper = &upper;
  b.joint(hinge), bob(b, "hinge");
  return b.finish();
}

TEST(Limits, LimitsHold) {
  Simulation run(pendulum(-0.5, 0.2));
  run.set({0.1}, {4});
  double most = -1, least = 1;
  for (int k = 0; k < 2000; ++k) run.steps(1), most = std::max(most, run.q[0]), least = std::min(least, run.q[0]);
  EXPECT_NEAR(0.2, most, 1e-9);
  EXPECT_GE(least, -0.5 - 1e-9);
  // not where the effect is off
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
  run.set({0.1}, {4});
  run.steps(100);
  EXPECT_GT(run.q[0], 0.3);
  // from beyond a limit it comes back
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL));
  run.set({0.4}, {0});
  run.steps(1000);
  EXPECT_LE(run.q[0], 0.2 + 1e-8);
}

// A bob on a ball joint limited to half a radian; on request two arms of which one follows the other (M has no tree structure).
Model ball_pendulum(bool beside, double angle = 0.5, double damping = 0) {
  Builder b;
  Spec ball("ball", DYN_JOINT_TYPE_SPHERICAL);
  const double lower[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, std::cos(angle / 2)};
  const double resists[3] = {damping, damping, damping};
  ball.lower = lower, ball.damping = resists;
  b.joint(ball), bob(b, "ball");
  if (beside) {
    Spec lead("lead", DYN_JOINT_TYPE_REVOLUTE), follow("follow", DYN_JOINT_TYPE_REVOLUTE);
    follow.mimic = "lead", follow.mimic_ratio = 2;
    b.joint(lead).joint(follow).body("x", "lead", 1, {0.1, 0, 0}).body("y", "follow", 1, {0.2, 0, 0});
  }
  return b.finish();
}
double angle_of(const Simulation& run) {
  return 2 * std::atan2(std::sqrt(run.q[0] * run.q[0] + run.q[1] * run.q[1] + run.q[2] * run.q[2]), std::abs(run.q[3]));
}

// In a plane a ball's limit equals a hinge's, for either sign of the quaternion.
TEST(Limits, BallLimitMatchesHingeLimitInAPlane) {
  for (const bool beside : {false, true})
    for (const double sign : {1.0, -1.0})
      for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
        Simulation run(ball_pendulum(beside)), hinge(pendulum(-0.5, 0.5));
        for (Simulation* p : {&run, &hinge}) p->options.integrator = by, dyn_data_set_step_options(p->m, p->d, &p->options);
        Numbers q(static_cast<std::size_t>(dyn_model_nq(run.m)), 0), v(static_cast<std::size_t>(dyn_model_nv(run.m)), 0);
        q[1] = sign * std::sin(0.05), q[3] = sign * std::cos(0.05), v[1] = 4;
        run.set(q, v), hinge.set({0.1}, {4});
        double most = 0;
        for (int k = 0; k < 2000; ++k) {
          run.steps(1), hinge.steps(1);
          ASSERT_NEAR(hinge.q[0], 2 * std::atan(run.q[1] / run.q[3]), 1e-9) << k << beside << by;
          ASSERT_NEAR(hinge.v[0], run.v[1], 1e-7) << k;  // to the solver's tolerance
          most = std::max(most, angle_of(run));
        }
        EXPECT_NEAR(0.5, most, 1e-9);
      }
}

// About any axis, with spin: the limit holds except for the axis' rotation in a step, and no energy is gained.
// With cos(a'/2) = cos(a/2) cos(h w/2) a step along the limit leads (h w)^2 / 4 cot(a/2) beyond; each step removes half of the
// error.
TEST(Limits, BallLimitHolds) {
  for (const double angle : {0.2, 0.5, 1.5, 3.0}) {
    Simulation run(ball_pendulum(false, angle));
    run.set({}, {6, -9, 2.5});
    double most = 0, fast = 0, energy = run.energy();
    for (int k = 0; k < 3000; ++k) {
      run.steps(1);
      most = std::max(most, angle_of(run)), fast = std::max(fast, std::hypot(run.v[0], run.v[1], run.v[2]));
      ASSERT_LE(run.energy(), energy + 1e-2 * 50) << k;  // of 100 J, by steps of first order
    }
    EXPECT_LE(most, angle + 2 * 1e-6 * fast * fast / 4 / std::tan(angle / 2) + 1e-6) << angle << " " << fast;
    EXPECT_GE(most, angle - 1e-9) << angle;
    // not where the effect is off
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
    run.set({0, 0, 0, 1}, {0, 12, 0});
    run.steps(int(1000 * (angle + 0.08) / 11));
    EXPECT_GT(angle_of(run), angle) << angle;
  }
}

// Gravity holds the bob at its limit: the row's force equals the moment, and the bob does not creep.
TEST(Limits, BallLimitDoesNotCreep) {
  Simulation run(ball_pendulum(false, 0.5, 1));
  const double aside[3] = {9, 0, -1};
  ASSERT_EQ(DYN_OK, dyn_data_set_gravity(run.m, run.d, aside));
  run.steps(20000);
  EXPECT_NEAR(0.5, angle_of(run), 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(0, run.v[i], 1e-9);
  run.options.accuracy = 1e-6;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set({0, 0, 0, 1}, {0, 0, 0});
  ASSERT_EQ(DYN_OK, dyn_advance(run.m, run.d, 2)) << dyn_last_error();
  EXPECT_NEAR(0.5, angle_of(run), 1e-5);
}

TEST(Limits, InvalidBallLimitsAreRefused) {
  Builder b;
  for (const double w : {1.0, 2.0}) {
    Spec ball("ball", DYN_JOINT_TYPE_SPHERICAL);
    const double lower[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, w};
    ball.lower = lower;
    EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_joint(b, &ball));
    EXPECT_TRUE(says({"ball", "lower limit[3]", "cos(a/2)"})) << dyn_last_error();
  }
}

// The sensors of a ball joint: its quaternion, of unit length, and its angular velocity.
TEST(Limits, SensorsOfABallReadItsState) {
  Builder b;
  b.joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL)), bob(b, "ball");
  for (const dynQuantity quantity : {DYN_QUANTITY_BALLQUAT, DYN_QUANTITY_BALLANGVEL}) {
    dynSensor s;
    dyn_sensor_init(&s, quantity);
    ASSERT_EQ(DYN_OK, dyn_builder_add_sensor(b, quantity == DYN_QUANTITY_BALLQUAT ? "turn" : "rate", &s, "ball", nullptr))
        << dyn_last_error();
  }
  Simulation run(b.finish());
  const double unit[4] = {0.1, -0.5, 0.7, 0.5}, v[3] = {3, -4, 5};
  for (const double length : {1.0, 1 + 1e-7}) {  // as long as rounding and callers leave it
    double q[4], x[7];
    for (int k = 0; k < 4; ++k) q[k] = length * unit[k];
    ASSERT_EQ(DYN_OK, dyn_sensors(run.m, run.d, q, v, nullptr, x)) << dyn_last_error();
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(unit[k], x[k], 1e-15) << k;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(v[k], x[4 + k]) << k;
  }
}

}  // namespace
}  // namespace dyn_test
