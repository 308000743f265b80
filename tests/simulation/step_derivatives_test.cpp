// Derivatives of steps: the analytic ones against central differences, exact values, modes at switches, and what must not change.
#include <random>

#include "simulation/step_derivatives.hpp"

namespace dyn_test {
namespace {

// ---------------------------------------------------------------------------------------------------- without contact

TEST(StepDerivatives, OfASmoothArm) {
  Stepper run(robot("panda"));
  Numbers q(static_cast<std::size_t>(run.m.nq())), v(static_cast<std::size_t>(run.m.nv())), tau(v.size());
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = k == 3 ? -1.5 : k == 5 ? 1.8 : k == 7 ? 0.02 : 0.02 + 0.1 * double(k % 3);
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = 0.5 - 0.2 * double(k), tau[k] = double(k) - 3;
  run.set(q, v, tau);
  for (dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
    run.integrate_by(by);
    run.agree(1e-7);
  }
}

TEST(StepDerivatives, OfEveryJointType) {
  for (bool mimic : {false, true}) {
    Stepper run(all_types(mimic), 2e-3);
    for (unsigned seed : {1, 2, 3}) {
      const State s = random_state(run.m, seed);
      run.set(s.q, s.v, s.tau);
      run.agree(1e-6);
    }
  }
}

// A tumbling body with its centre of mass off its origin.
TEST(StepDerivatives, OfAFreeBody) {
  Stepper run(Scene().free("stone", 2, {0.1, 0.2, 0.25}, {0.1, 0.2, 0.3}).finish(), 5e-3);
  run.set({0.1, 0.2, 1, 0.1, 0.2, 0.3, 0.9}, {1, 2, 3, 4, 5, -6}, {1, 2, 3, 0.4, 0.5, 0.6});
  run.agree(1e-7);
}

TEST(StepDerivatives, OtherIntegratorsHaveCentralDifferences) {
  Stepper run(robot("panda"));
  run.integrate_by(DYN_INTEGRATOR_RK4);
  const Derivatives x = derivatives(run.m, run.d, DYN_DERIVATIVE_METHOD_AUTO);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  EXPECT_EQ(DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES, x.report.method);
  EXPECT_STREQ("the integrator is neither SEMI_IMPLICIT_EULER nor IMPLICIT_FAST", x.report.reason);
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED, derivatives(run.m, run.d, DYN_DERIVATIVE_METHOD_ANALYTIC).status);
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "SEMI_IMPLICIT_EULER")) << dyn_last_error();
}

// Two wheels with motors, by a method of order 4: v' = v + h gear u / I, q' = q + h v + h^2 gear u / (2 I). The same by tau,
// without the gear.
TEST(StepDerivatives, DifferencesByControlsOfOtherIntegrators) {
  constexpr double h = 0.01, inertia[2] = {0.5, 0.2}, gear[2] = {3, -2};
  Builder b;
  for (int k = 0; k < 2; ++k) {
    const std::string name(1, char('a' + k)), body = name + "_wheel";
    const double com[3] = {}, I[9] = {1, 0, 0, 0, 1, 0, 0, 0, inertia[k]};
    b.joint(Spec(name.c_str(), DYN_JOINT_TYPE_REVOLUTE).about(0, 0, 1));
    ASSERT_EQ(DYN_OK, dyn_builder_add_body(b, body.c_str(), name.c_str(), nullptr, 2, com, I)) << dyn_last_error();
    dynActuator a;
    dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_MOTOR);
    a.gear = gear[k];
    ASSERT_EQ(DYN_OK, dyn_builder_add_actuator(b, name.c_str(), &a, name.c_str())) << dyn_last_error();
  }
  Stepper run(b.finish(), h);
  run.integrate_by(DYN_INTEGRATOR_RK4);
  run.set({0.1, 0.2}, {1, -2});
  const Derivatives x = run.central(1e-3);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      const double by = i == k ? h / inertia[k] : 0;  // of v' by tau
      EXPECT_NEAR(by * h / 2, x.B[i + 4 * k], 1e-12);
      EXPECT_NEAR(by, x.B[2 + i + 4 * k], 1e-12);
      EXPECT_NEAR(by * gear[k] * h / 2, x.B_control[i + 4 * k], 1e-12);
      EXPECT_NEAR(by * gear[k], x.B_control[2 + i + 4 * k], 1e-12);
    }
}

// ---------------------------------------------------------------------------------------------------- contacts

