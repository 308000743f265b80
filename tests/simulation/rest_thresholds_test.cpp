// Where bodies at rest begin to count as such: gaps that stay, forces that stay, residuals that end a solve.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Cubes of 0.1 m and 1 kg, one on the other.
struct Pile : Simulation {
  explicit Pile(int count, double dt, dynContactSolverType by = DYN_CONTACT_SOLVER_TYPE_ADMM) : Simulation(model(count), dt, by) {
    for (int k = 0; k < count; ++k) at.insert(at.end(), {0, 0, 0.05 + 0.1 * k, 0, 0, 0, 1});
    set(at);
  }
  static Model model(int count) {
    Scene scene;
    scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5));
    for (int k = 0; k < count; ++k) scene.box(("box" + std::to_string(k)).c_str(), 1, {0.1, 0.1, 0.1}, material(0.5));
    return scene.finish();
  }
  Numbers at;
};

// By default a gap stays that is smaller than a twentieth of what gravity closes in a step.
TEST(RestThresholds, GapsThatResidualsLeaveStay) {
  const double h = 1e-2;
  for (const double share : {0.03, 0.08}) {
    Pile pile(3, h);
    pile.steps(5);
    const double gap = share * g * h * h;
    pile.at[16] += gap;
    pile.set(pile.at);
    pile.steps(1);
    EXPECT_NEAR(share < 0.05 ? gap : 0, pile.q[16] - 0.25, 0.1 * gap) << share;
  }
}

// The forces of a pile at rest that is solved by one sweep a step converge from step to step. They stay where they would change
// by less than a millionth of the largest.
TEST(RestThresholds, ForcesStayThatChangeByLessThanAMillionth) {
  Pile pile(4, 1e-3, DYN_CONTACT_SOLVER_TYPE_PGS);
  EXPECT_EQ(DYN_OK, dyn_data_set_effects(pile.m, pile.d, 0, DYN_EFFECT_ALL));
  pile.options.max_iterations = 1, pile.options.sleep_time = 2e-3, pile.options.sleep_speed = 1, pile.options.tolerance = 1e-12;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(pile.m, pile.d, &pile.options));
  std::vector<dynContactForce> before;
  double least = 1;
  for (int k = 0; k < 3000; ++k) {
    pile.steps(1);
    const std::vector<dynContactForce> now = pile.contacts();
    double change = 0, largest = 0;
    for (std::size_t c = 0; before.size() == now.size() && c < now.size(); ++c)
      for (int i = 0; i < 3; ++i) {
        change = std::max(change, std::abs(now[c].force_on_b[i] - before[c].force_on_b[i]));
        largest = std::max(largest, std::abs(now[c].force_on_b[i]));
      }
    if (change > 0) least = std::min(least, change / largest);
    before = now;
  }
  EXPECT_EQ(1, pile.report().sleeping);
  EXPECT_GT(least, 1e-6);
  EXPECT_LT(least, 1.1e-6);
}

}  // namespace
}  // namespace dyn_test
