// Derivatives of steps: the analytic ones against central differences, exact values, modes at switches, and what must not change.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

struct Derivatives {
  Numbers A, B, B_control, q, v;
  std::vector<dynContactForce> contacts;
  std::vector<dynContactMode> modes;
  std::vector<std::int32_t> degenerate;
  dynStepDerivativeReport report{};
  dynStatus status = DYN_OK;
};

Derivatives derivatives(const dynModel* m, dynData* d, dynDerivativeMethod method, double epsilon = 1e-6, double margin = 1e-6) {
  const auto nq = static_cast<std::size_t>(dyn_model_nq(m)), nv = static_cast<std::size_t>(dyn_model_nv(m)),
             nu = static_cast<std::size_t>(dyn_model_nu(m)), room = static_cast<std::size_t>(dyn_model_contact_capacity(m));
  Derivatives x{Numbers(4 * nv * nv), Numbers(2 * nv * nv), Numbers(2 * nv * nu), Numbers(nq), Numbers(nv), {}, {}, {}};
  x.contacts.resize(room), x.modes.resize(room), x.degenerate.resize(room);
  dynStepDerivativeOptions options;
  dyn_step_derivative_options_init(&options);
  options.method = method, options.epsilon = epsilon, options.margin = margin;
  dynStepDerivatives out;
  dyn_step_derivatives_init(&out);
  x.report.struct_size = sizeof x.report;
  out.capacity = static_cast<std::int32_t>(room), out.A = x.A.data(), out.B = x.B.data(), out.B_control = x.B_control.data();
  out.q = x.q.data(), out.v = x.v.data(), out.contacts = x.contacts.data(), out.modes = x.modes.data();
  out.degenerate = x.degenerate.data(), out.report = &x.report;
  x.status = dyn_step_derivatives(m, d, &options, &out);
  const auto n = static_cast<std::size_t>(x.report.contacts);
  if (x.status == DYN_OK) x.contacts.resize(n), x.modes.resize(n), x.degenerate.resize(n);
  return x;
}

double largest(const Numbers& x) {
  double most = 0;
  for (double a : x) most = std::max(most, std::abs(a));
  return most;
}
double difference(const Numbers& a, const Numbers& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

struct Stepper {
  Model m;
  dynData* d = nullptr;
  dynStepOptions options;
  explicit Stepper(Model model, double dt = 1e-3) : m(std::move(model)) {
    EXPECT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
    EXPECT_EQ(DYN_OK, dyn_model_step_options(m, (dyn_step_options_init(&options), &options)));
    options.dt = dt;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  Stepper(const Stepper&) = delete;
  ~Stepper() { dyn_data_free(d); }
  void integrate_by(dynIntegrator by) {
    options.integrator = by;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
  }
  void set(const Numbers& q, const Numbers& v = {}, const Numbers& tau = {}) {
    const auto p = [](const Numbers& x) { return x.empty() ? nullptr : x.data(); };
    ASSERT_EQ(DYN_OK, dyn_data_set_state(m, d, p(q), p(v), nullptr, p(tau))) << dyn_last_error();
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k) ASSERT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
  }
  Numbers value(const char* name) const {
    dynArray a{};
    a.struct_size = sizeof a;
    EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id(name), &a));
    return {a.data, a.data + a.rows};
  }
  Derivatives analytic() { return derivatives(m, d, DYN_DERIVATIVE_METHOD_ANALYTIC); }
  Derivatives central(double epsilon) { return derivatives(m, d, DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES, epsilon); }
  // The two methods agree to `within` of the largest entry of each matrix, at least 1.
  Derivatives agree(double within = 1e-6, bool strict = true, double epsilon = 1e-6) {
    const Derivatives a = analytic(), c = central(epsilon);
    EXPECT_EQ(DYN_OK, a.status) << dyn_last_error();
    EXPECT_EQ(DYN_OK, c.status) << dyn_last_error();
    if (a.status || c.status) return a;
    EXPECT_TRUE(!strict || a.report.degenerate + c.report.degenerate == 0) << modes(a);
    EXPECT_LE(difference(a.A, c.A), within * std::max(1.0, largest(c.A)));
    EXPECT_LE(difference(a.B, c.B), within * std::max(1.0, largest(c.B)));
    EXPECT_LE(difference(a.B_control, c.B_control), within * std::max(1.0, largest(c.B_control)));
    EXPECT_EQ(a.q, c.q);
    EXPECT_EQ(a.v, c.v);
    if (::testing::Test::HasFailure()) locate(a, c);
    return a;
  }
  static std::string modes(const Derivatives& x) {
    std::string out;
    for (std::size_t k = 0; k < x.modes.size(); ++k)
      out += "mode " + std::to_string(x.modes[k]) + " gap " + std::to_string(1e6 * x.contacts[k].contact.distance) +
             "e-6 force " +
             std::to_string(std::hypot(x.contacts[k].force_on_b[0], x.contacts[k].force_on_b[1], x.contacts[k].force_on_b[2])) +
             (x.degenerate[k] ? " degenerate\n" : "\n");
    return out;
  }
  // Where A differs, by blocks.
  void locate(const Derivatives& a, const Derivatives& c) const {
    const auto nv = static_cast<std::size_t>(m.nv());
    for (std::size_t block = 0; block < 4; ++block) {
      double most = 0;
      std::size_t row = 0, column = 0;
      for (std::size_t j = 0; j < nv; ++j)
        for (std::size_t i = 0; i < nv; ++i) {
          const std::size_t at = i + nv * (block & 1) + 2 * nv * (j + nv * (block >> 1));
          if (const double e = std::abs(a.A[at] - c.A[at]); e > most) most = e, row = i, column = j;
        }
      const std::size_t at = row + nv * (block & 1) + 2 * nv * (column + nv * (block >> 1));
      ADD_FAILURE() << "block d" << (block & 1 ? "v" : "q") << "'/d" << (block >> 1 ? "v" : "q") << " (" << row << ", " << column
                    << "): " << a.A[at] << ", not " << c.A[at];
    }
  }
};

