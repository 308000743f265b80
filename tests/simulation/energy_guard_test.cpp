// Steps that gain energy are repeated in parts: how many, from speeds of 1 to 300 rad/s.
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
      run.set({0, c.bend}, {speed, -0.5 * speed});
      EXPECT_EQ(DYN_OK, dyn_step(run.m, run.d)) << speed;
      const int parts = int(run.report().rejected);
      repeated += parts > 0, tries += parts;
    }
    EXPECT_NEAR(c.repeated, repeated, 2) << c.by << " " << c.height;
    EXPECT_NEAR(c.tries, tries, 4) << c.by << " " << c.height;
  }
}

}  // namespace
}  // namespace dyn_test
