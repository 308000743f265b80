// Actuators and sensors are those that an MJCF file states, and numbers that it leaves open follow from inertias and lengths.
#include "mjcf/parts.hpp"

namespace dyn_test::mjcf_actuators {
namespace {

using namespace mjcf;

constexpr double pi = 3.14159265358979323846, degree = pi / 180, none = std::numeric_limits<double>::infinity();

// A hinge j with .3 kg m^2 about its axis, armature included, a slide s, and a ball.
constexpr const char* arm =
    "<worldbody><site name='hook' pos='1 0 0'/><body name='link'><joint name='j' axis='0 0 1' range='-10 20' armature='.02'/>"
    "<inertial pos='.3 0 0' mass='2' diaginertia='.1 .1 .1'/><site name='tip' pos='.5 0 0'/></body>"
    "<body name='cart'><joint name='s' type='slide' axis='1 0 0'/><inertial pos='0 0 0' mass='4' diaginertia='.1 .1 .1'/><site "
    "name='c'/></body>"
    "<body name='globe'><joint name='b' type='ball'/><inertial pos='0 0 0' mass='4' diaginertia='.1 .1 "
    ".1'/></body></worldbody>";

ModelPtr with(const std::string& actuators, const std::string& tendons = "", const std::string& rest = "") {
  return model(rest + arm + (tendons.empty() ? "" : "<tendon>" + tendons + "</tendon>") + "<actuator>" + actuators +
               "</actuator>");
}
const dynActuator& first(const ModelPtr& m) { return m->actuators()[0].spec; }

// f = (gain[0] + gain[1] l + gain[2] l') w + bias[0] + bias[1] l + bias[2] l'
TEST(MjcfActuators, HaveTheLawsOfTheirKinds) {
  struct Case {
    const char* text;
    std::array<double, 6> law;
    double time;
    int integrates;
  };
  for (const Case& c : {
           Case{"<motor joint='j'/>", {1}, 0, 0},
           Case{"<position joint='j' kp='20' kv='2'/>", {20, 0, 0, 0, -20, -2}, 0, 0},
           Case{"<position joint='j' kp='20' timeconst='.1'/>", {20, 0, 0, 0, -20, 0}, .1, 0},
           Case{"<velocity joint='j' kv='3'/>", {3, 0, 0, 0, 0, -3}, 0, 0},
           Case{"<intvelocity joint='j' kp='3' kv='1' actrange='-1 2'/>", {3, 0, 0, 0, -3, -1}, 0, 1},
           Case{"<damper joint='j' kv='2' ctrlrange='0 1'/>", {0, 0, -2}, 0, 0},
           Case{"<cylinder joint='j' diameter='2' bias='1 -2 -3' timeconst='.2'/>", {pi, 0, 0, 1, -2, -3}, .2, 0},
           Case{"<cylinder joint='j' area='5'/>", {5}, 1, 0},
           Case{"<adhesion body='link' gain='4' ctrlrange='0 1'/>", {4}, 0, 0},
           Case{"<general joint='j' gainprm='4' biastype='affine' biasprm='1 -2 -3' dyntype='filter' dynprm='.2'/>",
                {4, 0, 0, 1, -2, -3},
                .2,
                0},
           Case{"<general joint='j' gaintype='affine' gainprm='4 5 6' dyntype='filterexact'/>", {4, 5, 6}, 1, 0},
           Case{"<general joint='j' dyntype='integrator' gainprm='2' actrange='0 3'/>", {2}, 0, 1},
       }) {
    SCOPED_TRACE(c.text);
    const ModelPtr m = with(c.text);
    ASSERT_EQ(1, m->n.actuators);
    const ActuatorRecord& a = m->actuators()[0];
    const auto& x = c.law;
    EXPECT_NEAR(x[0], a.gain[0], 1e-15);
    expect_numbers({x[1], x[2]}, a.spec.gain_slope);
    expect_numbers({x[3], x[4], x[5]}, a.bias);
    EXPECT_EQ(c.time, a.spec.time_constant);
    EXPECT_EQ(c.integrates, a.spec.integrates);
  }
}

TEST(MjcfActuators, HaveTheirRanges) {
  const ModelPtr m = with(
      "<intvelocity joint='j' kp='1' ctrlrange='-4 5' forcerange='-6 7' actrange='-1 2' gear='3'/><motor joint='j' "
      "ctrlrange='-4 5' "
      "ctrllimited='false' forcerange='-1 2'/><position joint='j' inheritrange='.5'/><intvelocity joint='j' "
      "inheritrange='1'/>");
  const auto a = [&](Index k) -> const dynActuator& { return m->actuators()[k].spec; };
  EXPECT_EQ(3, a(0).gear);
  expect_numbers({-4, 5}, a(0).control_range);
  expect_numbers({-6, 7}, a(0).force_range);
  expect_numbers({-1, 2}, a(0).act_range);
  expect_numbers({-none, none}, a(1).control_range);
  expect_numbers({-1, 2}, a(1).force_range);
  expect_numbers({-2.5 * degree, 12.5 * degree}, a(2).control_range);
  expect_numbers({-10 * degree, 20 * degree}, a(3).act_range);
  expect_numbers({-none, none}, a(3).control_range);
}

// A range of a joint's force bounds gear times the force of its only actuator, or the sum of several.
TEST(MjcfActuators, ObeyTheRangesOfWhatTheyDrive) {
  const std::string body =
      "<worldbody><body><joint name='j' axis='0 0 1' actuatorfrcrange='-.5 .3'/><geom size='.1'/></body></worldbody>";
  const auto driven = [&](const char* actuators) { return model(body + "<actuator>" + actuators + "</actuator>"); };
  expect_numbers({-.5, .3}, first(driven("<motor joint='j'/>")).force_range);
  expect_numbers({-.15, .25}, first(driven("<motor joint='j' gear='-2'/>")).force_range);
  expect_numbers({-.1, .3}, first(driven("<motor joint='j' forcerange='-.1 9'/>")).force_range);
  const ModelPtr two = driven("<motor joint='j'/><motor joint='j'/>");
  ASSERT_EQ(1, two->n.force_limits);
  expect_numbers({-.5, .3}, two->force_limits()[0].range);
  expect_numbers({-none, none}, first(two).force_range);
}

TEST(MjcfActuators, ActThroughWhatTheyName) {
  const ModelPtr m = with(
      "<motor joint='b' gear='0 2 0'/><motor joint='b' gear='1 2 3'/><motor jointinparent='b' gear='1 2 3'/><motor tendon='t' "
      "gear='5'/>"
      "<motor site='tip' refsite='hook' gear='1 2 3 4 5 6'/><motor cranksite='c' slidersite='tip' cranklength='.7' gear='2'/>"
      "<adhesion body='link' gain='1' ctrlrange='0 1'/>",
      "<fixed name='t'><joint joint='j' coef='2'/></fixed>");
  const auto a = [&](Index k) -> const dynActuator& { return m->actuators()[k].spec; };
  EXPECT_EQ(DYN_TRANSMISSION_JOINT, a(0).transmission);
  EXPECT_EQ(1, a(0).component);
  EXPECT_EQ(2, a(0).gear);
  EXPECT_EQ(DYN_TRANSMISSION_AXES, a(1).transmission);
  EXPECT_EQ(0, a(1).in_parent);
  EXPECT_EQ(1, a(2).in_parent);
  expect_numbers({1, 2, 3, 0, 0, 0}, a(1).wrench);
  EXPECT_EQ(DYN_TRANSMISSION_TENDON, a(3).transmission);
  EXPECT_EQ(5, a(3).gear);
  EXPECT_EQ(DYN_TRANSMISSION_SITE, a(4).transmission);
  expect_numbers({1, 2, 3, 4, 5, 6}, a(4).wrench);
  EXPECT_EQ(frame_id(*m, "tip"), a(4).frame);
  EXPECT_EQ(frame_id(*m, "hook"), a(4).reference);
  EXPECT_EQ(DYN_TRANSMISSION_SLIDER_CRANK, a(5).transmission);
  EXPECT_EQ(.7, a(5).rod);
  EXPECT_EQ(2, a(5).gear);
  EXPECT_EQ(DYN_TRANSMISSION_BODY, a(6).transmission);
  EXPECT_EQ(frame_id(*m, "link"), a(6).frame);
}

// The motor's armature and damping count with the square of its gear.
TEST(MjcfActuators, ReflectTheirInertia) {
  const ModelPtr m =
      with("<motor joint='j' gear='-3' armature='.1' damping='.2'/><motor tendon='t' gear='2' armature='.1' damping='.2'/>",
           "<fixed name='t' armature='1' damping='2'><joint joint='s' coef='1'/></fixed>");
  EXPECT_NEAR(.02 + .9, m->armature()[0], 1e-15);
  EXPECT_NEAR(1.8, m->damping()[0], 1e-15);
  EXPECT_NEAR(1.4, m->tendons()[0].spec.armature, 1e-15);
  EXPECT_NEAR(2.8, m->tendons()[0].spec.damping, 1e-15);
}

// kv = 2 ratio sqrt(kp m) with 1 / m = J M^-1 J'
TEST(MjcfActuators, DampingFollowsFromARatio) {
  EXPECT_NEAR(1.4 * std::sqrt(5 * .3), first(with("<position joint='j' kp='5' dampratio='.7'/>")).kv, 1e-13);
  EXPECT_NEAR(1.4 * std::sqrt(5 * .3 / 9), first(with("<position joint='j' kp='5' dampratio='.7' gear='3'/>")).kv, 1e-13);
  EXPECT_NEAR(1.4 * std::sqrt(5 * .3), first(with("<pid joint='j' kp='5' dampratio='.7'/>")).kv, 1e-13);
  EXPECT_NEAR(-1.4 * std::sqrt(5 * .3),
              first(with("<general joint='j' biastype='affine' gainprm='5' biasprm='0 -5 .7'/>")).bias[2], 1e-13);
  // a tendon 2 j - 3 s with an armature A: M = diag(.3, 4) + A J' J, and J M^-1 J' = s / (1 + A s) with s = 4 / .3 + 9 / 4
  const double s = 4 / .3 + 9.0 / 4;
  const std::string path = "<joint joint='j' coef='2'/><joint joint='s' coef='-3'/></fixed>";
  EXPECT_NEAR(1.4 * std::sqrt(5 / s), first(with("<position tendon='t' kp='5' dampratio='.7'/>", "<fixed name='t'>" + path)).kv,
              1e-13);
  EXPECT_NEAR(1.4 * std::sqrt(5 * (1 + .6 * s) / s),
              first(with("<position tendon='t' kp='5' dampratio='.7'/>", "<fixed name='t' armature='.6'>" + path)).kv, 1e-12);
  // the joint alone: (M^-1)_jj = 1 / .3 - A (2 / .3)^2 / (1 + A s)
  EXPECT_NEAR(1.4 * std::sqrt(5 / (1 / .3 - .6 * 4 / .09 / (1 + .6 * s))),
              first(with("<position joint='j' kp='5' dampratio='.7'/>", "<fixed name='t' armature='.6'>" + path)).kv, 1e-12);
}

TEST(MjcfActuators, MusclesHaveTheirNumbers) {
  const ModelPtr given = with(
      "<muscle joint='j' range='.6 1.1' force='33' scale='150' lmin='.4' lmax='1.7' vmax='1.4' fpmax='1.2' fvmax='1.1' "
      "timeconst='.02 .06' "
      "tausmooth='.1' lengthrange='.1 .9'/>");
  const dynMuscle& x = first(given).muscle;
  expect_numbers({.6, 1.1, 33, .4, 1.7, 1.4, 1.2, 1.1, .02, .06, .1, .1, .9},
                 std::array{x.range[0], x.range[1], x.force, x.lmin, x.lmax, x.vmax, x.fpmax, x.fvmax, x.t_act, x.t_deact,
                            x.smoothing, x.length_range[0], x.length_range[1]}
                     .data());
  // MuJoCo's defaults; force = scale / |M^-1 J'|; the range of lengths follows from the joint's limits
  const ModelPtr open = with("<muscle joint='j' gear='2'/>");
  const dynMuscle& y = first(open).muscle;
  expect_numbers({.75, 1.05, 200 * .3 / 2, .5, 1.6, 1.5, 1.3, 1.2, .01, .04, 0, -20 * degree, 40 * degree},
                 std::array{y.range[0], y.range[1], y.force, y.lmin, y.lmax, y.vmax, y.fpmax, y.fvmax, y.t_act, y.t_deact,
                            y.smoothing, y.length_range[0], y.length_range[1]}
                     .data(),
                 1e-12);
  // of two degrees of freedom
  const ModelPtr two = with("<muscle tendon='t' lengthrange='0 1'/>",
                            "<fixed name='t'><joint joint='j' coef='2'/><joint joint='s' coef='-3'/></fixed>");
  EXPECT_NEAR(200 / std::hypot(2 / .3, 3.0 / 4), first(two).muscle.force, 1e-10);
}

// The shortest and longest path of a muscle within the limits of joints.
TEST(MjcfActuators, LengthsAreSearched) {
  // between points at 1 and .5 m from a hinge: l^2 = 1.25 - cos(q), whose least is inside the limits
  const ModelPtr turns = model(
      "<worldbody><site name='hook' pos='1 0 0'/><body><joint axis='0 0 1' range='-90 120'/><geom size='.1'/><site name='tip' "
      "pos='.5 0 0'/>"
      "</body></worldbody><tendon><spatial name='t'><site site='hook'/><site site='tip'/></spatial></tendon>"
      "<actuator><muscle tendon='t' force='1'/></actuator>");
  expect_numbers({.5, std::sqrt(1.75)}, first(turns).muscle.length_range, 1e-9);
  // a joint that follows: l = q + p(q) with p = .1 + 2 q + .3 q^2, from -1 to 1
  const std::string pair =
      "<worldbody><body><joint name='x' type='slide' axis='1 0 0' range='-1 1'/><joint name='y' type='slide' axis='0 1 "
      "0'/><geom size='.1'/>"
      "</body></worldbody><tendon><fixed name='t'><joint joint='x' coef='1'/><joint joint='y' coef='1'/></fixed></tendon>"
      "<equality><joint joint1='y' joint2='x' polycoef='.1 2 .3 -.2 .05'/></equality><actuator><muscle tendon='t'/></actuator>";
  expect_numbers({-1 + .1 - 2 + .3 + .2 + .05, 1 + .1 + 2 + .3 - .2 + .05}, first(model(pair)).muscle.length_range, 1e-12);
  // of a tendon with limits, on request, or not at all
  const std::string limited =
      "<worldbody><body><joint name='x' type='slide' axis='1 0 0' range='-1 1'/><geom size='.1'/></body></worldbody>"
      "<tendon><fixed name='t' range='-3 5'><joint joint='x' coef='1'/></fixed></tendon><actuator><muscle "
      "tendon='t'/></actuator>";
  expect_numbers({-1, 1}, first(model(limited)).muscle.length_range, 1e-12);
  expect_numbers({-3, 5}, first(model("<compiler><lengthrange uselimit='true'/></compiler>" + limited)).muscle.length_range);
  EXPECT_EQ(0, first(model("<compiler><lengthrange mode='none'/></compiler>" + limited)).gear);
}

TEST(MjcfActuators, PidsHaveTheirNumbers) {
  const ModelPtr m = with(
      "<pid joint='j' input='pos vel ff' kp='1' kv='2' ki='3' imax='4' slewmax='5' posrange='-6 7' velrange='-8 9' "
      "ffrange='-10 11' "
      "forcerange='-12 13'/><pid joint='j' kp='1' imax='4'/>");
  const dynActuator& a = first(m);
  EXPECT_EQ(DYN_ACTUATOR_TYPE_PID, a.type);
  EXPECT_EQ(std::uint32_t(DYN_INPUT_POSITION | DYN_INPUT_VELOCITY | DYN_INPUT_FORCE), a.inputs);
  expect_numbers({1, 2, 3, 4, 5}, std::array{a.kp, a.kv, a.ki, a.integral_limit, a.slew}.data());
  expect_numbers({-6, 7}, a.control_range);
  expect_numbers({-8, 9}, a.velocity_range);
  expect_numbers({-10, 11}, a.feedforward_range);
  expect_numbers({-12, 13}, a.force_range);
  EXPECT_EQ(0, m->actuators()[1].spec.integral_limit);  // nothing is integrated
  EXPECT_EQ(std::uint32_t(DYN_INPUT_POSITION | DYN_INPUT_VELOCITY), m->actuators()[1].spec.inputs);
}

TEST(MjcfActuators, MotorsHaveTheirNumbers) {
  const ModelPtr m = with(
      "<dcmotor joint='j' input='pos voltage' motorconst='.2 .8' resistance='2' inductance='.5 9' cogging='1 2 3' "
      "controller='4 5 6 7 8 9' "
      "saturation='10 0 11' thermal='12 13 0 14 15 16' lugre='17 18 19 20 21'/>");
  const dynActuator& a = first(m);
  const dynDcMotor& x = a.motor;
  EXPECT_EQ(DYN_ACTUATOR_TYPE_DC_MOTOR, a.type);
  EXPECT_EQ(std::uint32_t(DYN_INPUT_POSITION | DYN_INPUT_VOLTAGE), a.inputs);
  expect_numbers({2, .4, .25, 11},
                 std::array{x.resistance, x.constant, x.time_constant, x.rate}.data());  // K^2 = Kt Ke, T = L / R
  expect_numbers({1, 2, 3}, x.cogging);
  expect_numbers({4, 5, 6, 7, 8, 9}, std::array{x.kp, a.ki, x.kd, a.slew, a.integral_limit, x.voltage_limit}.data());
  expect_numbers({-10, 10}, a.force_range);
  expect_numbers({12, 13, 14, 15, 16},
                 std::array{x.thermal_resistance, x.heat_capacity, x.temperature_coefficient, x.reference, x.ambient}.data());
  expect_numbers({17, 18, 19, 20, 21},
                 std::array{x.bristle_stiffness, x.bristle_damping, x.coulomb, x.breakaway, x.stribeck}.data());
}

// Numbers of a data sheet: voltage V, stall torque, no-load speed w; with viscous damping B: w = V K / (K^2 + R B).
TEST(MjcfActuators, MotorsFollowFromDataSheets) {
  const auto motor = [](const std::string& attributes) { return first(with("<dcmotor joint='j' " + attributes + "/>")).motor; };
  dynDcMotor x = motor("nominal='12 2 100'");
  EXPECT_NEAR(.12, x.constant, 1e-15);
  EXPECT_NEAR(.12 * 12 / 2, x.resistance, 1e-15);
  x = motor("nominal='12 0 100' resistance='3' damping='.001'");
  EXPECT_NEAR(100, 12 * x.constant / (x.constant * x.constant + 3 * .001), 1e-10);
  EXPECT_GT(x.constant, .06);                      // the larger of both solutions
  x = motor("nominal='12 2 100' damping='.001'");  // R = K V / stall
  EXPECT_NEAR(100, 12 * x.constant / (x.constant * x.constant + x.resistance * .001), 1e-10);
  EXPECT_NEAR(x.constant * 12 / 2, x.resistance, 1e-15);
  EXPECT_EQ(.7, motor("motorconst='.1' resistance='1' inductance='0 .7'").time_constant);
  const ModelPtr current = with("<dcmotor joint='j' motorconst='.1' resistance='1' saturation='0 5'/>");
  expect_numbers({-.5, .5}, first(current).force_range);  // K times the largest current
  // a time constant in place of a resistance or a capacity
  EXPECT_EQ(3, motor("motorconst='.1' resistance='1' thermal='2 0 6'").heat_capacity);
  EXPECT_EQ(3, motor("motorconst='.1' resistance='1' thermal='0 2 6'").thermal_resistance);
}

// ---------------------------------------------------------------------------------------------------- sensors

TEST(MjcfSensors, HaveTheirNumbers) {
  const ModelPtr m = model(
      "<option magnetic='1 2 3'/><worldbody><geom name='floor' type='plane' size='1 1 1'/><body name='a' pos='0 0 1'><joint "
      "name='j'/>"
      "<geom name='ball' size='.1' pos='.2 0 0'/><site name='s' type='box' size='.1 .2 .3'/><site name='t' type='capsule' "
      "size='.1 .2'/></body>"
      "</worldbody><sensor><jointpos joint='j' cutoff='.5' noise='.25' delay='.01' nsample='6'/><magnetometer site='s'/><touch "
      "site='s'/>"
      "<touch site='t'/><framepos objtype='geom' objname='ball' reftype='site' refname='s'/><framepos objtype='body' "
      "objname='a'/>"
      "<rangefinder site='s' data='dist normal'/><contact geom1='ball' body2='world' num='3' data='found force dist' "
      "reduce='maxforce'/>"
      "<contact site='s' subtree1='a'/><user dim='4'/><distance geom1='ball' geom2='floor' cutoff='1'/></sensor>");
  ASSERT_EQ(11, m->n.sensors);
  const auto s = [&](Index k) -> const dynSensor& { return m->sensors()[k].spec; };
  EXPECT_EQ(DYN_QUANTITY_JOINTPOS, s(0).quantity);
  expect_numbers({.5, .25, .01}, std::array{s(0).cutoff, s(0).noise, s(0).delay}.data());
  expect_numbers({1, 2, 3}, s(1).field);
  EXPECT_EQ(DYN_SHAPE_TYPE_BOX, s(2).shape);
  expect_numbers({.2, .4, .6}, s(2).extent);
  EXPECT_EQ(DYN_SHAPE_TYPE_CAPSULE, s(3).shape);
  expect_numbers({.1, .4, 0}, s(3).extent);
  expect_numbers({.2, 0, 0}, s(4).placement + 9);
  EXPECT_EQ(frame_id(*m, "s"), s(4).reference);
  expect_numbers({.2, 0, 0}, s(5).placement + 9);  // the centre of mass
  EXPECT_EQ(std::uint32_t(DYN_VALUE_DISTANCE | DYN_VALUE_NORMAL), s(6).values);
  EXPECT_EQ(std::uint32_t(DYN_VALUE_FOUND | DYN_VALUE_FORCE | DYN_VALUE_DISTANCE), s(7).values);
  EXPECT_EQ(DYN_SIDE_SHAPE, s(7).side);
  EXPECT_EQ(DYN_SIDE_LINK, s(7).other_side);
  EXPECT_EQ(DYN_REDUCTION_MAXFORCE, s(7).reduction);
  EXPECT_EQ(3, s(7).count);
  EXPECT_EQ(DYN_SIDE_ZONE, s(8).side);
  EXPECT_EQ(4, s(9).size);
  EXPECT_EQ(1, s(10).size);
}

}  // namespace
}  // namespace dyn_test::mjcf_actuators
