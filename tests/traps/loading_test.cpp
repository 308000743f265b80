// Common mistakes with robot files: fixed joints, meshes, damping, the order of joints.
#include "traps/traps.hpp"

namespace dyn_test {
namespace {

// Fixed joints and merged links keep their names, placements and masses.
TEST(Traps, FixedJointsKeepNamesPlacementsAndMasses) {
  const char* text =
      "<robot name='r'>"
      "<link name='a'><inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='c'><inertial><mass value='0.5'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<link name='d'/>"
      "<joint name='ab' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' "
      "effort='1' velocity='1'/></joint>"
      "<joint name='bc' type='fixed'><origin xyz='0.5 0 0'/><parent link='b'/><child link='c'/></joint>"
      "<joint name='cd' type='fixed'><origin xyz='0 0.25 0'/><parent link='c'/><child link='d'/></joint></robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FLOATING;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, &options, &raw)) << dyn_last_error();
  const Model m(raw);
  Data d(m);
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(m, d, nullptr, nullptr, nullptr));
  EXPECT_EQ(3, m.njoints());
  EXPECT_EQ(4, dyn_model_nbodies(m));
  const int carrier = dyn_model_joint_id(m, "ab");
  EXPECT_EQ(-1, dyn_model_joint_id(m, "bc"));
  for (const char* name : {"bc", "cd"}) {
    const dynFrameInfo info = frame_info(m, dyn_model_frame_id(m, name));
    EXPECT_EQ(DYN_FRAME_TYPE_FIXED_JOINT, info.type) << name;
    EXPECT_EQ(carrier, info.joint) << name;
  }
  const double masses[] = {2, 1, 0.5, 0};
  for (int k = 0; k < 4; ++k) {
    const char name[2] = {char('a' + k), 0};
    const dynFrameInfo info = frame_info(m, dyn_model_frame_id_of_type(m, name, DYN_FRAME_TYPE_BODY));
    EXPECT_EQ(masses[k], info.mass) << name;
    EXPECT_EQ(k ? carrier : dyn_model_joint_id(m, "root_joint"), info.joint) << name;
  }
  EXPECT_EQ(3.5, dyn_model_total_mass(m));
  EXPECT_EQ((Numbers{1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0.25, 0}), placement(m, d, dyn_model_frame_id(m, "d")));
}

// A missing mesh is reported with the paths tried; strict loading refuses it.
TEST(Traps, MissingMeshIsReported) {
  const char* text =
      "<robot name='r'><link name='a'>\n<collision><geometry><mesh "
      "filename='package://nowhere/meshes/a.stl'/></geometry></collision></link></robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  const char* dirs[] = {"/none/such"};
  options.package_dirs = dirs, options.package_dirs_count = 1;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, &options, &raw)) << dyn_last_error();
  const Model m(raw);
  bool found = false;
  for (int k = 0; k < dyn_model_report_count(m); ++k) {
    dynReportEntry e{};
    e.struct_size = sizeof e;
    ASSERT_EQ(DYN_OK, dyn_model_report_entry(m, k, &e));
    found |= e.level == DYN_REPORT_LEVEL_DROPPED && e.line == 2 &&
             says({"package://nowhere/meshes/a.stl", "not found", "/none/such"}, e.message);
  }
  EXPECT_TRUE(found);
  options.strict = 1;
  dynModel* none = nullptr;
  EXPECT_EQ(DYN_ERROR_STRICT, dyn_model_load_string(text, &options, &none));
  EXPECT_TRUE(says({"a.stl", "not found"}));
}

// Damping and dry friction act when switched on, in inverse and forward dynamics alike. Until then the robot is frictionless.
TEST(Traps, DampingActsInStepsAndInAlgorithmsWhenSwitchedOn) {
  const char* text =
      "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
      "ixz='0' iyz='0'/></inertial></link>"
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>%s</joint></robot>";
  Model m[2];
  for (int k = 0; k < 2; ++k) {
    std::string t = text;
    t.replace(t.find("%s"), 2, k ? "<dynamics damping='0.7' friction='0.3'/>" : "");
    dynLoadOptions options;
    dyn_load_options_init(&options);
    options.base = DYN_BASE_FIXED, options.strict = 1;  // strict: nothing may be lost
    ASSERT_EQ(DYN_OK, dyn_model_load_string(t.c_str(), &options, &m[k].m)) << dyn_last_error();
  }
  EXPECT_EQ(0.7, dyn_model_array(m[1], DYN_MODEL_ARRAY_DAMPING)[0]);
  EXPECT_EQ(0.3, dyn_model_array(m[1], DYN_MODEL_ARRAY_FRICTION)[0]);
  EXPECT_EQ(0.0, dyn_model_array(m[0], DYN_MODEL_ARRAY_DAMPING)[0]);
  const State s = random_state(m[0], 19);
  Data d(m[0]), e(m[1]);
  compute_all(m[0], d, s), compute_all(m[1], e, s);
  EXPECT_EQ("", Snapshot(m[0], d).differs(Snapshot(m[1], e)));
  ASSERT_EQ(DYN_OK, take_step(m[0], d, DYN_INTEGRATOR_RK4, 0.1));
  ASSERT_EQ(DYN_OK, take_step(m[1], e, DYN_INTEGRATOR_RK4, 0.1));
  const double free = std::abs(field(m[0], d, "v")[0]), damped = std::abs(field(m[1], e, "v")[0]);
  EXPECT_LT(damped, free * std::exp(-0.7 * 0.1 / 1.5));  // the inertia is 1 kg m^2
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(m[1], e, 0, DYN_EFFECT_ALL));
  const double v = 2, a = 0.5;
  double tau, ddq;
  ASSERT_EQ(DYN_OK, dyn_rnea(m[1], e, nullptr, &v, &a, nullptr, &tau));
  EXPECT_NEAR(0.5 + 0.7 * 2 + 0.3, tau, 1e-14);
  ASSERT_EQ(DYN_OK, dyn_aba(m[1], e, nullptr, nullptr, &tau, nullptr, &ddq));
  EXPECT_NEAR(0.5, ddq, 1e-14);
}

// Joints keep the file's order, not the alphabetical one. Indices by name work in any order.
TEST(Traps, JointsKeepTheOrderOfTheFile) {
  const char* names[] = {"zeta", "alpha", "mid"};
  std::string text = "<robot name='r'><link name='root'/>";
  const std::string solid =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>";
  for (const char* n : names)
    text += std::string("<link name='l") + n + "'>" + solid + "<joint name='" + n +
            "' type='continuous'><parent link='root'/><child link='l" + n + "'/><axis xyz='0 0 1'/></joint>";
  text += "</robot>";
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  dynModel* raw = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), &options, &raw)) << dyn_last_error();
  const Model m(raw);
  for (int k = 0; k < 3; ++k) EXPECT_STREQ(names[k], dyn_model_joint_name(m, k + 1));
  const char* mine[] = {"alpha", "mid", "zeta"};
  std::int32_t q[3], v[3];
  ASSERT_EQ(DYN_OK, dyn_model_q_permutation(m, mine, 3, q, v));
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(q[k] == (k + 1) % 3 && v[k] == q[k]) << k;
}

}  // namespace
}  // namespace dyn_test
