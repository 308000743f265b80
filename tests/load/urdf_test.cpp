// URDF to model: order, frames, base, joint types, mimic, limits, mass properties, shapes, and unusual texts.
#include "load/urdf.hpp"

#include <clocale>
#include <cmath>
#include <thread>

namespace dyn_test {
namespace {

const double pi = std::acos(-1.0);

TEST(Urdf, JointsDepthFirstInTheOrderOfTheFile) {
  // names whose order any sorting would change
  const Loaded l = good(robot(link("m") + link("x") + link("c") + link("k") + link("b") + link("z") +    //
                              joint("j_x", "revolute", "m", "x") + joint("j_z", "revolute", "x", "z") +  //
                              joint("j_b", "revolute", "m", "b") + joint("j_k", "fixed", "b", "k") +     //
                              joint("j_c", "revolute", "x", "c")));
  EXPECT_EQ((std::vector<std::string>{"j_x", "j_z", "j_c", "j_b"}), joint_names(l));
  // a child joint may stand before its parent joint
  const Loaded late = good(robot(ab + link("c") + joint("second", "revolute", "b", "c") + joint("first", "revolute", "a", "b")));
  EXPECT_EQ((std::vector<std::string>{"first", "second"}), joint_names(late));
}

TEST(Urdf, EveryNameResolves) {
  const Loaded l =
      good(robot(ab + link("c") + link("tool", "") + joint("a", "revolute", "a", "b") + joint("weld", "fixed", "b", "c") +
                 joint("tip", "fixed", "c", "tool", "<origin xyz=\"0 0 0.5\"/>")));
  EXPECT_EQ(4, dyn_model_nbodies(l.model.get()));
  for (const char* name : {"a", "b", "c", "tool"})
    EXPECT_GT(dyn_model_frame_id_of_type(l.model.get(), name, DYN_FRAME_TYPE_BODY), 0) << name;
  for (const char* name : {"weld", "tip"})
    EXPECT_GT(dyn_model_frame_id_of_type(l.model.get(), name, DYN_FRAME_TYPE_FIXED_JOINT), 0) << name;
  EXPECT_EQ(dyn_model_joint_id(l.model.get(), "a"), frame(l, "tool").joint);
  EXPECT_EQ(0.5, frame(l, "tool").placement[11]);
  EXPECT_EQ(0, frame(l, "a").joint);
  EXPECT_EQ(1.0, frame(l, "c").mass);  // merged, and still with its own mass
  EXPECT_STREQ("r", dyn_model_name(l.model.get()));
}

TEST(Urdf, Base) {
  const std::string text = robot(ab + joint("j", "revolute", "a", "b"));
  EXPECT_EQ(1, dyn_model_nv(good(text, Options(DYN_BASE_FIXED)).model.get()));
  const Loaded floating = good(text, Options(DYN_BASE_FLOATING));
  EXPECT_EQ(7, dyn_model_nv(floating.model.get()));
  EXPECT_EQ((std::vector<std::string>{"root_joint", "j"}), joint_names(floating));
  EXPECT_EQ(DYN_JOINT_TYPE_FREE_FLYER, joint(floating, "root_joint").type);
  EXPECT_EQ(1, frame(floating, "a").joint);
  EXPECT_EQ(DYN_ERROR_BASE, load(text, Options(DYN_BASE_UNSPECIFIED)).status);
}

TEST(Urdf, RootWithoutMassIsWelded) {
  const Options unspecified(DYN_BASE_UNSPECIFIED);
  const Loaded world = good(robot(link("world", "") + link("a") + joint("j", "revolute", "world", "a")), unspecified);
  EXPECT_EQ(1, dyn_model_nv(world.model.get()));
  EXPECT_TRUE(world.reports("'world' has no mass", DYN_REPORT_LEVEL_INFO, 2));
  // a mass welded to the root may mean a floating robot
  const Loaded dummy = good(robot(link("base", "") + link("a") + joint("j", "fixed", "base", "a")), unspecified);
  EXPECT_TRUE(dummy.reports("choose base floating", DYN_REPORT_LEVEL_WARNING, 2));
  const Loaded free = good(robot(link("base", "") + link("a") + joint("j", "fixed", "base", "a")), Options(DYN_BASE_FLOATING));
  EXPECT_EQ(6, dyn_model_nv(free.model.get()));
}

TEST(Urdf, LinkWorldFloatsWhereThatIsChosen) {
  const Loaded floating =
      good(robot(link("world", "") + link("a") + joint("j", "fixed", "world", "a")), Options(DYN_BASE_FLOATING));
  EXPECT_EQ(6, dyn_model_nv(floating.model.get()));
  EXPECT_EQ(1, frame(floating, "world").joint);
  EXPECT_TRUE(floating.reports("with base floating", DYN_REPORT_LEVEL_WARNING, 2));
}

TEST(Urdf, JointTypes) {
  const auto type = [](const std::string& name, bool cos_sin = false) {
    Options o;
    o.cos_sin = cos_sin;
    const Loaded l = good(robot(ab + joint("j", name, "a", "b")), o);
    return l.status == DYN_OK ? joint(l, "j").type : DYN_JOINT_TYPE_FIXED;
  };
  EXPECT_EQ(DYN_JOINT_TYPE_REVOLUTE, type("revolute"));
  EXPECT_EQ(DYN_JOINT_TYPE_CONTINUOUS, type("continuous"));
  EXPECT_EQ(DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED, type("continuous", true));
  EXPECT_EQ(DYN_JOINT_TYPE_REVOLUTE, type("revolute", true));
  EXPECT_EQ(DYN_JOINT_TYPE_PRISMATIC, type("prismatic"));
  EXPECT_EQ(DYN_JOINT_TYPE_FREE_FLYER, type("floating"));
  EXPECT_EQ(DYN_JOINT_TYPE_PLANAR, type("planar"));
  EXPECT_EQ(DYN_JOINT_TYPE_SPHERICAL, type("spherical"));
  EXPECT_EQ(DYN_JOINT_TYPE_SPHERICAL, type("ball"));
  EXPECT_TRUE(
      good(robot(ab + joint("j", "ball", "a", "b", ""))).reports("'ball' is not in the URDF standard", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_EQ(0, dyn_model_nv(good(robot(ab + joint("j", "fixed", "a", "b"))).model.get()));
}

TEST(Urdf, PlanarMovesInThePlaneNormalToItsAxis) {
  const Loaded l = good(robot(ab + joint("j", "planar", "a", "b", "<axis xyz=\"0 2 0\"/>")));
  EXPECT_EQ(1.0, joint(l, "j").axis[1]);
  dynData* data = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(l.model.get(), 0, &data));
  const double q[3] = {0.3, -0.7, 0.5};
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(l.model.get(), data, q, nullptr, nullptr));
  double X[12];
  ASSERT_EQ(DYN_OK,
            dyn_frame_placement(l.model.get(), data, dyn_model_frame_id_of_type(l.model.get(), "b", DYN_FRAME_TYPE_BODY), X));
  EXPECT_NEAR(0, X[10], 1e-15);
  EXPECT_NEAR(std::hypot(0.3, 0.7), std::hypot(X[9], X[11]), 1e-15);
  EXPECT_NEAR(1, X[4], 1e-15);  // y stays y
  dyn_data_free(data);
}

TEST(Urdf, AxisIsNormalisedAndDefaultsToX) {
  const Loaded l = good(robot(ab + link("c") + joint("j", "revolute", "a", "b", "<axis xyz=\"0 3 4\"/>" + limit) +
                              joint("k", "continuous", "b", "c", "")));
  EXPECT_NEAR(0.6, joint(l, "j").axis[1], 1e-16);
  EXPECT_NEAR(0.8, joint(l, "j").axis[2], 1e-16);
  EXPECT_TRUE(l.reports("the axis has length 5 and was normalised", DYN_REPORT_LEVEL_INFO, 5));
  EXPECT_EQ(1.0, joint(l, "k").axis[0]);
  EXPECT_TRUE(l.reports("joint 'k' has no <axis>", DYN_REPORT_LEVEL_INFO, 6));
  // neither overflow nor underflow
  for (const char* big : {"1e300 1e300 0", "1e-300 1e-300 0"}) {
    const Loaded b = good(robot(ab + joint("j", "revolute", "a", "b", "<axis xyz=\"" + std::string(big) + "\"/>" + limit)));
    EXPECT_NEAR(std::sqrt(0.5), joint(b, "j").axis[0], 1e-15);
  }
}

TEST(Urdf, Origin) {
  const Loaded l = good(robot(ab + joint("j", "fixed", "a", "b", "<origin xyz=\"1 2 3\" rpy=\"0.1 0.2 0.3\"/>")));
  const dynFrameInfo f = frame(l, "b");
  const double cr = std::cos(0.1), sr = std::sin(0.1), cp = std::cos(0.2), sp = std::sin(0.2), cy = std::cos(0.3),
               sy = std::sin(0.3);
  const double X[12] = {cy * cp,
                        sy * cp,
                        -sp,
                        cy * sp * sr - sy * cr,
                        sy * sp * sr + cy * cr,
                        cp * sr,
                        cy * sp * cr + sy * sr,
                        sy * sp * cr - cy * sr,
                        cp * cr,
                        1,
                        2,
                        3};
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(X[i], f.placement[i], 1e-15) << i;
  const Loaded q = good(robot(ab + joint("j", "fixed", "a", "b", "<origin quat_xyzw=\"0 0 2 2\"/>")));
  EXPECT_NEAR(1, frame(q, "b").placement[1], 1e-15);  // 90 degrees about z
}

TEST(Urdf, MassProperties) {
  const Loaded l = good(
      robot(link("a", "<inertial><origin xyz=\"1 2 3\" rpy=\"0 0 " + std::to_string(pi / 2) +
                          "\"/><mass value=\"+2.5e0\"/>"
                          "<inertia ixx=\"0.3\" ixy=\"0.01\" ixz=\"0.02\" iyy=\"0.4\" iyz=\"0.03\" izz=\"0.5\"/></inertial>")));
  const dynFrameInfo f = frame(l, "a");
  EXPECT_EQ(2.5, f.mass);
  EXPECT_EQ(1, f.com[0]);
  EXPECT_EQ(2, f.com[1]);
  EXPECT_EQ(3, f.com[2]);
  const double turned[9] = {0.4, -0.01, -0.03, -0.01, 0.3, 0.02, -0.03, 0.02, 0.5};  // x -> y, y -> -x
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(turned[i], f.inertia[i], 1e-6) << i;
}

// Strict: what a joint moves has mass, be it a point; a follower's mass counts for its leader.
TEST(Urdf, StrictJointsMoveMass) {
  const Options strict(DYN_BASE_FIXED, true);
  const std::string turn = "<axis xyz=\"0 0 1\"/>" + limit,
                    point =
                        "<inertial><origin xyz=\"1 0 0\"/><mass value=\"1\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" "
                        "iyz=\"0\" izz=\"0\"/></inertial>";
  EXPECT_EQ(DYN_OK, load(robot(link("a") + link("b", point) + joint("j", "revolute", "a", "b", turn)), strict).status);
  const std::string follows = turn + "<mimic joint=\"j\"/>";
  EXPECT_EQ(DYN_OK, load(robot(link("a") + link("b", "") + link("c", point) + joint("j", "revolute", "a", "b", turn) +
                               joint("k", "revolute", "a", "c", follows)),
                         strict)
                        .status);
  std::string text = link("a"), joints;
  for (char k = '0'; k < '8'; ++k) {
    text += link(std::string("l") + k, "");
    joints +=
        joint(std::string("j") + k, "revolute", k == '0' ? "a" : std::string("l") + char(k - 1), std::string("l") + k, turn);
  }
  const Loaded refused = load(robot(text + joints), strict);
  EXPECT_EQ(DYN_ERROR_INVALID, refused.status);
  EXPECT_NE(std::string::npos, refused.error.find("joint 'j0': neither link 'l0' nor anything on it has mass"))
      << refused.error;
  EXPECT_NE(std::string::npos, refused.error.find("; so also 'j1', 'j2', 'j3', 'j4', 'j5' and 2 more")) << refused.error;
}

TEST(Urdf, Limits) {
  const Loaded l = good(robot(ab + link("c") +
                              joint("j", "revolute", "a", "b",
                                    "<axis xyz=\"0 0 1\"/><limit lower=\"-1.5\" upper=\"2\" effort=\"30\" velocity=\"4\"/>"
                                    "<dynamics damping=\"0.1\" friction=\"0.2\"/>") +
                              joint("k", "prismatic", "b", "c", "<axis xyz=\"0 0 1\"/>")));
  const dynModel* m = l.model.get();
  EXPECT_EQ(-1.5, dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT)[0]);
  EXPECT_EQ(2, dyn_model_array(m, DYN_MODEL_ARRAY_UPPER_LIMIT)[0]);
  EXPECT_EQ(30, dyn_model_array(m, DYN_MODEL_ARRAY_EFFORT_LIMIT)[0]);
  EXPECT_EQ(4, dyn_model_array(m, DYN_MODEL_ARRAY_VELOCITY_LIMIT)[0]);
  EXPECT_EQ(0.1, dyn_model_array(m, DYN_MODEL_ARRAY_DAMPING)[0]);
  EXPECT_EQ(0.2, dyn_model_array(m, DYN_MODEL_ARRAY_FRICTION)[0]);
  EXPECT_TRUE(l.reports("joint 'k' has no <limit>", DYN_REPORT_LEVEL_WARNING, 6));
  EXPECT_EQ(HUGE_VAL, dyn_model_array(m, DYN_MODEL_ARRAY_UPPER_LIMIT)[1]);
  EXPECT_EQ(-HUGE_VAL, dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT)[1]);
}

