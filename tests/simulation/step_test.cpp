// Properties of steps in any scene: momentum, limits, constraints, islands, repetition.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

Numbers momentum(Simulation& run) {
  Numbers h(6);
  EXPECT_EQ(DYN_OK, dyn_centroidal_momentum(run.m, run.d, nullptr, nullptr, h.data())) << dyn_last_error();
  return h;
}

// A tumbling body with its centre of mass off the joint's origin.
TEST(Step, FreeBodiesKeepTheirMomentum) {
  Simulation run(Scene({0, 0, 0}).free("stone", 2, {0.1, 0.2, 0.25}, {0.1, 0.2, 0.3}).finish());
  run.set({}, {1, 2, 3, 4, 5, -6});
  Numbers before = momentum(run);
  for (int k = 0; k < 1000; ++k) {
    run.steps(1);
    const Numbers now = momentum(run);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(before[i], now[i], 1e-12) << k;
    before = now;
  }
}

// Two bodies collide without external forces.
TEST(Step, CollisionsKeepMomentum) {
  Scene scene({0, 0, 0});
  scene.sphere("a", 1, 0.1, material(0.5, 0.8)).box("b", 3, {0.3, 0.2, 0.2}, material(0.5));
  Simulation run(scene.finish());
  run.place({{0, 0, 0}, {0.5, 0.05, 0.03}});
  run.set({}, {3, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0});
  const Numbers before = momentum(run);
  run.steps(300);
  const Numbers now = momentum(run);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(before[i], now[i], 1e-12);
  for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(before[i], now[i], 1e-3);  // moments of an impact use its position at the beginning of the step
  EXPECT_GT(std::abs(run.velocity(1)[0]), 0.5);
}

void bob(Builder& b, const char* joint) {
  const double com[3] = {0, 0, -1}, I[9] = {0.3, 0, 0, 0, 0.3, 0, 0, 0, 0.3};
  EXPECT_EQ(DYN_OK, dyn_builder_add_body(b, "bob", joint, nullptr, 1, com, I)) << dyn_last_error();
}

Model pendulum(double lower, double upper) {
  Builder b;
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  hinge.about(0, 1, 0), hinge.lower = &lower, hinge.upper = &upper;
  b.joint(hinge), bob(b, "hinge");
  return b.finish();
}

TEST(Step, LimitsHold) {
  Simulation run(pendulum(-0.5, 0.2));
  run.set({0.1}, {4});
  double most = -1, least = 1;
  for (int k = 0; k < 2000; ++k) run.steps(1), most = std::max(most, run.q[0]), least = std::min(least, run.q[0]);
  EXPECT_NEAR(0.2, most, 1e-9);
  EXPECT_GE(least, -0.5 - 1e-9);
  // not where the effect is off
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
  run.set({0.1}, {4});
  run.steps(100);
  EXPECT_GT(run.q[0], 0.3);
  // from beyond a limit it comes back
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ALL));
  run.set({0.4}, {0});
  run.steps(1000);
  EXPECT_LE(run.q[0], 0.2 + 1e-8);
}

// A bob on a ball joint limited to half a radian; on request two arms of which one follows the other (M has no tree structure).
Model ball_pendulum(bool beside, double angle = 0.5, double damping = 0) {
  Builder b;
  Spec ball("ball", DYN_JOINT_TYPE_SPHERICAL);
  const double lower[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, std::cos(angle / 2)};
  const double resists[3] = {damping, damping, damping};
  ball.lower = lower, ball.damping = resists;
  b.joint(ball), bob(b, "ball");
  if (beside) {
    Spec lead("lead", DYN_JOINT_TYPE_REVOLUTE), follow("follow", DYN_JOINT_TYPE_REVOLUTE);
    follow.mimic = "lead", follow.mimic_ratio = 2;
    b.joint(lead).joint(follow).body("x", "lead", 1, {0.1, 0, 0}).body("y", "follow", 1, {0.2, 0, 0});
  }
  return b.finish();
}
double angle_of(const Simulation& run) { return 2 * std::atan2(std::sqrt(run.q[0] * run.q[0] + run.q[1] * run.q[1] + run.q[2] * run.q[2]), std::abs(run.q[3])); }

