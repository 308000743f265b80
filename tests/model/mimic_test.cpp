// How mimic joints are resolved: chains of them, followers before their leaders, what they add to the leader.
#include "common/random_tree.hpp"

namespace dyn_test::mimic_test {
namespace {

JointSpec hinge(const std::string& name, const std::string& parent = "", const std::string& mimic = "", double ratio = 1,
                double offset = 0) {
  JointSpec s;
  s.name = name, s.parent.name = parent, s.mimic = mimic, s.mimic_ratio = ratio, s.mimic_offset = offset;
  return s;
}
ModelPtr build(const std::vector<JointSpec>& joints) {
  Builder b("mimic");
  for (const JointSpec& s : joints) {
    b.joint(s);
    b.body(s.name + "_link", {s.name, 0}, identity_placement, 1, {0.1, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
  return b.finish();
}
std::string refusal(const std::vector<JointSpec>& joints, dynStatus status) {
  try {
    build(joints);
  } catch (const Error& e) {
    EXPECT_EQ(status, e.status);
    return e.what();
  }
  return "";
}

TEST(Mimic, FollowersHaveNoCoordinatesOfTheirOwn) {
  const ModelPtr m = build({hinge("a"), hinge("b", "a", "a", -2, 0.5), hinge("c", "b")});
  EXPECT_EQ(2, m->n.nq);
  EXPECT_EQ(2, m->n.nv);
  EXPECT_EQ(3, m->n.nvx);
  EXPECT_TRUE(m->has_mimic);
  const JointRecord& b = m->joints()[2];
  EXPECT_EQ(0, b.nq);
  EXPECT_EQ(0, b.nv);
  EXPECT_EQ(1, b.leader);
  EXPECT_EQ(0, b.idx_q);
  EXPECT_EQ(-2, b.ratio);
  EXPECT_EQ(0.5, b.offset);
  EXPECT_EQ(1, m->joints()[3].idx_q);
  EXPECT_EQ(-1, m->joints()[3].leader);
}

TEST(Mimic, ChainsCompose) {
  // c = 3 b + 1, b = 2 a - 0.5: c = 6 a - 0.5
  const ModelPtr m = build({hinge("a"), hinge("b", "a", "a", 2, -0.5), hinge("c", "b", "b", 3, 1)});
  EXPECT_EQ(1, m->joints()[3].leader);
  EXPECT_EQ(6, m->joints()[3].ratio);
  EXPECT_EQ(-0.5, m->joints()[3].offset);
  EXPECT_EQ(1, m->n.nv);
}

TEST(Mimic, AFollowerMayComeBeforeItsLeader) {
  const ModelPtr m =
      build({hinge("first", "", "last", 0.5, 0.1), hinge("middle", "first", "first", -1, 0), hinge("last", "middle")});
  EXPECT_EQ(1, m->n.nv);
  EXPECT_EQ(3, m->joints()[1].leader);
  EXPECT_EQ(3, m->joints()[2].leader);
  EXPECT_EQ(-0.5, m->joints()[2].ratio);
  EXPECT_EQ(-0.1, m->joints()[2].offset);
  EXPECT_EQ(0, m->joints()[3].idx_q);
}

TEST(Mimic, RotorsAndDampingMoveToTheLeader) {
  JointSpec a = hinge("a"), b = hinge("b", "a", "a", -2, 0);
  a.armature = {0.5}, a.damping = {1}, a.friction = {1};
  b.armature = {0.1}, b.damping = {0.2}, b.friction = {0.3}, b.rotor_inertia = 1e-3, b.gear_ratio = 10;
  const ModelPtr m = build({a, b});
  EXPECT_DOUBLE_EQ(0.5 + 4 * (0.1 + 0.1), m->armature()[0]);
  EXPECT_DOUBLE_EQ(1 + 4 * 0.2, m->damping()[0]);
  EXPECT_DOUBLE_EQ(1 + 2 * 0.3, m->friction()[0]);
}

TEST(Mimic, AnyJointOfOneCoordinateTakesPart) {
  for (dynJointType leader :
       {DYN_JOINT_TYPE_REVOLUTE, DYN_JOINT_TYPE_CONTINUOUS, DYN_JOINT_TYPE_PRISMATIC, DYN_JOINT_TYPE_HELICAL})
    for (dynJointType follower :
         {DYN_JOINT_TYPE_REVOLUTE, DYN_JOINT_TYPE_CONTINUOUS, DYN_JOINT_TYPE_PRISMATIC, DYN_JOINT_TYPE_HELICAL}) {
      JointSpec a = hinge("a"), b = hinge("b", "a", "a", 1.5, 0);
      a.type = leader, b.type = follower, a.pitch = b.pitch = 0.1;
      EXPECT_EQ(1, build({a, b})->n.nv);
    }
  JointSpec whole = hinge("whole", "", "a", 2, 0), part;
  part.axis = {0, 1, 0};
  whole.type = DYN_JOINT_TYPE_COMPOSITE, whole.parts = {part};
  EXPECT_EQ(1, build({hinge("a"), whole})->n.nv);
}

TEST(Mimic, WhatCannotFollow) {
  EXPECT_NE(std::string::npos, refusal({hinge("a", "", "b"), hinge("b", "a", "a")}, DYN_ERROR_INVALID).find("circle"));
  EXPECT_NE(std::string::npos,
            refusal({hinge("a", "", "c"), hinge("b", "a", "a"), hinge("c", "b", "b")}, DYN_ERROR_INVALID).find("circle"));
  EXPECT_NE(std::string::npos, refusal({hinge("a", "", "a")}, DYN_ERROR_INVALID).find("joint 'a': it mimics itself"));
  EXPECT_NE(std::string::npos, refusal({hinge("a", "", "nobody")}, DYN_ERROR_NAME).find("joint 'a': mimics 'nobody'"));
  EXPECT_NE(std::string::npos, refusal({hinge("a", "", "a_link")}, DYN_ERROR_NAME).find("a_link")) << "a link is no joint";
  JointSpec ball = hinge("ball");
  ball.type = DYN_JOINT_TYPE_SPHERICAL;
  EXPECT_NE(std::string::npos,
            refusal({ball, hinge("a", "ball", "ball")}, DYN_ERROR_INVALID).find("'ball', which has more than one coordinate"));
  JointSpec wheel = hinge("wheel");
  wheel.type = DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
  EXPECT_NE(std::string::npos, refusal({wheel, hinge("a", "wheel", "wheel")}, DYN_ERROR_INVALID).find("'wheel'"));
  ball.mimic = "a";
  EXPECT_NE(std::string::npos, refusal({hinge("a"), ball}, DYN_ERROR_INVALID).find("this is spherical"));
  EXPECT_NE(std::string::npos,
            refusal({hinge("a"), hinge("b", "a", "a", std::nan(""), 0)}, DYN_ERROR_NONFINITE).find("mimic ratio nan"));
  EXPECT_NE(std::string::npos, refusal({hinge("a"), hinge("b", "a", "a", 1, infinity)}, DYN_ERROR_NONFINITE).find("offset inf"));
}

TEST(Mimic, LongChainsOfMimicAreBounded) {
  std::vector<JointSpec> chain = {hinge("j0")};
  for (int k = 1; k < 900; ++k) chain.push_back(hinge("j" + std::to_string(k), "", "j" + std::to_string(k - 1), 1, 0.001));
  const ModelPtr m = build(chain);
  EXPECT_EQ(1, m->n.nv);
  EXPECT_NEAR(0.899, m->joints()[900 - 0].offset, 1e-12);  // 899 roundings
}

}  // namespace
}  // namespace dyn_test::mimic_test
