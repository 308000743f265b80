// Walls of bricks: what the first step costs, of which nothing is known, and the others.
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

// Sweeps alone leave 2e-3 of the speed after a hundred; proximal steps end below the default tolerance of 1e-4.
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

}  // namespace
}  // namespace dyn_test
