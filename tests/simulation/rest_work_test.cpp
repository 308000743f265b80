// What bodies cost that come to rest or stand: iterations and residuals of many steps.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Cubes of 0.1 m, one on the other, that do not fall asleep.
struct Tower : Simulation {
  explicit Tower(const Numbers& masses, double dt, double tolerance = 0) : Simulation(model(masses), dt) {
    EXPECT_EQ(DYN_OK, dyn_data_set_effects(m, d, 0, DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING));
    options.tolerance = tolerance;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
    for (std::size_t k = 0; k < masses.size(); ++k) at.insert(at.end(), {0, 0, 0.05 + 0.1 * double(k), 0, 0, 0, 1});
  }
  static Model model(const Numbers& masses) {
    Scene scene;
    scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5));
    for (std::size_t k = 0; k < masses.size(); ++k)
      scene.box(("box" + std::to_string(k)).c_str(), masses[k], {0.1, 0.1, 0.1}, material(0.5));
    return scene.finish();
  }
  // Iterations of n steps.
  int work(int n, const Numbers& velocity = {}) {
    set(at, velocity);
    int sum = 0;
    for (int k = 0; k < n; ++k) steps(1), sum += report().iterations, unsolved += int(report().unsolved);
    return sum;
  }
  Numbers at;
  int unsolved = 0;
};

// Stress of redundant contacts is removed every 64 steps: then the guess solves the others, from which it else would drift.
TEST(RestWork, AStandingTowerCostsAnIterationInFewSteps) {
  Tower tower(Numbers(10, 1.0), 1e-3, 1e-8);
  EXPECT_LT(tower.work(300), 150);
  EXPECT_EQ(0, tower.unsolved);
}

// A box leans on a corner by a tilted gravity: by the smallest impulses of all four corners the opposite one would pull. So it is
// left out, and the three others share the weight without stress, however the box came to rest.
TEST(RestWork, SmallestImpulsesLeaveOutContactsThatWouldPull) {
  const double tilt = 0.275;
  int unstressed = 0;
  for (int k = 0; k < 12; ++k) {
    Simulation run(Scene({-g * tilt, -g * tilt, -g}).shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(1))
                       .box("box", 1, {1, 1, 2}, material(1)).finish());
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL & ~DYN_EFFECT_SLEEPING));
    run.set({0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.01, 0.03 * std::sin(1 + k), 0.03 * std::cos(1 + k), 0.03});
    run.steps(130);
    double square = 0;
    for (const dynContactForce& f : run.contacts())
      for (const double x : f.force_on_b) square += x * x;
    // normal forces of 0.55 and twice 0.225 of the weight, and a third of the shear each
    const double least = (0.55 * 0.55 + 2 * 0.225 * 0.225 + 2 * tilt * tilt / 3) * g * g;
    EXPECT_GT(square, 0.999 * least);
    unstressed += square < 1.01 * least;
  }
  EXPECT_GE(unstressed, 11);
}

// Small islands are solved to the fine residual, also where the default of 1e-4 would do: a try of the dense matrix is enough, but
// for few of the steps in which a contact begins to stick (of 15,000 steps of boxes that are pushed at random about 15).
TEST(RestWork, ASlidingBoxIsSolvedToTheFineResidual) {
  Tower box({1}, 1e-2);
  int iterations = 0, coarse = 0;
  for (int k = 0; k < 300; ++k) {
    if (k == 0) box.set(box.at, {0.3, -0.2, 0, 0.5, -0.4, 0.6});
    box.steps(1), iterations += box.report().iterations, coarse += box.report().residual > 1e-9;
  }
  EXPECT_LT(iterations, 160 + 20 * coarse);  // such a step uses up the try
  EXPECT_LE(coarse, 1);
  EXPECT_LE(box.residual, 1e-5);
}

// Newton's method goes on while it reduces the residual.
TEST(RestWork, TwoSlidingBoxesAreSolvedToTheFineResidual) {
  Tower boxes({1, 1}, 1e-3);
  boxes.work(300, {0.3, -0.2, 0, 0.5, -0.4, 0.6, -0.2, 0.1, 0, 0.3, 0.2, -0.5});
  EXPECT_LE(boxes.residual, 1e-9);
}

// A method that gets nowhere leaves iterations to others.
TEST(RestWork, HeavyBoxesOnLightOnesAreSolvedInNearlyEveryStep) {
  Tower tower({1, 10, 100, 1, 10, 100}, 1e-3, 1e-8);
  Numbers pushed;
  for (int k = 0; k < 36; ++k) pushed.push_back(0.05 * std::sin(1 + 3 * k));
  EXPECT_LT(tower.work(100, pushed), 6000);
  EXPECT_LE(tower.unsolved, 3);
}

}  // namespace
}  // namespace dyn_test