TEST(StepDerivatives, OfARollingBall) {
  Stepper run(ball_on_ground(0.8));
  run.set(upright(0, 0, 0.1 + 5e-6), {0.3, 0, 0, 0, 3, 0});
  const Derivatives x = run.agree();
  ASSERT_EQ(1u, x.modes.size());
  EXPECT_EQ(DYN_CONTACT_MODE_STICK, x.modes[0]);
}

TEST(StepDerivatives, OfASlidingBall) {
  Stepper run(ball_on_ground(0.3));
  run.set(upright(0, 0, 0.1 + 5e-6), {1, 0.5, 0, 0, 0, 2});
  const Derivatives x = run.agree();
  ASSERT_EQ(1u, x.modes.size());
  EXPECT_EQ(DYN_CONTACT_MODE_SLIDE, x.modes[0]);
}

TEST(StepDerivatives, OfABallThatRebounds) {
  Stepper run(ball_on_ground(0.5, 0.7));
  run.set(upright(0, 0, 0.1 + 1e-4), {0.3, 0.1, -1, 0, 1, 2});
  const Derivatives x = run.agree();
  ASSERT_EQ(1u, x.modes.size());
  EXPECT_EQ(DYN_CONTACT_MODE_IMPACT, x.modes[0]);
}

// The products of central differences are those of their matrices.
TEST(StepDerivatives, ProductsOfCentralDifferences) {
  Stepper run(ball_on_ground(0.3));
  run.set(upright(0, 0, 0.1 + 5e-6), {1, 0.5, 0, 0, 0, 2});
  expect_products(run.m, run.d, run.central(1e-6), DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES);
  run.integrate_by(DYN_INTEGRATOR_RK4), run.set(upright(0, 0, 1), {1, 2, 3, 4, 5, 6});
  const Derivatives x = derivatives(run.m, run.d, DYN_DERIVATIVE_METHOD_AUTO);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  EXPECT_EQ(DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES, x.report.method);
  expect_products(run.m, run.d, x, DYN_DERIVATIVE_METHOD_AUTO);
}

// Two equal balls on a line, elastic: they exchange their velocities.
TEST(StepDerivatives, OfTwoElasticBallsAreExact) {
  Builder b("balls");
  const double none[3] = {0, 0, 0};
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  for (const char* name : {"one", "two"}) {
    const std::string joint = std::string(name) + "_joint";
    b.joint(Spec(joint.c_str(), DYN_JOINT_TYPE_PRISMATIC, nullptr, {name[0] == 't' ? 1.0 : 0.0, 0, 0}).about(1, 0, 0))
        .body(name, joint.c_str(), 1, {0, 0, 0});
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = name, s.type = DYN_SHAPE_TYPE_SPHERE, s.size[0] = 0.1, s.material = material(0, 1);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s));
  }
  Stepper run(b.finish());
  run.set({0, -0.8}, {2, 0});
  const Derivatives x = derivatives(run.m, run.d, DYN_DERIVATIVE_METHOD_ANALYTIC);
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  ASSERT_EQ(1u, x.modes.size());
  EXPECT_EQ(DYN_CONTACT_MODE_IMPACT, x.modes[0]);
  const double h = 1e-3;
  // columns of q1, q2, v1, v2; rows q1', q2', v1', v2'
  const Numbers exact = {1, 0, 0, 0, 0, 1, 0, 0, 0, h, 0, 1, h, 0, 1, 0};
  EXPECT_LE(difference(exact, x.A), 1e-12);
}

// The end of a capsule is a ball's surface. Contacts of balls have closed forms, those of capsules central differences: their
// error falls with the square of 1e-5 m over the radii, 3 mm together.
TEST(StepDerivatives, OfACapsuleEndAreThoseOfABall) {
  Numbers A[2];
  for (const bool capsule : {false, true}) {
    Scene scene({0, 0, 0});
    const dynMaterial rough = material(0.3);
    if (capsule) scene.shape("universe", DYN_SHAPE_TYPE_CAPSULE, {2e-3, 0.02, 0}, rough, {0, 0, -0.01});
    else scene.shape("universe", DYN_SHAPE_TYPE_SPHERE, {2e-3, 0, 0}, rough);
    Stepper run(scene.sphere("ball", 1, 1e-3, rough).finish());
    const double angle = 0.6, apart = 3e-3 - 1e-6;
    run.set(upright(apart * std::sin(angle), 0, apart * std::cos(angle)), {0.01, 0.02, -0.03, 1, 2, 3});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(DYN_CONTACT_MODE_SLIDE, x.modes[0]);
    A[capsule] = x.A;
  }
  EXPECT_LE(difference(A[0], A[1]), 2e-5 * largest(A[0]));
}

