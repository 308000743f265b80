// URDF and MJCF: a model that is saved and loaded again moves as before, and losses are reported.
#include <set>

#include "save/same.hpp"

namespace dyn_test {
namespace {

bool lost(const SaveReport& lines, const char* what) {
  return std::any_of(lines.begin(), lines.end(), [&](const SaveEntry& e) {
    return e.level == DYN_REPORT_LEVEL_DROPPED && e.message.find(what) != std::string::npos;
  });
}

// All types of joints that move but these.
std::vector<dynJointType> types_but(std::initializer_list<dynJointType> these) {
  std::vector<dynJointType> types = moving_types();
  for (const dynJointType type : these) std::erase(types, type);
  return types;
}

TEST(Urdf, RobotsComeBack) {
  for (const auto& [path, base] : robots()) {
    SCOPED_TRACE(path);
    const ModelPtr m = robot(path, base);
    const ModelPtr back = again(*m, DYN_FORMAT_URDF, base);
    expect_same(*m, *back, 3, true);
    EXPECT_EQ(m->n.joints, back->n.joints);
    EXPECT_EQ(m->n.frames, back->n.frames);
    EXPECT_EQ(m->n.shapes, back->n.shapes);
    EXPECT_EQ(m->n.pairs, back->n.pairs);
    ASSERT_EQ(m->n.constraints, back->n.constraints);
    for (Index j = 1; j < m->n.joints; ++j) {
      EXPECT_EQ(name_of(*m, j), name_of(*back, j));
      EXPECT_EQ(m->joints()[j].type, back->joints()[j].type);
    }
    for (Index k = 0; k < m->n.constraints; ++k) {
      const dynConstraint &a = m->constraints()[k].spec, &b = back->constraints()[k].spec;
      EXPECT_EQ(a.type, b.type);
      EXPECT_EQ(a.stiffness, b.stiffness);
      EXPECT_EQ(a.damping, b.damping);
      for (int i = 0; i < 12; ++i) {
        EXPECT_NEAR(a.placement1[i], b.placement1[i], 1e-14);
        EXPECT_NEAR(a.placement2[i], b.placement2[i], 1e-14);
      }
    }
  }
}

TEST(Urdf, TreesOfAllJointsComeBack) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    TreeOptions options;
    options.resistance = 0.3, options.armature = 0;
    options.types = types_but({DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED, DYN_JOINT_TYPE_COMPOSITE});
    Tree tree = random_tree(seed, options);
    for (JointSpec& s : tree.joints) {
      for_each_coefficient([&]<class E>() {  // that URDF lacks
        if (!E::urdf) E::of(s).clear();
      });
      s.spring_reference.clear();
      if (s.type == DYN_JOINT_TYPE_SPHERICAL || s.type == DYN_JOINT_TYPE_FREE_FLYER) s.damping.clear(), s.friction.clear();
    }
    const ModelPtr m = tree.build();
    expect_same(*m, *again(*m, DYN_FORMAT_URDF, DYN_BASE_FIXED), seed, false);
  }
}

TEST(Urdf, CompositesAreChains) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    TreeOptions options;
    options.joints = 6, options.types = {DYN_JOINT_TYPE_COMPOSITE}, options.mimic = 0, options.armature = 0;
    const ModelPtr m = random_tree(seed, options).build();
    bool unbounded = false;
    for (Index i = 1; i < m->n.bodies; ++i) unbounded |= m->bodies()[i].type == BodyType::RevoluteUnbounded;
    if (!unbounded) expect_same(*m, *again(*m, DYN_FORMAT_URDF, DYN_BASE_FIXED), seed, false);
  }
}

TEST(Mjcf, RobotsComeBack) {
  for (const auto& [path, base] : robots()) {
    SCOPED_TRACE(path);
    const ModelPtr m = robot(path, base);
    SaveReport lines;
    const ModelPtr back = again(*m, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED, &lines);
    if (follows(*m)) {
      EXPECT_TRUE(lost(lines, "mimic joints become equalities"));
      EXPECT_EQ(m->n.nvx, back->n.nv);
      continue;
    }
    EXPECT_EQ(m->n.shapes, back->n.shapes);
    if (!lost(lines, "impossible inertias")) expect_same(*m, *back, 5, true);
  }
}

