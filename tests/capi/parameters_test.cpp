// Numbers of a builder: all are listed, each can be set alone, and what is refused changes nothing.
#include <cmath>
#include <cstring>
#include <map>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

template <class S>
S sized() {
  S out{};
  out.struct_size = sizeof out;
  return out;
}

std::vector<dynParameter> listed(dynBuilder* b) {
  std::vector<dynParameter> out(std::size_t(std::max(0, dyn_builder_parameter_count(b))));
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].struct_size = sizeof out[k];
    EXPECT_EQ(DYN_OK, dyn_builder_parameter(b, int(k), &out[k])) << dyn_last_error();
  }
  return out;
}

int find(dynBuilder* b, const char* object, const char* name, const char* quantity) {
  const auto all = listed(b);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!std::strcmp(all[k].object, object) && !std::strcmp(all[k].name, name) && !std::strcmp(all[k].quantity, quantity))
      return int(k);
  ADD_FAILURE() << object << " " << name << " " << quantity << " is not listed";
  return -1;
}

std::vector<unsigned char> image_of(dynBuilder* b) {
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  std::size_t size = 0;
  EXPECT_EQ(DYN_OK, dyn_model_image(m, 0, nullptr, 0, &size));
  std::vector<unsigned char> out(size);
  EXPECT_EQ(DYN_OK, dyn_model_image(m, 0, out.data(), size, &size)) << dyn_last_error();
  dyn_model_free(m);
  return out;
}

constexpr const char* scene = R"(<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
  <body name="cart" pos="0 0 1"><joint name="rail" type="slide" axis="1 0 0" damping="0.5" range="-1 1" limited="true"/>
    <geom type="box" size=".1 .1 .1"/><site name="hook" pos="0 .1 0"/>
    <body name="pole" pos="0 0 .2"><joint name="hinge" axis="0 1 0" armature="0.01" stiffness="2"/><geom name="rod" size=".05" mass="2"/></body>
  </body></worldbody><tendon><fixed name="cord"><joint joint="hinge" coef="2"/></fixed></tendon>
  <actuator><position name="servo" joint="rail" kp="10"/></actuator>
  <equality><weld name="held" body1="pole" body2="cart" active="false"/></equality></mujoco>)";

class ParametersTest : public ::testing::Test {
 protected:
  dynModel* m = nullptr;
  dynBuilder* b = nullptr;
  void SetUp() override {
    ASSERT_EQ(DYN_OK, dyn_model_load_string(scene, nullptr, &m)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_builder_from_model(m, &b));
  }
  void TearDown() override { dyn_builder_free(b), dyn_model_free(m); }
};

TEST_F(ParametersTest, EveryQuantitySetToItsOwnNumbersMakesTheSameModel) {
  const auto before = image_of(b);
  const auto all = listed(b);
  std::map<std::string, int> objects;
  for (std::size_t k = 0; k < all.size(); ++k) {
    ++objects[all[k].object];
    const std::vector<double> own(all[k].values, all[k].values + all[k].count);
    ASSERT_EQ(DYN_OK, dyn_builder_set_parameter(b, int(k), own.data(), own.size()))
        << all[k].object << " " << all[k].name << " " << all[k].quantity << ": " << dyn_last_error();
  }
  for (const char* object : {"model", "joint", "link", "frame", "shape", "tendon", "actuator", "constraint"})
    EXPECT_GT(objects[object], 0) << object;
  EXPECT_EQ(before, image_of(b));
}

