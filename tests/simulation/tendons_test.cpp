// Tendons, and actuators on tendons and frames, in steps: closed forms.
#include "common/every.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

constexpr double inertia = 0.5, mass = 2;
const std::vector<dynIntegrator> all_integrators = every<dynIntegrator>("dynIntegrator");

dynTendon tendon_of(dynTendonType type) {
  dynTendon t;
  dyn_tendon_init(&t, type);
  return t;
}
dynTendonElement element(dynTendonElementType type, const char* name, double value = 1, const char* side = nullptr) {
  dynTendonElement e;
  dyn_tendon_element_init(&e, type);
  e.name = name, e.value = value, e.side = side;
  return e;
}
dynTendonElement site(const char* name) { return element(DYN_TENDON_ELEMENT_TYPE_SITE, name); }
dynTendonElement joint(const char* name, double value) { return element(DYN_TENDON_ELEMENT_TYPE_JOINT, name, value); }

void add(Builder& b, const char* name, const dynTendon& t, const std::vector<dynTendonElement>& elements) {
  ASSERT_EQ(DYN_OK, dyn_builder_add_tendon(b, name, &t, elements.data(), int(elements.size()))) << dyn_last_error();
}
void frame(Builder& b, const char* name, const char* parent, std::array<double, 3> at) {
  const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, at[0], at[1], at[2]};
  ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, name, parent, X, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
}
// Wheels about z, named a, b, .., each on its own.
void add_wheels(Builder& b, int count) {
  const double I[9] = {inertia, 0, 0, 0, inertia, 0, 0, 0, inertia};
  for (int k = 0; k < count; ++k) {
    const std::string name(1, char('a' + k)), body = name + "_link";
    Spec hinge(name.c_str(), DYN_JOINT_TYPE_REVOLUTE);
    hinge.about(0, 0, 1);
    b.joint(hinge).body(body.c_str(), name.c_str(), 2, {0, 0, 0}, I);
  }
}
// Masses that slide along z through (x, 0, 0).
void add_weights(Builder& b, const std::vector<double>& x, const std::vector<double>& masses) {
  const double I[9] = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01};
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::string name(1, char('a' + k)), body = name + "_link";
    Spec slide(name.c_str(), DYN_JOINT_TYPE_PRISMATIC, nullptr, {x[k], 0, 0});
    slide.about(0, 0, 1);
    b.joint(slide).body(body.c_str(), name.c_str(), masses[k], {0, 0, 0}, I);
  }
}

// A string between two sites has the length of their distance and moves with its rate, however the sites are turned.
TEST(Tendons, SitesMayBeTurned) {
  for (int k = 0; k < 8; ++k) {
    const double c = std::cos(0.3 + 0.7 * k), s = std::sin(0.3 + 0.7 * k);
    Builder b;
    add_weights(b, {0.3}, {mass});
    const double fixed[12] = {c, s, 0, -s, c, 0, 0, 0, 1, 0, 0, 0}, moved[12] = {c, 0, -s, 0, 1, 0, s, 0, c, 0, 0.4, 0};
    ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "fixed", "universe", fixed, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "moved", "a_link", moved, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
    add(b, "string", tendon_of(DYN_TENDON_TYPE_SPATIAL), {site("moved"), site("fixed")});
    Simulation run(b.finish());
    const double q = 1.2, v = 0.7, length = std::hypot(0.3, 0.4, q);
    double l = 0, rate = 0;
    ASSERT_EQ(DYN_OK, dyn_tendons(run.m, run.d, &q, &v, &l, &rate, nullptr)) << dyn_last_error();
    EXPECT_NEAR(length, l, 1e-15);
    EXPECT_NEAR(q * v / length, rate, 1e-15);
  }
}