TEST(Mjcf, TreesComeBack) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    TreeOptions options;
    options.joints = 1 + int(seed % 12), options.mimic = 0;
    options.types = types_but({DYN_JOINT_TYPE_HELICAL, DYN_JOINT_TYPE_FREE_FLYER, DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED,
                               DYN_JOINT_TYPE_COMPOSITE});
    Tree tree = random_tree(seed, options);
    for (JointSpec& s : tree.joints)
      if (s.type == DYN_JOINT_TYPE_SPHERICAL) s.armature.assign(s.armature.size(), 0.01);
    const ModelPtr m = tree.build();
    expect_same(*m, *again(*m, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED), seed, false);
    for (Index k = 0; k < 3; ++k) EXPECT_EQ(m->gravity[k], again(*m, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED)->gravity[k]);
  }
}

// Three slides and a ball have the same positions and other velocities.
TEST(Mjcf, FreeJointsOnSomethingKeepTheirCoordinates) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TreeOptions options;
    options.joints = 5, options.mimic = 0, options.types = {DYN_JOINT_TYPE_FREE_FLYER, DYN_JOINT_TYPE_REVOLUTE};
    const ModelPtr m = random_tree(seed, options).build();
    SaveReport lines;
    const ModelPtr back = again(*m, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED, &lines);
    bool free = false;
    for (Index i = 1; i < m->n.bodies; ++i) free |= m->bodies()[i].type == BodyType::FreeFlyer;
    EXPECT_EQ(free, lost(lines, "free joints not on the world"));
    ASSERT_EQ(m->n.nq, back->n.nq);
    const State s(*m, seed);
    const Results x(*m, s.q, VectorXd::Zero(m->n.nv)), y(*back, s.q, VectorXd::Zero(m->n.nv));
    for (Index f = 1; f < m->n.frames; ++f)
      for (Index g = 1; g < back->n.frames; ++g) {
        if (std::strcmp(m->string(m->frames()[f].name), back->string(back->frames()[g].name))) continue;
        EXPECT_LE((x.frames[std::size_t(f)] - y.frames[std::size_t(g)]).cwiseAbs().maxCoeff(), 1e-12);
      }
  }
}

constexpr const char* scene = R"(<mujoco model="scene"><option gravity="0 0.5 -9" density="1.2" viscosity="0.01" wind="1 0 0"/>
<asset><hfield name="hill" nrow="3" ncol="4" size="2 1 0.5 0.2" elevation="0 0 0 0 0.1 0.7 1 0 0 0.2 0 0"/></asset>
<worldbody><geom name="floor" type="plane" size="0 0 1" friction="0.7"/><geom name="hill" type="hfield" hfield="hill" pos="5 0 0"/>
<body name="box" pos="0 0 2" quat="0.6 0.8 0 0" gravcomp="0.5"><freejoint name="free"/><inertial pos="0.1 0 0" mass="2" fullinertia="0.1 0.2 0.25 0.01 0 0.02"/>
  <geom name="cube" type="box" size="0.1 0.2 0.3" contype="3" conaffinity="5"/><site name="corner" pos="0.1 0.2 0.3"/>
  <geom type="ellipsoid" size="0.1 0.2 0.3" contype="0" conaffinity="0" rgba="0.2 0.4 0.6 0.5"/></body>
<body name="arm" pos="1 0 0"><joint name="a" axis="0 1 0" range="-90 45" damping="0.3" frictionloss="0.1" armature="0.02" stiffness="3" springref="20"/>
  <joint name="b" type="slide" axis="1 0 1" pos="0.1 0 0.2"/><inertial pos="0 0 0.3" mass="1" diaginertia="0.1 0.1 0.02"/>
  <geom name="rod" type="capsule" size="0.05 0.2" condim="6" friction="0.5 0.02 0.003"/>
  <body name="ball" pos="0 0 0.5"><joint name="c" type="ball" damping="0.1" range="0 100"/><inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.01"/>
    <geom name="bob" type="sphere" size="0.1"/><site name="tip" pos="0 0 0.2"/></body></body></worldbody>
