// Sleep: steps that leave out sleeping bodies end at the same bits as steps that do not.
#include "simulation/scene.hpp"

#include "count.hpp"

#include <fstream>
#include <iterator>

namespace dyn_test {
namespace {

void may_sleep(Simulation& run, bool visit) {
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_SLEEPING));
  run.options.visit_sleepers = visit;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
}

// Stacks of three boxes each, far apart, and a flying ball.
Model stacks(int n, int far = 0) {
  Scene scene;
  scene.ground();
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) scene.box(("box" + std::to_string(3 * k + i)).c_str(), 1, {0.2, 0.2, 0.2}, material(0.6));
  scene.sphere("ball", 2, 0.1, material(0.3));
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "universe", s.type = DYN_SHAPE_TYPE_BOX, s.placement[11] = -50;
  for (int i = 0; i < 3; ++i) s.size[i] = 0.5;
  for (int k = 0; k < far; ++k) EXPECT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
  return scene.finish();
}
void place_stacks(Simulation& run, int n, std::array<double, 3> ball) {
  std::vector<std::array<double, 3>> at;
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) at.push_back({1.0 * k, 0.002 * i, 0.1 + 0.2 * i});
  at.push_back(ball);
  run.place(at);
}

struct Pair {
  Simulation a, b;  // a leaves out sleeping bodies
  Pair(Model first, Model second) : a(std::move(first)), b(std::move(second)) { may_sleep(a, false), may_sleep(b, true); }
  Pair(int n, int far = 0) : Pair(stacks(n, far), stacks(n, far)) {}
  int compared = 0, slept = 0;
  template <class F>
  void both(F&& f) { f(a), f(b); }
  void steps(int n) {
    for (int k = 0; k < n; ++k) {
      a.steps(1), b.steps(1);
      ++compared;
      for (int i = 0; i < dyn_model_nq(a.m); ++i) ASSERT_EQ(a.q[i], b.q[i]) << "step " << compared << ", q " << i;
      for (int i = 0; i < dyn_model_nv(a.m); ++i) ASSERT_EQ(a.v[i], b.v[i]) << "step " << compared << ", v " << i;
      for (int i = 0; i < dyn_model_nactuators(a.m); ++i)
        ASSERT_EQ(a.array("actuator_force")[i], b.array("actuator_force")[i]) << "step " << compared << ", actuator " << i;
      ASSERT_EQ(a.report().sleeping, b.report().sleeping) << compared;
      slept = std::max(slept, a.report().sleeping);
      const auto x = a.contacts(), y = b.contacts();
      ASSERT_EQ(x.size(), y.size()) << compared;
      for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_EQ(x[i].contact.shape_a, y[i].contact.shape_a);
        ASSERT_EQ(x[i].contact.shape_b, y[i].contact.shape_b);
        for (int j = 0; j < 3; ++j) ASSERT_EQ(x[i].force_on_b[j], y[i].force_on_b[j]) << compared;
      }
    }
  }
};

class Sleeping : public testing::TestWithParam<std::pair<int, int>> {};

