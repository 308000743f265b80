// Numbers of a model are those that its MJCF file states: masses, poses, joints, tendons, constraints, contacts, settings.
#include "mjcf/parts.hpp"

namespace dyn_test::mjcf {
namespace {

constexpr double pi = 3.14159265358979323846, degree = pi / 180, none = std::numeric_limits<double>::infinity();

// ---------------------------------------------------------------------------------------------------- masses

TEST(MjcfMasses, ObeyTheCompiler) {
  const std::string bodies =
      "<worldbody><body name='a'><joint/><inertial pos='0 0 0' mass='1' diaginertia='.1 .2 .25'/></body>"
      "<body name='b'><joint/><inertial pos='0 0 0' mass='2' diaginertia='.3 .3 .3'/></body></worldbody>";
  struct Case {
    const char* compiler;
    double a, b, xx, yy;  // masses, and moments of a
  };
  for (const Case& c : {Case{"", 1, 2, .1, .2}, Case{"settotalmass='6'", 2, 4, .2, .4}, Case{"boundmass='1.5'", 1.5, 2, .1, .2},
                        Case{"boundinertia='.15'", 1, 2, .15, .2}}) {
    SCOPED_TRACE(c.compiler);
    const ModelPtr m = model("<compiler " + std::string(c.compiler) + "/>" + bodies);
    EXPECT_NEAR(c.a, link(*m, "a").mass, 1e-15);
    EXPECT_NEAR(c.b, link(*m, "b").mass, 1e-15);
    expect_numbers({c.xx, 0, 0, 0, c.yy}, link(*m, "a").inertia, 1e-15);
  }
  const std::string impossible =
      "<worldbody><body name='a'><joint/><inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .4'/></body></worldbody>";
  EXPECT_NE(std::string::npos, refusal(impossible).find("0.1 + 0.1 < 0.4"));
  expect_numbers({.2, 0, 0, 0, .2, 0, 0, 0, .2}, link(*model("<compiler balanceinertia='true'/>" + impossible), "a").inertia);
}

// Two balls of 1 and 3 kg, d apart: moments 2/5 m r^2, and mu (|d|^2 1 - d d^T) with the reduced mass mu.
TEST(MjcfMasses, OfGeomsAddUp) {
  const ModelPtr m = model(
      "<compiler inertiagrouprange='1 2'/><worldbody><body name='a'><joint/><geom size='.1' mass='1' group='1'/>"
      "<geom size='.2' mass='3' pos='.4 .2 -.1' group='2'/><geom size='.2' group='0'/><geom size='.2' group='3'/>"
      "</body></worldbody>");
  const LinkRecord& l = link(*m, "a");
  EXPECT_NEAR(4, l.mass, 1e-15);
  expect_numbers({.3, .15, -.075}, l.com);
  const double own = .4 * (.01 + 3 * .04), mu = .75;
  expect_numbers({own + mu * (.04 + .01), -mu * .08, mu * .04, -mu * .08, own + mu * (.16 + .01), mu * .02, mu * .04, mu * .02,
                  own + mu * (.16 + .04)},
                 l.inertia);
}

TEST(MjcfMasses, FollowFromVolumes) {
  struct Case {
    const char* geom;
    double volume;
  };
  for (const Case& c :
       {Case{"type='sphere' size='.2'", 4 * pi / 3 * .008}, Case{"type='box' size='.1 .2 .3'", 8 * .006},
        Case{"type='capsule' size='.1 .3'", pi * .01 * .6 + 4 * pi / 3 * .001},
        Case{"type='cylinder' size='.1 .3'", pi * .01 * .6}, Case{"type='ellipsoid' size='.1 .2 .3'", 4 * pi / 3 * .006}})
    for (const double density : {1000.0, 7.0}) {
      const std::string stated = density == 1000 ? "" : " density='7'";
      const ModelPtr m = model("<worldbody><body name='a'><joint/><geom " + (c.geom + stated) + "/></body></worldbody>");
      EXPECT_NEAR(density * c.volume, link(*m, "a").mass, 1e-13 * density) << c.geom;
    }
}

// ---------------------------------------------------------------------------------------------------- poses

TEST(MjcfPoses, OfEveryKind) {
  const double r = std::sqrt(.5);
  struct Case {
    const char* compiler;
    const char* rotation;
    std::array<double, 6> xz;  // the x and the z axis
  };
  for (const Case& c :
       {Case{"", "quat='1.2 1.6 0 0'", {1, 0, 0, 0, -.96, -.28}}, Case{"", "axisangle='0 0 2 90'", {0, 1, 0, 0, 0, 1}},
        Case{"", "euler='90 0 90'", {0, 0, 1, 0, -1, 0}}, Case{"eulerseq='XYZ'", "euler='90 0 90'", {0, 1, 0, 1, 0, 0}},
        Case{"eulerseq='zyx'", "euler='90 0 90'", {0, 1, 0, 1, 0, 0}},
        Case{"angle='radian'", "euler='0 1.5707963267948966 0'", {0, 0, -1, 1, 0, 0}},
        Case{"", "xyaxes='0 2 0 -1 1 0'", {0, 1, 0, 0, 0, 1}}, Case{"", "zaxis='1 1 0'", {.5, -.5, -r, r, r, 0}},
        Case{"", "zaxis='0 0 -3'", {1, 0, 0, 0, 0, -1}}}) {
    SCOPED_TRACE(c.rotation);
    const ModelPtr m = model("<compiler " + std::string(c.compiler) +
                             "/><worldbody><body pos='1 2 3'><joint/><geom size='1'/>"
                             "<frame pos='0 0 1' zaxis='0 0 1'><site name='s' pos='.1 .2 .3' " +
                             c.rotation + "/></frame></body></worldbody>");
    const M4 X = frames_at(*m, VectorXd::Zero(1))[std::size_t(frame_id(*m, "s"))];
    const auto& u = c.xz;
    expect_numbers({u[0], u[1], u[2]}, X.col(0).data());
    expect_numbers({u[3], u[4], u[5]}, X.col(2).data());
    expect_numbers({1.1, 2.2, 4.3}, X.col(3).data());
  }
}

// The ends of an axis, whose z axis is from the second to the first.
TEST(MjcfPoses, FromEndToEnd) {
  const ModelPtr m = model(
      "<worldbody><body><joint/><geom name='capsule' type='capsule' fromto='.1 .2 .3 .1 .6 .3' size='.05'/>"
      "<geom name='box' type='box' fromto='.1 .2 .3 .1 .6 .3' size='.05'/><site name='s' fromto='.1 .2 .3 .1 .6 "
      ".3'/></body></worldbody>");
  for (const char* name : {"capsule", "box"}) {
    SCOPED_TRACE(name);
    const ShapeRecord& s = shape(*m, name);
    expect_numbers({0, -1, 0, .1, .4, .3}, s.placement + 6);
  }
  expect_numbers({.05, .4}, shape(*m, "capsule").size);
  expect_numbers({.1, .1, .4}, shape(*m, "box").size);
  expect_numbers({0, -1, 0, .1, .4, .3}, m->frames()[frame_id(*m, "s")].placement + 6);
}

// Each replica is moved by the offset in the axes of the one before, and turned once more.
TEST(MjcfPoses, OfReplicas) {
  const ModelPtr m = model(
      "<worldbody><replicate count='3' offset='1 0 0' euler='0 0 90' sep='_'><body name='r' pos='.5 0 0'><joint/>"
      "<geom size='.1'/></body></replicate></worldbody>");
  const std::vector<M4> X = frames_at(*m, VectorXd::Zero(3));
  const auto at = [&](const char* name) { return X[std::size_t(frame_id(*m, name))]; };
  expect_numbers({.5, 0, 0}, at("r_0").col(3).data());
  expect_numbers({1, .5, 0}, at("r_1").col(3).data());
  expect_numbers({.5, 1, 0}, at("r_2").col(3).data());
  expect_numbers({0, 1, 0}, at("r_1").col(0).data());
  expect_numbers({-1, 0, 0}, at("r_2").col(0).data());
}

// ---------------------------------------------------------------------------------------------------- joints

// A body is drawn where its joints have their references.
TEST(MjcfJoints, AreDrawnAtTheirReferences) {
  const ModelPtr m = model(
      "<worldbody><body pos='1 0 0'><joint name='turn' axis='0 0 3' pos='.1 0 0' ref='90'/><joint name='push' type='slide' "
      "axis='0 2 0' "
      "ref='.5'/><geom size='.1'/><site name='s' pos='.3 0 0'/></body></worldbody>");
  ASSERT_EQ(2, m->n.nq);
  VectorXd q(2);
  const auto site = [&](double turn, double push) {
    q << turn, push;
    return Eigen::Vector3d(frames_at(*m, q)[std::size_t(frame_id(*m, "s"))].col(3).head<3>());
  };
  expect_numbers({1.3, 0, 0}, site(pi / 2, .5).data());
  expect_numbers({1.1, -.2, 0}, site(0, .5).data());  // turned by -90 degrees about the anchor
  expect_numbers({1.3, .2, 0}, site(pi / 2, .7).data());
  ASSERT_STREQ("qpos0", m->string(m->configuration_names()[m->simulation()->initial]));
  expect_numbers({pi / 2, .5}, m->configurations() + 2 * m->simulation()->initial);
}

TEST(MjcfJoints, HaveTheirNumbers) {
  const ModelPtr m = model(
      "<worldbody><body><joint name='h' range='-90 45' margin='.1' damping='.3' frictionloss='.4' armature='.02' stiffness='3' "
      "springref='20' actuatorfrcrange='-2 5'/><joint name='s' type='slide' axis='1 0 0' range='-1 2' margin='.25' "
      "springref='.5' "
      "stiffness='1'/><joint name='b' type='ball' range='0 120'/><geom size='.1'/></body></worldbody>");
  expect_numbers({-pi / 2 + .1, -.75, -none, -none, -none, .5}, m->lower_limit());
  expect_numbers({pi / 4 - .1, 1.75, none, none, none, none}, m->upper_limit());
  expect_numbers({.3, 0}, m->damping());
  expect_numbers({.4, 0}, m->friction());
  expect_numbers({.02, 0}, m->armature());
  expect_numbers({3, 1}, m->stiffness());
  expect_numbers({20 * degree, .5}, m->spring_reference());
  EXPECT_EQ(5, m->effort_limit()[0]);
}

// A spring and damper of a time constant T and a ratio r on the inertia I: stiffness I / (T r)^2, damping 2 I / T.
TEST(MjcfJoints, SpringsFollowFromInertias) {
  const ModelPtr m = model(
      "<worldbody><body><joint axis='0 0 1' springdamper='.5 .8' armature='.02'/><inertial pos='.3 0 0' mass='2' "
      "diaginertia='.1 .1 .1'/></body></worldbody>");
  EXPECT_NEAR(.3 / .16, m->stiffness()[0], 1e-13);
  EXPECT_NEAR(2 * .3 / .5, m->damping()[0], 1e-13);
}

// ---------------------------------------------------------------------------------------------------- tendons

constexpr const char* two_links =
    "<worldbody><site name='hook' pos='1 0 0'/><body name='a'><joint name='ja' axis='0 0 1' range='-90 120'/><geom size='.1'/>"
    "<geom name='ball' size='.2'/><geom name='drum' type='cylinder' size='.3 .4'/><site name='tip' pos='.5 0 0'/><site "
    "name='beside' pos='0 1 0'/>"
    "<body name='b' pos='.5 0 0'><joint name='jb' type='slide' axis='1 0 0' range='-1 1'/><geom "
    "size='.1'/></body></body></worldbody>";

TEST(MjcfTendons, HaveTheirNumbers) {
  const ModelPtr m = model(
      two_links +
      std::string(
          "<tendon><fixed name='f' stiffness='2' damping='3' frictionloss='4' armature='5' springlength='-.1 .3' range='-1 2' "
          "margin='.25'><joint joint='ja' coef='2'/><joint joint='jb' coef='-3'/></fixed>"
          "<spatial name='s' springlength='.7'><site site='hook'/><geom geom='ball' sidesite='beside'/><site site='tip'/>"
          "<pulley divisor='4'/><site site='hook'/><geom geom='drum'/><site site='tip'/></spatial>"
          "<fixed name='narrow' range='0 1' margin='.8'><joint joint='ja' coef='1'/></fixed></tendon>"
          "<equality><tendon tendon1='f' tendon2='s' polycoef='.1 2 .3 .4 .5'/><tendon tendon1='s'/></equality>"));
  ASSERT_EQ(3, m->n.tendons);
  const dynTendon &f = m->tendons()[0].spec, &s = m->tendons()[1].spec;
  EXPECT_EQ(DYN_TENDON_TYPE_FIXED, f.type);
  expect_numbers({2, 3, 4, 5}, std::array{f.stiffness, f.damping, f.friction, f.armature}.data());
  expect_numbers({-.1, .3}, f.rest);
  expect_numbers({-.75, 1.75}, f.range);
  EXPECT_EQ(DYN_TENDON_TYPE_SPATIAL, s.type);
  expect_numbers({.7, .7}, s.rest);
  expect_numbers({-none, none}, s.range);
  expect_numbers({.5, .5}, m->tendons()[2].spec.range);  // held in the middle
  const PathElement* e = m->path_elements() + m->paths()[0].first;
  EXPECT_EQ(2, e[0].value);
  EXPECT_EQ(-3, e[1].value);
  EXPECT_STREQ("jb", m->string(m->joints()[e[1].id].name));
  e = m->path_elements() + m->paths()[1].first;
  ASSERT_EQ(7, m->paths()[1].elements);
  EXPECT_EQ(DYN_TENDON_ELEMENT_TYPE_SPHERE, e[1].type);
  EXPECT_EQ(.2, e[1].value);
  EXPECT_STREQ("beside", m->string(m->frames()[e[1].side_id].name));
  EXPECT_EQ(DYN_TENDON_ELEMENT_TYPE_PULLEY, e[3].type);
  EXPECT_EQ(4, e[3].value);
  EXPECT_EQ(DYN_TENDON_ELEMENT_TYPE_CYLINDER, e[5].type);
  EXPECT_EQ(.3, e[5].value);
  ASSERT_EQ(2, m->n.couplings);
  expect_numbers({.1, 2, .3, .4, .5}, m->paths()[3].polynomial);
}

TEST(MjcfTendons, MisspeltPartsAreSuggested) {
  const auto refused = [](const std::string& path) { return refusal(two_links + ("<tendon>" + path + "</tendon>")); };
  const auto holds = [](const std::string& text, const char* words) { EXPECT_NE(text.npos, text.find(words)) << text; };
  holds(refused("<fixed><joint joint='jaa' coef='1'/></fixed>"), "there is no joint 'jaa' (did you mean 'ja'?)");
  holds(refused("<spatial><site site='hok'/><site site='tip'/></spatial>"), "there is no site 'hok' (did you mean 'hook'?)");
  holds(refused("<spatial><site site='hook'/><geom geom='bal'/><site site='tip'/></spatial>"),
        "there is no geom 'bal' (did you mean 'ball'?)");
}

// ---------------------------------------------------------------------------------------------------- constraints

TEST(MjcfEqualities, HoldWhatIsDrawn) {
  // a is turned by 90 degrees about z at (1, 0, 0), b lies at (0, 2, 0)
  const ModelPtr m = model(
      "<worldbody><body name='a' pos='1 0 0' euler='0 0 90'><freejoint/><geom size='.1'/></body><body name='b' pos='0 2 "
      "0'><freejoint/>"
      "<geom size='.1'/></body></worldbody><equality><connect name='c' body1='a' body2='b' anchor='.1 .2 .3'/>"
      "<weld name='w' body1='a' body2='b' anchor='.4 .5 .6' torquescale='.7' solref='.05 2' solimp='.7 .8 .01 .4 3'/>"
      "<weld name='r' body1='a' body2='b' relpose='.1 .2 .3 .6 .8 0 0' active='false'/></equality>");
  ASSERT_EQ(3, m->n.constraints);
  const auto c = [&](Index k) -> const dynConstraint& { return m->constraints()[k].spec; };
  EXPECT_EQ(frame_id(*m, "a"), c(0).first);
  EXPECT_EQ(frame_id(*m, "b"), c(0).second);
  expect_numbers({.1, .2, .3}, c(0).placement1 + 9);
  expect_numbers({.8, -1.9, .3}, c(0).placement2 + 9);  // (1 - .2, .1, .3) less (0, 2, 0)
  expect_numbers({.4, .5, .6}, c(1).placement2 + 9);
  expect_numbers({0, -1, 0, 1, 0, 0, 0, 0, 1, 2.5, .6, .6}, c(1).placement1);  // b's axes and (.4, 2.5, .6) in a
  expect_numbers({1, 0, 0, 0, -.28, .96, 0, -.96, -.28, .1, .2, .3}, c(2).placement1);
  EXPECT_TRUE(c(1).enabled);
  EXPECT_FALSE(c(2).enabled);
  const Compliance& law = m->constraint_compliances()[1].law;
  expect_numbers({.05, 2}, law.reference);
  expect_numbers({.7, .8, .01, .4, 3}, law.impedance);
  EXPECT_EQ(.7, law.scale);
}

// q1 - ref1 = p(q2 - ref2)
TEST(MjcfEqualities, OfJointsCountFromTheirReferences) {
  const ModelPtr m = model(
      "<worldbody><body><joint name='x' type='slide' axis='1 0 0' ref='.5'/><joint name='y' type='slide' axis='0 1 0' "
      "ref='.25'/>"
      "<geom size='.1'/></body></worldbody><equality><joint joint1='x' joint2='y' polycoef='.1 2 3 -4 5'/><joint joint1='x' "
      "polycoef='.3'/></equality>");
  ASSERT_EQ(2, m->n.constraints);
  const double* c = m->constraints()[0].spec.coefficients;
  for (const double y : {-.7, .25, 1.3}) {
    const double z = y - .25;
    EXPECT_NEAR(.5 + .1 + z * (2 + z * (3 + z * (-4 + z * 5))), c[0] + y * (c[1] + y * (c[2] + y * (c[3] + y * c[4]))), 1e-13);
  }
  expect_numbers({.8, 0, 0, 0, 0}, m->constraints()[1].spec.coefficients);
}

// ---------------------------------------------------------------------------------------------------- contacts

TEST(MjcfContacts, PairsHaveTheirMaterials) {
  const std::string balls =
      "<worldbody><geom name='floor' type='plane' size='1 1 1'/><body><freejoint/><geom name='ball' size='.1' friction='.5 .02 "
      ".003' condim='6' "
      "contype='2' conaffinity='4' priority='1' margin='.01' solref='-1e4 -20' solmix='3' surfacevel='1 2 "
      "3'/></body></worldbody>";
  const std::string pair =
      "<contact><pair geom1='ball' geom2='floor' condim='4' friction='.9 .9 .04 .3 .3' solref='.03 1.5' solreffriction='.07 2' "
      "margin='.2'/></contact>";
  const ModelPtr m = model(balls + pair);
  const ShapeRecord& ball = shape(*m, "ball");
  EXPECT_EQ(2u, ball.contype);
  EXPECT_EQ(4u, ball.conaffinity);
  EXPECT_EQ(.01, ball.radius);
  const dynMaterial& x = m->materials()[ball.material];
  expect_numbers({.5, .02, .003}, std::array{x.friction, x.torsion, x.rolling}.data());
  expect_numbers({1, 2, 3}, x.surface_velocity);
  // half a period of x'' + 20 x' + 1e4 x = 0: the ratio of damping is .1
  EXPECT_NEAR(std::exp(-pi * .1 / std::sqrt(.99)), x.restitution, 1e-14);
  ASSERT_EQ(1, m->n.pairs);
  EXPECT_TRUE(m->pairs()[0].wanted());
  const dynMaterial& own = m->materials()[m->pairs()[0].material() - 1];
  expect_numbers({.9, .04, 0}, std::array{own.friction, own.torsion, own.rolling}.data());
  const Compliance& law = m->material_compliances()[m->pairs()[0].material() - 1].law;
  expect_numbers({.03, 1.5}, law.reference);
  expect_numbers({.07, 2}, law.across);
  EXPECT_EQ(.2, law.margin);
  const ModelPtr off = model("<option><flag contact='disable'/></option>" + balls + pair);
  EXPECT_EQ(0u, shape(*off, "ball").contype | shape(*off, "ball").conaffinity);
  for (Index k = 0; k < off->n.pairs; ++k) EXPECT_FALSE(off->pairs()[k].wanted());
}

TEST(MjcfContacts, OverridesAreOfAll) {
  const ModelPtr m = model(
      "<option o_margin='.1' o_solref='-1e4 -20' o_solimp='.5 .6 .02 .3 1' o_friction='.4 .4 .05 .006 .006'><flag "
      "override='enable'/></option>"
      "<worldbody><geom name='floor' type='plane' size='1 1 1'/><body><freejoint/><geom name='ball' size='.1' "
      "condim='6'/></body></worldbody>");
  const dynMaterial& x = m->materials()[shape(*m, "ball").material];
  expect_numbers({.4, .05, .006, std::exp(-pi * .1 / std::sqrt(.99))},
                 std::array{x.friction, x.torsion, x.rolling, x.restitution}.data());
  EXPECT_EQ(.05, shape(*m, "ball").radius);  // margins of two geoms add up
  expect_numbers({-1e4, -20}, m->geom_compliances()[1].law.reference);
  expect_numbers({.5, .6, .02, .3, 1}, m->geom_compliances()[1].law.impedance);
}

// ---------------------------------------------------------------------------------------------------- settings

TEST(MjcfOptions, HaveTheirNumbers) {
  const std::string body = "<worldbody><body><joint/><geom size='.1'/></body></worldbody>";
  const ModelPtr m = model(
      "<option gravity='1 2 3' density='4' viscosity='5' wind='6 7 8' timestep='.004' integrator='implicitfast' "
      "impratio='9' cone='elliptic'/>" +
      body);
  expect_numbers({1, 2, 3}, m->gravity);
  expect_numbers({4, 5}, std::array{m->density, m->viscosity}.data());
  expect_numbers({6, 7, 8}, m->wind);
  EXPECT_EQ(.004, m->simulation()->dt);
  EXPECT_EQ(DYN_INTEGRATOR_IMPLICIT_FAST, m->simulation()->integrator);
  EXPECT_EQ(DYN_INTEGRATOR_RK4, model("<option integrator='RK4'/>" + body)->simulation()->integrator);
  EXPECT_EQ(DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, model("<option integrator='Euler'/>" + body)->simulation()->integrator);
  EXPECT_EQ(.002, model(body)->simulation()->dt);  // MuJoCo's default
}

TEST(MjcfOptions, FlagsSwitchEffectsOff) {
  const std::string body = "<worldbody><body><joint/><geom size='.1'/></body></worldbody>";
  const std::uint32_t all = model(body)->simulation()->effects;
  const std::uint32_t passive = DYN_EFFECT_SPRINGS | DYN_EFFECT_DAMPING | DYN_EFFECT_FLUID | DYN_EFFECT_FLUID_ELLIPSOIDS |
                                DYN_EFFECT_GRAVITY_COMPENSATION;
  const std::pair<const char*, std::uint32_t> flags[] = {{"limit", DYN_EFFECT_LIMITS},
                                                         {"frictionloss", DYN_EFFECT_FRICTION},
                                                         {"spring", DYN_EFFECT_SPRINGS},
                                                         {"damper", DYN_EFFECT_DAMPING},
                                                         {"passive", passive},
                                                         {"actuation", DYN_EFFECT_ACTUATORS},
                                                         {"constraint", DYN_EFFECT_LIMITS | DYN_EFFECT_FRICTION}};
  for (const auto& [flag, effects] : flags)
    for (const bool off : {false, true}) {
      const ModelPtr m =
          model("<option><flag " + (flag + std::string(off ? "='disable'" : "='enable'")) + "/></option>" + body);
      EXPECT_EQ(off ? all & ~effects : all, m->simulation()->effects) << flag;
    }
  expect_numbers({0, 0, 0}, model("<option><flag gravity='disable'/></option>" + body)->gravity);
}

// A key has w before x, y, z, and the linear velocity of a free joint along the world's axes.
TEST(MjcfKeys, AreInTheAxesOfTheModel) {
  const ModelPtr m = model(
      "<worldbody><body name='m' mocap='true' pos='1 1 1'/><body pos='3 2 1'><freejoint/><geom size='.1'/></body>"
      "<body><joint name='j'/><geom size='.1'/></body></worldbody>"
      "<actuator><motor joint='j'/><position joint='j' kp='1' timeconst='1'/></actuator>"
      "<keyframe><key name='k' qpos='1 2 3 .6 0 0 .8 .5' qvel='1 2 3 4 5 6 7' ctrl='8 9' act='10' time='11' mpos='12 13 14' "
      "mquat='.6 .8 0 0'/></keyframe>");
  ASSERT_EQ(3, m->n.configurations);
  const Index k = 2;
  ASSERT_STREQ("k", m->string(m->configuration_names()[k]));
  expect_numbers({3, 2, 1, 0, 0, 0, 1, 0}, m->configurations() + m->n.nq);  // as drawn
  expect_numbers({1, 2, 3, 0, 0, .8, .6, .5}, m->configurations() + k * m->n.nq);
  // R = rotation about z with cos -.28 and sin .96; R^T (1, 2, 3)
  expect_numbers({-.28 + 1.92, -.96 - .56, 3, 4, 5, 6, 7, 8, 9, 10, 11}, m->configuration_state(k));
  expect_numbers({1, 0, 0, 0, -.28, .96, 0, -.96, -.28, 12, 13, 14}, m->configuration_mocaps() + 12 * k);
}

}  // namespace
}  // namespace dyn_test::mjcf
