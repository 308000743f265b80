// Error-controlled steps with impacts: long calls behave as short ones; nothing passes through, sinks in or gains energy.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

void ask(Simulation& run, double accuracy) {
  run.options.accuracy = accuracy;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options)) << dyn_last_error();
}
void advance(Simulation& run, double duration) { ASSERT_EQ(DYN_OK, dyn_advance(run.m, run.d, duration)) << dyn_last_error(); }

// Two elastic balls without friction: the hit ball leaves along the line of centres, the other across it.
TEST(FreeFlight, ElasticBallsExchangeVelocities) {
  const double r = 0.0286, I = 0.4 * 0.17 * r * r;
  for (const double accuracy : {1e-2, 1e-6})
    for (int k = 0; k < 50; ++k) {
      const double beside = k == 0 ? r : 1.8 * r, speed = k == 0 ? 2 : 8;
      Scene scene({0, 0, 0});
      for (const char* name : {"a", "b"})
        scene.free(name, 0.17, {I, I, I}).shape(name, DYN_SHAPE_TYPE_SPHERE, {r, 0, 0}, material(0, 1));
      Simulation run(scene.finish());
      ask(run, accuracy);
      run.set({-0.2 - 0.016 * k / 50, -beside, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1}, {speed, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
      advance(run, 0.4 / speed);
      const double y = beside / (2 * r), x = std::sqrt(1 - y * y);
      EXPECT_NEAR(speed * x * x, run.v[6], 10 * accuracy * speed) << accuracy << " " << k;
      EXPECT_NEAR(speed * x * y, run.v[7], 10 * accuracy * speed) << accuracy << " " << k;
    }
}

// A pebble, an egg, a coin and a rod tumble down.
TEST(FreeFlight, TumblingBodiesNeitherSinkNorGainEnergy) {
  const struct {
    dynShapeType type;
    std::array<double, 3> size, inertia;
  } pieces[] = {{DYN_SHAPE_TYPE_ELLIPSOID, {0.003, 0.01, 0.02}, {1e-6, 8.18e-7, 2.18e-7}},
                {DYN_SHAPE_TYPE_ELLIPSOID, {0.05, 0.05, 0.1}, {2.5e-5, 2.5e-5, 1e-5}},
                {DYN_SHAPE_TYPE_CYLINDER, {0.012, 0.002, 0}, {4e-7, 4e-7, 7e-7}},
                {DYN_SHAPE_TYPE_CAPSULE, {0.004, 0.06, 0}, {3e-6, 3e-6, 8e-8}}};
  const double accuracy = 1e-3;
  Random random{7};
  for (const auto& piece : pieces)
    for (int k = 0; k < 8; ++k) {
      Simulation run(
          Scene().ground().free("body", 0.01, piece.inertia).shape("body", piece.type, piece.size, material(0.5)).finish());
      ask(run, accuracy);
      Numbers q = {0, 0, 0.3}, v;
      for (int i = 0; i < 4; ++i) q.push_back(random.uniform(-1, 1));
      for (int i = 0; i < 6; ++i) v.push_back(random.uniform(-1, 1) * (i < 3 ? 1 : 20));
      run.set(q, v);
      const double before = run.energy();
      for (int piecewise = 0; piecewise < (k % 2 ? 3 : 1); ++piecewise) advance(run, k % 2 ? 0.33 : 1);
      EXPECT_LT(run.energy(), before) << int(piece.type) << " " << k;
      double distance = 0;
      ASSERT_EQ(DYN_OK, dyn_distances(run.m, run.d, nullptr, &distance)) << dyn_last_error();
      EXPECT_GT(distance, -2 * accuracy) << int(piece.type) << " " << k;
    }
}

// Deep initial overlap is pushed out, with no more energy than the weight over that depth.
TEST(FreeFlight, InitialOverlapIsPushedOut) {
  const struct {
    dynShapeType type;
    std::array<double, 3> size;
    double z;
  } pieces[] = {{DYN_SHAPE_TYPE_ELLIPSOID, {0.05, 0.05, 0.08}, -0.05},
                {DYN_SHAPE_TYPE_CAPSULE, {0.03, 0.1, 0}, -0.2},
                {DYN_SHAPE_TYPE_BOX, {0.1, 0.1, 0.1}, -0.03}};
  for (const auto& piece : pieces) {
    Simulation run(
        Scene().ground().free("body", 1, {3e-3, 3e-3, 3e-3}).shape("body", piece.type, piece.size, material(0)).finish());
    ask(run, 1e-4);
    run.set({0, 0, piece.z, 0.15, 0, 0, 0.99});
    advance(run, 0.1);
    EXPECT_LT(run.q[2], 0.2) << int(piece.type);
    EXPECT_GT(run.q[2], piece.z + 0.05) << int(piece.type);
    EXPECT_LT(run.energy(), 9.81 * 0.2) << int(piece.type);
  }
}

// A saved state continues in data that met other contacts before.
TEST(FreeFlight, RestoredStateReproducesTheBits) {
  const auto model = [] {
    return Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.5, 0.2)).sphere("b", 1, 0.1, material(0.5, 0.5)).finish();
  };
  Simulation one(model());
  ask(one, 1e-4);
  dynData* other = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(one.m, DYN_PART_SIMULATION, &other));
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(one.m, other, &one.options));
  dynArray q{};
  q.struct_size = sizeof q;
  ASSERT_EQ(DYN_OK, dyn_data_array(one.m, other, dyn_field_id("q"), &q));
  std::vector<unsigned char> kept(dyn_model_state_size(one.m));
  for (int k = 0; k < 40; ++k) {
    one.set({0, 0, 0.15 + 0.004 * k, 0.1, 0.2, 0.3, 1, 0.15, 0.05, 0.4 + 0.01 * k, 0, 0, 0, 1},
            {0.1 * k, 0, -1, 1, 2, 0.1 * k, 0, 0, -3, 0, 5, 0});
    advance(one, 0.02);
    ASSERT_EQ(DYN_OK, dyn_data_save_state(one.m, one.d, kept.data(), kept.size()));
    advance(one, 0.05);
    ASSERT_EQ(DYN_OK, dyn_data_restore_state(one.m, other, kept.data(), kept.size())) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_advance(one.m, other, 0.05)) << dyn_last_error();
    EXPECT_TRUE(std::equal(one.q, one.q + 14, q.data)) << k;
  }
  dyn_data_free(other);
}

}  // namespace
}  // namespace dyn_test
