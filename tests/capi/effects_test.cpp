// Effects of joints through the C interface: what is on, what a switch makes stale, what is refused.
#include "capi/support.hpp"

namespace dyn_test {
namespace {

// Two hinges; the first one has all effects, the second damping, and a third follows the first.
Model arm() {
  Builder b("arm");
  const double one = 1, two = 2, three = 3, four = 4, half = 0.5, low = -3, high = 3;
  Spec shoulder("shoulder", DYN_JOINT_TYPE_REVOLUTE), elbow("elbow", DYN_JOINT_TYPE_REVOLUTE, "shoulder", {0, 0, 1}),
      finger("finger", DYN_JOINT_TYPE_PRISMATIC, "elbow");
  shoulder.about(0, 1, 0), elbow.about(0, 1, 0);
  shoulder.armature = &one, shoulder.damping = &two, shoulder.friction = &three, shoulder.stiffness = &four,
  shoulder.spring_reference = &half;
  shoulder.lower = &low, shoulder.upper = &high;
  elbow.damping = &four;
  finger.mimic = "shoulder";
  b.joint(shoulder).body("upper", "shoulder").joint(elbow).body("lower", "elbow").joint(finger).body("tip", "finger");
  return b.finish();
}

struct Effects : testing::Test {
  Model m = arm();
  Data d{m};
  const double q[2] = {0.3, -0.2}, v[2] = {0.7, 2}, a[2] = {1.5, -1};
  std::array<double, 2> rnea() {
    std::array<double, 2> tau{};
    EXPECT_EQ(DYN_OK, dyn_rnea(m, d, q, v, a, nullptr, tau.data())) << dyn_last_error();
    return tau;
  }
  std::uint32_t on(int joint) {
    std::uint32_t effects = 99;
    EXPECT_EQ(DYN_OK, dyn_data_effects(m, d, joint, &effects));
    return effects;
  }
  void set(int joint, std::uint32_t effects) {
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(m, d, joint, effects)) << dyn_last_error();
  }
};

TEST_F(Effects, NewDataHasTheDefault) {
  const std::uint32_t of_joints =
      DYN_EFFECT_ARMATURE | DYN_EFFECT_DAMPING | DYN_EFFECT_SPRINGS | DYN_EFFECT_FRICTION | DYN_EFFECT_LIMITS;
  EXPECT_EQ(std::uint32_t(DYN_EFFECT_DEFAULT), on(1));
  EXPECT_EQ(std::uint32_t(DYN_EFFECT_DEFAULT), on(2));
  EXPECT_EQ(of_joints, on(0));  // in steps
  set(0, DYN_EFFECT_ALL);
  EXPECT_EQ(of_joints, on(0));  // there are no actuators
  set(1, 0);
  EXPECT_EQ(0u, on(1));
  EXPECT_EQ(std::uint32_t(DYN_EFFECT_ALL), on(2));
  EXPECT_EQ(std::uint32_t(DYN_EFFECT_DAMPING), on(0));  // the elbow has nothing else
}

TEST_F(Effects, EachAddsItsTerm) {
  set(0, 0);
  const auto bare = rnea();
  const struct {
    std::uint32_t effect;
    double first, second;
  } rows[] = {{DYN_EFFECT_ARMATURE, 1 * a[0], 0},
              {DYN_EFFECT_DAMPING, 2 * v[0], 4 * v[1]},
              {DYN_EFFECT_FRICTION, 3 * std::tanh(v[0] / DYN_FRICTION_VELOCITY), 0},
              {DYN_EFFECT_SPRINGS, 4 * (q[0] - 0.5), 0}};
  for (const auto& r : rows) {
    set(0, r.effect);
    const auto tau = rnea();
    EXPECT_NEAR(bare[0] + r.first, tau[0], 1e-13);
    EXPECT_NEAR(bare[1] + r.second, tau[1], 1e-13);
    set(2, 0);
    EXPECT_NEAR(bare[1], rnea()[1], 1e-13);
  }
}

TEST_F(Effects, SwitchMakesResultsStale) {
  rnea();
  ASSERT_EQ(DYN_OK, dyn_crba(m, d, nullptr, nullptr));
  dynArray array{};
  array.struct_size = sizeof array;
  ASSERT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("tau"), &array));
  set(2, DYN_EFFECT_ALL);
  EXPECT_EQ(DYN_ERROR_STALE, dyn_data_array(m, d, dyn_field_id("tau"), &array));
  EXPECT_EQ(DYN_ERROR_STALE, dyn_data_array(m, d, dyn_field_id("M"), &array));
  EXPECT_EQ(DYN_ERROR_STALE, dyn_cholesky(m, d));
  EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("q"), &array));
}