// In a plane a ball's limit equals a hinge's, for either sign of the quaternion.
TEST(Step, BallLimitMatchesHingeLimitInAPlane) {
  for (const bool beside : {false, true})
    for (const double sign : {1.0, -1.0})
      for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
        Simulation run(ball_pendulum(beside)), hinge(pendulum(-0.5, 0.5));
        for (Simulation* p : {&run, &hinge}) p->options.integrator = by, dyn_data_set_step_options(p->m, p->d, &p->options);
        Numbers q(static_cast<std::size_t>(dyn_model_nq(run.m)), 0), v(static_cast<std::size_t>(dyn_model_nv(run.m)), 0);
        q[1] = sign * std::sin(0.05), q[3] = sign * std::cos(0.05), v[1] = 4;
        run.set(q, v), hinge.set({0.1}, {4});
        double most = 0;
        for (int k = 0; k < 2000; ++k) {
          run.steps(1), hinge.steps(1);
          ASSERT_NEAR(hinge.q[0], 2 * std::atan(run.q[1] / run.q[3]), 1e-9) << k << beside << by;
          ASSERT_NEAR(hinge.v[0], run.v[1], 1e-7) << k;  // to the solver's tolerance
          most = std::max(most, angle_of(run));
        }
        EXPECT_NEAR(0.5, most, 1e-9);
      }
}

// About any axis, with spin: the limit holds except for the axis' rotation in a step, and no energy is gained.
// With cos(a'/2) = cos(a/2) cos(h w/2) a step along the limit leads (h w)^2 / 4 cot(a/2) beyond; each step removes half of the error.
TEST(Step, BallLimitHolds) {
  for (const double angle : {0.2, 0.5, 1.5, 3.0}) {
    Simulation run(ball_pendulum(false, angle));
    run.set({}, {6, -9, 2.5});
    double most = 0, fast = 0, energy = run.energy();
    for (int k = 0; k < 3000; ++k) {
      run.steps(1);
      most = std::max(most, angle_of(run)), fast = std::max(fast, std::hypot(run.v[0], run.v[1], run.v[2]));
      ASSERT_LE(run.energy(), energy + 1e-2 * 50) << k;  // of 100 J, by steps of first order
    }
    EXPECT_LE(most, angle + 2 * 1e-6 * fast * fast / 4 / std::tan(angle / 2) + 1e-6) << angle << " " << fast;
    EXPECT_GE(most, angle - 1e-9) << angle;
    // not where the effect is off
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
    run.set({0, 0, 0, 1}, {0, 12, 0});
    run.steps(int(1000 * (angle + 0.08) / 11));
    EXPECT_GT(angle_of(run), angle) << angle;
  }
}

// Gravity holds the bob at its limit: the row's force equals the moment, and the bob does not creep.
TEST(Step, BallLimitDoesNotCreep) {
  Simulation run(ball_pendulum(false, 0.5, 1));
  const double aside[3] = {9, 0, -1};
  ASSERT_EQ(DYN_OK, dyn_data_set_gravity(run.m, run.d, aside));
  run.steps(20000);
  EXPECT_NEAR(0.5, angle_of(run), 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(0, run.v[i], 1e-9);
  run.options.accuracy = 1e-6;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
  run.set({0, 0, 0, 1}, {0, 0, 0});
  ASSERT_EQ(DYN_OK, dyn_advance(run.m, run.d, 2)) << dyn_last_error();
  EXPECT_NEAR(0.5, angle_of(run), 1e-5);
}

TEST(Step, InvalidBallLimitsAreRefused) {
  Builder b;
  for (const double w : {1.0, 2.0}) {
    Spec ball("ball", DYN_JOINT_TYPE_SPHERICAL);
    const double lower[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, w};
    ball.lower = lower;
    EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_joint(b, &ball));
    EXPECT_TRUE(says({"ball", "lower limit[3]", "cos(a/2)"})) << dyn_last_error();
  }
}