// Two wheels on a spring: the difference of their angles oscillates at sqrt(2 k / I), their sum moves on.
TEST(Tendons, SpringBetweenTwoWheelsOscillates) {
  const double k = 8, rate = std::sqrt(2 * k / inertia);
  for (const dynIntegrator by : all_integrators) {
    Builder b;
    add_wheels(b, 2);
    dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
    t.stiffness = k;
    add(b, "spring", t, {joint("a", 1), joint("b", -1)});
    Simulation run(b.finish());
    integrate_by(run, by);
    run.set({0.3, -0.3}, {1, 1});
    run.steps(1000);
    const bool first_order = by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST;
    const double off = first_order ? 1e-2 : by == DYN_INTEGRATOR_IMPLICIT_MIDPOINT ? 1e-4 : 1e-9;
    EXPECT_NEAR(0.6 * std::cos(rate), run.q[0] - run.q[1], off) << by;
    EXPECT_NEAR(2, run.q[0] + run.q[1], 1e-12) << by;
  }
}

// Damping alone: the difference of velocities decays at 2 c / I.
TEST(Tendons, DamperBetweenTwoWheelsDecays) {
  for (const dynIntegrator by : all_integrators) {
    Builder b;
    add_wheels(b, 2);
    dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
    t.damping = 0.4;
    add(b, "damper", t, {joint("a", 1), joint("b", -1)});
    Simulation run(b.finish());
    integrate_by(run, by);
    run.set({0, 0}, {3, 1});
    run.steps(1000);
    const bool first_order = by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST;
    EXPECT_NEAR(2 * std::exp(-2 * 0.4 / inertia), run.v[0] - run.v[1],
                first_order ? 2e-3 : by == DYN_INTEGRATOR_IMPLICIT_MIDPOINT ? 1e-6 : 1e-9)
        << by;
    EXPECT_NEAR(4, run.v[0] + run.v[1], 1e-12) << by;
  }
}

// 1e10 N m/rad and 1e6 N m s/rad at 10 ms: too much for any explicit method; the wheels turn as one.
TEST(Tendons, StiffSpringsAndDampersAreStable) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
    Builder b;
    add_wheels(b, 2);
    dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
    t.stiffness = 1e10, t.damping = 1e6;
    add(b, "shaft", t, {joint("a", 1), joint("b", -1)});
    Simulation run(b.finish(), 0.01);
    integrate_by(run, by);
    run.set({0.1, 0}, {2, 0});
    run.steps(300);
    EXPECT_NEAR(0, run.q[0] - run.q[1], 1e-9) << by;
    EXPECT_NEAR(1, run.v[0], 1e-9) << by;
    EXPECT_NEAR(1, run.v[1], 1e-9) << by;
  }
}

// Between its two rest lengths a spring is slack.
TEST(Tendons, DeadBandHasNoForce) {
  Builder b;
  add_wheels(b, 1);
  dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
  t.stiffness = 50, t.rest[0] = -1, t.rest[1] = 2;
  add(b, "band", t, {joint("a", 1)});
  Simulation run(b.finish());
  run.set({0}, {0.5});
  run.steps(1000);
  EXPECT_NEAR(0.5, run.v[0], 1e-13);
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL));
  run.set({2.5}, {0});
  EXPECT_NEAR(0.5 * 50 * 0.25, run.energy(), 1e-12);
}

// A weight on a string: it falls freely, then hangs at the string's length, and pulls with its weight.
TEST(Tendons, StringHoldsAWeight) {
  Builder b;
  add_weights(b, {0}, {mass});
  dynTendon t = tendon_of(DYN_TENDON_TYPE_SPATIAL);
  t.range[0] = 0, t.range[1] = 1;
  frame(b, "eye", "universe", {0, 0, 0});
  frame(b, "hook", "a_link", {0, 0, 0});
  add(b, "string", t, {site("eye"), site("hook")});
  Simulation run(b.finish());
  run.set({-0.5});
  run.steps(100);
  EXPECT_NEAR(-g * 0.1, run.v[0], 1e-12);
  run.steps(1500);
  EXPECT_NEAR(-1, run.q[0], 1e-6);
  EXPECT_NEAR(0, run.v[0], 1e-12);
}

