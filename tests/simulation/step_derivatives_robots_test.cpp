// Derivatives of steps of robots and mechanisms: on their feet, at a limit, with closed loops, with an object.
#include "simulation/step_derivatives.hpp"

namespace dyn_test {
namespace {

TEST(StepDerivatives, OfAStandingQuadruped) {
  Numbers q;
  Stepper run(standing("go2", {0, 0.9, -1.8}, q, 2e-5), 2e-3);
  hold(run, q);
  const Derivatives x = run.agree();
  EXPECT_EQ(4, x.report.active);
}

// A box that slides and turns: how its corners share the weight is open, and so is the moment of their friction.
TEST(StepDerivatives, MotionThatForcesDoNotDetermineIsDegenerate) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.3)).box("box", 2, {0.2, 0.3, 0.1}, material(0.3));
  Stepper run(scene.finish());
  run.set(upright(0, 0, 0.05 - 1e-5), {1, 0.3, 0, 0, 0, 0.5});
  const Derivatives x = run.analytic();
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  EXPECT_EQ(4, x.report.degenerate);
}

TEST(StepDerivatives, OfAStandingHumanoid) {
  Numbers q;
  Numbers angles(33, 0.0);
  angles[29 - 7] = 0.2, angles[35 - 7] = -0.2;  // legs apart
  angles[33 - 7] = -0.2, angles[39 - 7] = 0.2;  // soles level
  for (int leg : {28, 34}) angles[std::size_t(leg + 3 - 7)] = 0.1, angles[std::size_t(leg + 4 - 7)] = -0.1;
  Stepper run(standing("humanoid", angles, q, 1e-4), 2e-3);
  run.set(q);
  const Derivatives x = run.agree(1e-5, false);  // some of the eight corners bear nothing
  EXPECT_GE(x.report.active, 4);
}

TEST(StepDerivatives, OfAnArmAtItsLimit) {
  Stepper run(robot("panda"));
  Numbers q(static_cast<std::size_t>(run.m.nq())), v(static_cast<std::size_t>(run.m.nv()));
  const double* const upper = dyn_model_array(run.m, DYN_MODEL_ARRAY_UPPER_LIMIT);
  q[3] = -1.5, q[5] = 1.8, q[7] = 0.02, q[1] = upper[1] + 1e-5, v[1] = 0.5, v[0] = 0.3;
  run.set(q, v);
  run.agree();
}

// A pendulum beyond its one limit, without room for constraints: as many rows are corrected as there can be.
TEST(StepDerivatives, OfAPendulumBeyondItsLimit) {
  Builder b;
  const double upper = 0.2;
  ASSERT_EQ(DYN_OK, dyn_builder_set_constraint_slots(b, 0));
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  hinge.about(0, 1, 0), hinge.upper = &upper;
  b.joint(hinge).body("bob", "hinge", 1, {0, 0, -1});
  Stepper run(b.finish());
  run.set({0.2 + 2e-4}, {0.1});
  const Derivatives x = run.agree();
  EXPECT_EQ(DYN_DERIVATIVE_METHOD_ANALYTIC, x.report.method);
  EXPECT_NEAR(0.2 + 1e-4, x.q[0], 1e-9);  // a step removes half of what a limit is passed by
}

TEST(StepDerivatives, OfMechanisms) {
  for (const char* name : {"four_bar.urdf", "four_bar_in_space.urdf"}) {
    SCOPED_TRACE(name);
    for (double speed : {0.0, 0.7}) {
      Stepper run(mechanism(name));
      Numbers q(static_cast<std::size_t>(run.m.nq())), v(static_cast<std::size_t>(run.m.nv()), speed);
      ASSERT_EQ(DYN_OK, dyn_configuration_neutral(run.m, q.data()));
      for (double& x : q) x += 0.2;
      close_loops(run, q, v);
      const Derivatives x = run.agree(1e-5);
      EXPECT_EQ(DYN_OK, x.status) << dyn_last_error();
    }
  }
}

// A loop that is open by more than 1e-5 m is closed in a way that the analytic derivatives do not cover.
TEST(StepDerivatives, OfALoopThatIsOpen) {
  Stepper run(mechanism("four_bar.urdf"));
  Numbers q(3, 0.2), v(3, 0.7);
  close_loops(run, q, v);
  q = run.value("q"), v = run.value("v");
  const auto open = [&](double by) {
    Numbers off = q;
    off[1] += by;
    Numbers error(12);
    EXPECT_EQ(DYN_OK, dyn_constraint_terms(run.m, run.d, off.data(), v.data(), error.data(), nullptr, nullptr, nullptr))
        << dyn_last_error();
    run.set(off, v);
    return largest(error);
  };
  const double a_radian = open(1e-6) / 1e-6;
  open(5e-6 / a_radian);
  run.agree(1e-4, false);
  EXPECT_EQ(DYN_OK, run.analytic().status) << dyn_last_error();
  open(2e-5 / a_radian);
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED, run.analytic().status);
}