TEST(Urdf, LimitsThatAreLeftOut) {
  const auto with = [](const std::string& type, const std::string& attributes) {
    return good(robot(ab + joint("j", type, "a", "b", "<axis xyz=\"0 0 1\"/><limit " + attributes + "/>")));
  };
  const Loaded one = with("revolute", "upper=\"1\" effort=\"1\" velocity=\"1\"");
  EXPECT_EQ(0, dyn_model_array(one.model.get(), DYN_MODEL_ARRAY_LOWER_LIMIT)[0]);
  EXPECT_TRUE(one.reports("no lower: 0", DYN_REPORT_LEVEL_WARNING, 4));
  const Loaded wheel = with("revolute", "effort=\"1\" velocity=\"1\"");
  EXPECT_EQ(HUGE_VAL, dyn_model_array(wheel.model.get(), DYN_MODEL_ARRAY_UPPER_LIMIT)[0]);
  EXPECT_TRUE(wheel.reports("neither lower nor upper", DYN_REPORT_LEVEL_WARNING, 4));
  const Loaded no_effort = with("revolute", "lower=\"-1\" upper=\"1\"");
  EXPECT_EQ(HUGE_VAL, dyn_model_array(no_effort.model.get(), DYN_MODEL_ARRAY_EFFORT_LIMIT)[0]);
  EXPECT_TRUE(no_effort.reports("no effort: unlimited", DYN_REPORT_LEVEL_INFO, 4));
  const Loaded continuous = with("continuous", "lower=\"-1\" upper=\"1\" effort=\"3\" velocity=\"1\"");
  EXPECT_EQ(HUGE_VAL, dyn_model_array(continuous.model.get(), DYN_MODEL_ARRAY_UPPER_LIMIT)[0]);
  EXPECT_EQ(3, dyn_model_array(continuous.model.get(), DYN_MODEL_ARRAY_EFFORT_LIMIT)[0]);
  EXPECT_TRUE(continuous.reports("lower and upper are not used", DYN_REPORT_LEVEL_INFO, 4));
}