// A ball hits one of the sleeping stacks; gravity rotates; a body is pushed, then moved; the effect is switched off.
TEST_P(Sleeping, WakingGivesTheBitsOfNoSleep) {
  const int n = GetParam().first, far = GetParam().second;
  Pair run(n, far);
  run.both([&](Simulation& p) { place_stacks(p, n, {0.5, 3, 40}); });
  run.steps(800);
  EXPECT_EQ(n, run.slept);
  EXPECT_EQ(n, run.a.report().sleeping);
  for (int k = 0; k < 18 * n; ++k) EXPECT_EQ(0, run.a.v[k]);
  double weight = 0;
  for (const dynContactForce& f : run.a.contacts())
    if (f.contact.shape_a == 0) weight += f.force_on_b[2];
  EXPECT_NEAR(3 * n * g, weight, 1e-6 * weight);
  // the ball flies into the first stack
  run.both([&](Simulation& p) {
    Numbers q(p.q, p.q + dyn_model_nq(p.m)), v(p.v, p.v + dyn_model_nv(p.m));
    double *at = q.data() + 21 * n, *u = v.data() + 18 * n;
    at[0] = -1, at[1] = 0, at[2] = 0.5, u[0] = 4, u[1] = 0, u[2] = 1;
    p.set(q, v);
  });
  run.steps(250);
  EXPECT_EQ(n - 1, run.a.report().sleeping);
  EXPECT_GT(std::abs(run.a.q[14]), 1e-3);
  // stronger gravity: same rest, other forces
  const double heavy[3] = {0, 0, -20}, turned[3] = {5, 0, -8}, down[3] = {0, 0, -g};
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_gravity(p.m, p.d, heavy)); });
  run.steps(20);
  double last = 0;  // under the last stack
  for (const dynContactForce& f : run.a.contacts())
    if (f.contact.shape_a == 0 && f.contact.shape_b > 3 * (n - 1) && f.contact.shape_b <= 3 * n) last += f.force_on_b[2];
  EXPECT_NEAR(60, last, 1e-6);
  EXPECT_GE(run.a.report().sleeping, n - 1);
  // gravity rotates: they fall over
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_gravity(p.m, p.d, turned)); });
  run.steps(50);
  EXPECT_EQ(0, run.a.report().sleeping);
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_gravity(p.m, p.d, down)); });
  run.steps(2250);
  const int again = run.a.report().sleeping;
  EXPECT_GT(again, 0);
  // one box is pushed
  run.both([&](Simulation& p) {
    Numbers tau(std::size_t(dyn_model_nv(p.m)), 0);
    tau[std::size_t(18 * n - 6)] = 8;
    ASSERT_EQ(DYN_OK, dyn_data_set_state(p.m, p.d, nullptr, nullptr, nullptr, tau.data()));
  });
  run.steps(50);
  EXPECT_EQ(again - 1, run.a.report().sleeping);
  run.both([&](Simulation& p) {
    ASSERT_EQ(DYN_OK, dyn_data_set_state(p.m, p.d, nullptr, nullptr, nullptr, Numbers(std::size_t(dyn_model_nv(p.m)), 0).data()));
  });
  run.steps(50);
  const double push[6] = {0, 0, 30, 0, 0, 0};
  run.both([&](Simulation& p) {
    ASSERT_EQ(DYN_OK,
              dyn_data_apply_wrench(p.m, p.d, dyn_model_frame_id(p.m, "box2"), nullptr, push, DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
  });
  run.steps(30);
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_clear_wrenches(p.m, p.d)); });
  run.steps(300);
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_effects(p.m, p.d, 0, DYN_EFFECT_DEFAULT)); });
  run.steps(10);
  EXPECT_EQ(0, run.a.report().sleeping);
}
// with a pair list, by the broad phase, and without a list
INSTANTIATE_TEST_SUITE_P(Scenes, Sleeping, testing::Values(std::pair{3, 0}, std::pair{12, 0}, std::pair{3, 1000}));

// Robots of a trunk and two legs lie or stand on the ground; a ball flies.
// Their joints have damping, dry friction, springs, limits and servos, one of them filtered.
Model robots(int n, const char* more = "") {
  std::string bodies, actuators;
  for (int k = 0; k < n; ++k) {
    const std::string i = std::to_string(k);
    bodies += "<body name='trunk" + i + "' pos='" + i + " 0 .16'><freejoint/><geom type='box' size='.15 .1 .03' mass='2'/>";
    for (const std::string side : {"l", "r"})
      bodies += "<body pos='0 " + std::string(side == "l" ? ".08" : "-.08") + " 0'><joint name='" + side + i +
                "' axis='0 1 0' range='-1.5 1.5' damping='.2' frictionloss='.05' stiffness='1' armature='.01'/><geom "
                "type='capsule' size='.02' fromto='0 0 0 .1 0 -.1' mass='.3'/></body>";
    bodies += "</body>";
    actuators += "<position joint='l" + i + "' kp='8' kv='.3' timeconst='.02' forcerange='-3 3'/><position joint='r" + i +
                 "' kp='8' kv='.3'/>";
  }
  const std::string text = "<mujoco><compiler angle='radian'/><worldbody><geom type='plane' size='1 1 1'/>" + bodies +
                           "<body name='ball' pos='.5 5 2000'><freejoint/><geom size='.05'/></body></worldbody><actuator>" +
                           actuators + "</actuator>" + more + "</mujoco>";
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}
void start_robots(Pair& run) {
  Numbers q(static_cast<std::size_t>(dyn_model_nq(run.a.m)));
  ASSERT_EQ(DYN_OK, dyn_model_configuration(run.a.m, "qpos0", q.data()));
  run.both([&](Simulation& p) { p.set(q); });
}

