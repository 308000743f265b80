// Actuators against closed forms.
#include "common/every.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

const std::vector<dynIntegrator> all_integrators = every<dynIntegrator>("dynIntegrator");
constexpr double inertia = 0.5;

dynActuator actuator(dynActuatorType type, double kp = 0, double kv = 0) {
  dynActuator a;
  dyn_actuator_init(&a, type);
  a.kp = kp, a.kv = kv;
  return a;
}

// A wheel about z driven by its actuator alone.
Model wheel(const dynActuator& a) {
  Builder b;
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  hinge.about(0, 0, 1);
  const double com[3] = {}, I[9] = {inertia, 0, 0, 0, inertia, 0, 0, 0, inertia};
  b.joint(hinge);
  EXPECT_EQ(DYN_OK, dyn_builder_add_body(b, "wheel", "hinge", nullptr, 2, com, I));
  EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, "drive", &a, "hinge")) << dyn_last_error();
  return b.finish();
}

TEST(Actuators, MotorTurnsAWheel) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  a.gear = 3, a.control_range[0] = -1, a.control_range[1] = 1;
  for (const dynIntegrator by : all_integrators) {
    Simulation run(wheel(a));
    integrate_by(run, by);
    control(run, {5});  // beyond its range: 1
    run.steps(1000);
    EXPECT_NEAR(3 / inertia, run.v[0], 1e-12) << by;
    EXPECT_NEAR(0.5 * 3 / inertia, run.q[0],
                by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST ? 3.1e-3 : 1e-12)
        << by;
    EXPECT_EQ(1, run.array("actuator_force")[0]) << by;
  }
}

// Gains of 1e9 and 1e5 at 10 ms, too large for any explicit method.
TEST(Actuators, LargeGainsAreStable) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
    Simulation run(wheel(actuator(DYN_ACTUATOR_TYPE_POSITION, 1e9, 1e5)), 0.01);
    integrate_by(run, by);
    control(run, {0.7});
    run.steps(200);
    EXPECT_NEAR(0.7, run.q[0], 1e-9) << by;
    EXPECT_NEAR(0, run.v[0], 1e-9) << by;
    Simulation speed(wheel(actuator(DYN_ACTUATOR_TYPE_VELOCITY, 0, 1e9)), 0.01);
    integrate_by(speed, by);
    control(speed, {-2});
    speed.steps(10);
    EXPECT_NEAR(-2, speed.v[0], 1e-9) << by;
  }
}

// A step of a motor under a controller of position and velocity. Where the voltage has no bound, its force is that of the
// controller at the end of the step: I (v' - v) = h (kp (u - q - h v') + kd (u_v - v')).
TEST(Actuators, ControlledMotorIsAnImplicitServo) {
  constexpr double h = 0.01, kp = 1e4, kd = 30, q = 0.1, v = 0.4, u = 0.3, u_v = -0.7;
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_DC_MOTOR);
  a.inputs = DYN_INPUT_POSITION | DYN_INPUT_VELOCITY;
  a.motor.resistance = 0.8, a.motor.constant = 0.05, a.motor.kp = kp, a.motor.kd = kd;
  Simulation run(wheel(a), h);
  run.set({q}, {v});
  control(run, {u, u_v});
  run.steps(1);
  // rows of stiff actuators are solved to 1e-9
  EXPECT_NEAR((inertia * v + h * (kp * (u - q) + kd * u_v)) / (inertia + h * kd + h * h * kp), run.v[0], 1e-9);
}

// At a constant voltage a motor loses K^2 / R of its rate, here 16 times in a step: v' = (I v + h K V / R) / (I + h K^2 / R).
TEST(Actuators, MotorAtAConstantVoltageIsADamper) {
  constexpr double h = 0.01, K = 20, R = 0.5, v = 0.4, V = 3;
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_DC_MOTOR);
  a.motor.resistance = R, a.motor.constant = K;
  Simulation run(wheel(a), h);
  run.set({0}, {v});
  control(run, {V});
  run.steps(1);
  EXPECT_NEAR((inertia * v + h * K * V / R) / (inertia + h * K * K / R), run.v[0], 1e-9);
}

// Far from its target a servo applies its largest force; near it, it settles without chatter.
TEST(Actuators, ForcesStayWithinTheirRange) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_POSITION, 1e6, 1e6);
  a.force_range[0] = -4, a.force_range[1] = 4;
  Simulation run(wheel(a));
  control(run, {10});
  run.steps(100);
  EXPECT_NEAR(4 / inertia * 0.1, run.v[0], 1e-12);
  EXPECT_EQ(4, run.array("actuator_force")[0]);
  for (int k = 0; k < 20000; ++k) {
    run.steps(1);
    ASSERT_LE(std::abs(run.array("actuator_force")[0]), 4) << k;
  }
  EXPECT_NEAR(10, run.q[0], 1e-6);
  EXPECT_NEAR(0, run.v[0], 1e-6);
}

