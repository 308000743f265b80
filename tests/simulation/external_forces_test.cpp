// Applied wrenches, gravity compensation, drag of a medium and gravity per data, against closed forms.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// A force at a point of a free body and its wrench at the origin give the same motion.
TEST(Wrenches, ForceAtAPointEqualsItsWrench) {
  const double point[3] = {0.1, -0.2, 0.3}, F[3] = {3, -1, 2};
  Simulation run(Scene({0, 0, 0}).free("stone", 2, {0.1, 0.2, 0.25}).finish());
  const double push[6] = {F[0], F[1], F[2], 0, 0, 0};
  const int stone = dyn_model_frame_id(run.m, "stone");
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, stone, point, push, DYN_REFERENCE_LOCAL_WORLD_ALIGNED))
      << dyn_last_error();
  run.steps(1);
  const double moment[3] = {point[1] * F[2] - point[2] * F[1], point[2] * F[0] - point[0] * F[2],
                            point[0] * F[1] - point[1] * F[0]},
               I[3] = {0.1, 0.2, 0.25};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(F[k] / 2 * 1e-3, run.velocity()[std::size_t(k)], 1e-9);
    EXPECT_NEAR(moment[k] / I[k] * 1e-3, run.v[3 + k], 1e-6);
  }
  // the force keeps its world direction while the body rotates
  run.steps(500);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(F[k] / 2 * 0.501, run.velocity()[std::size_t(k)], 1e-9);
  ASSERT_EQ(DYN_OK, dyn_data_clear_wrenches(run.m, run.d));
  const auto v = run.velocity();
  run.steps(100);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(v[k], run.velocity()[k], 1e-12);
}

// A body-fixed thrust on a spinning body: a circle.
TEST(Wrenches, LocalForcesRotateWithTheBody) {
  Simulation run(Scene({0, 0, 0}).free("disc", 2, {0.1, 0.1, 0.2}).finish(), 1e-4);
  integrate_by(run, DYN_INTEGRATOR_RK4);
  run.set({}, {0, 0, 0, 0, 0, 3});
  const double thrust[6] = {4, 0, 0, 0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, dyn_model_frame_id(run.m, "disc"), nullptr, thrust, DYN_REFERENCE_LOCAL));
  run.steps(10000);
  EXPECT_NEAR(4.0 / 2 / 3 * std::sin(3.0), run.velocity()[0], 1e-9);
  EXPECT_NEAR(4.0 / 2 / 3 * (1 - std::cos(3.0)), run.velocity()[1], 1e-9);
}

// World frame: the line of action stays fixed, and the moment grows as the body moves away.
TEST(Wrenches, WorldWrenchKeepsItsLineOfAction) {
  Simulation run(Scene({0, 0, 0}).free("disc", 1, {1, 1, 1}).finish(), 1e-3);
  integrate_by(run, DYN_INTEGRATOR_RK4);
  run.set({0, 2, 0, 0, 0, 0, 1});
  const double force[6] = {1, 0, 0, 0, 0, 0};
  ASSERT_EQ(DYN_OK, dyn_data_apply_wrench(run.m, run.d, dyn_model_frame_id(run.m, "disc"), nullptr, force, DYN_REFERENCE_WORLD));
  run.steps(1000);
  EXPECT_NEAR(1, run.velocity()[0], 1e-12);
  EXPECT_NEAR(2, run.v[5], 1e-12);  // -(y = 2) x (1, 0, 0): 2 about z
}

TEST(GravityCompensation, CancelsWeight) {
  for (const double share : {1.0, 0.25, -1.0}) {
    Scene scene;
    scene.free("stone", 2, {0.1, 0.2, 0.25}, {0.1, 0.2, 0.3});
    ASSERT_EQ(DYN_OK, dyn_builder_set_gravity_compensation(scene.builder(), "stone", share));
    Simulation run(scene.finish());
    run.steps(100);
    EXPECT_NEAR(-9.81 * (1 - share) * 0.1, run.velocity()[2], 1e-12) << share;
    for (int k = 3; k < 6; ++k) EXPECT_NEAR(0, run.v[k], 1e-12);
    ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, 0));
    run.set({}, {0, 0, 0, 0, 0, 0});
    run.steps(100);
    EXPECT_NEAR(-0.981, run.velocity()[2], 1e-12);
  }
}

// A falling ball reaches the speed at which drag equals weight: 6 pi r eta v, then also 2 rho r^2 v^2.
// r = sqrt(0.6) R belongs to the box of equal inertia.
TEST(Medium, BallsReachTheirTerminalVelocity) {
  const double m = 0.5, R = 0.1, I = 0.4 * m * R * R, r = std::sqrt(0.6) * R, pi = 3.14159265358979323846;
  const struct {
    double density, viscosity, v;
  } cases[] = {{0, 2, m * 9.81 / (6 * pi * r * 2)}, {3, 0, std::sqrt(m * 9.81 / (2 * 3 * r * r))}};
  for (const auto& c : cases)
    for (const double wind : {0.0, 1.5}) {
      Scene scene;
      scene.free("ball", m, {I, I, I});
      const double w[3] = {0, 0, wind};
      ASSERT_EQ(DYN_OK, dyn_builder_set_medium(scene.builder(), c.density, c.viscosity, w));
      Simulation run(scene.finish());
      integrate_by(run, DYN_INTEGRATOR_RK4);
      run.steps(20000);
      EXPECT_NEAR(wind - c.v, run.velocity()[2], 1e-9 * c.v);
    }
}

