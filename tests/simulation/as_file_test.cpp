// Rows as an MJCF file states them, where MuJoCo bounds the file's numbers.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// A slider of 2 kg along x, its origin at 0, in a file that says more of its joint and its sphere.
Model slider(const std::string& joint, const std::string& sphere, const std::string& more = "") {
  const std::string text = "<mujoco><option gravity='0 0 0'/><worldbody>" + more + "<body><joint type='slide' axis='1 0 0' " + joint +
                           "/><geom type='sphere' size='0.1' mass='2' " + sphere + "/></body></worldbody></mujoco>";
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}

// The velocity after a step of 1 ms from `by` beyond the limit or the surface at 0, at the velocity v.
double after_a_step(Model model, double by, double v) {
  Simulation run(std::move(model));
  run.options.contact_model = DYN_CONTACT_MODEL_AS_FILE;
  EXPECT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options)) << dyn_last_error();
  run.set({by}, {v});
  run.steps(1);
  return run.v[0];
}

// MuJoCo's documentation, "Solver parameters": a + R f = -b v - k d r with R = (1 - d) / d W. Here W = 1 / mass, so that the share
// d of the reference acceleration acts.
double pushed_back(double by, double v, double d, double k, double b) { return v + 1e-3 * d * (-b * v - k * d * by); }

// 0.0001 <= d <= 0.9999. Near the limit d(r) is the first number, while k and b are scaled by the second.
TEST(AsFile, ImpedanceHasTwoBounds) {
  const double by = 1e-3, v = 0.01, high = 0.5, near = 2 * by * by;  // width 1 m, midpoint 0.5, power 2
  for (const auto& [first, bound] : {std::pair("0", 1e-4), std::pair("1", 0.9999)}) {
    const std::string joint = std::string("range='-1 0' solreflimit='-10 -20' solimplimit='") + first + " 0.5 1 0.5 2'";
    const double d = bound + near * (high - bound), expected = pushed_back(by, v, d, 10 / (high * high), 20 / high);
    EXPECT_NEAR(expected, after_a_step(slider(joint, ""), by, v), 1e-11 * std::abs(expected - v)) << first;
  }
}

// Time constant and damping ratio whose product squared is less than 1e-15 count as that: k = 1e15 / s^2.
TEST(AsFile, StiffnessHasABound) {
  const double by = 1e-12, d = 0.9;
  const double expected = pushed_back(by, 0, d, 1e15, 2 / (d * 0.02));
  EXPECT_NEAR(expected, after_a_step(slider("range='-1 0' solreflimit='0.02 1e-7' solimplimit='0.9 0.9 0.001'", ""), by, 0),
              1e-4 * std::abs(expected));  // of the error, which is the rounding of the range's end over 1e-12
}

// Two shapes share by their weights, which count down to 1e-15.
TEST(AsFile, SmallWeightsMix) {
  const double by = 1e-3, d = 0.9, v = 0.01;
  const auto run = [&](const char* wall, const char* ball) {
    const std::string same = "condim='1' solimp='0.9 0.9 0.001' ";
    return after_a_step(slider("", same + "solref='0.03 1' solmix='" + ball + "'",
                               "<geom type='plane' size='1 1 1' pos='0.1 0 0' zaxis='-1 0 0' " + same + "solref='0.01 1' solmix='" + wall + "'/>"),
                        by, v);
  };
  const auto expected = [&](double time) { return pushed_back(by, v, d, 1 / (d * d * time * time), 2 / (d * time)); };
  EXPECT_NEAR(expected(0.025), run("3e-15", "9e-15"), 1e-10);
  EXPECT_NEAR(expected(0.02), run("3e-16", "9e-16"), 1e-10);  // as if both were zero
  EXPECT_NEAR(expected(0.03), run("3e-16", "9e-15"), 1e-10);
}

}  // namespace
}  // namespace dyn_test