// Below its friction a tendon sticks exactly; above it the rest accelerates.
TEST(Tendons, FrictionSticksExactly) {
  Builder b;
  add_wheels(b, 2);
  dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
  t.friction = 0.7;
  add(b, "brake", t, {joint("a", 1), joint("b", -1)});
  Simulation run(b.finish());
  const double tau[2] = {0.6, -0.6}, more[2] = {0.9, -0.9};
  ASSERT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, nullptr, nullptr, nullptr, tau));
  run.steps(1000);
  EXPECT_NEAR(0, run.v[0], 1e-12);
  EXPECT_NEAR(0, run.q[0] - run.q[1], 1e-12);
  ASSERT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, nullptr, nullptr, nullptr, more));
  run.steps(1000);
  EXPECT_NEAR((0.9 - 0.7) / inertia, run.v[0], 1e-9);
}

// Gears: q_a = 2 q_b. A torque on a alone gives it tau / (I + I / 4).
TEST(Tendons, CoupledTendonsAreGears) {
  Builder b;
  add_wheels(b, 2);
  const dynTendon t = tendon_of(DYN_TENDON_TYPE_FIXED);
  add(b, "one", t, {joint("a", 1)});
  add(b, "two", t, {joint("b", 1)});
  const double c[5] = {0, 2};
  ASSERT_EQ(DYN_OK, dyn_builder_couple_tendons(b, "gear", "one", "two", c)) << dyn_last_error();
  Simulation run(b.finish());
  const double tau[2] = {0.5, 0};
  ASSERT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, nullptr, nullptr, nullptr, tau));
  run.steps(1000);
  EXPECT_NEAR(0.5 / (inertia * 1.25), run.v[0], 1e-9);
  EXPECT_NEAR(run.q[0], 2 * run.q[1], 1e-9);
}