// A spinning ball slows as its moments say: w' = -8 pi eta r^3 / I w, or -rho r^5 / I w^2.
TEST(Medium, SpinOfABallDecays) {
  const double m = 0.5, R = 0.1, I = 0.4 * m * R * R, r = std::sqrt(0.6) * R, pi = 3.14159265358979323846, spin = 10, time = 0.5;
  const double viscosity = 0.1, density = 30, rate = 8 * pi * viscosity * r * r * r / I, share = density * std::pow(r, 5) / I;
  const struct {
    double density, viscosity, spin;
  } cases[] = {{0, viscosity, spin * std::exp(-rate * time)}, {density, 0, spin / (1 + share * spin * time)}};
  for (const auto& c : cases) {
    Scene scene;
    scene.free("ball", m, {I, I, I});
    const double still[3] = {0, 0, 0};
    ASSERT_EQ(DYN_OK, dyn_builder_set_medium(scene.builder(), c.density, c.viscosity, still));
    Simulation run(scene.finish());
    integrate_by(run, DYN_INTEGRATOR_RK4);
    run.set({}, {0, 0, 0, 0, spin, 0});
    run.steps(500);
    ASSERT_LT(c.spin, 0.9 * spin);
    EXPECT_NEAR(c.spin, run.v[4], 1e-9);
  }
}

// A sphere's blunt drag and Stokes drag: 6 pi r eta v, rho C pi r^2 v^2. Without them its link has no drag of the box.
TEST(FluidEllipsoids, BallsReachTheirTerminalVelocity) {
  const double m = 0.5, r = 0.1, I = 0.4 * m * r * r, pi = 3.14159265358979323846;
  const struct {
    double density, viscosity, blunt, v;
  } cases[] = {{0, 2, 0.5, m * 9.81 / (6 * pi * r * 2)}, {3, 0, 0.4, std::sqrt(m * 9.81 / (3 * 0.4 * pi * r * r))}};
  for (const auto& c : cases) {
    Scene scene;
    scene.free("ball", m, {I, I, I});
    const double still[3] = {0, 0, 0}, coefficients[5] = {c.blunt, 0, 0, 0, 0};
    ASSERT_EQ(DYN_OK, dyn_builder_set_medium(scene.builder(), c.density, c.viscosity, still));
    dynShapeSpec ball;
    dyn_shape_spec_init(&ball);
    ball.type = DYN_SHAPE_TYPE_SPHERE, ball.role = DYN_SHAPE_ROLE_VISUAL, ball.body = "ball", ball.size[0] = r;
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &ball)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_builder_set_shape_fluid(scene.builder(), coefficients, nullptr, nullptr)) << dyn_last_error();
    Simulation run(scene.finish());
    integrate_by(run, DYN_INTEGRATOR_RK4);
    run.steps(20000);
    EXPECT_NEAR(-c.v, run.velocity()[2], 1e-9 * c.v);
  }
}

TEST(FluidEllipsoids, RefuseBadNumbers) {
  Scene scene;
  scene.free("ball", 1, {1, 1, 1});
  dynBuilder* const b = scene.builder();
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_shape_fluid(b, nullptr, nullptr, nullptr));  // no shape yet
  dynShapeSpec spec;
  dyn_shape_spec_init(&spec);
  spec.type = DYN_SHAPE_TYPE_CONE, spec.body = "ball", spec.size[0] = spec.size[1] = 0.1;
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &spec)) << dyn_last_error();
  const double negative[5] = {0, 0, 0, -1, 0}, flat[3] = {1, 0, 1}, good[3] = {1, 2, 3}, turned[12] = {2, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_shape_fluid(b, nullptr, nullptr, nullptr));  // a cone has no semiaxes
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_shape_fluid(b, negative, good, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_shape_fluid(b, nullptr, flat, nullptr));
  EXPECT_EQ(DYN_ERROR_INVALID, dyn_builder_set_shape_fluid(b, nullptr, good, turned));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_shape_fluid(b, nullptr, nullptr, turned));
  EXPECT_EQ(DYN_OK, dyn_builder_set_shape_fluid(b, nullptr, good, nullptr)) << dyn_last_error();
}

TEST(Gravity, IsSetPerData) {
  Simulation run(Scene().free("stone", 2, {0.1, 0.2, 0.25}).finish());
  const double g[3] = {1, 2, 3};
  ASSERT_EQ(DYN_OK, dyn_data_set_gravity(run.m, run.d, g));
  run.steps(100);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(0.1 * g[k], run.velocity()[k], 1e-12);
  EXPECT_EQ(3, run.array("world_gravity")[2]);
  // another data of the model has the model's gravity
  Data other(run.m);
  double tau[6];
  ASSERT_EQ(DYN_OK, dyn_gravity_torque(run.m, other, nullptr, tau));
  EXPECT_NEAR(2 * 9.81, tau[2], 1e-12);
}

}  // namespace
}  // namespace dyn_test