TEST(Urdf, Mimic) {
  const std::string turn = "<axis xyz=\"0 0 1\"/>" + limit;
  // the leader comes later in the order; a mimic joint of a mimic joint
  const Loaded l =
      good(robot(ab + link("c") + link("d") +
                 joint("f", "revolute", "a", "b", turn + "<mimic joint=\"lead\" multiplier=\"-2\" offset=\"0.5\"/>") +
                 joint("g", "prismatic", "b", "c", turn + "<mimic joint=\"f\"/>") + joint("lead", "revolute", "a", "d", turn)));
  EXPECT_EQ(1, dyn_model_nv(l.model.get()));
  const dynJointInfo f = joint(l, "f");
  EXPECT_EQ(dyn_model_joint_id(l.model.get(), "lead"), f.mimic_leader);
  EXPECT_EQ(-2, f.mimic_ratio);
  EXPECT_EQ(0.5, f.mimic_offset);
  EXPECT_EQ(0, f.nv);
  EXPECT_EQ(-2, joint(l, "g").mimic_ratio);
  // with (cos, sin) storage, joints of a mimic relation keep their angle
  Options o;
  o.cos_sin = 1;
  const Loaded angles = good(
      robot(ab + link("c") + joint("j", "continuous", "a", "b", "") + joint("k", "continuous", "b", "c", "<mimic joint=\"j\"/>")),
      o);
  EXPECT_EQ(DYN_JOINT_TYPE_CONTINUOUS, joint(angles, "j").type);
  EXPECT_TRUE(angles.reports("joint 'j' takes part in a mimic relation", DYN_REPORT_LEVEL_INFO, 5));
  // the robot with its gripper locked
  const Loaded locked = good(robot(ab + joint("j", "fixed", "a", "b", "<mimic joint=\"gone\"/>")));
  EXPECT_TRUE(locked.reports("joint 'j' is fixed: its <mimic> has no effect", DYN_REPORT_LEVEL_INFO, 4));
}

