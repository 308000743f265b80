// Steps that gain energy are repeated in parts: how many, from speeds of 1 to 300 rad/s, and in long motions.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Two rods of 0.5 m. With a height, gravity acts, and all is so high above where potentials are zero.
Model two_rods(double height) {
  const double gravity[3] = {0, 0, height > 0 ? -g : 0};
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, gravity));
  const Spec first("first", DYN_JOINT_TYPE_REVOLUTE, nullptr, {0, 0, height});
  const Spec second("second", DYN_JOINT_TYPE_REVOLUTE, "first", {0.5, 0, 0});
  return b.joint(first).body("upper", "first", 1, {0.5, 0, 0}).joint(second).body("lower", "second", 1, {0.5, 0, 0}).finish();
}

// 2 % of the kinetic energy is allowed, 0.1 % by RK4, 10 % in parts; and a billionth of the potential energy, 40 J at 1e9 m.
// Steps are halved at most five times: twice would refuse a dozen of these.
TEST(EnergyGuard, RepeatsStepsThatGain) {
  const struct {
    dynIntegrator by;
    double height, bend;
    int repeated, tries;
  } cases[] = {{DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 0, 1.5, 62, 120},
               {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e9, 1.5, 43, 95},
               {DYN_INTEGRATOR_RK4, 0, 2.5, 40, 49}};
  for (const auto& c : cases) {
    Simulation run(two_rods(c.height), 0.01);
    integrate_by(run, c.by);
    int repeated = 0, tries = 0;
    for (double speed = 1; speed < 300; speed *= 1.02) {
      EXPECT_EQ(DYN_OK, dyn_data_reset(run.m, run.d, nullptr));
      run.set({0, c.bend}, {speed, -0.5 * speed});
      EXPECT_EQ(DYN_OK, dyn_step(run.m, run.d)) << speed;
      const int parts = int(run.report().rejected);
      repeated += parts > 0, tries += parts;
    }
    EXPECT_NEAR(c.repeated, repeated, 2) << c.by << " " << c.height;
    EXPECT_NEAR(c.tries, tries, 4) << c.by << " " << c.height;
  }
}

// What a torque of 1000 N m gives is no gain: the steps that it drives are made, the repeated ones in a few parts.
TEST(EnergyGuard, CountsTheWorkOfTorques) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_RK4}) {
    Simulation run(two_rods(0), 0.01);
    integrate_by(run, by);
    int tries = 0;
    for (double speed = 1; speed < 300; speed *= 1.02) {
      const Numbers q = {0, 2.5}, v = {speed, -0.5 * speed}, tau = {1000, 0};
      EXPECT_EQ(DYN_OK, dyn_data_reset(run.m, run.d, nullptr));
      EXPECT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, q.data(), v.data(), nullptr, tau.data()));
      EXPECT_EQ(DYN_OK, dyn_step(run.m, run.d)) << by << " " << speed;
      tries += int(run.report().rejected);
    }
    EXPECT_NEAR(by == DYN_INTEGRATOR_RK4 ? 452 : 538, tries, 20) << by;
  }
}

// A thousand steps of less than 0.2 rad: each may gain 2 %, all together 15 %. Without the sum they end at 4.3 times the energy.
TEST(EnergyGuard, BoundsWhatManyStepsGain) {
  Simulation run(two_rods(0), 0.01);
  run.set({0, 1.5}, {20, -20});
  const double begun = run.energy();
  double most = 0;
  int tries = 0;
  for (int k = 0; k < 1000; ++k) run.steps(1), tries += int(run.report().rejected), most = std::max(most, run.energy() / begun);
  EXPECT_LE(most, 1.1);
  EXPECT_NEAR(1427, tries, 60);
}

// Two spheres of 1 g with stiff springs, half sunk into each other: they may take what the springs hold, in parts of the step, too.
TEST(EnergyGuard, SoftContactsGiveWhatTheyHold) {
  for (const double dt : {1e-4, 1e-3, 1e-2}) {
    dynMaterial soft = material(0);
    soft.stiffness = 1e6;
    Scene scene({0, 0, 0});
    Simulation run(scene.sphere("a", 1e-3, 0.1, soft).sphere("b", 1e3, 0.1, soft).finish(), dt);
    run.place({{0, 0, 0}, {0, 0, 0.1}});
    const double held = 0.5 * 5e5 * 0.1 * 0.1;  // springs in series
    for (int k = 0; k < 100; ++k) {
      run.steps(1);
      EXPECT_LE(run.energy(), held * 1.001) << dt << " " << k;
    }
  }
}

// Two links of 0.05 and 0.1 g carry two of 3 kg. A turn of less than 0.1 rad in a step changes what the light ones do by much.
TEST(EnergyGuard, LightLinksUnderHeavyOnesAreGuardedInSmallerMotions) {
  const char* const text = R"(<mujoco><option gravity="0 0 0"/><worldbody>
      <body pos=".18 -.06 -.09"><joint type="hinge" axis=".7 -1.3 -.5"/>
        <inertial pos="-.05 -.12 -.12" mass="5e-5" diaginertia="5e-7 5e-7 5e-7"/>
      <body pos=".18 .26 .55"><joint type="hinge" axis=".1 1.4 -.8"/>
        <inertial pos=".1 -.03 .14" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/>
      <body pos=".14 .13 -.14"><joint type="hinge" axis="1 .25 0"/>
        <inertial pos="-.15 .26 .16" mass="3" diaginertia=".03 .03 .03"/>
      <body pos=".15 -.07 .31"><joint type="hinge" axis="-.7 .6 1.5"/>
        <inertial pos=".15 .29 .3" mass="3" diaginertia=".03 .03 .03"/>
      </body></body></body></body></worldbody></mujoco>)";
  for (const double speed : {1.0, 2.0}) {
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
    Simulation run(Model(m), 0.01);
    run.set({0.36, 2.8, -0.2, 1.3}, {-2.2 * speed, 0.3 * speed, 2.2 * speed, 0.6 * speed});
    const double begun = run.energy();
    double most = 0;
    for (int k = 0; k < 200; ++k) run.steps(1), most = std::max(most, run.energy() / begun);
    EXPECT_LE(most, 1.25) << speed;  // 1.33 and 1.53 if motions of less than 0.1 rad were not guarded
  }
}

}  // namespace
}  // namespace dyn_test