// The loop of a swinging four-bar linkage stays closed.
TEST(Step, ConstraintsHold) {
  dynModel* loaded = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/mechanisms/four_bar.urdf", nullptr, &loaded)) << dyn_last_error();
  Simulation run{Model(loaded)};
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_ARMATURE));
  Numbers q(static_cast<std::size_t>(run.m.nq()));
  ASSERT_EQ(DYN_OK, dyn_configuration_neutral(run.m, q.data()));
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(run.m, 0, &d));
  int rows = 0;
  ASSERT_EQ(DYN_OK, dyn_data_constraint_rows(run.m, d, -1, nullptr, &rows)) << dyn_last_error();
  ASSERT_GT(rows, 0);
  Numbers C(static_cast<std::size_t>(rows));
  for (double& x : q) x += 0.3;
  ASSERT_EQ(DYN_OK, dyn_project(run.m, d, q.data(), nullptr, nullptr, q.data(), nullptr, nullptr)) << dyn_last_error();
  run.set(q);
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    run.steps(1);
    ASSERT_EQ(DYN_OK, dyn_constraint_terms(run.m, d, run.q, run.v, C.data(), nullptr, nullptr, nullptr)) << dyn_last_error();
    for (const double c : C) worst = std::max(worst, std::abs(c));
  }
  EXPECT_LT(worst, 1e-6);
  dyn_data_free(d);
}

// Islands are independent: each moves as it would alone, bit for bit.
TEST(Step, IslandsAreIndependent) {
  auto boxes = [](int n) {
    Scene scene;
    scene.ground();
    for (int k = 0; k < n; ++k) scene.box(k ? "second" : "first", 1 + k, {0.2, 0.2, 0.2}, material(0.4));
    return scene.finish();
  };
  Simulation one(boxes(1)), two(boxes(2));
  one.place({{0, 0, 0.15}});
  two.place({{0, 0, 0.15}, {5, 0, 0.3}});
  for (int k = 0; k < 500; ++k) {
    one.steps(1), two.steps(1);
    for (int i = 0; i < 7; ++i) ASSERT_EQ(one.q[i], two.q[i]) << k;
  }
  EXPECT_EQ(2, two.report().islands);
}

TEST(Step, IsRepeatedBitForBit) {
  Numbers end[2];
  for (Numbers& x : end) {
    Scene scene;
    scene.ground();
    for (const char* name : {"a", "b", "c"}) scene.box(name, 1, {0.2, 0.2, 0.2}, material(0.6, 0.2));
    Simulation run(scene.finish());
    run.place({{0, 0, 0.3}, {0.05, 0.02, 0.6}, {0.1, 0, 0.9}});
    run.steps(1000);
    x.assign(run.q, run.q + 21);
  }
  EXPECT_EQ(end[0], end[1]);
}

// A saved state continues in other data with the same steps.
TEST(Step, RestoredStateReproducesTheBits) {
  auto scene = [] {
    Scene x;
    x.ground();
    for (const char* name : {"a", "b", "c"}) x.box(name, 1, {0.2, 0.2, 0.2}, material(0.6, 0.2));
    return x.finish();
  };
  Simulation play(scene());
  play.place({{0, 0, 0.3}, {0.05, 0.02, 0.6}, {0.1, 0, 0.9}});
  play.steps(300);
  std::vector<unsigned char> kept(dyn_model_state_size(play.m));
  ASSERT_EQ(DYN_OK, dyn_data_save_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  play.steps(300);
  const Numbers end(play.q, play.q + 21), speed(play.v, play.v + 18);
  ASSERT_EQ(DYN_OK, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  EXPECT_NEAR(0.3, play.array("time")[0], 1e-12);
  play.steps(300);
  EXPECT_EQ(end, Numbers(play.q, play.q + 21));
  EXPECT_EQ(speed, Numbers(play.v, play.v + 18));

  const Numbers before(play.q, play.q + 21);
  Simulation other(scene());
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_restore_state(other.m, other.d, kept.data(), kept.size()));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "another model"));
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size() - 1));
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_save_state(play.m, play.d, kept.data(), 3));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_restore_state(play.m, play.d, nullptr, kept.size()));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_save_state(nullptr, play.d, kept.data(), kept.size()));
  EXPECT_EQ(0u, dyn_model_state_size(nullptr));
  for (const std::size_t at : {std::size_t(0), std::size_t(16), std::size_t(32)}) {
    std::vector<unsigned char> damaged = kept;
    std::fill_n(damaged.begin() + std::ptrdiff_t(at), 8, static_cast<unsigned char>(0xff));
    EXPECT_NE(DYN_OK, dyn_data_restore_state(play.m, play.d, damaged.data(), damaged.size())) << at;
  }
  EXPECT_EQ(before, Numbers(play.q, play.q + 21));
}