<contact><exclude body1="arm" body2="box"/><pair geom1="bob" geom2="floor" condim="4" friction="0.9 0.9 0.01 0 0"/></contact>
<equality><connect name="rope" site1="tip" site2="corner" active="false"/><weld name="glue" site1="tip" site2="corner" active="false"/>
  <joint name="couple" joint1="a" joint2="b" polycoef="0.1 2 0 0 0"/></equality>
<actuator><motor name="m" joint="a" gear="3" ctrlrange="-1 2"/><position name="p" joint="b" kp="20" kv="2" timeconst="0.1" forcerange="-5 5"/><velocity name="v" joint="a" kv="3"/>
  <general name="g" joint="b" gainprm="4" biastype="affine" biasprm="1 -2 -3" dyntype="filter" dynprm="0.2"/><motor name="turn" joint="c" gear="0 2 0"/>
  <intvelocity name="i" joint="a" kp="3" kv="1" actrange="-1 2"/><general name="sum" joint="b" dyntype="integrator" gainprm="2" actrange="0 3"/></actuator>
<keyframe><key name="bent" qpos="0 0 1 1 0 0 0 0.3 0.1 0.6 0 0.8 0"/></keyframe></mujoco>)";

TEST(Mjcf, ASceneComesBackWithAllItHas) {
  const ModelPtr m = load_string(scene, {}), back = again(*m, DYN_FORMAT_MJCF, DYN_BASE_UNSPECIFIED);
  expect_same(*m, *back, 7, true);
  const Model &a = *m, &b = *back;
  EXPECT_EQ(a.n.joints, b.n.joints);
  EXPECT_EQ(a.n.frames, b.n.frames);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.viscosity, b.viscosity);
  EXPECT_EQ(a.wind[0], b.wind[0]);
  ASSERT_EQ(a.n.shapes, b.n.shapes);
  for (Index k = 0; k < a.n.shapes; ++k) {
    const ShapeRecord &x = a.shapes()[k], &y = b.shapes()[k];
    EXPECT_STREQ(a.string(x.name), b.string(y.name));
    EXPECT_EQ(x.type, y.type);
    EXPECT_EQ(x.role, y.role);
    EXPECT_EQ(x.contype, y.contype);
    EXPECT_EQ(x.conaffinity, y.conaffinity);
    EXPECT_EQ(x.colour, y.colour);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(x.size[i], y.size[i]);
    EXPECT_EQ(0, std::memcmp(&a.materials()[x.material], &b.materials()[y.material], sizeof(dynMaterial))) << a.string(x.name);
  }
  ASSERT_EQ(a.n.pairs, b.n.pairs);
  for (Index k = 0; k < a.n.pairs; ++k) {
    EXPECT_EQ(a.pairs()[k].wanted(), b.pairs()[k].wanted());
    EXPECT_EQ(a.pairs()[k].reason, b.pairs()[k].reason);
  }
  ASSERT_EQ(a.n.actuators, b.n.actuators);
  for (Index k = 0; k < a.n.actuators; ++k) {
    const ActuatorRecord &x = a.actuators()[k], &y = b.actuators()[k];
    EXPECT_STREQ(a.string(x.name), b.string(y.name));
    EXPECT_EQ(x.v, y.v);
    EXPECT_EQ(x.q, y.q);
    EXPECT_EQ(x.spec.gear, y.spec.gear);
    EXPECT_EQ(x.spec.time_constant, y.spec.time_constant);
    EXPECT_EQ(x.spec.integrates, y.spec.integrates);
    EXPECT_EQ(x.spec.type, y.spec.type);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(x.gain[i], y.gain[i]);
      EXPECT_EQ(x.bias[i], y.bias[i]);
    }
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(x.spec.control_range[i], y.spec.control_range[i]);
      EXPECT_EQ(x.spec.force_range[i], y.spec.force_range[i]);
      EXPECT_EQ(x.spec.act_range[i], y.spec.act_range[i]);
    }
  }
  ASSERT_EQ(a.n.constraints, b.n.constraints);
  for (Index k = 0; k < a.n.constraints; ++k) {
    const dynConstraint &x = a.constraints()[k].spec, &y = b.constraints()[k].spec;
    EXPECT_EQ(x.type, y.type);
    EXPECT_EQ(x.first, y.first);
    EXPECT_EQ(x.second, y.second);
    EXPECT_EQ(x.enabled, y.enabled);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(x.coefficients[i], y.coefficients[i]);
  }
  ASSERT_EQ(a.n.configurations, b.n.configurations);
  for (Index k = 0; k < a.n.configurations * a.n.nq; ++k) EXPECT_NEAR(a.configurations()[k], b.configurations()[k], 1e-15);
  for (Index k = 0; k < a.n.links; ++k) EXPECT_EQ(a.compensation(k), b.compensation(k));
  for (Index k = 0; k < a.n.nv; ++k) {
    EXPECT_EQ(a.stiffness()[k], b.stiffness()[k]);
    EXPECT_EQ(a.armature()[k], b.armature()[k]);
  }
  ASSERT_EQ(a.n.limits, b.n.limits);
  for (Index k = 0; k < a.n.nq; ++k) {
    EXPECT_EQ(a.spring_reference()[k], b.spring_reference()[k]);
    EXPECT_NEAR(std::max(-1e9, a.lower_limit()[k]), std::max(-1e9, b.lower_limit()[k]),
                1e-15);  // a ball's limit is saved as an angle
  }
}