TEST(Actuators, FilterIsAFirstOrderLag) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  a.time_constant = 0.2;
  for (const dynIntegrator by : all_integrators) {
    Simulation run(wheel(a));
    integrate_by(run, by);
    control(run, {1});
    run.steps(500);
    const double w = 1 - std::exp(-0.5 / 0.2);
    EXPECT_NEAR(w, run.array("act")[0], by == DYN_INTEGRATOR_RK4 ? 1e-11 : 1e-12) << by;
    const double v = (0.5 - 0.2 * w) / inertia;
    EXPECT_NEAR(v, run.v[0],
                by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST ? 1.1e-3
                : by == DYN_INTEGRATOR_IMPLICIT_MIDPOINT                                       ? 1e-5
                                                                                               : 1e-12)
        << by;
  }
}

// The activation's rate is the control until the end of its range.
TEST(Actuators, ControlIsIntegrated) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  a.integrates = 1, a.act_range[0] = -1, a.act_range[1] = 0.3;
  for (const dynIntegrator by : all_integrators) {
    Simulation run(wheel(a));
    integrate_by(run, by);
    control(run, {2});
    run.steps(100);
    EXPECT_NEAR(0.2, run.array("act")[0], 1e-12) << by;
    EXPECT_NEAR(0.5 * 2 * 0.1 * 0.1 / inertia, run.v[0],
                by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST ? 2.1e-4 : 1e-12)
        << by;
    run.steps(100);
    EXPECT_NEAR(0.3, run.array("act")[0], 1e-15) << by;
    control(run, {-1});
    run.steps(100);
    EXPECT_NEAR(0.2, run.array("act")[0], 1e-12) << by;
    control(run, {-100});
    run.steps(100);
    EXPECT_NEAR(-1, run.array("act")[0], 1e-15) << by;
  }
}

// The activation of a filter stays in the range, too.
TEST(Actuators, FilteredActivationStaysInRange) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  a.time_constant = 0.05, a.act_range[0] = 0, a.act_range[1] = 0.4;
  for (const dynIntegrator by : all_integrators) {
    Simulation run(wheel(a));
    integrate_by(run, by);
    control(run, {1});
    run.steps(200);
    EXPECT_EQ(0.4, run.array("act")[0]) << by;
    control(run, {-1});
    run.steps(200);
    EXPECT_EQ(0, run.array("act")[0]) << by;
  }
}

// Feed-forward holds an arm still without a servo error.
TEST(Actuators, FeedForwardHoldsAnArm) {
  Builder b;
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  hinge.about(0, 1, 0);
  b.joint(hinge).body("arm", "hinge", 2, {0.5, 0, 0});
  const dynActuator a = actuator(DYN_ACTUATOR_TYPE_PD, 10, 1);
  ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(b, "pd", &a, "hinge"));
  Simulation run(b.finish());
  EXPECT_EQ(3, dyn_model_nu(run.m));
  control(run, {0, 0, -2 * 9.81 * 0.5});
  run.steps(1000);
  EXPECT_NEAR(0, run.q[0], 1e-12);
  EXPECT_NEAR(-2 * 9.81 * 0.5, run.array("actuator_force")[0], 1e-9);
}

TEST(Actuators, DisabledActuatorsDoNothing) {
  Simulation run(wheel(actuator(DYN_ACTUATOR_TYPE_MOTOR)));
  control(run, {1});
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL & ~DYN_EFFECT_ACTUATORS));
  run.steps(10);
  EXPECT_EQ(0, run.v[0]);
}

void keeps_its_state(const dynActuator& a) {
  Simulation run(wheel(a));
  control(run, {1});
  run.steps(20);
  std::vector<char> state(dyn_model_state_size(run.m));
  ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, run.d, state.data(), state.size()));
  run.steps(20);
  const double q = run.q[0], w = run.array("act")[0];
  control(run, {-3});
  run.steps(5);
  ASSERT_EQ(DYN_OK, dyn_data_restore_state(run.m, run.d, state.data(), state.size()));
  run.steps(20);
  EXPECT_EQ(q, run.q[0]);
  EXPECT_EQ(w, run.array("act")[0]);
  EXPECT_GT(w, 0);
}
TEST(Actuators, SavedStateRestoresFilters) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  a.time_constant = 0.1;
  keeps_its_state(a);
}
TEST(Actuators, SavedStateRestoresIntegrals) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_POSITION, 5, 1);
  a.integrates = 1, a.act_range[0] = -0.01, a.act_range[1] = 1;
  keeps_its_state(a);
}