// Atwood's machine: an inextensible tendon over a cylinder between two weights.
TEST(Tendons, WeightsOverACylinder) {
  const double m1 = 3, m2 = 2, r = 0.2;
  Builder b;
  add_weights(b, {-r, r}, {m1, m2});
  frame(b, "one", "a_link", {0, 0, 0});
  frame(b, "two", "b_link", {0, 0, 0});
  const double X[12] = {1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 0, 2};  // its axis along y
  ASSERT_EQ(DYN_OK, dyn_builder_add_frame(b, "pulley", "universe", X, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
  frame(b, "above", "universe", {0, 0, 3});
  add(b, "rope", tendon_of(DYN_TENDON_TYPE_SPATIAL),
      {site("one"), element(DYN_TENDON_ELEMENT_TYPE_CYLINDER, "pulley", r, "above"), site("two")});
  const double c[5] = {};
  ASSERT_EQ(DYN_OK, dyn_builder_couple_tendons(b, "inextensible", "rope", nullptr, c)) << dyn_last_error();
  Simulation run(b.finish());
  double length = 0, J[2];
  ASSERT_EQ(DYN_OK, dyn_tendons(run.m, run.d, nullptr, nullptr, &length, nullptr, J)) << dyn_last_error();
  EXPECT_NEAR(4 + M_PI * r, length, 1e-12);
  EXPECT_NEAR(-1, J[0], 1e-12);
  EXPECT_NEAR(-1, J[1], 1e-12);
  run.steps(500);
  const double a = g * (m1 - m2) / (m1 + m2);
  EXPECT_NEAR(-a * 0.5, run.v[0], 1e-6);
  EXPECT_NEAR(a * 0.5, run.v[1], 1e-6);
}

// A string around a peg whose side is beyond the peg, both ends before it: it goes the long way. Its length is that of two
// tangents and of the arc between them.
TEST(Tendons, StringsGoTheLongWayToTheirSide) {
  constexpr double r = 1;
  struct Ends {
    double ax, ay, bx, by;
  };
  for (const Ends& e : {Ends{-0.02, -2.93, -0.18, -1.40}, Ends{0.75, -1.80, 0.75, -1.07}, Ends{-2.61, -0.26, -1.26, 0.06},
                        Ends{-1.5, -2, 1.5, -2}}) {
    const double la = std::hypot(e.ax, e.ay), lb = std::hypot(e.bx, e.by), x = e.ax / la + e.bx / lb, y = e.ay / la + e.by / lb;
    Builder b;
    add_weights(b, {0}, {mass});
    frame(b, "one", "a_link", {e.ax, e.ay, 0});
    frame(b, "two", "universe", {e.bx, e.by, 0});
    frame(b, "peg", "universe", {0, 0, 0});
    frame(b, "beyond", "universe", {-3 * x, -3 * y, 0});
    add(b, "string", tendon_of(DYN_TENDON_TYPE_SPATIAL),
        {site("one"), element(DYN_TENDON_ELEMENT_TYPE_CYLINDER, "peg", r, "beyond"), site("two")});
    Simulation run(b.finish());
    double length = 0;
    ASSERT_EQ(DYN_OK, dyn_tendons(run.m, run.d, nullptr, nullptr, &length, nullptr, nullptr)) << dyn_last_error();
    const double between = std::acos((e.ax * e.bx + e.ay * e.by) / (la * lb)),
                 arc = 2 * M_PI - between - std::acos(r / la) - std::acos(r / lb);
    EXPECT_NEAR(std::sqrt(la * la - r * r) + r * arc + std::sqrt(lb * lb - r * r), length, 1e-12) << e.ax;
  }
}

// A pulley's branches count by their divisor: the block and tackle halves the force.
TEST(Tendons, PulleysDivide) {
  Builder b;
  add_weights(b, {0, 1}, {4, 2});
  frame(b, "ceiling", "universe", {0, 0, 1});
  frame(b, "ceiling2", "universe", {1, 0, 1});
  frame(b, "one", "a_link", {0, 0, 0});
  frame(b, "two", "b_link", {0, 0, 0});
  add(b, "rope", tendon_of(DYN_TENDON_TYPE_SPATIAL),
      {element(DYN_TENDON_ELEMENT_TYPE_PULLEY, nullptr, 0.5), site("ceiling"), site("one"),
       element(DYN_TENDON_ELEMENT_TYPE_PULLEY, nullptr, 1), site("ceiling2"), site("two")});
  const double c[5] = {};
  ASSERT_EQ(DYN_OK, dyn_builder_couple_tendons(b, "inextensible", "rope", nullptr, c)) << dyn_last_error();
  Simulation run(b.finish());
  run.steps(500);
  EXPECT_NEAR(0, run.v[0], 1e-9);  // 4 kg on two parts of the rope, 2 kg on one
  EXPECT_NEAR(0, run.v[1], 1e-9);
}

// Three free bodies on one string: momentum stays, and so does the sum of its pieces.
TEST(Tendons, OneStringJoinsThreeTrees) {
  Scene scene({0, 0, 0});
  const char* names[] = {"a", "b", "c"};
  for (const char* name : names) scene.free(name, 1, {0.1, 0.1, 0.1});
  dynTendon t = tendon_of(DYN_TENDON_TYPE_SPATIAL);
  t.range[0] = 0, t.range[1] = 2.1;
  const dynTendonElement elements[] = {site("a"), site("b"), site("c")};
  ASSERT_EQ(DYN_OK, dyn_builder_add_tendon(scene, "string", &t, elements, 3)) << dyn_last_error();
  Simulation run(scene.finish());
  run.set({0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 1}, {-1, 0, 0, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 0, 0, 0,
      0, 0});
  double length = 0;
  for (int k = 0; k < 400; ++k) {
    run.steps(1);
    ASSERT_EQ(DYN_OK, dyn_tendons(run.m, run.d, nullptr, nullptr, &length, nullptr, nullptr));
    ASSERT_LE(length, 2.1 + 2e-3) << k;
  }
  EXPECT_NEAR(1, run.v[0] + run.v[6] + run.v[12], 1e-9);
  EXPECT_NEAR(0.5, run.v[1] + run.v[7] + run.v[13], 1e-9);
}

// A servo on a tendon with gains far beyond any explicit method, and a range of forces.
TEST(Tendons, ServoOnATendon) {
  for (const double gear : {1.0, -3.0}) {
    Builder b;
    add_wheels(b, 2);
    add(b, "sum", tendon_of(DYN_TENDON_TYPE_FIXED), {joint("a", 1), joint("b", 1)});
    dynActuator a;
    dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_POSITION);
    a.kp = 1e8, a.kv = 1e6, a.transmission = DYN_TRANSMISSION_TENDON, a.gear = gear, a.force_range[0] = -2, a.force_range[1] = 2;
    ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(b, "servo", &a, "sum")) << dyn_last_error();
    Simulation run(b.finish(), 0.01);
    control(run, {0.8 * gear});
    run.steps(20);
    EXPECT_NEAR(2 * std::abs(gear) / inertia * 0.2, run.v[0], 1e-9) << gear;  // at the end of its range
    run.steps(3000);
    EXPECT_NEAR(0.8, run.q[0] + run.q[1], 1e-6) << gear;
    EXPECT_NEAR(0, run.v[0], 1e-6) << gear;
    EXPECT_NEAR(0, run.q[0] - run.q[1], 1e-9) << gear;
  }
}