TEST(Urdf, WhatASceneLosesIsSaid) {
  const ModelPtr m = load_string(scene, {});
  SaveReport lines;
  save_string(*m, DYN_FORMAT_URDF, false, lines);
  for (const char* what : {"actuators: 'm', 'p', 'v', 'g', 'turn'", "gravity", "medium", "shapes that are no mesh file",
                           "materials", "masks", "armature of joints: 'a'", "springs of joints: 'a'", "named configurations",
                           "disabled pairs", "gravity compensation of links"})
    EXPECT_TRUE(lost(lines, what)) << what;
  SaveReport none;
  try {
    save_string(*m, DYN_FORMAT_URDF, true, none);
    FAIL() << "strict";
  } catch (const Error& e) {
    EXPECT_EQ(DYN_ERROR_STRICT, e.status);
  }
}

TEST(Urdf, ResistanceOfAFloatingBaseIsLost) {
  for (int k = 0; k < 4; ++k) {
    Builder b("r");
    JointSpec base;
    base.name = "root_joint", base.type = DYN_JOINT_TYPE_FREE_FLYER;
    if (k == 1) base.armature.assign(6, 0.1);
    if (k == 2) base.damping.assign(6, 0.1);
    if (k == 3) base.friction.assign(6, 0.1);
    b.joint(base);
    b.body("trunk", {"root_joint", 0}, identity_placement, 1, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    SaveReport lines;
    const ModelPtr m = b.finish(), back = again(*m, DYN_FORMAT_URDF, DYN_BASE_FLOATING, &lines);
    EXPECT_EQ(k > 0, lost(lines, "armature, damping and dry friction of the floating base")) << k;
    ASSERT_EQ(2, back->n.joints) << k;
    EXPECT_EQ(DYN_JOINT_TYPE_FREE_FLYER, back->joints()[1].type);
  }
}

// Every number of a joint and of each kind of constraint.
TEST(Urdf, NumbersComeBack) {
  const std::string solid =
      "<inertial><origin xyz='.1 .2 .3' rpy='.4 .5 .6'/><mass value='2'/><inertia ixx='.3' ixy='.01' ixz='.02' "
      "iyy='.4' iyz='.03' izz='.5'/></inertial>";
  std::string text =
      "<robot name='r'><link name='base'><collision name='c'><origin xyz='1 2 3' rpy='.1 .2 .3'/><geometry><box "
      "size='1 2 3'/></geometry></collision><visual name='v'><geometry><cylinder radius='.1' length='.5'/></geometry>"
      "<material name='m'><color rgba='.2 .4 .6 .8'/></material></visual></link>";
  const char* const of_joints[] = {
      "type='revolute'><axis xyz='0 0 1'/><limit lower='-1' upper='2' effort='3' velocity='4'/><dynamics damping='5' "
      "friction='6'/>",
      "type='prismatic'><axis xyz='1 0 0'/><limit lower='-.5' upper='.25' effort='7' velocity='8'/><dynamics damping='9'/>",
      "type='continuous'><axis xyz='0 1 0'/><limit effort='10' velocity='11'/><dynamics friction='12'/>",
      "type='spherical'><dynamics damping='13' friction='14'/>",
      "type='revolute'><axis xyz='0 1 0'/><limit lower='-9' upper='9' effort='15' velocity='16'/><mimic joint='j0' "
      "multiplier='-2' offset='.5'/>"};
  for (int k = 0; k < 5; ++k) {
    const std::string n = std::to_string(k);
    text += "<link name='l" + n + "'>" + solid + "</link><joint name='j" + n + "' " + of_joints[k] + "<origin xyz='.1 .2 ." +
            n + "' rpy='.3 .2 .1'/><parent link='" + (k ? "l" + std::to_string(k - 1) : "base") + "'/><child link='l" + n +
            "'/></joint>";
  }
  const std::string ends =
      "<first link='l1'><origin xyz='1 2 3' rpy='.1 .2 .3'/></first><second link='l3'><origin xyz='4 5 6'/></second>";
  text += "<libdyn><constraint name='a' type='distance' length='2' stiffness='3' damping='4' restitution='.5'>" + ends +
          "</constraint><constraint name='b' type='weld'>" + ends +
          "</constraint><constraint name='c' type='helical' pitch='.7'>" + ends +
          "<axis xyz='1 0 0'/></constraint><constraint name='d' type='universal'>" + ends +
          "<axis xyz='1 0 0'/><axis2 xyz='0 1 0'/></constraint>"
          "<constraint name='e' type='coupling' coefficients='1 2 3 4 5'><first joint='j1'/><second joint='j0'/></constraint>"
          "<constraint name='f' type='friction' force='6' damping='7'><first joint='j0'/></constraint>"
          "<constraint name='g' type='limit' restitution='.25'><first joint='j1'/></constraint></libdyn></robot>";
  LoadOptions options;
  options.base = DYN_BASE_FIXED;
  const ModelPtr m = load_string(text, options), back = again(*m, DYN_FORMAT_URDF, DYN_BASE_FIXED);
  const Model &a = *m, &b = *back;
  expect_same(a, b, 3, true);
  for (Index k = 0; k < a.n.nv; ++k) EXPECT_EQ(a.velocity_limit()[k], b.velocity_limit()[k]);
  EXPECT_EQ(3, b.effort_limit()[0]);
  EXPECT_EQ(8, b.velocity_limit()[1]);
  const JointRecord& follower = b.joints()[b.n.joints - 1];
  EXPECT_EQ(-2, follower.ratio);
  EXPECT_EQ(.5, follower.offset);
  ASSERT_EQ(a.n.shapes, b.n.shapes);
  for (Index k = 0; k < a.n.shapes; ++k) {
    const ShapeRecord &x = a.shapes()[k], &y = b.shapes()[k];
    EXPECT_STREQ(a.string(x.name), b.string(y.name));
    EXPECT_EQ(x.role, y.role);
    EXPECT_EQ(x.colour, y.colour);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(x.size[i], y.size[i]);
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(x.placement[i], y.placement[i], 1e-15);
  }
  ASSERT_EQ(7, a.n.constraints);
  ASSERT_EQ(7, b.n.constraints);
  for (Index k = 0; k < 7; ++k) {
    SCOPED_TRACE(k);
    const dynConstraint &x = a.constraints()[k].spec, &y = b.constraints()[k].spec;
    EXPECT_EQ(x.type, y.type);
    EXPECT_EQ(x.joint_type, y.joint_type);
    for (const auto number : {&dynConstraint::length, &dynConstraint::pitch, &dynConstraint::force, &dynConstraint::stiffness,
                              &dynConstraint::damping, &dynConstraint::restitution})
      EXPECT_EQ(x.*number, y.*number);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(x.axis[i], y.axis[i], 1e-15);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(x.axis2[i], y.axis2[i], 1e-15);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(x.coefficients[i], y.coefficients[i]);
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(x.placement1[i], y.placement1[i], 1e-14);
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(x.placement2[i], y.placement2[i], 1e-14);
  }
}

// Contact between neighbours: a slider on the world and the floor, an arm and its plinth, another plinth.
TEST(Save, TheSamePairsAreTested) {
  const ModelPtr m = load_string(R"(<mujoco><worldbody><geom name='floor' type='box' size='5 5 .1' pos='0 0 -5'/>
      <body name='plinth' pos='1 0 0'><geom type='sphere' size='.1'/>
        <body name='arm' pos='0 0 .5'><joint name='pan' axis='0 0 1'/><joint name='tilt' axis='0 1 0'/><geom type='sphere' size='.1'/>
          <body name='hand' pos='0 0 .5'><joint name='wrist' axis='1 0 0'/><geom type='sphere' size='.1'/></body></body></body>
      <body name='wall' pos='2 0 0'><geom type='sphere' size='.1'/></body>
      <body name='sledge' pos='3 0 0'><joint name='slide' type='slide' axis='1 0 0'/><geom type='sphere' size='.1'/></body></worldbody></mujoco>)",
                                 {});
  const auto tested = [](const Model& model) {
    std::set<std::set<std::string>> out;
    for (Index k = 0; k < model.n.pairs; ++k) {
      const auto link = [&](Index geom) {
        const std::string name = model.string(model.frames()[model.shapes()[model.geoms()[geom].shape].frame].name);
        return name == "world" ? "universe" : name;
      };
      if (model.pairs()[k].reason == DYN_PAIR_REASON_TESTED) out.insert({link(model.pairs()[k].a), link(model.pairs()[k].b)});
    }
    return out;
  };
  // By MuJoCo's rule what is fixed to the world is nobody's parent. A URDF has no such rule, and its plinth carries the arm.
  const std::set<std::set<std::string>> in_urdf = {
      {"universe", "arm"}, {"universe", "hand"}, {"universe", "sledge"}, {"plinth", "hand"}, {"plinth", "sledge"},
      {"wall", "arm"},     {"wall", "hand"},     {"wall", "sledge"},     {"arm", "sledge"},  {"hand", "sledge"}};
  auto expected = in_urdf;
  expected.insert({"plinth", "arm"});
  EXPECT_EQ(expected, tested(*m));
  EXPECT_EQ(in_urdf, tested(*again(*m, DYN_FORMAT_URDF, DYN_BASE_FIXED)));
  for (const dynFormat format : {DYN_FORMAT_MJCF, DYN_FORMAT_DYNB})
    EXPECT_EQ(expected, tested(*again(*m, format, DYN_BASE_UNSPECIFIED))) << format;
}

TEST(Save, TheExtensionNamesTheFormat) {
  EXPECT_EQ(DYN_FORMAT_URDF, format_of("a/b.urdf"));
  EXPECT_EQ(DYN_FORMAT_MJCF, format_of("b.xml"));
  EXPECT_EQ(DYN_FORMAT_DYNB, format_of("b.x.dynb"));
  for (const char* path : {"robot", "robot.sdf", "", ".urdf"}) {
    try {
      format_of(path);
      FAIL() << path;
    } catch (const Error& e) {
      EXPECT_EQ(DYN_ERROR_ARGUMENT, e.status);
    }
  }
}

}  // namespace
}  // namespace dyn_test