TEST_F(Effects, BadArgumentsChangeNothing) {
  set(0, DYN_EFFECT_ALL);
  const auto before = rnea();
  std::uint32_t effects = 7;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_effects(m, d, 0, 1u << 30));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "0x40000000"));
  for (const int joint : {-1, 4}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_effects(m, d, joint, 0));
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_effects(m, d, joint, &effects));
  }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_effects(m, d, dyn_model_joint_id(m, "finger"), 0));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "'finger' mimics 'shoulder'"));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_effects(m, d, 1, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_set_effects(nullptr, d, 0, 0));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_set_effects(m, nullptr, 0, 0));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_effects(m, nullptr, 0, &effects));
  EXPECT_EQ(7u, effects);
  EXPECT_EQ(before, rnea());
}

TEST_F(Effects, OfABatch) {
  dynBatch* batch = nullptr;
  ASSERT_EQ(DYN_OK, dyn_batch_new(m, 0, 2, &batch));
  set(0, DYN_EFFECT_ALL);
  const auto expected = rnea();
  double tau[2];
  dynBatchArrays arrays;
  dyn_batch_arrays_init(&arrays);
  arrays.q = q, arrays.v = v, arrays.a = a, arrays.out[0] = tau;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_batch_set_effects(batch, 9, 0));
  ASSERT_EQ(DYN_OK, dyn_batch_set_effects(batch, 0, DYN_EFFECT_ALL));
  ASSERT_EQ(DYN_OK, dyn_batch_run(batch, DYN_ALGORITHM_RNEA, 1, &arrays));
  EXPECT_EQ(expected[0], tau[0]);
  EXPECT_EQ(expected[1], tau[1]);
  dyn_batch_free(batch);
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_batch_set_effects(batch, 0, 0));
}

TEST_F(Effects, SpringsThatCannotBe) {
  const struct {
    dynJointType type;
    std::vector<double> stiffness, reference;
    dynStatus status;
    const char* says;
  } rows[] = {{DYN_JOINT_TYPE_REVOLUTE, {-1}, {}, DYN_ERROR_INVALID, "stiffness"},
              {DYN_JOINT_TYPE_REVOLUTE, {inf}, {}, DYN_ERROR_NONFINITE, "stiffness"},
              {DYN_JOINT_TYPE_REVOLUTE, {1}, {nan}, DYN_ERROR_NONFINITE, "spring reference"},
              {DYN_JOINT_TYPE_SPHERICAL, {1, 1, 2}, {}, DYN_ERROR_INVALID, "same three times"},
              {DYN_JOINT_TYPE_SPHERICAL, {1, 1, 1}, {0, 0, 0, 0}, DYN_ERROR_QUATERNION, "spring reference"},
              {DYN_JOINT_TYPE_FREE_FLYER, {1, 0, 0, 0, 0, 0}, {}, DYN_ERROR_INVALID, "free flyer"}};
  for (const auto& r : rows) {
    Builder b("robot");
    Spec s("joint", r.type);
    s.stiffness = r.stiffness.data(), s.spring_reference = r.reference.empty() ? nullptr : r.reference.data();
    EXPECT_EQ(r.status, dyn_builder_add_joint(b, &s));
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), r.says)) << dyn_last_error();
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "'joint'")) << dyn_last_error();
  }
}

}  // namespace
}  // namespace dyn_test