// Depth: the correction of positions acts, too.
TEST(StepDerivatives, OfABallThatSinksIn) {
  for (double friction : {0.0, 0.4}) {
    Stepper run(ball_on_ground(friction));
    run.set(upright(0, 0, 0.1 - 1e-4), {0.3, 0, 0, 0, 3, 0});
    run.agree();
  }
}

TEST(StepDerivatives, OfASoftContact) {
  Scene scene;
  dynMaterial soft = material(0.5);
  soft.stiffness = 1e4, soft.damping = 50;
  scene.ground().sphere("ball", 1, 0.1, soft);
  Stepper run(scene.finish());
  run.set(upright(0, 0, 0.1 - 1e-3), {0.3, 0, 0, 0, 3, 0});
  run.agree();
}

TEST(StepDerivatives, OfABelt) {
  Scene scene;
  dynMaterial belt = material(0.5);
  belt.surface_velocity[0] = 0.7;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, belt).sphere("ball", 1, 0.1, material(0.5));
  Stepper run(scene.finish());
  run.set(upright(0, 0, 0.1 - 1e-5), {0.3, 0.1, 0, 0, 0, 2});
  run.agree();
}

// Two balls that roll on one another: the normal turns.
TEST(StepDerivatives, OfBallsOnEachOther) {
  Scene scene;
  scene.sphere("lower", 1, 0.1, material(0.6)).sphere("upper", 0.5, 0.05, material(0.6));
  Stepper run(scene.finish());
  run.set(joined({upright(0, 0, 1), upright(0.09, 0, 1 + 0.12 - 1e-5)}), {0.1, 0.2, 0.3, 1, 2, 3, 0.1, -0.2, 0.1, -1, 2, 0.5});
  run.agree();
}

// Eight redundant rows a face. Depths differ from zero, so no mode is degenerate.
TEST(StepDerivatives, OfAStackOfBoxes) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.7));
  scene.box("lower", 2, {0.2, 0.2, 0.1}, material(0.7)).box("upper", 1, {0.15, 0.15, 0.1}, material(0.7));
  Stepper run(scene.finish());
  run.set(joined({upright(0, 0, 0.05 - 1e-5), upright(0.01, 0.02, 0.15 - 3e-5)}));
  const Derivatives x = run.agree();
  EXPECT_EQ(8u, x.modes.size());
}

TEST(StepDerivatives, OfASlidingBox) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.3)).box("box", 2, {0.2, 0.3, 0.1}, material(0.3));
  Stepper run(scene.finish());
  run.set(upright(0, 0, 0.05 - 1e-4), {1, 0.3, 0, 0, 0, 0});
  const Derivatives x = run.agree(1e-6, true, 1e-5);  // of a speed of 1 m/s solved to 1e-12
  ASSERT_EQ(4u, x.modes.size());
  for (dynContactMode mode : x.modes) EXPECT_EQ(DYN_CONTACT_MODE_SLIDE, mode);
}

// A box slides at 1 m/s. Its four corners are redundant. Turning at w, friction has other directions at the corners, so that their
// loads decide on its moment, to a share of w times half a length over the speed: 1e-5 is what rounding leaves of that.
TEST(StepDerivatives, OfASlidingBoxThatTurns) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.3)).box("box", 1, {0.4, 0.3, 0.2}, material(0.3));
  Stepper run(scene.finish());
  for (const double w : {0.0, 1e-5, 1.2e-4, 1e-2}) {
    run.set(upright(0, 0, 0.1 - 1e-4), {1, 0.5, 0, 0, 0, w});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    EXPECT_EQ(w > 3e-5 ? 4 : 0, x.report.degenerate) << w;
  }
}

// A box on two feet that are 30 um apart, between two that are not: what is nearly redundant is not left out. Tilting moves it by
// nothing, though the lever is short.
TEST(StepDerivatives, OfRowsThatNearlyDepend) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5)).free("box", 1, {0.1, 0.1, 0.1});
  for (const auto& [x, y] : {std::pair{0.0, 0.5}, {0.0, -0.5}, {1.5e-5, 0.0}, {-1.5e-5, 0.0}})
    scene.shape("box", DYN_SHAPE_TYPE_SPHERE, {0.05, 0, 0}, material(0.5), {x, y, -0.05});
  Stepper run(scene.finish());
  run.set(upright(0, 0, 0.1 - 1e-5));
  const Derivatives x = run.analytic();
  ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
  EXPECT_EQ(4u, x.modes.size());
  EXPECT_EQ(0, x.report.degenerate);
  EXPECT_LT(std::abs(x.B[10 + 12 * 4]), 1e-8);  // rad/s by a moment about y; 0.009 of a free body
}

