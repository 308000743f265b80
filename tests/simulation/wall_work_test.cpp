// Walls of bricks: what the first step costs, of which nothing is known, and the others.
#include <random>

#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Bricks in bond, 1 mm apart. Their faces are flush, so rounding decides whose corner a contact point is.
struct Wall : Simulation {
  Wall(int columns, int rows) : Simulation(model(columns * rows), 2e-3) {
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < columns; ++i)
        at.insert(at.end(), {(i + 0.5 * (k % 2)) * 0.201, 0, 0.04 + 0.08 * k, 0, 0, 0, 1});
    set(at, Numbers(std::size_t(m.nv()), 0.0));
  }
  static Model model(int count) {
    Scene scene;
    scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5));
    for (int k = 0; k < count; ++k) scene.box(("brick" + std::to_string(k)).c_str(), 1, {0.2, 0.1, 0.08}, material(0.5));
    return scene.finish();
  }
  Numbers at;
};

// Sweeps alone leave 2e-3 of the speed after a hundred; the smoothing method ends below the default tolerance of 1e-4.
TEST(WallWork, AWallIsSolvedFromNothing) {
  for (const int side : {6, 10, 14}) {
    Wall wall(side, side);
    wall.steps(1);
    EXPECT_EQ(0u, wall.report().unsolved) << side;
    EXPECT_LE(wall.report().residual, 1e-4) << side;
    EXPECT_LE(wall.report().iterations, 90u) << side;
  }
}

// The forces of the step before are nearly right, also where features change: few steps have much to solve.
TEST(WallWork, AStandingWallCostsFewIterations) {
  Wall wall(15, 15);
  wall.steps(1);
  int sum = 0, unsolved = 0;
  for (int k = 0; k < 30; ++k) {
    wall.steps(1);
    sum += int(wall.report().iterations), unsolved += int(wall.report().unsolved);
  }
  EXPECT_LE(sum, 100);
  EXPECT_EQ(0, unsolved);
}

// Bricks that fly apart and meet again: where guesses are bad, Newton's method alone is not enough; where they are good, sweeps
// before it are wasted.
TEST(WallWork, AThrownWallCostsAsManyIterationsAsStated) {
  int sum = 0;
  for (const int side : {6, 8}) {
    Wall wall(side, side);
    std::mt19937 random(1);
    Numbers v(std::size_t(wall.m.nv()));
    for (double& x : v) x = 0.3 * (double(random()) / 2147483648.0 - 1);
    wall.set(wall.at, v);
    for (int k = 0; k < 60; ++k) wall.steps(1), sum += int(wall.report().iterations);
  }
  EXPECT_NEAR(2750, sum, 0.2 * 2750);
}

// Two cubes have 24 rows on two segments: elimination is worth its price already.
TEST(WallWork, NewtonOfTwoCubesEliminates) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5));
  for (const char* name : {"low", "high"}) scene.box(name, 1, {0.1, 0.1, 0.1}, material(0.5));
  Simulation cubes(scene.finish(), 2e-3, DYN_CONTACT_SOLVER_TYPE_NEWTON);
  std::mt19937 random(1);
  Numbers v(12);
  for (double& x : v) x = 0.3 * (double(random()) / 2147483648.0 - 1);
  cubes.set({0, 0, 0.05, 0, 0, 0, 1, 0, 0, 0.15, 0, 0, 0, 1}, v);
  int sum = 0;
  for (int k = 0; k < 20; ++k) cubes.steps(1), sum += int(cubes.report().iterations);
  EXPECT_LE(sum, 80);  // 73; by the dense matrix 88
}

}  // namespace
}  // namespace dyn_test
