// Steps without a tolerance: a residual of 1e-4 within 100 iterations, impulses in their cones, heaps that come to rest.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// Boxes turned at random fall into a pit with rough walls.
struct Heap {
  Scene scene;
  std::vector<std::array<double, 3>> at;
  Heap(int layers, double friction) {
    const auto plane = [&](const double* placement) {
      dynShapeSpec s;
      dyn_shape_spec_init(&s);
      s.body = "universe", s.type = DYN_SHAPE_TYPE_HALF_SPACE, s.material = material(friction);
      std::copy_n(placement, 12, s.placement);
      EXPECT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
    };
    const double ground[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    plane(ground);
    for (const double side : {-1.0, 1.0}) {
      const double z = -side, across[12] = {0, z, 0, 0, 0, 1, z, 0, 0, 0.4 * side, 0, 0},
                   beside[12] = {0, 0, 1, z, 0, 0, 0, z, 0, 0, 0.4 * side, 0};
      plane(across), plane(beside);
    }
    for (int k = 0; k < 9 * layers; ++k) {
      scene.box(("box" + std::to_string(k)).c_str(), 1, {0.14, 0.14, 0.14}, material(friction));
      at.push_back({0.25 * (k % 3 - 1), 0.25 * (k / 3 % 3 - 1), 0.15 + 0.25 * (k / 9)});
    }
  }
};

Numbers turned(const std::vector<std::array<double, 3>>& at) {
  Numbers q;
  for (std::size_t k = 0; k < at.size(); ++k) {
    double u[4] = {std::sin(3.0 * double(k)), std::sin(5.0 * double(k)), std::sin(7.0 * double(k)),
                   std::sin(11.0 * double(k) + 1)};
    const double size = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3]);
    q.insert(q.end(), {at[k][0], at[k][1], at[k][2], u[0] / size, u[1] / size, u[2] / size, u[3] / size});
  }
  return q;
}

TEST(DefaultTolerance, HeapOfBoxesRestsWithBoundedIterations) {
  Heap heap(4, 0.6);
  Simulation play(heap.scene.finish(), 2e-3);
  play.set(turned(heap.at));
  double fastest = 0;
  int rows = 0;
  for (int k = 0; k < 2000; ++k) {
    play.steps(1);
    const dynStepReport r = play.report();
    rows = std::max(rows, r.rows);
    ASSERT_LE(r.iterations, 100 * r.islands) << k;
    for (const dynContactForce& f : play.contacts()) {
      const double n =
          f.force_on_b[0] * f.contact.normal[0] + f.force_on_b[1] * f.contact.normal[1] + f.force_on_b[2] * f.contact.normal[2];
      double across = 0;
      for (int i = 0; i < 3; ++i) across += std::pow(f.force_on_b[i] - n * f.contact.normal[i], 2);
      ASSERT_GE(n, -1e-9) << k;
      ASSERT_LE(std::sqrt(across), 0.6 * n + 1e-6) << k << ", n " << n;
    }

    if (k >= 1950) {
      EXPECT_LE(r.residual, 1e-4) << k;
      for (int i = 0; i < dyn_model_nv(play.m); ++i) fastest = std::max(fastest, std::abs(play.v[i]));
    }
  }
  EXPECT_GT(rows, 240);
  EXPECT_LT(fastest, 1e-3);  // at rest
}

// The forces of a resting stack hold its weight; the solve of a step ends at the default residual.
TEST(DefaultTolerance, ForcesOfAStackHoldItsWeight) {
  Scene scene;
  scene.ground();
  std::vector<std::array<double, 3>> at;
  for (int k = 0; k < 8; ++k)
    scene.box(("box" + std::to_string(k)).c_str(), 1, {0.2, 0.2, 0.2}, material(0.6)),
        at.push_back({0.003 * k, 0, 0.1 + 0.2 * k});
  Simulation play(scene.finish());
  play.place(at);
  play.steps(1000);
  double on_ground = 0;
  for (const dynContactForce& f : play.contacts())
    if (f.contact.shape_a == 0) on_ground += f.force_on_b[2];
  EXPECT_NEAR(8 * g, on_ground, 8 * g * 1e-3);
  EXPECT_LE(play.report().residual, 1e-4);
  for (int i = 0; i < dyn_model_nv(play.m); ++i) EXPECT_NEAR(0, play.v[i], 1e-5) << i;
}

// Bricks 1 mm apart are contact points, not rows.
TEST(DefaultTolerance, GapsThatCannotCloseAreNoRows) {
  Scene scene;
  scene.ground();
  std::vector<std::array<double, 3>> at;
  for (int k = 0; k < 3; ++k)
    scene.box(("box" + std::to_string(k)).c_str(), 1, {0.2, 0.2, 0.2}, material(0.6)), at.push_back({0.201 * k, 0, 0.1});
  Simulation play(scene.finish());
  play.place(at);
  play.steps(100);
  double across = 0;
  for (const dynContactForce& f : play.contacts())
    if (f.contact.shape_a != 0) across += std::abs(f.force_on_b[0]);
  EXPECT_EQ(0, across);
  EXPECT_LE(play.report().rows, 3 * 3 * 4);
}

TEST(DefaultTolerance, ZeroIsTheDefaultAndIsKept) {
  dynStepOptions options;
  dyn_step_options_init(&options);
  EXPECT_EQ(0, options.tolerance);
  EXPECT_EQ(0, options.max_iterations);
  Simulation play(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(1)).finish());
  options.struct_size = sizeof options;
  ASSERT_EQ(DYN_OK, dyn_data_step_options(play.m, play.d, &options));
  EXPECT_EQ(0, options.tolerance);
  options.max_iterations = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_step_options(play.m, play.d, &options));
}

}  // namespace
}  // namespace dyn_test