// They fall asleep and wake by a control, gravity, a ball or a wrench, each as if they had never slept.
TEST(Sleep, DrivenAndDampedRobotsSleepAndWake) {
  constexpr int n = 3;
  Pair run(robots(n), robots(n));
  start_robots(run);
  Numbers u(2 * n, 0);
  const auto control = [&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_control(p.m, p.d, u.data())); };
  u[0] = 0.2, u[3] = -0.1;
  run.both(control);
  run.steps(4000);
  EXPECT_EQ(n, run.a.report().sleeping);
  // the same controls again wake nobody; another one wakes its own robot
  run.both(control);
  run.steps(2);
  EXPECT_EQ(n, run.a.report().sleeping);
  const double before = run.a.q[7];
  u[0] = -0.6, u[1] = 0.5;
  run.both(control);
  run.steps(200);
  EXPECT_EQ(n - 1, run.a.report().sleeping);
  EXPECT_GT(std::abs(run.a.q[7] - before), 0.02);
  run.steps(4000);
  EXPECT_EQ(n, run.a.report().sleeping);
  // full servo force, while others sleep
  u[2] = 1.4;
  run.both(control);
  run.steps(300);
  EXPECT_EQ(n - 1, run.a.report().sleeping);
  // stronger and rotated
  for (const auto& gravity :
       {std::array<double, 3>{0, 0, -15}, std::array<double, 3>{4, 0, -9}, std::array<double, 3>{0, 0, -g}}) {
    run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_gravity(p.m, p.d, gravity.data())); });
    run.steps(150);
  }
  run.steps(4000);
  EXPECT_GT(run.a.report().sleeping, 0);
  const int asleep = run.a.report().sleeping;
  // the ball falls on the first robot
  run.both([&](Simulation& p) {
    Numbers q(p.q, p.q + dyn_model_nq(p.m)), v(p.v, p.v + dyn_model_nv(p.m));
    const std::size_t ball = q.size() - 7;
    q[ball] = q[0], q[ball + 1] = q[1], q[ball + 2] = q[2] + 0.5;
    std::fill(v.end() - 6, v.end(), 0.0);
    p.set(q, v);
  });
  run.steps(400);
  EXPECT_LT(run.a.report().sleeping, asleep);
  const double push[6] = {0, 20, 10, 0, 0, 0};
  run.both([&](Simulation& p) {
    ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(p.m, p.d, dyn_model_frame_id(p.m, "trunk1"), nullptr, push,
                                            DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
  });
  run.steps(100);
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_clear_wrenches(p.m, p.d)); });
  run.steps(500);
}