// Results computed for a restored state are not reused for the next one.
TEST(Step, RestoredStateInvalidatesResults) {
  Simulation play(Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish()), fresh(Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish());
  play.place({{0, 0, 0.3}});
  play.steps(10);
  std::vector<unsigned char> kept(dyn_model_state_size(play.m));
  ASSERT_EQ(DYN_OK, dyn_data_save_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
  const Numbers next = {1, 2, 3, 0, 0, 1, 0}, v = {1, 2, 3, 4, 5, 6}, tau = {6, 5, 4, 3, 2, 1};
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(DYN_OK, dyn_data_restore_state(play.m, play.d, kept.data(), kept.size())) << dyn_last_error();
    for (int n = 0; n < k; ++n) ASSERT_EQ(DYN_OK, dyn_aba(play.m, play.d, nullptr, nullptr, nullptr, nullptr, nullptr));
    ASSERT_EQ(DYN_OK, dyn_forward_kinematics(play.m, play.d, nullptr, nullptr, nullptr));
    double at[2][12], hg[2][6], ddq[2][6];
    int which = 0;
    for (Simulation* one : {&play, &fresh}) {
      ASSERT_EQ(DYN_OK, dyn_forward_kinematics(one->m, one->d, next.data(), nullptr, nullptr));
      ASSERT_EQ(DYN_OK, dyn_frame_placement(one->m, one->d, dyn_model_frame_id(one->m, "a"), at[which])) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_centroidal_momentum(one->m, one->d, next.data(), v.data(), hg[which])) << dyn_last_error();
      ASSERT_EQ(DYN_OK, dyn_aba(one->m, one->d, next.data(), v.data(), tau.data(), nullptr, ddq[which++])) << dyn_last_error();
    }
    EXPECT_TRUE(std::equal(at[0], at[0] + 12, at[1])) << k;
    EXPECT_TRUE(std::equal(hg[0], hg[0] + 6, hg[1])) << k;
    EXPECT_TRUE(std::equal(ddq[0], ddq[0] + 6, ddq[1])) << k;
  }
}

// Refused options leave sleeping bodies asleep.
TEST(Step, RefusedOptionsWakeNobody) {
  Scene scene;
  Simulation play(scene.ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.6)).finish());
  dynData* plain = nullptr;  // without energies
  ASSERT_EQ(DYN_OK, dyn_data_new(play.m, DYN_PART_SIMULATION, &plain));
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(play.m, plain, 0, DYN_EFFECT_ALL));
  const double q[] = {0, 0, 0.1, 0, 0, 0, 1};
  ASSERT_EQ(DYN_OK, dyn_data_set_state(play.m, plain, q, nullptr, nullptr, nullptr));
  dynStepReport report{};
  report.struct_size = sizeof report;
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(DYN_OK, dyn_step(play.m, plain));
  ASSERT_EQ(DYN_OK, dyn_data_step_report(play.m, plain, &report));
  ASSERT_EQ(1, report.sleeping);
  dynStepOptions options = play.options;
  options.ledger = 1, options.dt = 2e-3, options.solver = DYN_CONTACT_SOLVER_TYPE_PGS;
  ASSERT_EQ(DYN_ERROR_PART, dyn_data_set_step_options(play.m, plain, &options));
  ASSERT_EQ(DYN_OK, dyn_step(play.m, plain));
  ASSERT_EQ(DYN_OK, dyn_data_step_report(play.m, plain, &report));
  EXPECT_EQ(1, report.sleeping);
  dyn_data_free(plain);
}

