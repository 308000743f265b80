// Shapes that pass each other or slide onto a flush surface do not collide: a gap is no wall.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

dynShapeSpec box_at(double x, double z, std::array<double, 3> size, double friction) {
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "universe", s.type = DYN_SHAPE_TYPE_BOX, s.material = material(friction);
  s.placement[9] = x, s.placement[11] = z;
  std::copy(size.begin(), size.end(), s.size);
  return s;
}

// Over the seam of two boxes, the second as high or lower, a box slides as on one plane: v^2 / (2 mu g).
TEST(ContinuousCollision, BoxSlidesOverFlushSeams) {
  const double mu = 0.3, way = 2 * 2 / (2 * mu * 9.81);
  for (const double lower : {0.0, 1e-6, 1e-4})
    for (const double dt : {1e-3, 1e-4}) {
      Scene scene;
      for (const dynShapeSpec& s : {box_at(-0.9, -0.05, {2, 2, 0.1}, mu), box_at(1.1, -0.05 - lower, {2, 2, 0.1}, mu)})
        ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
      scene.box("box", 1, {0.1, 0.1, 0.1}, material(mu));
      Simulation run(scene.finish(), dt);
      run.set({-0.1, 0, 0.05, 0, 0, 0, 1}, {2, 0, 0, 0, 0, 0});
      run.steps(int(0.75 / dt));
      EXPECT_NEAR(way - 0.1, run.q[0], 0.01 * way) << lower << " " << dt;
      EXPECT_NEAR(0.05 - lower, run.q[2], 1e-8) << lower << " " << dt;
    }
}

// A box on a floor of tiles is not lifted.
TEST(ContinuousCollision, BoxSlidesOverTiles) {
  const double mu = 0.3;
  Scene scene;
  for (int k = 0; k < 12; ++k) {
    const dynShapeSpec s = box_at(-0.5 + 0.2 * k, -0.05, {0.2, 2, 0.1}, mu);
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
  }
  scene.box("box", 1, {0.1, 0.1, 0.1}, material(mu));
  Simulation run(scene.finish());
  run.set({0, 0, 0.05, 0, 0, 0, 1}, {2, 0, 0, 0, 0, 0});
  for (int k = 0; k < 750; ++k) {
    run.steps(1);
    ASSERT_LT(run.q[2], 0.05 + 1e-6) << k;
  }
  EXPECT_NEAR(2 * 2 / (2 * mu * 9.81), run.q[0], 0.01);
}

// A ledge as high as a tenth of the box stops it.
TEST(ContinuousCollision, LedgeStopsBox) {
  Scene scene;
  for (const dynShapeSpec& s : {box_at(-0.9, -0.05, {2, 2, 0.1}, 0), box_at(1.1, -0.04, {2, 2, 0.1}, 0)})
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
  scene.box("box", 1, {0.1, 0.1, 0.1}, material(0));
  Simulation run(scene.finish());
  run.set({-0.1, 0, 0.05, 0, 0, 0, 1}, {0.3, 0, 0, 0, 0, 0});
  double farthest = -1;
  for (int k = 0; k < 700; ++k) run.steps(1), farthest = std::max(farthest, run.q[0]);
  EXPECT_NEAR(0.05, farthest, 2e-3);  // it tips a little
}

// 2 cm of clearance at 10 cm a step.
TEST(ContinuousCollision, BallFliesPastWithoutContact) {
  for (const auto& [speed, dt] : {std::pair{10.0, 1e-2}, {100.0, 1e-3}}) {
    Scene scene({0, 0, 0});
    const dynShapeSpec box = box_at(0, 0, {0.1, 0.1, 0.1}, 0.5);
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &box)) << dyn_last_error();
    Simulation run(scene.sphere("ball", 1, 0.05, material(0.5)).finish(), dt);
    run.set({-0.5, 0.12, 0, 0, 0, 0, 1}, {speed, 0, 0, 0, 0, 0});
    run.steps(10);
    EXPECT_EQ(Numbers({speed, 0, 0, 0, 0, 0}), Numbers(run.v, run.v + 6));
    run.set({-0.5, 0.02, 0, 0, 0, 0, 1}, {speed, 0, 0, 0, 0, 0});  // this one is hit
    run.steps(10);
    EXPECT_LT(run.v[0], 0.1 * speed);
  }
}

}  // namespace
}  // namespace dyn_test