TEST(Actuators, BuilderFromModelKeepsActuators) {
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_PD, 3, 4);
  a.force_range[0] = -1, a.integrates = 1, a.act_range[1] = 7;
  const Model m = wheel(a);
  dynBuilder* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_from_model(m, &b));
  dynModel* again = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_attach(b, m, "second_", nullptr));
  ASSERT_EQ(DYN_OK, dyn_builder_remove_subtree(b, "hinge"));
  ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &again));
  dyn_builder_free(b);
  const Model kept(again);
  EXPECT_EQ(1, dyn_model_nactuators(kept));
  EXPECT_EQ(0, dyn_model_actuator_id(kept, "second_drive"));
  dynActuator x;
  dyn_actuator_init(&x, DYN_ACTUATOR_TYPE_MOTOR);
  ASSERT_EQ(DYN_OK, dyn_model_actuator_info(kept, 0, &x));
  EXPECT_EQ(3, x.kp);
  EXPECT_EQ(-1, x.force_range[0]);
  EXPECT_EQ(3, x.controls);
  EXPECT_EQ(1, x.integrates);
  EXPECT_EQ(7, x.act_range[1]);
  EXPECT_EQ(0, x.idx_act);
}

TEST(Actuators, InvalidSpecsAreRefused) {
  Builder b;
  b.joint(Spec("hinge", DYN_JOINT_TYPE_REVOLUTE))
      .joint(Spec("ball", DYN_JOINT_TYPE_SPHERICAL))
      .body("x", "hinge", 1)
      .body("y", "ball", 1);
  const auto refused = [&](dynStatus expected, const dynActuator& a, const char* joint, const char* word,
                           const char* name = "a") {
    EXPECT_EQ(expected, dyn_builder_add_actuator(b, name, &a, joint)) << word;
    EXPECT_TRUE(says({word})) << dyn_last_error();
  };
  dynActuator a = actuator(DYN_ACTUATOR_TYPE_MOTOR);
  refused(DYN_ERROR_NAME, a, "elbow", "elbow");
  refused(DYN_ERROR_ARGUMENT, a, "hinge", "no name", "");
  a.component = 1;
  refused(DYN_ERROR_ARGUMENT, a, "hinge", "component is 1");
  a = actuator(DYN_ACTUATOR_TYPE_POSITION, -1);
  refused(DYN_ERROR_INVALID, a, "hinge", "kp is -1");
  a = actuator(DYN_ACTUATOR_TYPE_POSITION, NAN);
  refused(DYN_ERROR_NONFINITE, a, "hinge", "kp is nan");
  a = actuator(DYN_ACTUATOR_TYPE_MOTOR), a.force_range[0] = 1, a.force_range[1] = -1;
  refused(DYN_ERROR_INVALID, a, "hinge", "force_range");
  a = actuator(DYN_ACTUATOR_TYPE_MOTOR), a.time_constant = -1;
  refused(DYN_ERROR_INVALID, a, "hinge", "time_constant");
  a.integrates = 1, a.time_constant = 0.1;
  refused(DYN_ERROR_INVALID, a, "hinge", "integrates its control");
  a = actuator(DYN_ACTUATOR_TYPE_MOTOR), a.act_range[0] = NAN;
  refused(DYN_ERROR_INVALID, a, "hinge", "act_range");
  a = actuator(dynActuatorType(9));
  refused(DYN_ERROR_ARGUMENT, a, "hinge", "type 9");
  a = actuator(DYN_ACTUATOR_TYPE_MOTOR), a.struct_size = 4;
  refused(DYN_ERROR_SIZE, a, "hinge", "dyn_actuator_init");
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_add_actuator(b, "a", nullptr, "hinge"));
  EXPECT_EQ(DYN_ERROR_NAME, dyn_builder_set_gravity_compensation(b, "nobody", 1));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_builder_set_gravity_compensation(b, "x", NAN));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_medium(b, -1, 0, nullptr));
  // length of a quaternion
  a = actuator(DYN_ACTUATOR_TYPE_POSITION, 1);
  ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(b, "twist", &a, "ball"));
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_finish(b, &m));
  EXPECT_TRUE(says({"twist", "length"}));

  Simulation run(wheel(actuator(DYN_ACTUATOR_TYPE_MOTOR)));
  const double nan = NAN, six[6] = {1, 0, 0, 0, 0, 0}, point[3] = {};
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_data_set_control(run.m, run.d, &nan));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_control(run.m, run.d, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_apply_wrench(run.m, run.d, 0, nullptr, six, DYN_REFERENCE_LOCAL));
  EXPECT_TRUE(says({"universe", "does not move"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_apply_wrench(run.m, run.d, 1, point, six, DYN_REFERENCE_WORLD));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_apply_wrench(run.m, run.d, 1, point, nullptr, DYN_REFERENCE_LOCAL));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_apply_wrench(run.m, run.d, 99, point, six, DYN_REFERENCE_LOCAL));
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_data_set_gravity(run.m, run.d, &nan));
  EXPECT_EQ(nullptr, dyn_model_actuator_name(run.m, 1));
  EXPECT_EQ(-1, dyn_model_actuator_id(run.m, "none"));
}

}  // namespace
}  // namespace dyn_test