// Islands of more rows than a dense matrix holds.
TEST(Step, LargePileIsSolved) {
  Scene scene;
  scene.ground();
  std::vector<std::array<double, 3>> at;
  std::vector<std::string> names;
  for (int k = 0; k < 64; ++k) names.push_back("s" + std::to_string(k));
  for (int k = 0; k < 64; ++k) {
    scene.sphere(names[std::size_t(k)].c_str(), 1, 0.1, material(0.5));
    at.push_back({0.19 * (k % 4) + 0.001 * (k % 3), 0.19 * (k / 4 % 4) + 0.001 * (k % 5), 0.1 + 0.2 * (k / 16)});
  }
  Simulation play(scene.finish());
  play.place(at);
  const double start = play.energy();
  play.steps(1000);
  EXPECT_GT(play.report().rows, 0);
  EXPECT_LT(play.energy(), start);
  double lowest = inf;
  for (int k = 0; k < 64; ++k) lowest = std::min(lowest, play.q[7 * k + 2]);
  EXPECT_GT(lowest, 0.1 - 1e-4);
  EXPECT_LT(play.residual, 1e-8);
}

// The other integrators handle contact, too.
TEST(Step, EveryIntegratorHandlesContact) {
  for (const dynIntegrator integrator : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_IMPLICIT_FAST, DYN_INTEGRATOR_IMPLICIT_MIDPOINT, DYN_INTEGRATOR_RK45, DYN_INTEGRATOR_REFERENCE}) {
    Simulation run(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.5)).finish());
    run.options.integrator = integrator;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
    run.place({{0, 0, 0.5}});
    run.steps(600);
    EXPECT_NEAR(0.1, run.q[2], 1e-9) << int(integrator);
  }
}

// Error-controlled steps: a falling ball bounces and rises as in the closed form.
TEST(Step, AccuracyHoldsThroughImpacts) {
  const double height = 1, e = 0.5, g = 9.81, fall = std::sqrt(2 * height / g), rise = std::sqrt(2 * g * height) * e;
  for (const double accuracy : {1e-3, 1e-4, 1e-5}) {
    Simulation play(Scene().ground().sphere("ball", 1, 0.1, material(0.5, e)).finish());
    play.options.accuracy = accuracy;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
    play.place({{0, 0, height + 0.1}});
    const double after = 0.2;
    ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, fall + after)) << dyn_last_error();
    EXPECT_NEAR(0.1 + rise * after - g * after * after / 2, play.q[2], 3 * accuracy) << accuracy;
    EXPECT_LT(play.report().steps, 200);
  }
}

// A sphere slides, then rolls; a block slides, then rests.
TEST(Step, AccuracyHoldsThroughFriction) {
  const double mu = 0.2, g = 9.81, v0 = 1, duration = 0.5, rolls = 2 * v0 / (7 * mu * g);
  // the last two are below the contact solver's tolerance
  for (const double accuracy : {1e-3, 1e-5, 1e-7, 1e-8, 1e-10}) {
    const auto slide = [&](Model model, double height) {
      Simulation play(std::move(model));
      play.options.accuracy = accuracy;
      EXPECT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
      play.set({0, 0, height, 0, 0, 0, 1}, {v0, 0, 0, 0, 0, 0});
      EXPECT_EQ(DYN_OK, dyn_advance(play.m, play.d, duration)) << dyn_last_error();
      EXPECT_LT(play.report().steps, 500);
      return play.q[0];
    };
    EXPECT_NEAR(v0 * rolls - mu * g * rolls * rolls / 2 + 5 * v0 / 7 * (duration - rolls), slide(Scene().ground().sphere("ball", 1, 0.1, material(mu)).finish(), 0.1), 3 * accuracy) << accuracy;
    EXPECT_NEAR(v0 * v0 / (2 * 2 * mu * g), slide(Scene().ground().box("block", 1, {0.2, 0.2, 0.2}, material(2 * mu)).finish(), 0.1), 3 * accuracy) << accuracy;
  }
}

