// Error bars (dyn_data_error_bar) of states that are set, so that their difference is known.
#include <gtest/gtest.h>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

// Of a hinge at (q, v) with dt 1 ms, by one at (q + by, v - by) with half of it.
dynErrorBar hinge_bar(double q, double v, double by) {
  dynModel* loaded = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string("<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>", nullptr,
                                          &loaded));
  const Model m(loaded);
  dynData* runs[2] = {};
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(DYN_OK, dyn_data_new(m, 0, &runs[k]));
    dynStepOptions options;
    dyn_step_options_init(&options);
    options.dt = k ? 5e-4 : 1e-3;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, runs[k], &options)) << dyn_last_error();
    const double at = k ? q + by : q, speed = k ? v - by : v;
    EXPECT_EQ(DYN_OK, dyn_data_set_state(m, runs[k], &at, &speed, nullptr, nullptr)) << dyn_last_error();
  }
  dynErrorBar bar{};
  bar.struct_size = sizeof bar;
  EXPECT_EQ(DYN_OK, dyn_data_error_bar(m, runs[0], runs[1], &bar)) << dyn_last_error();
  for (dynData* const run : runs) dyn_data_free(run);
  return bar;
}

// 4 / (1 - 1/2) times the difference.
TEST(ErrorBar, IsEightDifferencesToHalfTheStep) {
  const dynErrorBar bar = hinge_bar(0, 0, 1e-3);
  EXPECT_NEAR(8e-3, bar.q, 1e-15);
  EXPECT_NEAR(8e-3, bar.v, 1e-15);
}

// Beyond a bar of 0.1 rad.
TEST(ErrorBar, IsLostFromATenthOfARadian) {
  EXPECT_EQ(0, hinge_bar(0, 0, 0.0124).lost);
  EXPECT_EQ(1, hinge_bar(0, 0, 0.0126).lost);
}

// 1e-12 of the state, and of 1 at least, where runs agree.
TEST(ErrorBar, IsRoundingWhereRunsAgree) {
  const dynErrorBar bar = hinge_bar(3, -5, 0);
  EXPECT_NEAR(3e-12, bar.q, 1e-24);
  EXPECT_NEAR(5e-12, bar.v, 1e-24);
  EXPECT_NEAR(1e-12, hinge_bar(0.5, 0, 0).q, 1e-24);
}

}  // namespace
}  // namespace dyn_test