// Sweeps approach their solution slowly: differences see where they end, 1e-12 of the speed over the change of 1e-6.
TEST(StepDerivatives, DifferencesOfSweepsEndClose) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.3)).box("box", 1, {0.4, 0.3, 0.2}, material(0.3));
  Stepper run(scene.finish());
  run.options.solver = DYN_CONTACT_SOLVER_TYPE_PGS;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options)) << dyn_last_error();
  run.set(upright(0, 0, 0.1 - 1e-4), {1, 0.5, 0, 0, 0, 0});
  run.agree(3e-5);
}

// ---------------------------------------------------------------------------------------------------- forces

TEST(StepDerivatives, OfWrenchesAndControls) {
  Stepper run(all_types(false), 2e-3);
  const State s = random_state(run.m, 5);
  run.set(s.q, s.v, s.tau);
  const double wrench[6] = {1, -2, 3, 0.3, 0.2, -0.1}, point[3] = {0.1, 0.2, 0.3};
  for (dynReference r : {DYN_REFERENCE_LOCAL, DYN_REFERENCE_LOCAL_WORLD_ALIGNED, DYN_REFERENCE_WORLD})
    ASSERT_EQ(DYN_OK,
              dyn_data_apply_wrench(run.m, run.d, run.m.nframes() - 1, r == DYN_REFERENCE_WORLD ? nullptr : point, wrench, r))
        << dyn_last_error();
  run.agree();
}

// Tendons on joints of several trees: springs and dampers that the step adds to tau, and stiff ones and armature that it takes at
// its end; a motor and a servo, at the ends of their ranges and within, and one that is filtered.
Model with_fixed_tendons(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  Builder b;
  const char* const names[] = {"a", "b", "c", "d", "e"};
  const char* const links[] = {"la", "lb", "lc", "ld", "le"};
  for (int k = 0; k < 5; ++k) {
    Spec joint(names[k], k % 2 ? DYN_JOINT_TYPE_PRISMATIC : DYN_JOINT_TYPE_REVOLUTE, k == 0 || k == 3 ? nullptr : links[k - 1],
               {0.2 * k, 0.1, 0});
    joint.about(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const double damping = uniform(0, 1);
    joint.damping = &damping;
    b.joint(joint).body(links[k], names[k], uniform(0.5, 2));
  }
  for (int k = 0; k < 3; ++k) {
    dynTendon t;
    dyn_tendon_init(&t, DYN_TENDON_TYPE_FIXED);
    const bool stiff = k == 1;
    t.stiffness = stiff ? uniform(1e4, 1e6) : uniform(0, 20), t.damping = stiff ? uniform(0, 1e3) : uniform(0, 2);
    t.rest[0] = -0.05, t.rest[1] = 0.05, t.armature = k == 2 ? uniform(0.1, 3) : 0;
    std::vector<dynTendonElement> elements(3);
    for (int i = 0; i < 3; ++i) {
      dyn_tendon_element_init(&elements[std::size_t(i)], DYN_TENDON_ELEMENT_TYPE_JOINT);
      elements[std::size_t(i)].name = names[(k + 2 * i) % 5], elements[std::size_t(i)].value = uniform(-1, 1);
    }
    const std::string name = "tendon" + std::to_string(k);
    EXPECT_EQ(DYN_OK, dyn_builder_add_tendon(b, name.c_str(), &t, elements.data(), 3)) << dyn_last_error();
    dynActuator a;
    dyn_actuator_init(&a, k == 0 ? DYN_ACTUATOR_TYPE_MOTOR : DYN_ACTUATOR_TYPE_POSITION);
    a.transmission = DYN_TRANSMISSION_TENDON, a.gear = uniform(-2, 2), a.kp = uniform(1, 1e3), a.kv = uniform(0, 30);
    if (k == 0) a.time_constant = 0.02;
    if (k == 2) a.force_range[0] = -1, a.force_range[1] = 2;
    EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, ("drive" + std::to_string(k)).c_str(), &a, name.c_str())) << dyn_last_error();
  }
  return b.finish();
}
TEST(StepDerivatives, OfFixedTendons) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Stepper run(with_fixed_tendons(seed), seed % 3 ? 2e-3 : 1e-2);
    for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST}) {
      run.integrate_by(by);
      const State s = random_state(run.m, int(seed));
      run.set(s.q, s.v, s.tau);
      const double u[] = {0.4, -0.2, 0.3};
      ASSERT_EQ(DYN_OK, dyn_data_set_control(run.m, run.d, u));
      // differences have the noise of the rows of stiff tendons; v' is linear in tau and in controls
      const Derivatives a = run.analytic(), c = run.central(3e-5), wide = run.central(1e-3), wider = run.central(0.1);
      ASSERT_EQ(DYN_OK, a.status) << dyn_last_error();
      EXPECT_LE(difference(a.A, c.A), 1e-6 * std::max(1.0, largest(c.A)));
      // the wide one has less noise, but may reach the end of a servo's range
      EXPECT_LE(std::min(difference(a.B, wide.B), difference(a.B, wider.B)), 1e-6 * largest(a.B));
      EXPECT_LE(difference(a.B_control, wide.B_control), 1e-6 * std::max(1.0, largest(wide.B_control)));
      EXPECT_GT(largest(a.B_control), 0);
      expect_products(run.m, run.d, a, DYN_DERIVATIVE_METHOD_ANALYTIC);
    }
  }
}