// A rod stands on its sticking end and falls: lasting contact while all rotates. The accuracy is met, and steps stay long.
TEST(Step, AccuracyHoldsThroughLastingContact) {
  const auto fall = [](double accuracy, std::int64_t steps) {
    Simulation play(Scene().ground().rod("rod", 1, 0.02, 1, material(1)).finish());
    play.options.accuracy = accuracy, play.options.tolerance = 1e-12;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
    const double lean = 0.3;
    play.set({0, 0, 0.02 + 0.5 * std::cos(lean), 0, std::sin(lean / 2), 0, std::cos(lean / 2)});
    EXPECT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.4)) << dyn_last_error();
    EXPECT_LT(play.report().steps, steps);
    return Numbers(play.q, play.q + 7);
  };
  const Numbers best = fall(1e-8, 1500);
  for (const double accuracy : {1e-3, 1e-5, 1e-6}) {
    const Numbers q = fall(accuracy, 300);
    for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(best[k], q[k], 3 * accuracy) << accuracy << " " << k;
  }
}

// A thin disc rolls on its rim, leaned by 30 degrees. A step that moves first approaches the ground as it turns; corrections
// must not lead it off. Energy and lean are kept in proportion to any accuracy.
TEST(Step, AccuracyHoldsWhileADiskRolls) {
  const double g = 9.81, lean = std::acos(-1.0) / 6, thin = 1e-6;
  for (const double a : {0.0375, 1.0})
    for (const double accuracy : {1e-4, 1e-6, 3e-7, 1e-7, 1e-8}) {
      const double I = a * a / 4, turn = std::sqrt(4 * g / (a * std::sin(lean)));
      Simulation play(Scene().ground().free("disc", 1, {I, I, 2 * I}).shape("disc", DYN_SHAPE_TYPE_CYLINDER, {a, thin, 0}, material(1)).finish());
      play.options.accuracy = accuracy, play.options.tolerance = 1e-13;
      ASSERT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
      play.set({0, 0, a * std::sin(lean) + thin / 2 * std::cos(lean), std::sin(lean / 2), 0, 0, std::cos(lean / 2)}, {0, 0, 0, 0, turn * std::sin(lean), 0});
      const double energy = play.energy();
      for (int k = 0; k < 5; ++k) {
        ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 2 * std::acos(-1.0) / turn)) << dyn_last_error();
        EXPECT_LT(play.report().steps + play.report().rejected, 20 / std::cbrt(accuracy)) << a << " " << accuracy;
      }
      EXPECT_NEAR(energy, play.energy(), 3 * accuracy) << a << " " << accuracy;
      EXPECT_NEAR(lean, 2 * std::asin(std::hypot(play.q[3], play.q[4])), accuracy + thin / a) << a << " " << accuracy;  // its centre is half of that off the rim
      EXPECT_EQ(1, play.report().contacts);
    }
}

// Two tilted boxes fall on one another and on the ground, bounce on their corners and come to rest in few steps (stalled, 0.01 s takes 1e5).
// The resting place is as accurate as asked. Which corner hits first is chance, so the median of five starts counts.
TEST(Step, AccuracyPassesAccumulatingImpacts) {
  std::vector<std::int64_t> all, longest;
  const auto fall = [&](double accuracy, double beside) {
    Simulation play(Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.5, 0.3)).box("b", 1, {0.2, 0.2, 0.2}, material(0.5, 0.3)).finish());
    play.options.accuracy = accuracy;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
    play.set({0, 0, 0.3, 0.104612, 0.104612, 0.020922, 0.988771, 0.03 + beside, 0.01, 0.62, 0.026804, 0.089346, 0.035738, 0.995004});
    double estimate = 0;
    std::int64_t steps = 0, most = 0;
    for (int k = 0; k < 100; ++k) {
      EXPECT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.01)) << dyn_last_error();
      const std::int64_t now = play.report().steps + play.report().rejected;
      most = std::max(most, now), steps += now, estimate += play.report().error_estimate;
    }
    EXPECT_LT(most, 10000);
    longest.push_back(most);
    EXPECT_LT(estimate, 100 * 3 * accuracy);  // of a hundred calls
    for (int k = 0; k < 12; ++k) EXPECT_NEAR(0, play.v[k], 3 * accuracy) << k;
    EXPECT_NEAR(0.1, play.q[2], accuracy);
    EXPECT_NEAR(0.3, play.q[9], accuracy);
    all.push_back(steps);
    return Numbers(play.q, play.q + 14);
  };
  std::vector<Numbers> places;  // of the first start
  for (const double accuracy : {1e-3, 1e-5}) {
    all.clear(), longest.clear();
    places.push_back(fall(accuracy, 0));
    for (const double beside : {0.001, 0.002, 0.003, 0.004}) fall(accuracy, beside);
    std::sort(all.begin(), all.end());
    EXPECT_LT(all[2], accuracy == 1e-3 ? 1500 : 6000) << accuracy;
    std::sort(longest.begin(), longest.end());
    EXPECT_LT(longest[2], accuracy == 1e-3 ? 500 : 3000) << accuracy;
  }
  for (std::size_t k = 0; k < 14; ++k) EXPECT_NEAR(places[1][k], places[0][k], 0.03) << k;  // (chance decides which of two corners hits first)
}