// Colour by the material's own <color>, else by its name anywhere in the file. An invalid colour counts as none.
TEST(Urdf, ColoursOfShapes) {
  const auto visual = [](const std::string& material) {
    return "<visual><geometry><box size=\"1 1 1\"/></geometry>" + material + "</visual>";
  };
  const Loaded l = good("<robot name=\"r\">" +
                        link("a", solid + visual("<material name=\"late\"/>") +
                                      visual("<material name=\"own\"><color rgba=\"0 1 0 0.4\"/></material>") +
                                      visual("<material name=\"own\"/>") + visual("<material name=\"unknown\"/>") +
                                      visual("<material name=\"x\"><color rgba=\"1 2\"/></material>") +
                                      visual("<material name=\"y\"><color rgba=\"1 nan 0 1\"/></material>") +
                                      visual("<material name=\"z\"><color rgba=\"2 -1 0 0\"/></material>") + visual("")) +
                        "<material name=\"late\"><color rgba=\"1 0 0 1\"/></material></robot>");
  const double expected[][4] = {{1, 0, 0, 1},     {0, 1, 0, 0.4},   {0, 1, 0, 0.4}, {-1, -1, -1, -1},
                                {-1, -1, -1, -1}, {-1, -1, -1, -1}, {1, 0, 0, 0},   {-1, -1, -1, -1}};
  ASSERT_EQ(8, dyn_model_nshapes(l.model.get()));
  for (int k = 0; k < 8; ++k) {
    double rgba[4];
    ASSERT_EQ(DYN_OK, dyn_model_shape_rgba(l.model.get(), k, rgba));
    for (int i = 0; i < 4; ++i) EXPECT_EQ(expected[k][i], rgba[i]) << k;
  }
  EXPECT_TRUE(l.reports("3 x <material> without a colour", DYN_REPORT_LEVEL_INFO, 1));
}

