// Forces of bodies at rest: redundant contacts keep no stress from the impacts before.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

struct Forces {
  double normal = 0, least = HUGE_VAL, across = 0;  // N: sum and least of the normal forces, largest tangential force
};
Forces forces_on(const Simulation& play) {
  Forces out;
  for (const dynContactForce& f : play.contacts()) {
    const double *n = f.contact.normal, *force = f.force_on_b, along = n[0] * force[0] + n[1] * force[1] + n[2] * force[2];
    double across = 0;
    for (int i = 0; i < 3; ++i) across += std::pow(force[i] - along * n[i], 2);
    out.normal += along, out.least = std::min(out.least, along), out.across = std::max(out.across, std::sqrt(across));
  }
  return out;
}

// A box falls on an edge. At rest each corner bears a quarter of its weight, without friction: the impact left 1.4 N of it.
TEST(Rest, BoxBearsItsWeightWithoutFriction) {
  for (const double tolerance : {0.0, 1e-9}) {
    Simulation play(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.7)).finish(), 2e-3);
    play.options.tolerance = tolerance;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
    play.set({0, 0, 0.3, 0.17, 0.09, 0.05, std::sqrt(1 - 0.17 * 0.17 - 0.09 * 0.09 - 0.05 * 0.05)});
    play.steps(1000);
    const Forces f = forces_on(play);
    EXPECT_EQ(4u, play.contacts().size());
    EXPECT_NEAR(9.81, f.normal, 1e-6);
    EXPECT_NEAR(9.81 / 4, f.least, 1e-2);
    EXPECT_LT(f.across, 1e-6) << tolerance;
  }
}

// Once it rests, the impulses of the step before hold it: hundreds of steps go by between solves. It swung at the size of the
// tolerance before, and was solved in every second step.
TEST(Rest, TallBoxIsSeldomSolved) {
  Simulation play(Scene().ground().box("box", 0.1, {0.02, 0.08, 0.2}, material(1)).finish(), 2e-3);
  play.place({{0, 0, 0.1}});
  int iterations = 0;
  for (int k = 0; k < 3000; ++k) play.steps(1), iterations += play.report().iterations;
  EXPECT_LT(iterations, 100);
}

// Boxes that fall turned on one another: friction forces of 5 N were locked between them.
TEST(Rest, StackLocksNoFriction) {
  Scene scene;
  scene.ground();
  Numbers q;
  for (int k = 0; k < 4; ++k) {
    scene.box(("box" + std::to_string(k)).c_str(), 1, {0.2, 0.2, 0.2}, material(1));
    q.insert(q.end(), {0.01 * k, 0, 0.12 + 0.21 * k, 0, std::sin(0.025 * k), 0, std::cos(0.025 * k)});
  }
  Simulation play(scene.finish(), 2e-3);
  play.set(q);
  play.steps(2500);
  const Forces f = forces_on(play);
  EXPECT_NEAR(9.81 * (4 + 3 + 2 + 1), f.normal, 1e-2);
  EXPECT_LT(f.across, 1e-2);
}

// On a slope friction is needed: each corner bears its share of it, and the box stays.
TEST(Rest, FrictionOnASlopeIsShared) {
  const double tilt = 0.3;
  Scene scene({9.81 * std::sin(tilt), 0, -9.81 * std::cos(tilt)});
  Simulation play(scene.ground().box("box", 1, {0.2, 0.2, 0.2}, material(1)).finish(), 2e-3);
  play.place({{0, 0, 0.1}});
  play.steps(500);
  EXPECT_NEAR(9.81 * std::sin(tilt) / 4, forces_on(play).across, 1e-2);
  EXPECT_LT(std::abs(play.v[0]), 1e-9);
}

}  // namespace
}  // namespace dyn_test