Numbers joined(std::initializer_list<Numbers> parts) {
  Numbers out;
  for (const Numbers& x : parts) out.insert(out.end(), x.begin(), x.end());
  return out;
}
Numbers upright(double x, double y, double z) { return {x, y, z, 0, 0, 0, 1}; }

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

// ---------------------------------------------------------------------------------------------------- contacts

Model ball_on_ground(double friction, double restitution = 0) {
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(friction))
      .sphere("ball", 1, 0.1, material(friction, restitution));
  return scene.finish();
}

// The gap of 1e-5 m closes in the step; the ball rolls on.
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

// The stance of a quadruped or a humanoid under servos, its feet a little below the floor.
Model standing(const char* name, const Numbers& angles, Numbers& q, double depth) {
  const Model plain = robot(name, DYN_BASE_FLOATING);
  dynBuilder* b = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(plain, &b));
  dynShapeSpec s;
  dyn_shape_spec_init(&s);
  s.body = "universe", s.type = DYN_SHAPE_TYPE_HALF_SPACE;
  EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s));
  for (int j = 2; j < plain.njoints(); ++j) {
    dynActuator a;
    dyn_actuator_init(&a, DYN_ACTUATOR_TYPE_POSITION);
    a.kp = 60, a.kv = 3;
    EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, dyn_model_joint_name(plain, j), &a, dyn_model_joint_name(plain, j)))
        << dyn_last_error();
  }
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  dyn_builder_free(b);
  q.assign(static_cast<std::size_t>(dyn_model_nq(m)), 0);
  q[6] = 1;
  const double *const lower = dyn_model_array(m, DYN_MODEL_ARRAY_LOWER_LIMIT), *const upper = dyn_model_array(
                                                                                   m, DYN_MODEL_ARRAY_UPPER_LIMIT);
  for (std::size_t k = 7; k < q.size(); ++k) q[k] = std::clamp(angles[(k - 7) % angles.size()], lower[k] + 0.02, upper[k] - 0.02);
  int floor = 0;
  for (dynShapeInfo shape{}; floor < dyn_model_nshapes(m); ++floor) {
    shape.struct_size = sizeof shape;
    EXPECT_EQ(DYN_OK, dyn_model_shape_info(m, floor, &shape));
    if (shape.type == DYN_SHAPE_TYPE_HALF_SPACE) break;
  }
  // the height at which the lowest contact is `depth` deep
  dynData* d = nullptr;
  EXPECT_EQ(DYN_OK, dyn_data_new(m, 0, &d));
  double low = 0, high = 2;
  for (int n = 0; n < 60; ++n) {
    q[2] = (low + high) / 2;
    dynContact contacts[64];
    int count = 0;
    EXPECT_EQ(DYN_OK, dyn_contacts(m, d, q.data(), 0.0, contacts, 64, &count)) << dyn_last_error();
    double gap = 1;
    for (int k = 0; k < std::min(count, 64); ++k)
      if (contacts[k].shape_a == floor || contacts[k].shape_b == floor) gap = std::min(gap, contacts[k].distance);
    (gap < -depth ? low : high) = q[2];
  }
  dyn_data_free(d);
  return Model(m);
}