// Two sleds, each geared to the other by its own ratio, so that the two rows nearly depend. An error that both rows hardly see
// closes slowly.
TEST(StepDerivatives, OfGearsThatNearlyAgree) {
  const double none[3] = {};
  for (const double apart : {5e-3, 1e-2}) {
    Builder b;
    ASSERT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    for (const char* name : {"a", "b"})
      b.joint(Spec(name, DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)).body((std::string(name) + "_sled").c_str(), name, 1);
    for (const bool second : {false, true}) {
      dynConstraint c;
      dyn_constraint_init(&c, DYN_CONSTRAINT_TYPE_COUPLING);
      std::fill_n(c.coefficients, 5, 0.0);
      c.coefficients[1] = second ? 2 * (1 + apart) : 0.5;
      ASSERT_EQ(DYN_OK, dyn_builder_add_constraint(b, second ? "back" : "there", &c, second ? "b" : "a", second ? "a" : "b"))
          << dyn_last_error();
    }
    Stepper run(b.finish());
    run.set({1e-6, 2e-6}, {0, 0});
    run.agree(1e-5);
  }
}

// A four-bar whose coupler carries a ball that comes down on the ground within the step. Where the loop is open a little, the
// contact joins in closing it, by the side to which that pushes: it is degenerate. Motion with a closed loop has no kink.
TEST(StepDerivatives, OfAFourBarWithContact) {
  Stepper alone(mechanism("four_bar.urdf"));
  Numbers q(3, 0.2), v(3, 0.7);
  close_loops(alone, q, v);
  q = alone.value("q"), v = alone.value("v");
  double X[12];
  ASSERT_EQ(DYN_OK, dyn_forward_kinematics(alone.m, alone.d, q.data(), nullptr, nullptr)) << dyn_last_error();
  ASSERT_EQ(DYN_OK, dyn_frame_placement(alone.m, alone.d, dyn_model_frame_id(alone.m, "coupler"), X)) << dyn_last_error();
  const double along = 0.5, radius = 0.1, low = X[10] + X[1] * along - radius;  // lowest point of the ball, y upwards
  for (double friction : {0.0, 0.3, 2.0}) {
    dynBuilder* b = nullptr;
    ASSERT_EQ(DYN_OK, dyn_builder_from_model(alone.m, &b));
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = "coupler", s.type = DYN_SHAPE_TYPE_SPHERE, s.size[0] = radius, s.placement[9] = along;
    s.material = material(friction);
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
    dyn_shape_spec_init(&s);
    s.body = "universe", s.type = DYN_SHAPE_TYPE_HALF_SPACE, s.material = material(friction);
    const double turned[12] = {1, 0, 0, 0, 0, -1, 0, 1, 0, 0, low - 1e-5, 0};  // its normal along y
    std::copy_n(turned, 12, s.placement);
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
    dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
    dyn_builder_free(b);
    Stepper run{Model(m)};
    run.set(q, v);
    const Derivatives x = run.analytic(), c = run.central(1e-6);
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    EXPECT_EQ(1, x.report.active) << friction;
    EXPECT_EQ(1, x.report.degenerate) << friction;
    expect_products(run.m, run.d, x, DYN_DERIVATIVE_METHOD_ANALYTIC);
    const auto along = [&](const Derivatives& of, std::size_t row, std::size_t first) {  // its derivative along v
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += of.A[row + 6 * (first + k)] * v[k];
      return sum;
    };
    const double size = largest(c.A);
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t first : {std::size_t(0), std::size_t(3)})
        EXPECT_NEAR(along(c, row, first), along(x, row, first), 1e-7 * size) << friction << ' ' << row << ' ' << first;
    EXPECT_LE(difference(x.B, c.B), 1e-6 * std::max(1.0, largest(c.B)));
  }
}

// Two fingers that press on a box and hold it up.
TEST(StepDerivatives, OfAGripperWithAnObject) {
  const char* const text =
      "<mujoco><worldbody>"
      "<body pos='-0.07 0 0'><joint type='slide' axis='1 0 0'/><geom type='sphere' size='0.02' mass='0.1' friction='1'/></body>"
      "<body pos='0.07 0 0'><joint type='slide' axis='1 0 0'/><geom type='sphere' size='0.02' mass='0.1' friction='1'/></body>"
      "<body><freejoint/><geom type='box' size='0.05 0.05 0.05' mass='0.2' friction='1'/></body></worldbody></mujoco>";
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
  Stepper run{Model(m)};
  Numbers q(static_cast<std::size_t>(run.m.nq())), tau(static_cast<std::size_t>(run.m.nv()));
  ASSERT_EQ(DYN_OK, dyn_model_configuration(run.m, "qpos0", q.data()));
  q[0] = 1e-5, q[1] = -2e-5, tau[0] = 5, tau[1] = -5;
  run.set(q, {}, tau);
  const Derivatives x = run.agree(1e-5);
  ASSERT_EQ(2, x.report.active);
  for (dynContactMode mode : x.modes) EXPECT_EQ(DYN_CONTACT_MODE_STICK, mode);
}

}  // namespace
}  // namespace dyn_test