TEST_F(ParametersTest, ANumberSetIsThatOfTheModel) {
  const double damping = 0.75, mass = 3, tilted[3] = {0, 1, 1}, place[6] = {0.1, 0.2, 0.3, 0, 0, 0.5}, kp = 20, friction = 0.25;
  const auto set = [&](const char* object, const char* name, const char* quantity, const double* x, std::size_t n) {
    ASSERT_EQ(DYN_OK, dyn_builder_set_parameter(b, find(b, object, name, quantity), x, n)) << dyn_last_error();
  };
  set("joint", "rail", "damping", &damping, 1), set("link", "pole", "mass", &mass, 1), set("joint", "hinge", "axis", tilted, 3);
  set("joint", "hinge", "placement", place, 6), set("actuator", "servo", "kp", &kp, 1);
  set("shape", "floor", "friction", &friction, 1);
  dynModel* made = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &made)) << dyn_last_error();
  EXPECT_EQ(0.75, dyn_model_array(made, DYN_MODEL_ARRAY_DAMPING)[0]);
  EXPECT_NEAR(dyn_model_total_mass(m) + 1, dyn_model_total_mass(made), 1e-12);
  dynJointInfo joint = sized<dynJointInfo>();
  ASSERT_EQ(DYN_OK, dyn_model_joint_info(made, dyn_model_joint_id(made, "hinge"), &joint));
  EXPECT_NEAR(joint.axis[1], joint.axis[2], 1e-15);
  EXPECT_NEAR(0.1, joint.placement[9], 1e-15);
  EXPECT_NEAR(0.3, joint.placement[11], 1e-15);
  EXPECT_NEAR(std::cos(0.5), joint.placement[0], 1e-15);
  EXPECT_NEAR(std::sin(0.5), joint.placement[1], 1e-15);
  dynActuator servo = sized<dynActuator>();
  ASSERT_EQ(DYN_OK, dyn_model_actuator_info(made, 0, &servo));
  EXPECT_EQ(20, servo.kp);
  dyn_model_free(made);
}

TEST_F(ParametersTest, RefusedNumbersChangeNothing) {
  const auto before = image_of(b);
  const double negative = -1, two[2] = {1, 2}, nan = NAN, zero[3] = {}, inf = HUGE_VAL;
  const auto refused = [&](const char* object, const char* name, const char* quantity, const double* x, std::size_t n,
                           dynStatus status, const std::vector<std::string>& words) {
    EXPECT_EQ(status, dyn_builder_set_parameter(b, find(b, object, name, quantity), x, n)) << quantity;
    EXPECT_TRUE(says(words));
  };
  refused("joint", "rail", "damping", &negative, 1, DYN_ERROR_INVALID, {"rail", "damping"});
  refused("joint", "rail", "damping", two, 2, DYN_ERROR_SIZE, {"rail", "damping has 1 numbers, and 2"});
  refused("joint", "rail", "damping", &nan, 1, DYN_ERROR_NONFINITE, {"rail", "damping is NaN"});
  refused("joint", "hinge", "axis", zero, 3, DYN_ERROR_INVALID, {"hinge", "axis is zero"});
  refused("link", "pole", "mass", &negative, 1, DYN_ERROR_INVALID, {"pole", "mass"});
  refused("model", "", "density", &negative, 1, DYN_ERROR_INVALID, {"density"});
  refused("actuator", "servo", "kp", &negative, 1, DYN_ERROR_INVALID, {"servo", "kp"});
  refused("shape", "floor", "friction", &negative, 1, DYN_ERROR_INVALID, {"friction"});
  refused("shape", "rod", "size", &negative, 1, DYN_ERROR_INVALID, {"size"});
  refused("tendon", "cord", "damping", &negative, 1, DYN_ERROR_INVALID, {"cord", "damping"});
  refused("constraint", "held", "stiffness", &negative, 1, DYN_ERROR_ARGUMENT, {"held"});
  refused("frame", "hook", "placement", std::vector<double>(6, inf).data(), 6, DYN_ERROR_NONFINITE, {"hook", "placement"});
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_parameter(b, -1, two, 2));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_parameter(b, dyn_builder_parameter_count(b), two, 2));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_parameter(b, 0, nullptr, 3));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_parameter(b, -1, nullptr));
  dynParameter p = sized<dynParameter>();
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_parameter(b, -1, &p));
  EXPECT_EQ(before, image_of(b));
}

TEST_F(ParametersTest, TheListFollowsWhatIsAdded) {
  const int before = dyn_builder_parameter_count(b);
  const double com[3] = {};
  ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, "extra", "hinge", nullptr, 1, com, some_inertia));
  EXPECT_EQ(before + 5, dyn_builder_parameter_count(b));
  find(b, "link", "extra", "gravity_compensation");
}

}  // namespace
}  // namespace dyn_test