TEST(StepDerivatives, OfAStandingQuadruped) {
  Numbers q;
  Stepper run(standing("go2", {0, 0.9, -1.8}, q, 2e-5), 2e-3);
  run.set(q);
  Numbers u(static_cast<std::size_t>(dyn_model_nu(run.m)));
  for (std::size_t k = 0; k < u.size(); ++k) u[k] = q[7 + k];
  ASSERT_EQ(DYN_OK, dyn_data_set_control(run.m, run.d, u.data()));
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

// A mechanism, its loops closed, at rest and in motion.
Model mechanism(const char* name) {
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load((std::string(DYN_MODELS_DIR "/mechanisms/") + name).c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}
void close_loops(Stepper& run, Numbers q, Numbers v) {
  ASSERT_EQ(DYN_OK, dyn_project(run.m, run.d, q.data(), v.data(), nullptr, q.data(), v.data(), nullptr)) << dyn_last_error();
  run.set(q, v);
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

// ---------------------------------------------------------------------------------------------------- modes

// A ball that slides at the speed at which it begins to roll, and one that just touches the ground at the end of the step.
TEST(StepDerivatives, SwitchesAreDegenerate) {
  int found = 0;
  for (int k = -49; k <= 49; ++k) {
    Stepper run(ball_on_ground(0.5));
    const double off = 2e-8 * k;  // m; degenerate within 1e-6
    run.set(upright(0, 0, 0.1 + off), {0.1, 0, 0, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(1, x.degenerate[0]) << off;
    EXPECT_EQ(1, x.report.degenerate);
    found += x.degenerate[0];
  }
  EXPECT_EQ(99, found);
}

// A slider on the ground that is pushed with the largest friction, more or less 1e-6 of it.
Model slider_on_ground(double friction) {
  const std::string mu = std::to_string(friction),
                    text = "<mujoco><worldbody><geom type='plane' size='1 1 1' friction='" + mu +
                           "'/><body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint type='slide' "
                           "axis='0 0 1'/><geom type='sphere' size='0.1' mass='2' friction='" +
                           mu + "'/></body></worldbody></mujoco>";
  dynModel* m = nullptr;
  EXPECT_EQ(DYN_OK, dyn_model_load_string(text.c_str(), nullptr, &m)) << dyn_last_error();
  return Model(m);
}
TEST(StepDerivatives, TheLargestFrictionIsASwitch) {
  constexpr double mu = 0.4, largest = mu * 2 * 9.81;
  for (int k = -50; k <= 50; ++k) {
    const double push = largest * (1 + 1.9e-8 * k), angle = 0.13 * k;
    Stepper run(slider_on_ground(mu));
    run.set({0, 0, 0.1 - 1e-5}, {}, {push * std::cos(angle), push * std::sin(angle), 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size());
    EXPECT_EQ(1, x.degenerate[0]) << k;
  }
  for (int k = 1; k <= 50; ++k)
    for (const bool slides : {false, true}) {
      const double push = largest * (slides ? 1 + 2e-3 * k : 1 - 1e-5 * k), angle = 0.13 * k;
      SCOPED_TRACE(push / largest);
      Stepper run(slider_on_ground(mu));
      run.set({0, 0, 0.1 - 1e-5}, {}, {push * std::cos(angle), push * std::sin(angle), 0});
      const Derivatives x = slides ? run.agree(1e-6, true, 1e-9) : run.analytic();
      ASSERT_EQ(1u, x.modes.size());
      EXPECT_EQ(slides ? DYN_CONTACT_MODE_SLIDE : DYN_CONTACT_MODE_STICK, x.modes[0]);
      EXPECT_EQ(0, x.degenerate[0]);
    }
}

// A ball whose gap closes at the end of the step, more or less 1e-7 m: it meets the ground or not.
TEST(StepDerivatives, TheEndOfAFlightIsASwitch) {
  for (int k = -50; k <= 50; ++k) {
    Stepper run(ball_on_ground(0.5));
    const double h = run.options.dt, speed = 0.5 + 0.01 * k;
    run.set(upright(0, 0, 0.1 + speed * h + 9.81 * h * h + 1e-11 * k), {0.2, 0, -speed, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    ASSERT_EQ(1u, x.modes.size()) << k;
    EXPECT_EQ(1, x.degenerate[0]) << k;
  }
}

TEST(StepDerivatives, ModesThatHoldAreNotDegenerate) {
  for (int k = 1; k <= 50; ++k) {
    Stepper run(ball_on_ground(0.5));
    run.set(upright(0, 0, 0.1 - 1e-5 * k), {0.1, 0, 0, 0, 1, 0});
    const Derivatives x = run.analytic();
    ASSERT_EQ(DYN_OK, x.status) << dyn_last_error();
    EXPECT_EQ(0, x.report.degenerate) << k;
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
  dynData* small = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(run.m, DYN_PART_SIMULATION, &small));
  EXPECT_EQ(DYN_ERROR_PART, dyn_step_derivatives(run.m, small, nullptr, &out));
  EXPECT_NE(nullptr, std::strstr(dyn_last_error(), "STEP_DERIVATIVES")) << dyn_last_error();
  dyn_data_free(small);
}

}  // namespace
}  // namespace dyn_test
