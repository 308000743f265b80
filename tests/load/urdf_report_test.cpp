// The load report of URDF files: what is not used, what is kept as data, doubtful inertias, and strict loading.
#include "load/urdf.hpp"

namespace dyn_test {
namespace {

TEST(Urdf, ReportOfWhatIsNotUsed) {
  const Loaded l = good(
      "<robot name=\"r\">\n"
      "<gazebo/>\n<gazebo reference=\"a\"><material>Red</material></gazebo>\n"
      "<transmission name=\"t\"><actuator name=\"m\"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>\n" +
      link("a", solid + "<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"red\"/></visual>") +  // line 5
      link("b") + "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>" + limit +
      "\n"
      "<dynamics>\n<damping>0.1</damping></dynamics>\n"  // 8, 9
      "<safety_controller k_velocity=\"1\"/>\n<calibration rising=\"0\"/>\n"
      "<wobble/></joint>\n"  // 12
      "<link_order a=\"b\"/></robot>");
  EXPECT_TRUE(l.reports("2 x <gazebo>", DYN_REPORT_LEVEL_INFO, 2));
  EXPECT_TRUE(l.reports("1 x <transmission>", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_TRUE(l.reports("1 x <material>", DYN_REPORT_LEVEL_INFO, 5));
  EXPECT_TRUE(l.reports("joint 'j': <dynamics>: element <damping> is not used", DYN_REPORT_LEVEL_DROPPED, 9));
  EXPECT_TRUE(l.reports("1 x <safety_controller>", DYN_REPORT_LEVEL_INFO, 10));
  EXPECT_TRUE(l.reports("1 x <calibration>", DYN_REPORT_LEVEL_INFO, 11));
  EXPECT_TRUE(l.reports("joint 'j': <joint>: element <wobble> is not used", DYN_REPORT_LEVEL_DROPPED, 12));
  EXPECT_TRUE(l.reports("<link_order> is not used", DYN_REPORT_LEVEL_DROPPED, 13));
  const auto all = l.report();
  for (size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].line, all[i].line);
}

TEST(Urdf, CleanFileHasAnEmptyReportAlsoStrictly) {
  const Loaded l = good(robot(ab + joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 1\"/>")), Options(DYN_BASE_FIXED, true));
  for (const Entry& e : l.report()) ADD_FAILURE() << e.message;
}

// Damping, dry friction and limits are kept. One report entry each says how they are applied, also under strict.
TEST(Urdf, ReportOfWhatIsKeptAsData) {
  const std::string axis = "<axis xyz=\"0 0 1\"/>";
  const Loaded l = good(robot(ab + link("c") + link("d") +
                              joint("j", "revolute", "a", "b", axis + limit + "<dynamics damping=\"1\" friction=\"0\"/>") +
                              joint("k", "continuous", "b", "c",
                                    axis + "<limit velocity=\"2\" effort=\"3\"/><dynamics damping=\"2\" friction=\"3\"/>") +
                              joint("l", "revolute", "c", "d", axis + limit + "<mimic joint=\"j\"/>")),
                        Options(DYN_BASE_FIXED, true));
  EXPECT_TRUE(l.reports("acts in steps, and in algorithms when its effect is switched on: 2 x damping, 1 x dry friction",
                        DYN_REPORT_LEVEL_INFO, 0));
  EXPECT_TRUE(l.reports("kept as data, not applied by the algorithms: 2 x velocity limit, 2 x effort limit",
                        DYN_REPORT_LEVEL_INFO, 0));
  EXPECT_TRUE(l.reports("1 x <limit> of a mimicking joint: not kept", DYN_REPORT_LEVEL_INFO, 8));
  EXPECT_EQ(3, l.report().size());
}

TEST(Urdf, StrictAcceptsWhatIsNoPhysics) {
  good(robot("<gazebo><plugin/></gazebo><transmission/><material name=\"red\"><color rgba=\"1 0 0 1\"/></material>" +
             link("a", solid + "<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"red\"/></visual>") +
             link("b", "") + joint("j", "fixed", "a", "b", "<safety_controller k_velocity=\"1\"/><axis xyz=\"0 0 0\"/>")),
       Options(DYN_BASE_FIXED, true));
}

TEST(Urdf, StrictListsTheFirstFewAndCountsTheRest) {
  std::string text = "<robot name=\"r\">\n" + link("a");
  for (int i = 0; i < 20; ++i) text += "<unknown" + std::to_string(i) + "/>\n";
  const Loaded l = load(text + "</robot>", Options(DYN_BASE_FIXED, true));
  EXPECT_EQ(DYN_ERROR_STRICT, l.status);
  EXPECT_NE(std::string::npos, l.error.find("line 3")) << l.error;
  EXPECT_NE(std::string::npos, l.error.find("15 more")) << l.error;
}

TEST(Urdf, DoubtfulInertiasAreReported) {
  const auto of = [](const std::string& mass, const std::string& xx, const std::string& yy, const std::string& zz) {
    return robot(link("base") +
                 link("a", "\n<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" +
                               yy + "\" iyz=\"0\" izz=\"" + zz + "\"/></inertial>") +
                 joint("j", "fixed", "base", "a"));
  };
  EXPECT_TRUE(
      good(of("1", "0.1", "0.1", "0.5")).reports("principal moments of inertia are 0.1, 0.1, 0.5", DYN_REPORT_LEVEL_DROPPED, 4));
  EXPECT_TRUE(
      good(of("1", "-0.01", "0.1", "0.1")).reports("no negative one", DYN_REPORT_LEVEL_DROPPED, 4));  // welded to the world
  EXPECT_TRUE(good(of("2", "0", "0", "0")).reports("a point mass", DYN_REPORT_LEVEL_INFO, 4));
  EXPECT_EQ(0, good(of("1", "0.1", "0.2", "0.3")).warnings());                 // a flat body
  EXPECT_EQ(0, good(of("1", "0", "0.1", "0.1")).warnings());                   // a rod
  EXPECT_EQ(0, good(of("1", "0.123457", "0.234567", "0.358024")).warnings());  // and one rounded to six digits
  EXPECT_TRUE(good(robot(link("base") + link("frame", "") + joint("j", "fixed", "base", "frame")))
                  .reports("link 'frame' has no <inertial>", DYN_REPORT_LEVEL_INFO, 3));
}

TEST(Urdf, InertiaWithoutMassIsReported) {
  const Loaded l = good(robot(
      link("a") +
      link("b",
           "\n<inertial><mass value=\"0\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>") +
      joint("j", "fixed", "a", "b")));
  EXPECT_TRUE(l.reports("rotational inertia but no mass", DYN_REPORT_LEVEL_DROPPED, 4));
}

TEST(Urdf, NegativeInertiaIsBearableWhereAWeldMakesUpForIt) {
  const auto text = [](const std::string& mass) {
    return robot(
        link("base") + link("arm") + joint("j", "revolute", "base", "arm") +
        link("antenna", "\n<inertial><origin xyz=\"0 0 0.1\"/><mass value=\"" + mass +
                            "\"/><inertia ixx=\"-3e-8\" ixy=\"0\" ixz=\"0\" iyy=\"3e-8\" iyz=\"0\" izz=\"9e-8\"/></inertial>") +
        joint("k", "fixed", "arm", "antenna"));
  };
  EXPECT_TRUE(good(text("1e-6")).reports("make up for it", DYN_REPORT_LEVEL_DROPPED, 6));
  EXPECT_EQ(DYN_ERROR_STRICT, load(text("1e-6"), Options(DYN_BASE_FIXED, true)).status);
}

TEST(Urdf, AFollowersMassIsItsLeaders) {
  const std::string turn = "<axis xyz=\"0 0 1\"/>" + limit;
  good(robot(link("a") + link("knob", "") + link("c") + joint("lead", "revolute", "a", "knob", turn) +
             joint("f", "revolute", "a", "c", turn + "<mimic joint=\"lead\"/>")));
}

}  // namespace
}  // namespace dyn_test