// ---------------------------------------------------------------------------------------------------- the call

TEST(StepDerivatives, LeaveTheStateAndTheNextStep) {
  for (dynDerivativeMethod method : {DYN_DERIVATIVE_METHOD_ANALYTIC, DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES}) {
    Stepper run(ball_on_ground(0.5)), other(ball_on_ground(0.5));
    for (Stepper* r : {&run, &other}) r->set(upright(0, 0, 0.13), {0.3, 0, -0.1, 0, 3, 0}), r->steps(100);
    std::vector<unsigned char> before(dyn_model_state_size(run.m)), after(before.size());
    ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, run.d, before.data(), before.size()));
    const Derivatives x = derivatives(run.m, run.d, method);
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_data_save_state(run.m, run.d, after.data(), after.size()));
    EXPECT_EQ(before, after);
    run.steps(50), other.steps(50);
    EXPECT_EQ(other.value("q"), run.value("q"));
    EXPECT_EQ(other.value("v"), run.value("v"));
  }
}

TEST(StepDerivatives, RefuseWhatIsWrong) {
  Stepper run(ball_on_ground(0.5));
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out);
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_step_derivatives(run.m, run.d, nullptr, nullptr));
  EXPECT_EQ(DYN_ERROR_HANDLE, dyn_step_derivatives(run.m, nullptr, nullptr, &out));
  out.capacity = -1;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_step_derivatives(run.m, run.d, nullptr, &out));
  out.capacity = 0;
  dynStepDerivativeOptions options;
  const auto refused = [&](auto&& change, dynStatus expected) {
    dyn_step_derivative_options_init(&options);
    change(options);
    EXPECT_EQ(expected, dyn_step_derivatives(run.m, run.d, &options, &out)) << dyn_last_error();
  };
  refused([](auto& o) { o.epsilon = 0; }, DYN_ERROR_ARGUMENT);
  refused([](auto& o) { o.epsilon = nan; }, DYN_ERROR_NONFINITE);
  refused([](auto& o) { o.margin = -1; }, DYN_ERROR_ARGUMENT);
  refused([](auto& o) { o.method = static_cast<dynDerivativeMethod>(7); }, DYN_ERROR_ARGUMENT);
  refused([](auto& o) { o.struct_size = 7; }, DYN_ERROR_SIZE);
  const auto refused_product = [&](auto&& change, const char* named) {
    dyn_step_derivatives_init(&out), change();
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_step_derivatives(run.m, run.d, nullptr, &out)) << named;
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), named)) << dyn_last_error();
  };
  Numbers in(18, 0.5), result(18);
  refused_product([&] { out.tangent_count = -1; }, "tangent_count is -1");
  refused_product([&] { out.tangent_count = 1, out.jvp = result.data(); }, "tangents");
  refused_product([&] { out.tangent_count = 1, out.tangents = in.data(); }, "jvp");
  refused_product([&] { out.cotangent_count = -2; }, "cotangent_count is -2");
  refused_product([&] { out.cotangent_count = 1, out.vjp = result.data(); }, "cotangents");
  refused_product([&] { out.cotangent_count = 1, out.cotangents = in.data(); }, "vjp");
  dyn_step_derivatives_init(&out), in[3] = nan;
  out.tangent_count = 1, out.tangents = in.data(), out.jvp = result.data();
  EXPECT_EQ(DYN_ERROR_NONFINITE, dyn_step_derivatives(run.m, run.d, nullptr, &out));
  dyn_step_derivatives_init(&out);
  dynData* small = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(run.m, DYN_PART_SIMULATION, &small));
  EXPECT_EQ(DYN_ERROR_PART, dyn_step_derivatives(run.m, small, nullptr, &out));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "STEP_DERIVATIVES")) << dyn_last_error();
  dyn_data_free(small);
}

}  // namespace
}  // namespace dyn_test
