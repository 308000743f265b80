// Tests what the builder refuses, that a refused call adds nothing, and that a builder stays usable.
#include "common/every.hpp"
#include "capi/support.hpp"

namespace dyn_test {
namespace {

constexpr double com0[3] = {};

class BuilderTest : public ::testing::Test {
 protected:
  Builder b;

  void SetUp() override { b.joint(Spec("base", DYN_JOINT_TYPE_REVOLUTE)).body("link", "base"); }
  // Whatever the test tried, the model is still the one of SetUp.
  void TearDown() override {
    const Model m = b.finish();
    EXPECT_EQ(2, m.njoints());
    EXPECT_EQ(3, m.nframes());
    EXPECT_EQ(1, m.nv());
    EXPECT_EQ(1.0, dyn_model_total_mass(m));
  }
  void refuse(const dynJointSpec& s, dynStatus status, const std::vector<std::string>& fragments) {
    EXPECT_EQ(status, dyn_builder_add_joint(b, &s)) << (fragments.empty() ? "" : fragments.back());
    EXPECT_TRUE(says(fragments));
  }
  void refuse(dynStatus status, dynStatus s, const std::vector<std::string>& fragments) {
    EXPECT_EQ(status, s);
    EXPECT_TRUE(says(fragments));
  }
};

TEST_F(BuilderTest, Pointers) {
  dyn_joint_spec_init(nullptr);
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_new("b", nullptr), {"dyn_builder_new", "builder is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_joint(b, nullptr), {"dyn_builder_add_joint", "spec is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_set_gravity(b, nullptr), {"gravity is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_body(b, "x", "base", nullptr, 1, nullptr, some_inertia), {"com is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_body(b, "x", "base", nullptr, 1, com0, nullptr), {"inertia is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_configuration(b, "c", nullptr, 1), {"q is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_finish(b, nullptr), {"dyn_builder_finish", "model is NULL"});
}

// What the operations do: tests/model/operations_test.cpp.
TEST_F(BuilderTest, Operations) {
  const Model m = b.finish();
  const double q[1] = {};
  const char *base = "base", *none = nullptr;
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_from_model(m, nullptr), {"dyn_builder_from_model", "builder is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_lock(b, nullptr, 1, q, 1), {"dyn_builder_lock", "joints is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_lock(b, &none, 1, q, 1), {"joints[0] is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_lock(b, &base, 1, nullptr, 1), {"q is NULL"});
  refuse(DYN_ERROR_SIZE, dyn_builder_lock(b, &base, 1, q, 0), {"q has 0 numbers", "nq = 1"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_keep_subtree(b, nullptr), {"dyn_builder_keep_subtree", "joint is NULL"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_remove_subtree(b, nullptr), {"dyn_builder_remove_subtree", "joint is NULL"});
  refuse(DYN_ERROR_NAME, dyn_builder_remove_subtree(b, "link"), {"no moving joint 'link'"});
  refuse(DYN_ERROR_NAME, dyn_builder_attach(b, m, nullptr, nullptr), {"its joint and the joint of", "'base'", "give a prefix"});
  Spec wrong("seat", DYN_JOINT_TYPE_FIXED);
  wrong.struct_size = 8;
  refuse(DYN_ERROR_SIZE, dyn_builder_attach(b, m, "x_", &wrong), {"struct_size is 8"});
  EXPECT_EQ(DYN_OK, dyn_builder_lock(b, nullptr, 0, q, 1));

  dynBuilder* two = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_from_model(m, &two));
  const Spec rail("rail", DYN_JOINT_TYPE_PRISMATIC, "link");
  ASSERT_EQ(DYN_OK, dyn_builder_attach(two, m, "x_", &rail)) << dyn_last_error();
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_finish(two, &raw)) << dyn_last_error();
  const Model pair(raw);
  EXPECT_EQ(3, pair.nv());
  EXPECT_STREQ("x_base", dyn_model_joint_name(pair, 3));
  dyn_builder_free(two);
}

TEST_F(BuilderTest, Sizes) {
  for (std::uint32_t size : {0u, 8u, std::uint32_t(sizeof(dynJointSpec)) - 1}) {
    Spec s("j", DYN_JOINT_TYPE_REVOLUTE);
    s.struct_size = size;
    refuse(s, DYN_ERROR_SIZE, {"struct_size is " + std::to_string(size), "dyn_joint_spec_init"});
  }
}

TEST_F(BuilderTest, Names) {
  refuse(Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE), DYN_ERROR_ARGUMENT, {"joint has no name", "give one"});
  refuse(Spec("", DYN_JOINT_TYPE_REVOLUTE), DYN_ERROR_ARGUMENT, {"joint has no name"});
  refuse(Spec("base", DYN_JOINT_TYPE_REVOLUTE), DYN_ERROR_NAME, {"joint 'base'", "taken", "choose another"});
  refuse(Spec("base", DYN_JOINT_TYPE_FIXED), DYN_ERROR_NAME, {"joint 'base'", "taken"});
  refuse(Spec("universe", DYN_JOINT_TYPE_REVOLUTE), DYN_ERROR_NAME, {"universe", "choose another"});
  refuse(Spec("j", DYN_JOINT_TYPE_REVOLUTE, "nobody"), DYN_ERROR_NAME, {"joint 'j'", "no parent 'nobody'", "add it first"});
  refuse(DYN_ERROR_NAME, dyn_builder_add_body(b, "link", "base", nullptr, 1, com0, some_inertia), {"body 'link'", "taken"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_body(b, nullptr, "base", nullptr, 1, com0, some_inertia), {"body has no name"});
  refuse(DYN_ERROR_NAME, dyn_builder_add_body(b, "x", "nobody", nullptr, 1, com0, some_inertia),
         {"body 'x'", "no parent 'nobody'"});
  refuse(DYN_ERROR_NAME, dyn_builder_add_frame(b, "base", nullptr, nullptr, DYN_FRAME_TYPE_OP_FRAME), {"frame 'base'", "taken"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_frame(b, "", nullptr, nullptr, DYN_FRAME_TYPE_OP_FRAME), {"frame has no name"});
  refuse(DYN_ERROR_NAME, dyn_builder_add_frame(b, "f", "nobody", nullptr, DYN_FRAME_TYPE_OP_FRAME), {"frame 'f'", "no parent"});
  refuse(DYN_ERROR_NAME, dyn_builder_add_configuration(b, "neutral", com0, 1), {"neutral", "choose another"});
  refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_configuration(b, nullptr, com0, 1), {"configuration has no name"});
}

TEST_F(BuilderTest, Types) {
  for (int bad : {-1, int(every<dynJointType>("dynJointType").size()), 1000}) {
    Spec s("j", DYN_JOINT_TYPE_REVOLUTE);
    std::memcpy(&s.type, &bad, sizeof bad);
    refuse(s, DYN_ERROR_ARGUMENT, {"type is " + std::to_string(bad), "dynJointType"});
    s.type = DYN_JOINT_TYPE_COMPOSITE;
    Spec part(nullptr, DYN_JOINT_TYPE_REVOLUTE);
    std::memcpy(&part.type, &bad, sizeof bad);
    s.parts = &part, s.parts_count = 1;
    refuse(s, DYN_ERROR_ARGUMENT, {"type is " + std::to_string(bad)});
  }
  for (int bad : {0, 2, 4, 8, 3, 1000, -1}) {
    dynFrameType type;
    std::memcpy(&type, &bad, sizeof type);
    refuse(DYN_ERROR_ARGUMENT, dyn_builder_add_frame(b, "f", nullptr, nullptr, type), {"frame 'f'", "OP_FRAME or SENSOR"});
  }
}

TEST_F(BuilderTest, Placements) {
  using Change = void (*)(double*);
  const Change not_rotations[] = {
      [](double* x) { x[0] = 0.9; },                       // stretched
      [](double* x) { x[0] = -1; },                        // a reflection
      [](double* x) { x[1] = 1e-3; },                      // sheared
      [](double* x) { std::fill(x, x + 9, 0.0); },         // nothing
      [](double* x) { std::fill(x, x + 9, 1e200); },       // huge
      [](double* x) { std::swap_ranges(x, x + 3, x + 3); } // exchanged axes
  };
  for (Change change : not_rotations) {
    Spec s("j", DYN_JOINT_TYPE_REVOLUTE, "base");
    change(s.placement);
    refuse(s, DYN_ERROR_INVALID, {"joint 'j'", "not a rotation", "orthonormal right-handed"});
    s.type = DYN_JOINT_TYPE_FIXED;
    refuse(s, DYN_ERROR_INVALID, {"joint 'j'", "not a rotation"});
    refuse(DYN_ERROR_INVALID, dyn_builder_add_body(b, "x", "base", s.placement, 1, com0, some_inertia),
           {"body 'x'", "not a rotation"});
    refuse(DYN_ERROR_INVALID, dyn_builder_add_frame(b, "f", "base", s.placement, DYN_FRAME_TYPE_SENSOR),
           {"frame 'f'", "not a rotation"});
    Spec composite("j", DYN_JOINT_TYPE_COMPOSITE),
        parts[] = {Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE), Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE)};
    std::copy(s.placement, s.placement + 12, parts[1].placement);
    composite.parts = parts, composite.parts_count = 2;
    refuse(composite, DYN_ERROR_INVALID, {"joint 'j', part 1", "not a rotation"});
  }
  for (int k = 0; k < 12; ++k)
    for (double bad : {nan, inf}) {
      Spec s("j", DYN_JOINT_TYPE_REVOLUTE);
      s.placement[k] = bad;
      refuse(s, DYN_ERROR_NONFINITE, {"joint 'j'", "placement[" + std::to_string(k) + "]", "finite"});
    }
}

TEST_F(BuilderTest, Axes) {
  refuse(Spec("j", DYN_JOINT_TYPE_REVOLUTE).about(0, 0, 0), DYN_ERROR_INVALID, {"joint 'j'", "axis is zero", "(0, 0, 1)"});
  refuse(Spec("j", DYN_JOINT_TYPE_PRISMATIC).about(0, nan, 1), DYN_ERROR_NONFINITE, {"axis[1]"});
  refuse(Spec("j", DYN_JOINT_TYPE_PRISMATIC).about(inf, 0, 1), DYN_ERROR_NONFINITE, {"axis[0]"});
  refuse(Spec("j", DYN_JOINT_TYPE_UNIVERSAL).about(-3, 0, 0), DYN_ERROR_INVALID, {"parallel", "two directions"});
  Spec s("j", DYN_JOINT_TYPE_UNIVERSAL);
  s.axis2[0] = 0;
  refuse(s, DYN_ERROR_INVALID, {"axis2 is zero"});
  s.axis2[0] = nan;
  refuse(s, DYN_ERROR_NONFINITE, {"axis2[0]"});
  Spec screw("j", DYN_JOINT_TYPE_HELICAL);
  screw.pitch = inf;
  refuse(screw, DYN_ERROR_NONFINITE, {"pitch", "metres per radian"});
}

TEST_F(BuilderTest, NumbersOfADegreeOfFreedom) {
  const double bad_nan[3] = {0, 0, nan}, negative[3] = {0, 0, -1}, large[3] = {2, 2, 2}, one[3] = {1, 1, 1},
               infinite[3] = {0, 0, inf};
  struct Row {
    const double* dynJointSpec::*member;
    const char* name;
    bool may_be_negative;
  };
  const Row rows[] = {{&dynJointSpec::lower, "lower limit", true}, {&dynJointSpec::upper, "upper limit", true},
                      {&dynJointSpec::velocity, "velocity limit", false}, {&dynJointSpec::effort, "effort limit", false},
                      {&dynJointSpec::armature, "armature", false}, {&dynJointSpec::damping, "damping", false},
                      {&dynJointSpec::friction, "friction", false}};
  for (const Row& r : rows) {
    Spec s("j", DYN_JOINT_TYPE_TRANSLATION);
    s.*r.member = bad_nan;
    refuse(s, DYN_ERROR_NONFINITE, {"joint 'j'", r.name, "NaN"});
    s.*r.member = negative;
    if (!r.may_be_negative) refuse(s, DYN_ERROR_INVALID, {"joint 'j'", r.name, "-1", "can't be negative"});
  }
  Spec s("j", DYN_JOINT_TYPE_TRANSLATION);
  s.lower = large, s.upper = one;
  refuse(s, DYN_ERROR_INVALID, {"joint 'j'", "lower limit[0] 2 exceeds upper limit 1"});
  const double up[3] = {1, 1, inf}, down[3] = {-1, -1, -inf};
  s.lower = up, s.upper = nullptr;
  refuse(s, DYN_ERROR_NONFINITE, {"joint 'j'", "lower limit[2] is inf", "-inf for none"});
  s.lower = nullptr, s.upper = down;
  refuse(s, DYN_ERROR_NONFINITE, {"joint 'j'", "upper limit[2] is -inf", "inf for none"});
  s = Spec("j", DYN_JOINT_TYPE_TRANSLATION), s.armature = infinite;
  refuse(s, DYN_ERROR_NONFINITE, {"armature", "finite"});
}

TEST_F(BuilderTest, Rotors) {
  Spec s("j", DYN_JOINT_TYPE_REVOLUTE);
  s.rotor_inertia = -1;
  refuse(s, DYN_ERROR_INVALID, {"rotor inertia", "negative"});
  s.rotor_inertia = nan;
  refuse(s, DYN_ERROR_NONFINITE, {"rotor inertia"});
  s.rotor_inertia = 1, s.gear_ratio = inf;
  refuse(s, DYN_ERROR_NONFINITE, {"gear ratio"});
  s = Spec("j", DYN_JOINT_TYPE_SPHERICAL), s.rotor_inertia = 1;
  refuse(s, DYN_ERROR_INVALID, {"rotor inertia", "one degree of freedom", "armature"});
}

TEST_F(BuilderTest, Mimics) {
  Spec s("j", DYN_JOINT_TYPE_SPHERICAL);
  s.mimic = "base";
  refuse(s, DYN_ERROR_INVALID, {"joint 'j'", "one degree of freedom", "spherical"});
  s.type = DYN_JOINT_TYPE_FIXED;
  refuse(s, DYN_ERROR_INVALID, {"fixed joint can't mimic"});
  s.type = DYN_JOINT_TYPE_REVOLUTE, s.mimic = "j";
  refuse(s, DYN_ERROR_INVALID, {"mimics itself"});
  s.mimic = "base", s.mimic_ratio = nan;
  refuse(s, DYN_ERROR_NONFINITE, {"mimic ratio"});
  s.mimic_ratio = 1, s.mimic_offset = inf;
  refuse(s, DYN_ERROR_NONFINITE, {"offset"});
}

TEST_F(BuilderTest, Composites) {
  Spec s("j", DYN_JOINT_TYPE_COMPOSITE);
  refuse(s, DYN_ERROR_ARGUMENT, {"joint 'j'", "composite", "at least one part"});
  s.parts_count = 2;
  refuse(s, DYN_ERROR_ARGUMENT, {"parts is NULL"});
  Spec parts[] = {Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE), Spec(nullptr, DYN_JOINT_TYPE_FIXED, nullptr, {1, 0, 0})};
  s.parts = parts;
  refuse(s, DYN_ERROR_INVALID, {"end with a fixed part", "bodies"});
  parts[1].struct_size = 3;
  refuse(s, DYN_ERROR_SIZE, {"struct_size is 3"});
  parts[1] = Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE).about(0, 0, 0);
  refuse(s, DYN_ERROR_INVALID, {"joint 'j', part 1", "axis is zero"});
  s.parts_count = 1001;
  refuse(s, DYN_ERROR_LIMIT, {"1000 parts"});
  // parts of what is no composite, at the top and below
  Spec hinge("j", DYN_JOINT_TYPE_REVOLUTE), part(nullptr, DYN_JOINT_TYPE_REVOLUTE);
  hinge.parts = &part;
  for (std::size_t count : {0u, 1u}) {
    hinge.parts_count = count;
    refuse(hinge, DYN_ERROR_ARGUMENT, {"joint 'j'", "parts are given", "revolute", "DYN_JOINT_TYPE_COMPOSITE"});
  }
  hinge.type = DYN_JOINT_TYPE_FIXED;
  refuse(hinge, DYN_ERROR_ARGUMENT, {"parts are given", "fixed"});
  hinge.type = DYN_JOINT_TYPE_REVOLUTE;
  Spec outer("outer", DYN_JOINT_TYPE_COMPOSITE);
  outer.parts = &hinge, outer.parts_count = 1;
  refuse(outer, DYN_ERROR_ARGUMENT, {"joint 'j'", "parts are given"});
  // itself within itself
  Spec loop("j", DYN_JOINT_TYPE_COMPOSITE);
  loop.parts = &loop, loop.parts_count = 1;
  refuse(loop, DYN_ERROR_LIMIT, {"16 deep"});
  // a tree of composites that would have 10^12 leaves
  std::vector<std::vector<Spec>> levels(5, std::vector<Spec>(1000, Spec(nullptr, DYN_JOINT_TYPE_REVOLUTE)));
  for (std::size_t k = 0; k + 1 < levels.size(); ++k)
    for (Spec& part : levels[k]) part.type = DYN_JOINT_TYPE_COMPOSITE, part.parts = levels[k + 1].data(), part.parts_count = 1;
  Spec wide("j", DYN_JOINT_TYPE_COMPOSITE);
  wide.parts = levels[0].data(), wide.parts_count = 1000;
  levels[0][0].parts_count = 1000;
  refuse(wide, DYN_ERROR_LIMIT, {"1000"});
}

TEST_F(BuilderTest, Bodies) {
  for (double bad : {nan, inf, -inf})
    refuse(DYN_ERROR_NONFINITE, dyn_builder_add_body(b, "x", "base", nullptr, bad, com0, some_inertia),
           {"body 'x'", "mass", "finite"});
  refuse(DYN_ERROR_INVALID, dyn_builder_add_body(b, "x", "base", nullptr, -0.5, com0, some_inertia),
         {"body 'x'", "mass is -0.5 kg", "negative"});
  double com[3] = {0, 0, nan}, inertia[9];
  refuse(DYN_ERROR_NONFINITE, dyn_builder_add_body(b, "x", "base", nullptr, 1, com, some_inertia), {"body 'x'", "com[2]"});
  std::copy(some_inertia, some_inertia + 9, inertia);
  inertia[8] = inf;
  refuse(DYN_ERROR_NONFINITE, dyn_builder_add_body(b, "x", "base", nullptr, 1, com0, inertia), {"body 'x'", "inertia[8]"});
  inertia[8] = 0.02, inertia[1] = 0.5;
  refuse(DYN_ERROR_INVALID, dyn_builder_add_body(b, "x", "base", nullptr, 1, com0, inertia), {"body 'x'", "not symmetric"});
  const double impossible[9] = {1, 0, 0, 0, 3, 0, 0, 0, 1.5};
  refuse(DYN_ERROR_INVALID, dyn_builder_add_body(b, "x", "base", nullptr, 1, com0, impossible),
         {"body 'x'", "and 3 kg m^2", "no body has one above the sum"});
}

TEST_F(BuilderTest, GravityAndConfigurations) {
  for (int k = 0; k < 3; ++k) {
    double g[3] = {};
    g[k] = k ? nan : inf;
    refuse(DYN_ERROR_NONFINITE, dyn_builder_set_gravity(b, g), {"gravity[" + std::to_string(k) + "]"});
  }
  const double bad[1] = {nan}, good[1] = {0.1};
  refuse(DYN_ERROR_NONFINITE, dyn_builder_add_configuration(b, "c", bad, 1), {"configuration 'c'", "[0]"});
  EXPECT_EQ(DYN_OK, dyn_builder_add_configuration(b, "c", good, 1));
  refuse(DYN_ERROR_NAME, dyn_builder_add_configuration(b, "c", good, 1), {"configuration 'c'", "choose another"});
}

}  // namespace
}  // namespace dyn_test