// A filter that still changes keeps its robot awake. Constant wrenches and a medium allow sleep.
TEST(Sleep, ConstantForcesAllowSleep) {
  Pair run(robots(1, "<option density='1.2' viscosity='1e-5'/>"), robots(1, "<option density='1.2' viscosity='1e-5'/>"));
  start_robots(run);
  const double pull[6] = {0, 0, -1, 0, 0, 0};
  run.both([&](Simulation& p) {
    ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(p.m, p.d, dyn_model_frame_id(p.m, "trunk0"), nullptr, pull,
                                            DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
  });
  run.steps(2500);
  EXPECT_EQ(1, run.a.report().sleeping);
  const double tiny[2] = {1e-9, 0};
  run.both([&](Simulation& p) { ASSERT_EQ(DYN_OK, dyn_data_set_control(p.m, p.d, tiny)); });
  run.steps(100);
  EXPECT_EQ(0, run.a.report().sleeping);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(0, run.a.v[i]);
  run.steps(2000);  // 100 time constants: constant to rounding
  EXPECT_EQ(1, run.a.report().sleeping);
  EXPECT_NEAR(1e-9, run.a.array("act")[0], 1e-23);
}

// A state saved asleep continues in other data with the same bits.
TEST(Sleep, RestoredStateReproducesTheBits) {
  Simulation a(stacks(3)), b(stacks(3));
  may_sleep(a, false);
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(a.m, DYN_PART_SIMULATION, &d));
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(a.m, d, 0, DYN_EFFECT_DEFAULT | DYN_EFFECT_SLEEPING));
  dynArray q{};
  q.struct_size = sizeof q;
  ASSERT_EQ(DYN_OK, dyn_data_array(a.m, d, dyn_field_id("q"), &q));
  // the ball falls onto the second stack
  place_stacks(a, 3, {1.05, 0.01, 4});
  std::vector<unsigned char> memory(dyn_model_state_size(a.m));
  int asleep = 0;
  for (int k = 0; k < 20; ++k) {
    a.steps(60);
    asleep += a.report().sleeping;
    ASSERT_EQ(DYN_OK, dyn_data_save_state(a.m, a.d, memory.data(), memory.size()));
    ASSERT_EQ(DYN_OK, dyn_data_restore_state(a.m, d, memory.data(), memory.size())) << dyn_last_error();
    for (int i = 0; i < 40; ++i) {
      a.steps(1);
      ASSERT_EQ(DYN_OK, dyn_step(a.m, d));
      for (int j = 0; j < dyn_model_nq(a.m); ++j) ASSERT_EQ(a.q[j], q.data[j]) << k << " " << i << " " << j;
    }
  }
  EXPECT_GT(asleep, 10);
  dyn_data_free(d);
}

