// Common mistakes with bases, quaternions, and motion on the manifold.
#include "traps/traps.hpp"

namespace dyn_test {
namespace {

TEST(Traps, MissingBaseIsRefused) {
  dynModel* m = nullptr;
  const std::string path = std::string(DYN_MODELS_DIR) + "/robots/go2.urdf";
  EXPECT_EQ(DYN_ERROR_BASE, dyn_model_load(path.c_str(), nullptr, &m));
  EXPECT_TRUE(says({"go2.urdf:", "root link 'base' has mass", "base fixed or base floating"}));
  EXPECT_EQ(nullptr, m);
  const Model fixed = robot("go2", DYN_BASE_FIXED), floating = robot("go2", DYN_BASE_FLOATING);
  EXPECT_EQ(12, fixed.nq());
  EXPECT_TRUE(floating.nq() == 19 && floating.nv() == 18);
  EXPECT_EQ(DYN_JOINT_TYPE_FREE_FLYER, joint_info(floating, 1).type);
}

// A quaternion whose norm is not 1 is the same rotation. A zero quaternion is an error.
TEST(Traps, UnnormalisedQuaternionIsTheSameRotation) {
  const Model m = robot("go2", DYN_BASE_FLOATING);
  const State s = random_state(m, 9);
  Data unit(m);
  compute_all(m, unit, s);
  for (double scale : {0.5, 1 + 1e-4, 3.0, 1e-150, 1e150}) {
    State t = s;
    for (std::size_t k = 3; k < 7; ++k) t.q[k] *= scale;
    Data d(m);
    compute_all(m, d, t);
    for (const char* name : {"placements", "M", "tau", "nle", "ddq", "com", "Jcom", "kinetic"})
      expect_near(field(m, unit, name), field(m, d, name), 1e-11, name);
  }
  State t = s;
  std::fill_n(t.q.begin() + 3, 4, 0.0);
  Data d(m);
  for (const CallRow& row : call_rows) {
    if (!(row.uses & uses_q)) continue;
    Prepared p(row, m, t);
    EXPECT_EQ(DYN_ERROR_QUATERNION, p(m, d)) << row.name;
    EXPECT_TRUE(says({row.name, "quaternion of joint 'root_joint'", "zero"}));
    EXPECT_TRUE(p.untouched());
    p.s.q[4] = nan;
    EXPECT_EQ(DYN_ERROR_NONFINITE, p(m, d)) << row.name;
    EXPECT_TRUE(says({"q[4] is NaN"}));
  }
}

// dyn_integrate and dyn_difference invert each other and stay on the manifold; plain addition does not.
TEST(Traps, IntegrationStaysOnTheManifold) {
  for (const Model& m : models()) {
    const State s = random_state(m, 10);
    Numbers q1(s.q.size()), v(s.v.size());
    ASSERT_EQ(DYN_OK, dyn_integrate(m, s.q.data(), s.v.data(), q1.data()));
    int normalized = 0;
    ASSERT_EQ(DYN_OK, dyn_configuration_is_normalized(m, q1.data(), 1e-14, &normalized));
    EXPECT_EQ(1, normalized);
    ASSERT_EQ(DYN_OK, dyn_difference(m, s.q.data(), q1.data(), v.data()));
    expect_near(s.v, v, 1e-12, "difference of integrate");
    // steps use the same integration
    Data d(m);
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, s.q.data(), s.v.data(), nullptr, nullptr));
    for (int k = 0; k < 100; ++k)
      ASSERT_EQ(DYN_OK, take_step(m, d, k % 2 ? DYN_INTEGRATOR_RK4 : DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1e-5))
          << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_configuration_is_normalized(m, field(m, d, "q").data(), 1e-14, &normalized));
    EXPECT_EQ(1, normalized);
  }
}

}  // namespace
}  // namespace dyn_test