TEST(Step, EverySolverHoldsAStack) {
  for (const dynContactSolverType solver : {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON}) {
    Scene scene;
    scene.ground();
    std::vector<std::array<double, 3>> at;
    const char* names[] = {"b0", "b1", "b2", "b3", "b4"};
    for (int k = 0; k < 5; ++k) scene.box(names[k], 1, {0.2, 0.2, 0.2}, material(0.6)), at.push_back({0, 0, 0.1 + 0.2 * k});
    Simulation run(scene.finish(), 1e-3, solver);
    run.options.max_iterations = 2000;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
    run.place(at);
    run.steps(300);
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(0.1 + 0.2 * k, run.q[7 * k + 2], 1e-6) << int(solver);
    EXPECT_EQ(20, run.report().contacts);
  }
}

TEST(Step, MaterialsCombineAndInvalidOnesAreRefused) {
  Simulation run(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.25)).finish());
  dynMaterial x;
  ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 1, &x));
  EXPECT_EQ(0.25, x.friction);
  dynShapeInfo info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(DYN_OK, dyn_model_shape_info(run.m, 1, &info));
  EXPECT_EQ(0.25, info.material.friction);
  const dynMaterial good = material(0.75);
  ASSERT_EQ(DYN_OK, dyn_data_set_shape_material(run.m, run.d, -1, &good));
  ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 0, &x));
  EXPECT_EQ(0.75, x.friction);
  for (double dynMaterial::*number : {&dynMaterial::friction, &dynMaterial::torsion, &dynMaterial::rolling, &dynMaterial::restitution, &dynMaterial::stiffness,
                                      &dynMaterial::damping})
    for (const double bad : {-1.0, nan, inf, 1e16}) {
      dynMaterial wrong = good;
      wrong.*number = bad;
      EXPECT_NE(DYN_OK, dyn_data_set_shape_material(run.m, run.d, 1, &wrong)) << bad;
      ASSERT_EQ(DYN_OK, dyn_data_shape_material(run.m, run.d, 1, &x));
      EXPECT_EQ(0.75, x.friction);
      dynShapeSpec spec;
      dyn_shape_spec_init(&spec);
      spec.size[0] = spec.size[1] = spec.size[2] = 1, spec.material = wrong;
      dynBuilder* b = nullptr;
      ASSERT_EQ(DYN_OK, dyn_builder_new("x", &b));
      EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_add_shape(b, &spec));
      EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "material"));
      dyn_builder_free(b);
    }
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_shape_material(run.m, run.d, 7, &good));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_set_shape_material(run.m, run.d, 1, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_shape_material(run.m, run.d, -1, &x));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_shape_material(run.m, run.d, 0, nullptr));
  int count = 0;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, 1, &count));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_step_contacts(run.m, run.d, nullptr, -1, &count));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_step_contacts(nullptr, run.d, nullptr, 0, &count));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_shape_material(run.m, nullptr, 0, &x));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_data_set_shape_material(nullptr, run.d, 0, &good));
}

}  // namespace
}  // namespace dyn_test