// Robots of MATLAB's and Valkyrie's packages have them.
TEST(Urdf, VisualsOfNoSizeAndCallsThatXacroLeftAreNotUsed) {
  const Loaded l = good(robot(link("a", solid + "<visual><geometry><box size=\"0 0 0\"/></geometry></visual>"
                                                "<visual><geometry><box size=\"1 1 0\"/></geometry></visual>") +
                              "<xacro:sensors prefix=\"left\"/>"));
  EXPECT_EQ(0, dyn_model_nshapes(l.model.get()));
  EXPECT_TRUE(l.reports("<box> has a size of 0: not used", DYN_REPORT_LEVEL_WARNING, 2));
  EXPECT_TRUE(l.reports("<xacro:sensors> is not used: xacro did not know this macro", DYN_REPORT_LEVEL_DROPPED, 3));
}

TEST(Urdf, Shapes) {
  const std::string in = "<origin xyz=\"0 0 1\"/>";
  const Loaded l =
      good(robot(link("a", solid + "<visual name=\"skin\">" + in +
                               "<geometry><box size=\"1 2 3\"/></geometry></visual>"
                               "<collision><geometry><sphere radius=\"0.5\"/></geometry></collision>"
                               "<collision><geometry><cylinder radius=\"0.5\" length=\"2\"/></geometry></collision>"
                               "<collision><geometry><capsule radius=\"0.25\" length=\"4\"/></geometry></collision>"
                               "\n<collision><geometry/></collision><collision><geometry><cone/></geometry></collision>")));
  ASSERT_EQ(4, dyn_model_nshapes(l.model.get()));
  dynShapeInfo s{};
  s.struct_size = sizeof s;
  ASSERT_EQ(DYN_OK, dyn_model_shape_info(l.model.get(), 0, &s));
  EXPECT_STREQ("skin", s.name);
  EXPECT_EQ(DYN_SHAPE_TYPE_BOX, s.type);
  EXPECT_EQ(DYN_SHAPE_ROLE_VISUAL, s.role);
  EXPECT_EQ(2, s.size[1]);
  EXPECT_EQ(1, s.placement[11]);
  EXPECT_EQ(dyn_model_frame_id_of_type(l.model.get(), "a", DYN_FRAME_TYPE_BODY), s.frame);
  ASSERT_EQ(DYN_OK, dyn_model_shape_info(l.model.get(), 3, &s));
  EXPECT_EQ(DYN_SHAPE_TYPE_CAPSULE, s.type);
  EXPECT_EQ(DYN_SHAPE_ROLE_COLLISION, s.role);
  EXPECT_EQ(4, s.size[1]);
  EXPECT_TRUE(l.reports("<collision> has no geometry", DYN_REPORT_LEVEL_DROPPED, 3));
  EXPECT_TRUE(l.reports("shape <cone> is not known", DYN_REPORT_LEVEL_DROPPED, 3));
}