// Four thrusts hold a body up; one more newton accelerates it.
TEST(Tendons, ThrustAtFramesHovers) {
  Scene scene;
  scene.free("drone", mass, {0.02, 0.02, 0.04});
  const double at[4][2] = {{0.1, 0.1}, {-0.1, 0.1}, {-0.1, -0.1}, {0.1, -0.1}};
  for (int k = 0; k < 4; ++k) {
    const double X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, at[k][0], at[k][1], 0};
    const std::string name = "rotor" + std::to_string(k);
    ASSERT_EQ(DYN_OK, dyn_builder_add_frame(scene, name.c_str(), "drone", X, DYN_FRAME_TYPE_OP_FRAME)) << dyn_last_error();
    dynActuator a;
    dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_MOTOR);
    a.transmission = DYN_TRANSMISSION_SITE, a.wrench[2] = 1, a.wrench[5] = k % 2 ? -0.01 : 0.01;
    ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(scene, name.c_str(), &a, name.c_str())) << dyn_last_error();
  }
  Simulation run(scene.finish());
  const double each = mass * g / 4;
  control(run, {each, each, each, each});
  run.place({{0, 0, 1}});
  run.steps(500);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(0, run.v[k], 1e-12) << k;
  control(run, {each + 0.25, each + 0.25, each + 0.25, each + 0.25});
  run.steps(1000);
  EXPECT_NEAR(1 / mass, run.v[2], 1e-12);
  control(run, {each + 1, each - 1, each + 1, each - 1});
  run.steps(1000);
  EXPECT_NEAR(4 * 0.01 / 0.04, run.v[5], 1e-9);
}

// Energy-neutral muscles at rest pull with their passive force; an active one with force FL FV.
TEST(Tendons, MusclePulls) {
  Builder b;
  add_weights(b, {0}, {mass});
  frame(b, "eye", "universe", {0, 0, 1});
  frame(b, "hook", "a_link", {0, 0, 0});
  add(b, "muscle", tendon_of(DYN_TENDON_TYPE_SPATIAL), {site("eye"), site("hook")});
  dynActuator a;
  dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_MUSCLE);
  a.transmission = DYN_TRANSMISSION_TENDON;
  a.muscle.force = 100, a.muscle.length_range[0] = 0.5, a.muscle.length_range[1] = 1.5;
  a.muscle.range[0] = 0.5, a.muscle.range[1] = 1.5;  // optimum length 1
  ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(b, "muscle", &a, "muscle")) << dyn_last_error();
  Simulation run(b.finish());
  control(run, {1});
  run.steps(5000);
  EXPECT_NEAR(1, run.array("act")[0], 1e-9);
  EXPECT_NEAR(0, run.v[0], 1e-6);
  EXPECT_NEAR(-mass * g, run.array("actuator_force")[0], 1e-3);  // it holds the weight
  EXPECT_GT(run.q[0], 0);
}