// A body that is slow only for a moment stays awake, and so does one with a joint that may not sleep.
TEST(Sleep, MovingBodiesStayAwake) {
  Scene scene({0, 0, 0});
  scene.ground().sphere("slow", 1, 0.1, material(0.5)).sphere("thrown", 1, 0.1, material(0.5));
  Simulation run(scene.finish());
  may_sleep(run, false);
  run.place({{0, 0, 1}, {5, 0, 1}});
  run.set({}, {2e-4, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0});
  const double pull[6] = {0, 0, -0.1, 0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, dyn_model_frame_id(run.m, "thrown"), nullptr, pull,
                                          DYN_REFERENCE_LOCAL_WORLD_ALIGNED));
  run.steps(2000);
  EXPECT_EQ(0, run.report().sleeping);
  EXPECT_NEAR(4e-4, run.q[0], 1e-12);
  EXPECT_NEAR(1 + 0.1 * 2 - 0.05 * 4, run.q[9], 1e-3);
  // it is stopped within the bounds, at most sleep_speed sleep_time further
  run.set({}, {5e-5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  run.steps(700);
  EXPECT_EQ(1, run.report().sleeping);
  EXPECT_EQ(0, run.v[0]);
  EXPECT_NEAR(4e-4 + 5e-5 * 0.5, run.q[0], 1e-7);
}

// A ball without velocity that is still pushed out of the ground stays awake until it is out.
TEST(Sleep, BodiesThatArePushedOutStayAwake) {
  Simulation run(Scene({0, 0, 0}).ground().sphere("ball", 1, 0.1, material(0)).finish());
  may_sleep(run, false);
  run.options.sleep_time = 0.01;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set({0, 0, 0.05, 0, 0, 0, 1});
  run.steps(60);
  EXPECT_EQ(0, run.report().sleeping);
  run.steps(140);
  EXPECT_EQ(1, run.report().sleeping);
  EXPECT_NEAR(0.1, run.q[2], 1e-8);
}

// Instructions of some steps of a flying ball beside sleeping ones.
long instructions_beside(int sleepers, int steps) {
  Scene scene;
  scene.ground().sphere("awake", 1, 0.05, material(0.5));
  std::vector<std::array<double, 3>> at = {{0.5, 0.55, 30}};
  for (int k = 0; k < sleepers; ++k) {
    scene.sphere(("b" + std::to_string(k)).c_str(), 0.5, 0.05, material(0.5));
    at.push_back({0.11 * (k % 100), 0.11 * (k / 100), 0.05});
  }
  Simulation run(scene.finish(), 2e-3);
  may_sleep(run, false);
  run.place(at);
  run.steps(600);
  EXPECT_EQ(sleepers, run.report().sleeping);
  return bench::instructions([&] {
    for (int k = 0; k < steps; ++k) dyn_step(run.m, run.d);
  });
}
void expect_no_cost(int sleepers, int steps) {
  const long alone = instructions_beside(0, steps);
  if (alone < 0) GTEST_SKIP() << "this system does not let a process trace its child";
  const long beside = instructions_beside(sleepers, steps);
  EXPECT_LE(double(beside), 1.01 * double(alone)) << alone << " " << beside;
}

// Sleeping balls and one flying ball cost the instructions of the one. A hundred are enough to be found by boxes.
TEST(Sleep, AHundredSleepingBodiesCostNothing) { expect_no_cost(100, 2); }
TEST(Sleep, SleepingBodiesCostNothing) { expect_no_cost(10000, 10); }

// The quadruped of models/scenes on its feet, beside boxes that sleep and boxes of the world that are far away.
Model standing_beside(int sleepers, int far) {
  std::ifstream file(std::string(DYN_MODELS_DIR) + "/scenes/go2_stands.xml");
  std::string text{std::istreambuf_iterator<char>(file), {}}, boxes, places;
  const auto grid = [](int k) { return std::to_string(3 + 0.3 * (k % 40)) + " " + std::to_string(3 + 0.3 * (k / 40)); };
  for (int k = 0; k < sleepers; ++k) {
    boxes += "<body pos='" + grid(k) + " 0.05'><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='0.002 0.002 0.002'/>"
             "<geom type='box' size='0.05 0.05 0.05'/></body>";
    places += " " + grid(k) + " 0.05 1 0 0 0";
  }
  for (int k = 0; k < far; ++k) boxes += "<geom type='box' size='0.05 0.05 0.05' pos='" + grid(k) + " 5'/>";
  text.insert(text.find("</worldbody>"), boxes);
  text.insert(text.find('"', text.find("qpos=\"") + 6), places);
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}

// More than 16 pairs a shape are found by boxes around shapes, not from a list: that is all that many bodies beside a robot cost.
TEST(Sleep, WhatSleepsOrIsFarBesideARobotInContact) {
  const auto count = [](int sleepers, int far) -> long {
    Simulation run(standing_beside(sleepers, far), 1e-3);
    may_sleep(run, false);
    EXPECT_EQ(DYN_OK, dyn_data_reset(run.m, run.d, "standing")) << dyn_last_error();
    run.steps(550);
    EXPECT_EQ(sleepers, run.report().sleeping);
    EXPECT_EQ(4, run.report().contacts);
    return bench::instructions([&] {
      for (int k = 0; k < 3; ++k) dyn_step(run.m, run.d);
    });
  };
  const long alone = count(0, 0);
  if (alone < 0) GTEST_SKIP() << "this system does not let a process trace its child";
  const long asleep = count(1000, 0), far = count(0, 900);
  EXPECT_LE(double(asleep), 1.3 * double(alone)) << alone << " " << asleep;
  EXPECT_LE(double(far), 1.3 * double(alone)) << alone << " " << far;
}

// Sleeping robots cost nearly nothing.
TEST(Sleep, SleepingRobotsCostLittle) {
  const auto count = [](bool sleep) -> long {
    Simulation run(robots(20), 2e-3);
    may_sleep(run, !sleep);
    Numbers q(static_cast<std::size_t>(dyn_model_nq(run.m)));
    EXPECT_EQ(DYN_OK, dyn_model_configuration(run.m, "qpos0", q.data()));
    run.set(q);
    run.steps(1250);  // the ball still falls
    EXPECT_EQ(20, run.report().sleeping);
    return bench::instructions([&] { dyn_step(run.m, run.d); });
  };
  const long asleep = count(true), visited = count(false);
  if (asleep < 0) GTEST_SKIP() << "this system does not let a process trace its child";
  EXPECT_LE(20.0 * double(asleep), double(visited)) << asleep << " " << visited;
}

}  // namespace
}  // namespace dyn_test