TEST(Urdf, UnusualButLegalText) {
  // byte order mark, declaration, comments with markup, XML entities, single quotes, tabs and line ends between numbers
  const Loaded l = good("\xEF\xBB\xBF<?xml version='1.0' encoding='utf-8'?>\n<!-- <robot> & \" -->\n<robot name='r&amp;d'>\n" +
                        link("a") + link("b\xC3\xA4r") +
                        "<joint name='j>k' type='revolute'><parent link='a'/><child link='b\xC3\xA4r'/><!-- x --><origin xyz=' "
                        "1\t2\n 3 '/><axis xyz='0 0 +1'/>" +
                        limit + "</joint></robot>\n<!-- end -->\n");
  EXPECT_STREQ("r&d", dyn_model_name(l.model.get()));
  EXPECT_EQ(2, joint(l, "j>k").placement[10]);
  // tiny numbers become zero, long ones are rounded correctly
  const Loaded tiny =
      good(robot(ab + joint("j", "fixed", "a", "b",
                            "<origin xyz=\"1e-400 0.1000000000000000055511151231257827021181583404541015625 -.5\"/>")));
  EXPECT_EQ(0, frame(tiny, "b").placement[9]);
  EXPECT_EQ(0.1, frame(tiny, "b").placement[10]);
  EXPECT_EQ(-0.5, frame(tiny, "b").placement[11]);
}

