// Mocap bodies: what is fixed to the world and placed by the caller.
#include "scene.hpp"

namespace dyn_test {

namespace {

using X12 = std::array<double, 12>;
X12 at(double x, double y, double z) { return {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z}; }

// A box of 1 kg on a plate, whose upper side is at z = 0.05 in its frame.
Model plate_and_box() {
  Scene s;
  const double none[9] = {};
  EXPECT_EQ(DYN_OK, dyn_builder_add_body(s, "plate", "universe", at(0, 0, 1).data(), 0, none, none)) << dyn_last_error();
  EXPECT_EQ(DYN_OK, dyn_builder_set_mocap(s, "plate")) << dyn_last_error();
  s.shape("plate", DYN_SHAPE_TYPE_BOX, {1, 1, 0.1}, material(0.5)).box("box", 1, {0.2, 0.2, 0.2}, material(0.5));
  return s.finish();
}

void place(Simulation& run, const X12& X) {
  ASSERT_EQ(DYN_OK, dyn_data_set_mocap(run.m, run.d, 0, X.data())) << dyn_last_error();
}

}  // namespace

TEST(Mocap, ABoxGoesDownWithItsPlate) {
  Simulation run(plate_and_box());
  run.place({{0, 0, 1.15}});
  for (int k = 1; k <= 500; ++k) place(run, at(0, 0, 1 - 4e-4 * k)), run.steps(1);
  EXPECT_NEAR(0.95, run.q[2], 2e-3);  // a step of the plate is 4e-4 m
  run.steps(500);
  EXPECT_NEAR(0.95, run.q[2], 1e-5);
  X12 X;
  ASSERT_EQ(DYN_OK, dyn_data_mocap(run.m, run.d, 0, X.data()));
  EXPECT_EQ(at(0, 0, 1 - 4e-4 * 500), X);
  ASSERT_EQ(DYN_OK, dyn_data_reset(run.m, run.d, nullptr));
  ASSERT_EQ(DYN_OK, dyn_data_mocap(run.m, run.d, 0, X.data()));
  EXPECT_EQ(at(0, 0, 1), X);
}

TEST(Mocap, BadInput) {
  Scene s;
  s.sphere("ball", 1, 0.1, material(0));
  EXPECT_EQ(DYN_ERROR_NAME, dyn_builder_set_mocap(s, "nobody"));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_mocap(s, "ball"));
  EXPECT_TRUE(says({"ball", "ball_joint", "fixed to the world"}));

  Simulation run(plate_and_box());
  EXPECT_EQ(1, dyn_model_nmocaps(run.m));
  EXPECT_EQ(0, dyn_model_mocap_id(run.m, "plate"));
  EXPECT_EQ(dyn_model_frame_id(run.m, "plate"), dyn_model_mocap_frame(run.m, 0));
  EXPECT_EQ(-1, dyn_model_mocap_id(run.m, "box"));
  EXPECT_EQ(-1, dyn_model_mocap_frame(run.m, 1));
  X12 X = at(0, 0, NAN);
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_data_set_mocap(run.m, run.d, 0, X.data()));
  X = at(0, 0, 0), X[0] = 2;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_mocap(run.m, run.d, 0, X.data()));
  EXPECT_TRUE(says({"plate", "rotation"}));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_mocap(run.m, run.d, 1, at(0, 0, 0).data()));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_mocap(run.m, run.d, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_mocap(run.m, run.d, 0, nullptr));
}

}  // namespace dyn_test