// The ledger closes: what the spring stores, the damper takes.
TEST(Tendons, LedgerCloses) {
  Builder b;
  add_weights(b, {0, 0.5}, {mass, 1});
  frame(b, "eye", "universe", {0, 0, 1});
  frame(b, "one", "a_link", {0, 0, 0});
  frame(b, "two", "b_link", {0, 0, 0});
  dynTendon t = tendon_of(DYN_TENDON_TYPE_SPATIAL);
  t.stiffness = 100, t.damping = 3;
  add(b, "rubber", t, {site("eye"), site("one"), site("two")});
  Simulation run(b.finish());
  run.options.ledger = 1, run.options.integrator = DYN_INTEGRATOR_RK4, run.options.dt = 1e-4;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  ASSERT_EQ(DYN_OK, dyn_advance(run.m, run.d, 0.7)) << dyn_last_error();
  dynErrorLedger l{};
  l.struct_size = sizeof l;
  ASSERT_EQ(DYN_OK, dyn_data_ledger(run.m, run.d, &l)) << dyn_last_error();
  EXPECT_LT(l.damping, -0.1);
  EXPECT_NEAR(l.energy_change, l.damping, 1e-6);  // work is that of the trapezoidal rule
}

// A weight on a rail and a cord with armature a to an eye beside it: with the share c = z / L of the cord's moment arm, the energy
// (m + a c^2) v^2 / 2 stays.
TEST(Tendons, ArmatureTakesPartAlongTheChangingArm) {
  const double armature = 5, beside = 0.4, z0 = 0.05, v0 = 2;
  const auto moved = [&](double z) { return mass + armature * z * z / (z * z + beside * beside); };
  for (const dynIntegrator by : all_integrators) {
    const auto error = [&](double dt, double accuracy) {
      Builder b;
      dyn_builder_set_gravity(b, std::array<double, 3>{0, 0, 0}.data());
      add_weights(b, {0}, {mass});
      frame(b, "eye", "universe", {beside, 0, 0});
      frame(b, "hook", "a_link", {0, 0, 0});
      dynTendon t = tendon_of(DYN_TENDON_TYPE_SPATIAL);
      t.armature = armature;
      add(b, "cord", t, {site("eye"), site("hook")});
      Simulation run(b.finish(), dt);
      run.options.accuracy = accuracy, run.options.ledger = 1;
      integrate_by(run, by);
      EXPECT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL));
      run.set({z0}, {v0});
      const double energy = run.energy();
      EXPECT_NEAR(moved(z0) * v0 * v0 / 2, energy, 1e-12);
      EXPECT_EQ(DYN_OK, dyn_advance(run.m, run.d, 0.3)) << dyn_last_error();
      dynErrorLedger l{};
      l.struct_size = sizeof l;
      EXPECT_EQ(DYN_OK, dyn_data_ledger(run.m, run.d, &l)) << dyn_last_error();
      EXPECT_NEAR(run.energy() - energy, l.energy_change, 1e-12);
      EXPECT_NEAR(l.energy_change, l.energy_defect, 1e-12);  // nothing but the step's error
      return run.v[0] - v0 * std::sqrt(moved(z0) / moved(run.q[0]));
    };
    const double one = error(1e-3, 0), half = error(5e-4, 0);
    EXPECT_LT(std::abs(one), 3e-3) << by;
    const bool first_order = by == DYN_INTEGRATOR_SEMI_IMPLICIT_EULER || by == DYN_INTEGRATOR_IMPLICIT_FAST;
    EXPECT_NEAR(first_order ? 2 : 8, one / half, 0.2) << by;
    EXPECT_NEAR(0, error(1e-3, 1e-8), 1e-7) << by;
  }
}

// A body on a tendon does not sleep while its tendon may move it.
TEST(Tendons, WhatATendonMovesStaysAwake) {
  Builder b;
  add_weights(b, {0}, {mass});
  frame(b, "eye", "universe", {0, 0, 0});
  frame(b, "hook", "a_link", {0, 0, 0});
  dynTendon t = tendon_of(DYN_TENDON_TYPE_SPATIAL);
  t.range[1] = 1;
  add(b, "string", t, {site("eye"), site("hook")});
  Simulation run(b.finish());
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_SLEEPING));
  run.set({-1});
  run.steps(3000);
  EXPECT_NEAR(-1, run.q[0], 1e-6);
}

}  // namespace
}  // namespace dyn_test