TEST(Urdf, MessagesAreUtf8InOneLine) {
  const Loaded l =
      good(robot(link("a") + "<b\xC3\xA4r/><link name=\"c\"/>" +
                 joint("j", "fixed", "a", "c", "<dynamics x=\"\xE4\nb\" y=\"" + std::string(59, 'a') + "\xC3\xA4\"/>")));
  EXPECT_TRUE(l.reports("<b\xC3\xA4r> is not used", DYN_REPORT_LEVEL_DROPPED, 3));
  EXPECT_TRUE(l.reports("x=\"? b\"", DYN_REPORT_LEVEL_DROPPED, 3));
  EXPECT_TRUE(l.reports("aaa?...", DYN_REPORT_LEVEL_DROPPED, 4));
}

TEST(Urdf, SingleLink) {
  EXPECT_EQ(0, dyn_model_nv(good(robot(link("a"))).model.get()));
  EXPECT_EQ(6, dyn_model_nv(good(robot(link("a")), Options(DYN_BASE_FLOATING)).model.get()));
}

TEST(Urdf, NumbersDoNotDependOnTheLocale) {
  const std::string text = robot(ab + joint("j", "revolute", "a", "b",
                                            "<origin xyz=\"0.5 1.25 -1e-3\"/><axis xyz=\"0 0 2.5\"/><limit lower=\"-0.5\" "
                                            "upper=\"1.5\" effort=\"1\" velocity=\"1\"/>"));
  const std::string before = std::setlocale(LC_ALL, nullptr);
  bool comma = false;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"}) comma = comma || std::setlocale(LC_ALL, name);
  const Loaded l = good(text);
  const Loaded bad = load(robot(link("a", "<inertial><mass value=\"0,5\"/></inertial>")));
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(0.5, joint(l, "j").placement[9]);
  EXPECT_EQ(1.25, joint(l, "j").placement[10]);
  EXPECT_EQ(-1e-3, joint(l, "j").placement[11]);
  EXPECT_EQ(1.5, dyn_model_array(l.model.get(), DYN_MODEL_ARRAY_UPPER_LIMIT)[0]);
  EXPECT_TRUE(l.reports("length 2.5", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_EQ(0, l.warnings());  // urdfdom agrees
  EXPECT_EQ(DYN_ERROR_PARSE, bad.status);
  if (!comma) GTEST_SKIP() << "no locale with a decimal comma on this machine";
}

TEST(Urdf, WhatUrdfdomRefusesIsSaidAndNothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const Loaded l = good(robot(ab + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 1\"/>")));
  EXPECT_EQ("", testing::internal::GetCapturedStderr());
  EXPECT_EQ("", testing::internal::GetCapturedStdout());
  EXPECT_TRUE(l.reports("urdfdom, the parser of ROS, refuses this file", DYN_REPORT_LEVEL_INFO, 0));
}

TEST(Urdf, PercentSignsAreNoFormats) {
  const std::string color =
      "<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"m\"><color rgba=\"%s%s%n%n %s %n "
      "%n\"/></material></visual>";
  const Loaded l = good(robot(link("a%s", solid + color) + link("b%n") + joint("%j", "revolute", "a%s", "b%n")));
  EXPECT_GT(dyn_model_joint_id(l.model.get(), "%j"), 0);
  EXPECT_EQ(0, l.warnings());
  std::string references = robot(link("a", solid + color));
  for (size_t at; (at = references.find('%')) != std::string::npos;) references.replace(at, 1, "&#37;");
  good(references);
}

TEST(Urdf, LoadingFromManyThreads) {
  const std::string text = robot(ab + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 1\"/>"));
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) EXPECT_EQ(2, load(text).report().size());
    });
  for (std::thread& t : threads) t.join();
}

}  // namespace
}  // namespace dyn_test
