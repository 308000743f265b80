// What the builder refuses: the status, and a message that says what, where and what to do. A refusal leaves the builder usable.
#include <functional>

#include "common/random_tree.hpp"

namespace dyn_test {
namespace {

constexpr std::array<double, 9> unit = {1, 0, 0, 0, 1, 0, 0, 0, 1};
const double nan = std::nan("");

JointSpec joint(const std::string& name, const std::string& parent = "", dynJointType type = DYN_JOINT_TYPE_REVOLUTE) {
  JointSpec s;
  s.name = name, s.parent.name = parent, s.type = type;
  return s;
}
JointSpec with(const std::function<void(JointSpec&)>& change, dynJointType type = DYN_JOINT_TYPE_REVOLUTE) {
  JointSpec s = joint("j", "", type);
  change(s);
  return s;
}
void link(Builder& b, const std::string& name, const std::string& parent, double mass = 1) {
  b.body(name, {parent, 0}, identity_placement, mass, {0.1, 0, 0}, mass > 0 ? unit : std::array<double, 9>{});
}

struct Case {
  const char* name;
  dynStatus status;
  std::vector<std::string> fragments;
  std::function<void(Builder&)> act;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

Case bad_joint(const char* name, dynStatus status, std::vector<std::string> fragments,
               const std::function<void(JointSpec&)>& change, dynJointType type = DYN_JOINT_TYPE_REVOLUTE) {
  fragments.insert(fragments.begin(), "joint 'j'");
  return {name, status, fragments, [=](Builder& b) { b.joint(with(change, type)); }};
}

Placement mirrored() {
  Placement p = identity_placement;
  p[0] = -1;
  return p;
}
Placement stretched() {
  Placement p = identity_placement;
  p[4] = 1.001;
  return p;
}
JointSpec part(dynJointType type) { return joint("", "", type); }

const Case cases[] = {
    // names
    {"JointWithoutName", DYN_ERROR_ARGUMENT, {"joint has no name", "give one"}, [](Builder& b) { b.joint(joint("")); }},
    {"BodyWithoutName", DYN_ERROR_ARGUMENT, {"body has no name"}, [](Builder& b) { link(b, "", ""); }},
    {"FrameWithoutName", DYN_ERROR_ARGUMENT, {"frame has no name"}, [](Builder& b) { b.frame("", {}, identity_placement, DYN_FRAME_TYPE_OP_FRAME); }},
    {"ZeroByte", DYN_ERROR_ARGUMENT, {"zero byte"}, [](Builder& b) { b.joint(joint(std::string("a\0b", 3))); }},
    {"JointNamedUniverse", DYN_ERROR_NAME, {"'universe' is the world's"}, [](Builder& b) { b.joint(joint("universe")); }},
    {"JointTwice", DYN_ERROR_NAME, {"joint 'ok'", "'ok' is taken"}, [](Builder& b) { b.joint(joint("ok")); }},
    {"BodyTwice", DYN_ERROR_NAME, {"body 'ok_link'", "is taken"}, [](Builder& b) { link(b, "ok_link", "ok"); }},
    {"FrameNamedAsAJoint", DYN_ERROR_NAME, {"frame 'ok'", "is taken"}, [](Builder& b) { b.frame("ok", {}, identity_placement, DYN_FRAME_TYPE_OP_FRAME); }},
    {"FixedJointTwice", DYN_ERROR_NAME, {"joint 'ok'", "is taken"}, [](Builder& b) { b.joint(joint("ok", "", DYN_JOINT_TYPE_FIXED)); }},
    {"JointWithoutParent", DYN_ERROR_NAME, {"joint 'j'", "no parent 'nobody'", "add it first"}, [](Builder& b) { b.joint(joint("j", "nobody")); }},
    {"BodyWithoutParent", DYN_ERROR_NAME, {"body 'l'", "no parent 'nobody'"}, [](Builder& b) { link(b, "l", "nobody"); }},
    {"FrameWithoutParent", DYN_ERROR_NAME, {"frame 'f'", "no parent 'nobody'"}, [](Builder& b) { b.frame("f", {"nobody", 0}, identity_placement, DYN_FRAME_TYPE_OP_FRAME); }},
    {"ParentOfAnotherType", DYN_ERROR_NAME, {"no parent 'ok'"}, [](Builder& b) { b.frame("f", {"ok", DYN_FRAME_TYPE_BODY}, identity_placement, DYN_FRAME_TYPE_OP_FRAME); }},
    {"ItsOwnParent", DYN_ERROR_NAME, {"joint 'j'", "no parent 'j'"}, [](Builder& b) { b.joint(joint("j", "j")); }},
    {"FrameOfAJointsType", DYN_ERROR_ARGUMENT, {"frame 'f'", "OP_FRAME or SENSOR"}, [](Builder& b) { b.frame("f", {}, identity_placement, DYN_FRAME_TYPE_JOINT); }},
    // geometry
    bad_joint("PlacementNaN", DYN_ERROR_NONFINITE, {"placement[3] is nan", "give a finite number"}, [](JointSpec& s) { s.placement[3] = nan; }),
    bad_joint("PlacementInfinite", DYN_ERROR_NONFINITE, {"placement[11] is -inf"}, [](JointSpec& s) { s.placement[11] = -infinity; }),
    bad_joint("PlacementStretched", DYN_ERROR_INVALID, {"placement is not a rotation", "orthonormal"}, [](JointSpec& s) { s.placement = stretched(); }),
    bad_joint("PlacementMirrored", DYN_ERROR_INVALID, {"placement is not a rotation", "right-handed"}, [](JointSpec& s) { s.placement = mirrored(); }),
    bad_joint("PlacementZero", DYN_ERROR_INVALID, {"placement is not a rotation"}, [](JointSpec& s) { s.placement = Placement{}; }),
    {"BodyPlacement", DYN_ERROR_INVALID, {"body 'l'", "not a rotation"}, [](Builder& b) { b.body("l", {"ok", 0}, mirrored(), 1, {0, 0, 0}, unit); }},
    {"FramePlacement", DYN_ERROR_INVALID, {"frame 'f'", "not a rotation"}, [](Builder& b) { b.frame("f", {"ok", 0}, mirrored(), DYN_FRAME_TYPE_SENSOR); }},
    bad_joint("AxisZero", DYN_ERROR_INVALID, {"axis is zero", "(0, 0, 1)"}, [](JointSpec& s) { s.axis = {0, 0, 0}; }),
    bad_joint("AxisNaN", DYN_ERROR_NONFINITE, {"axis[1] is nan"}, [](JointSpec& s) { s.axis = {0, nan, 1}; }),
    bad_joint("UniversalParallel", DYN_ERROR_INVALID, {"axis and axis2 are parallel"}, [](JointSpec& s) { s.axis = {1, 0, 0}, s.axis2 = {-2, 0, 0}; }, DYN_JOINT_TYPE_UNIVERSAL),
    bad_joint("UniversalAxis2Zero", DYN_ERROR_INVALID, {"axis2 is zero"}, [](JointSpec& s) { s.axis2 = {0, 0, 0}; }, DYN_JOINT_TYPE_UNIVERSAL),
    bad_joint("PitchInfinite", DYN_ERROR_NONFINITE, {"pitch is inf", "metres per radian"}, [](JointSpec& s) { s.pitch = infinity; }, DYN_JOINT_TYPE_HELICAL),
    bad_joint("UnknownType", DYN_ERROR_ARGUMENT, {"unknown joint type 99"}, [](JointSpec& s) { s.type = dynJointType(99); }),
    // numbers per coordinate
    bad_joint("LowerSize", DYN_ERROR_SIZE, {"lower limit has 2 numbers, needs 1"}, [](JointSpec& s) { s.lower = {0, 0}; }),
    bad_joint("UpperSize", DYN_ERROR_SIZE, {"upper limit has 1 numbers, needs 4"}, [](JointSpec& s) { s.upper = {0}; }, DYN_JOINT_TYPE_SPHERICAL),
    bad_joint("VelocitySize", DYN_ERROR_SIZE, {"velocity limit has 4 numbers, needs 3"}, [](JointSpec& s) { s.velocity = {0, 0, 0, 0}; }, DYN_JOINT_TYPE_SPHERICAL),
    bad_joint("LowerNaN", DYN_ERROR_NONFINITE, {"lower limit is NaN"}, [](JointSpec& s) { s.lower = {nan}; }),
    bad_joint("LowerAboveUpper", DYN_ERROR_INVALID, {"lower limit 2 exceeds upper limit 1"}, [](JointSpec& s) { s.lower = {2}, s.upper = {1}; }),
    bad_joint("UpperNaN", DYN_ERROR_NONFINITE, {"upper limit is NaN"}, [](JointSpec& s) { s.upper = {nan}; }),
    bad_joint("LowerInfinite", DYN_ERROR_NONFINITE, {"lower limit is inf", "-inf for none"}, [](JointSpec& s) { s.lower = {infinity}; }),
    bad_joint("UpperMinusInfinite", DYN_ERROR_NONFINITE, {"upper limit is -inf", "inf for none"}, [](JointSpec& s) { s.upper = {-infinity}; }),
    bad_joint("BothInfinite", DYN_ERROR_NONFINITE, {"lower limit is inf"}, [](JointSpec& s) { s.lower = s.upper = {infinity}; }),
    bad_joint("LimitOfOneCoordinate", DYN_ERROR_NONFINITE, {"upper limit[2] is -inf"}, [](JointSpec& s) { s.upper = {1, infinity, -infinity}; }, DYN_JOINT_TYPE_TRANSLATION),
    bad_joint("VelocityNegative", DYN_ERROR_INVALID, {"velocity limit is -1", "can't be negative"}, [](JointSpec& s) { s.velocity = {-1}; }),
    bad_joint("EffortNegative", DYN_ERROR_INVALID, {"effort limit is -1"}, [](JointSpec& s) { s.effort = {-1}; }),
    bad_joint("ArmatureNegative", DYN_ERROR_INVALID, {"armature is -0.1"}, [](JointSpec& s) { s.armature = {-0.1}; }),
    bad_joint("ArmatureInfinite", DYN_ERROR_NONFINITE, {"armature is inf"}, [](JointSpec& s) { s.armature = {infinity}; }),
    bad_joint("DampingNegative", DYN_ERROR_INVALID, {"damping is -1"}, [](JointSpec& s) { s.damping = {-1}; }),
    bad_joint("DampingInfinite", DYN_ERROR_NONFINITE, {"damping"}, [](JointSpec& s) { s.damping = {infinity}; }),
    bad_joint("FrictionNegative", DYN_ERROR_INVALID, {"friction is -1"}, [](JointSpec& s) { s.friction = {-1}; }),
    bad_joint("RotorNegative", DYN_ERROR_INVALID, {"rotor inertia is -1"}, [](JointSpec& s) { s.rotor_inertia = -1; }),
    bad_joint("RotorNaN", DYN_ERROR_NONFINITE, {"rotor inertia and gear ratio must be finite"}, [](JointSpec& s) { s.gear_ratio = nan; }),
    bad_joint("RotorOverflow", DYN_ERROR_NONFINITE, {"rotor"}, [](JointSpec& s) { s.rotor_inertia = 1e200, s.gear_ratio = 1e100; }),
    bad_joint("RotorOfABall", DYN_ERROR_INVALID, {"one degree of freedom"}, [](JointSpec& s) { s.rotor_inertia = 1; }, DYN_JOINT_TYPE_SPHERICAL),
    // composite
    bad_joint("CompositeOfNothing", DYN_ERROR_ARGUMENT, {"at least one part"}, [](JointSpec&) {}, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositeOfFixedOnly", DYN_ERROR_ARGUMENT, {"part"}, [](JointSpec& s) { s.parts = {part(DYN_JOINT_TYPE_FIXED)}; }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositeEndsFixed", DYN_ERROR_INVALID, {"can't end with a fixed part"}, [](JointSpec& s) { s.parts = {part(DYN_JOINT_TYPE_REVOLUTE), part(DYN_JOINT_TYPE_FIXED)}, s.parts[1].placement[10] = 1; }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositePartAxis", DYN_ERROR_INVALID, {"part 1", "axis is zero"}, [](JointSpec& s) { s.parts = {part(DYN_JOINT_TYPE_REVOLUTE), part(DYN_JOINT_TYPE_PRISMATIC)}, s.parts[1].axis = {0, 0, 0}; }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositePartPlacement", DYN_ERROR_INVALID, {"part 0", "not a rotation"}, [](JointSpec& s) { s.parts = {part(DYN_JOINT_TYPE_REVOLUTE)}, s.parts[0].placement = mirrored(); }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositePartType", DYN_ERROR_ARGUMENT, {"part 0", "unknown joint type 77"}, [](JointSpec& s) { s.parts = {part(dynJointType(77))}; }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("CompositeTooLong", DYN_ERROR_LIMIT, {"more than 1000"}, [](JointSpec& s) { s.parts.assign(1100, part(DYN_JOINT_TYPE_REVOLUTE)); }, DYN_JOINT_TYPE_COMPOSITE),
    bad_joint("FixedMimic", DYN_ERROR_INVALID, {"a fixed joint can't mimic 'ok'"}, [](JointSpec& s) { s.mimic = "ok"; }, DYN_JOINT_TYPE_FIXED),
    // bodies
    {"MassNegative", DYN_ERROR_INVALID, {"body 'l'", "mass is -1 kg"}, [](Builder& b) { link(b, "l", "ok", -1); }},
    {"MassNaN", DYN_ERROR_NONFINITE, {"body 'l'", "mass is nan"}, [](Builder& b) { b.body("l", {"ok", 0}, identity_placement, nan, {0, 0, 0}, unit); }},
    {"ComInfinite", DYN_ERROR_NONFINITE, {"body 'l'", "com[2] is inf"}, [](Builder& b) { b.body("l", {"ok", 0}, identity_placement, 1, {0, 0, infinity}, unit); }},
    {"InertiaNaN", DYN_ERROR_NONFINITE, {"body 'l'", "inertia[8] is nan"}, [](Builder& b) { b.body("l", {"ok", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, nan}); }},
    {"InertiaAsymmetric", DYN_ERROR_INVALID, {"body 'l'", "not symmetric"}, [](Builder& b) { b.body("l", {"ok", 0}, identity_placement, 1, {0, 0, 0}, {1, 0.1, 0, 0, 1, 0, 0, 0, 1}); }},
    // the rest
    {"GravityNaN", DYN_ERROR_NONFINITE, {"gravity[1] is nan"}, [](Builder& b) { b.gravity({0, nan, 0}); }},
    {"ShapeWithoutBody", DYN_ERROR_NAME, {"shape of body 'nobody'"}, [](Builder& b) { Shape s; s.body = "nobody"; b.shape(s); }},
    {"ShapeOnAJoint", DYN_ERROR_NAME, {"shape of body 'ok'"}, [](Builder& b) { Shape s; s.body = "ok"; b.shape(s); }},
    {"ShapeSizeNaN", DYN_ERROR_NONFINITE, {"size[0] is nan"}, [](Builder& b) { Shape s; s.body = "ok_link"; s.size = {nan, 0, 0}; b.shape(s); }},
    {"ConfigurationNeutral", DYN_ERROR_NAME, {"'neutral' is always there"}, [](Builder& b) { b.configuration("neutral", {0}); }},
    {"ConfigurationTwice", DYN_ERROR_NAME, {"configuration 'home' is there already"}, [](Builder& b) { b.configuration("home", {0}); }},
    {"ConfigurationNaN", DYN_ERROR_NONFINITE, {"configuration 'x'[0] is nan"}, [](Builder& b) { b.configuration("x", {nan}); }},
    {"ConfigurationWithoutName", DYN_ERROR_ARGUMENT, {"configuration has no name"}, [](Builder& b) { b.configuration("", {0}); }},
};

class Refusal : public testing::TestWithParam<Case> {};

TEST_P(Refusal, SaysWhatWhereAndLeavesTheBuilderUsable) {
  Builder b("refusal");
  b.joint(joint("ok"));
  link(b, "ok_link", "ok");
  b.configuration("home", {0.5});
  try {
    GetParam().act(b);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(GetParam().status, e.status) << e.what();
    for (const std::string& fragment : GetParam().fragments)
      EXPECT_NE(std::string::npos, std::string(e.what()).find(fragment)) << "'" << fragment << "' is not in: " << e.what();
  }
  const ModelPtr m = b.finish();
  EXPECT_EQ(2, m->n.joints);
  EXPECT_EQ(3, m->n.frames) << "universe, ok, ok_link: nothing of what was refused";
  EXPECT_EQ(1, m->n.nv);
}
INSTANTIATE_TEST_SUITE_P(Builder, Refusal, testing::ValuesIn(cases), [](const auto& p) { return std::string(p.param.name); });

// What only the whole shows.
std::string refused(const Builder& b, dynStatus status) {
  try {
    b.finish();
  } catch (const Error& e) {
    EXPECT_EQ(status, e.status) << e.what();
    return e.what();
  }
  return "accepted";
}
#define EXPECT_SAYS(fragment, message) EXPECT_NE(std::string::npos, (message).find(fragment)) << (message)

TEST(Finish, AConfigurationOfAnotherSize) {
  Builder b("size");
  b.joint(joint("j"));
  link(b, "l", "j");
  b.configuration("home", {1, 2});
  EXPECT_SAYS("configuration 'home' has 2 numbers, the model needs nq = 1", refused(b, DYN_ERROR_SIZE));
}

TEST(Finish, AConfigurationWithAZeroQuaternion) {
  for (dynJointType type :
       {DYN_JOINT_TYPE_SPHERICAL, DYN_JOINT_TYPE_FREE_FLYER, DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED, DYN_JOINT_TYPE_COMPOSITE}) {
    Builder b("zero");
    b.joint(joint("first"));
    link(b, "first_link", "first");
    JointSpec odd = joint("odd", "first", type);
    if (type == DYN_JOINT_TYPE_COMPOSITE) odd.parts = {part(DYN_JOINT_TYPE_PRISMATIC), part(DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED)};
    b.joint(odd);
    link(b, "odd_link", "odd");
    b.configuration("good", std::vector<double>(std::size_t(1 + spec_nq(odd)), 0.5));
    EXPECT_EQ(2, b.finish()->n.configurations);
    b.configuration("home", std::vector<double>(std::size_t(1 + spec_nq(odd)), 0.0));
    const std::string message = refused(b, DYN_ERROR_QUATERNION);
    EXPECT_SAYS("configuration 'home'", message);
    EXPECT_SAYS("joint 'odd'", message);
    EXPECT_SAYS("give one of norm 1, such as that of 'neutral'", message);
  }
}

TEST(Finish, AMasslessLeafIsNamed) {
  for (bool armature : {false, true}) {
    Builder b("leaf");
    b.joint(joint("base"));
    link(b, "base_link", "base");
    JointSpec leaf = joint("leaf", "base");
    if (armature) leaf.armature = {0.01};
    b.joint(leaf);
    link(b, "leaf_link", "leaf", 0);
    b.joint(joint("other", "base"));
    link(b, "other_link", "other");
    if (armature) {
      EXPECT_EQ(3, b.finish()->n.nv);  // a rotor makes it well-defined
    } else {
      const std::string message = refused(b, DYN_ERROR_INVALID);
      EXPECT_SAYS("joint 'leaf'", message);
      EXPECT_SAYS("'leaf_link'", message);
      EXPECT_SAYS("give the links an inertial", message);
    }
  }
}

TEST(Finish, AMasslessLeafIsNamedInAModelWithMimic) {
  // the factor of M finds it there, another way than along the tree
  Builder b("mimic");
  b.joint(joint("base"));
  link(b, "base_link", "base");
  JointSpec follower = joint("follower", "base");
  follower.mimic = "base", follower.mimic_ratio = -1.5;
  b.joint(follower);
  link(b, "follower_link", "follower");
  b.joint(joint("good", "base"));
  link(b, "good_link", "good");
  b.joint(joint("leaf", "good"));
  link(b, "leaf_link", "leaf", 0);
  EXPECT_SAYS("joint 'leaf'", refused(b, DYN_ERROR_INVALID));
}

TEST(Finish, AMasslessLeafInTheMiddleOfTheOrder) {
  Builder b("middle");
  for (const char* name : {"a", "b", "c"}) b.joint(joint(name));
  link(b, "a_link", "a");
  link(b, "b_link", "b", 0);
  link(b, "c_link", "c");
  EXPECT_SAYS("joint 'b'", refused(b, DYN_ERROR_INVALID));
}

TEST(Finish, APointMassOnItsAxisDoesNotResistTurning) {
  Builder b("point");
  b.joint(joint("j"));
  b.body("point", {"j", 0}, identity_placement, 1, {0, 0, 0.5}, {});  // on the axis z
  EXPECT_SAYS("joint 'j'", refused(b, DYN_ERROR_INVALID));
  Builder off("off");
  off.joint(joint("j"));
  off.body("point", {"j", 0}, identity_placement, 1, {0.1, 0, 0.5}, {});
  EXPECT_EQ(1, off.finish()->n.nv);
  Builder slide("slide");
  slide.joint(joint("j", "", DYN_JOINT_TYPE_PRISMATIC));
  slide.body("point", {"j", 0}, identity_placement, 1, {0, 0, 0.5}, {});
  EXPECT_EQ(1, slide.finish()->n.nv);
}

TEST(Finish, JointsWithoutMassBetweenOthersAreFine) {
  Builder b("between");
  b.joint(joint("a"));
  JointSpec second = joint("b", "a"), third = joint("c", "b");
  second.axis = {1, 0, 0}, third.axis = {0, 1, 0};
  b.joint(second);
  b.joint(third);
  link(b, "hand", "c");
  EXPECT_EQ(3, b.finish()->n.nv);
}

TEST(Finish, TooManyJointsForOneBody) {
  // two sliders along one line: one of them resists nothing
  Builder b("redundant");
  b.joint(joint("a", "", DYN_JOINT_TYPE_PRISMATIC));
  b.joint(joint("b", "a", DYN_JOINT_TYPE_PRISMATIC));
  link(b, "hand", "b");
  EXPECT_SAYS("joint 'a'", refused(b, DYN_ERROR_INVALID));
}

TEST(Finish, AnImpossibleInertia) {
  Builder b("negative");
  b.joint(joint("j"));
  b.body("odd", {"j", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, -0.5, 0, 0, 0, 1});
  const std::string message = refused(b, DYN_ERROR_INVALID);
  EXPECT_SAYS("joint 'j'", message);
  EXPECT_SAYS("'odd'", message);
  EXPECT_SAYS("negative principal moment -0.5", message);
}

TEST(Finish, LightAndHeavyRobotsAreNotMistakenForMassless) {
  for (const auto& [length, mass] : std::vector<std::pair<double, double>>{{1e-6, 1e-9}, {1e-3, 1e-3}, {1e6, 1e9}})
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
      EXPECT_NO_THROW(random_tree(seed).scaled(length, mass).build()) << length << ", " << mass << ", " << seed;
}

}  // namespace
}  // namespace dyn_test
