// Contact in steps against closed forms: friction, rolling, restitution, rest, compliance, belts.
#include "common/every.hpp"
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

class Incline : public testing::TestWithParam<double> {};

// A box on an incline: it sticks below the friction angle and slides with g (sin a - mu cos a) above.
TEST_P(Incline, SticksOrSlides) {
  const double mu = 0.5, angle = std::atan(mu * GetParam());
  Simulation run(
      Scene({g * std::sin(angle), 0, -g * std::cos(angle)}).ground().box("box", 1, {0.2, 0.2, 0.2}, material(mu)).finish());
  run.place({{0, 0, 0.1}});
  run.steps(1000);
  EXPECT_LE(run.residual, 1.01e-9);
  const double a = g * (std::sin(angle) - mu * std::cos(angle));
  if (a < 0) {
    EXPECT_LT(std::abs(run.velocity()[0]), 1e-9);
    EXPECT_LT(std::abs(run.q[0]), 1e-9);
  } else {
    EXPECT_NEAR(a, run.velocity()[0], 1e-3 * a);
    EXPECT_NEAR(a / 2, run.q[0], 1.5e-3 * a);
  }
  EXPECT_NEAR(0.1, run.q[2], 1e-9);
}
INSTANTIATE_TEST_SUITE_P(Angles, Incline, testing::Values(0.99, 0.999, 1.01, 1.5));

// v0 = 1 m/s without spin: the sphere slides until v = 5/7 v0, then rolls.
TEST(Contact, SlidingSphereStartsToRoll) {
  Simulation run(Scene().ground().sphere("ball", 2, 0.1, material(0.3)).finish());
  run.place({{0, 0, 0.1}});
  run.set({}, {1, 0, 0, 0, 0, 0});
  run.steps(1000);
  EXPECT_NEAR(5.0 / 7, run.velocity()[0], 1e-6);
  EXPECT_NEAR(50.0 / 7, run.v[4], 1e-5);
}

// Bounce heights fall by e^2 each time; the ball rests once the sum of its flight times is over.
TEST(Contact, BounceHeightsAndComingToRest) {
  const double e = 0.5, height = 1, dt = 1e-4;
  Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.5, e)).finish(), dt);
  run.place({{0, 0, height + 0.1}});
  std::vector<double> peaks;
  double before = 2 * height, last = height, rest = 0;
  for (int k = 0; k < 20000; ++k) {
    run.steps(1);
    const double z = run.q[2] - 0.1;
    EXPECT_GE(z, -1e-9);
    if (last >= before && last > z) peaks.push_back(last);
    before = last, last = z;
    if (std::abs(run.v[2]) > 1e-9) rest = (k + 1) * dt;
  }
  ASSERT_GE(peaks.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(std::pow(e, 2.0 * double(k + 1)) * height, peaks[k], dt * std::sqrt(2 * g * height)) << k;  // motion in one step
  EXPECT_NEAR(std::sqrt(2 * height / g) * (1 + e) / (1 - e), rest, 0.01);
}

TEST(Contact, ForcesOnARestingStackAddUpToItsWeight) {
  Simulation run(Scene()
                     .ground()
                     .box("a", 1, {0.2, 0.2, 0.2}, material(1))
                     .box("b", 2, {0.2, 0.2, 0.2}, material(1))
                     .box("c", 1e-3, {0.2, 0.2, 0.2}, material(1))
                     .finish());
  run.exactly(), run.place({{0, 0, 0.1}, {0.01, 0, 0.3}, {0, 0.02, 0.5}});
  run.steps(500);
  EXPECT_LE(run.residual, 1.01e-9);
  double on_ground = 0;
  for (const dynContactForce& f : run.contacts()) {
    if (f.contact.shape_a == 0) on_ground += f.force_on_b[2];
    EXPECT_GE(
        f.force_on_b[0] * f.contact.normal[0] + f.force_on_b[1] * f.contact.normal[1] + f.force_on_b[2] * f.contact.normal[2],
        -1e-9);
  }
  EXPECT_NEAR(3.001 * g, on_ground, 1e-7);
  for (int k = 0; k < 18; ++k) EXPECT_NEAR(0, run.v[k], 1e-8) << k;
}

// 64 directions: the friction cone is round.
TEST(Contact, FrictionIsIsotropic) {
  double least = inf, most = 0;
  for (int k = 0; k < 64; ++k) {
    const double angle = 2 * M_PI * k / 64;
    Simulation run(Scene().ground().sphere("ball", 1, 0.1, material(0.2)).finish(), 1e-3);
    run.place({{0, 0, 0.1}});
    run.set({}, {std::cos(angle), std::sin(angle), 0, -10 * std::sin(angle) * -1, 10 * std::cos(angle) * -1,
                 0});  // spinning backwards: it slides to the end
    run.steps(300);
    const double distance = std::hypot(run.q[0], run.q[1]);
    least = std::min(least, distance), most = std::max(most, distance);
  }
  EXPECT_GT(least, 0.1);
  EXPECT_LT((most - least) / most, 1e-8);
}

// The energy of an undriven box that falls on an edge never grows until it rests.
TEST(Contact, EnergyNeverGrows) {
  Simulation run(Scene().ground().box("box", 1, {0.2, 0.3, 0.1}, material(0.7)).finish());
  run.set({0, 0, 0.5, 0.3, 0.1, 0.05, std::sqrt(1 - 0.09 - 0.01 - 0.0025)});
  double before = run.energy();
  for (int k = 0; k < 3000; ++k) {
    run.steps(1);
    const double now = run.energy();
    EXPECT_LE(now, before + 2e-5 * std::max(1.0, std::abs(before))) << k;  // first-order steps: m g^2 h^2 in free fall
    before = now;
  }
  EXPECT_NEAR(0.05 * g, before, 1e-6);
  EXPECT_LT(run.report().residual, 1.01e-9);
}

// A spring under a load: depth m g / k. A belt carries what lies on it.
TEST(Contact, SpringDepthAndBeltVelocity) {
  dynMaterial soft = material(0.5);
  soft.stiffness = 1e4, soft.damping = 200;
  Simulation run(Scene().ground().sphere("ball", 2, 0.1, soft).finish());
  run.place({{0, 0, 0.1}});
  run.steps(2000);
  EXPECT_NEAR(0.1 - 2 * g / 1e4, run.q[2], 1e-8);
  EXPECT_NEAR(2 * g, run.contacts().at(0).force_on_b[2], 1e-5);

  dynMaterial belt = material(0.5);
  belt.surface_velocity[0] = 0.7;
  Scene scene;
  scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, belt).box("box", 1, {0.2, 0.2, 0.2}, material(0.2));
  Simulation carried(scene.finish());
  carried.place({{0, 0, 0.1}});
  carried.steps(100);
  EXPECT_NEAR(0.5 * g * 0.1, carried.velocity()[0], 1e-6);  // friction accelerates it
  carried.steps(400);
  EXPECT_NEAR(0.7, carried.velocity()[0], 1e-8);  // until it moves with the belt
}

// Rebound off a spring and damper that act only in contact: exp(-z / sqrt(1 - z^2) (pi - 2 asin z)), z = d / (2 sqrt(k m)).
TEST(Contact, SoftReboundMatchesSpringAndDamper) {
  const double k = 1e3, damping = 10, z = damping / (2 * std::sqrt(k)),
               exact = std::exp(-z / std::sqrt(1 - z * z) * (3.141592653589793 - 2 * std::asin(z)));
  dynMaterial soft = material(0);
  soft.stiffness = k, soft.damping = damping;
  for (const double radius : {0.1, 1.0}) {
    Simulation run(Scene({0, 0, 0}).ground().sphere("ball", 1, radius, soft).finish(), 1e-4);
    run.set({0, 0, radius + 0.05, 0, 0, 0, 1}, {0, 0, -1, 0, 0, 0});
    run.steps(3000);
    EXPECT_NEAR(exact, run.v[2], 4e-3) << radius;  // 2.8e-3: first order in the step
  }
}

// Rolling friction without torsion, whose row is fixed at zero, for every solver and with an expired deadline.
TEST(Contact, RollingFrictionWorksWithoutTorsion) {
  for (const dynContactSolverType solver : every<dynContactSolverType>("dynContactSolverType"))
    for (const double budget : {0.0, 1e-9}) {
      double end[2];
      for (const double torsion : {0.0, 1e-4}) {
        dynMaterial x = material(0.8);
        x.rolling = 1e-3, x.torsion = torsion;
        Simulation run(Scene().ground().sphere("ball", 1, 0.1, x).finish(), 1e-3, solver);
        run.options.time_budget = budget;
        ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
        run.set({0, 0, 0.1, 0, 0, 0, 1}, {0.5, 0, 0, 0, 0, 0});
        run.steps(1000);
        end[torsion > 0] = run.q[0];
      }
      EXPECT_NEAR(end[1], end[0], 1e-9) << int(solver) << " " << budget;
      EXPECT_GT(end[0], 0.2);
    }
}

// Rolling friction stops a ball: m a = F, I alpha = F r - M, v = omega r, M = c N. Torsion stops a spinning one: I alpha = c N.
TEST(Contact, TorsionAndRollingFrictionDecelerate) {
  dynMaterial x = material(0.8);
  x.rolling = 1e-3, x.torsion = 2e-3;
  Simulation run(Scene().ground().sphere("ball", 1, 0.1, x).finish());
  run.place({{0, 0, 0.1}});
  run.set({}, {0.5, 0, 0, 0, 5, 0});
  run.steps(1000);
  const double a = 1e-3 * g / 0.1 / 1.4;
  EXPECT_NEAR(0.5 - a, run.velocity()[0], 1e-4);
  Simulation spin(Scene().ground().sphere("ball", 1, 0.1, x).finish());
  spin.place({{0, 0, 0.1}});
  spin.set({}, {0, 0, 0, 0, 0, 6});
  spin.steps(1000);
  EXPECT_NEAR(6 - 2e-3 * g / 0.004, spin.v[5], 1e-4);
  spin.steps(1000);
  EXPECT_NEAR(0, spin.v[5], 1e-8);
}

// Impacts are found before they happen: nothing passes through at any speed.
TEST(Contact, FastBodiesDoNotPassThrough) {
  for (const double speed : {10.0, 100.0, 1000.0}) {
    Scene scene({0, 0, 0});
    scene.shape("universe", DYN_SHAPE_TYPE_BOX, {1, 1, 0.01}, material(0)).sphere("ball", 1, 0.02, material(0.5));
    Simulation run(scene.finish());
    run.place({{0, 0, 0.6}});
    run.set({}, {0, 0, -speed, 0, 0, 0});
    run.steps(100);
    EXPECT_NEAR(0.025, run.q[2], 1e-6) << speed;
  }
}

// A box on four corners with room for three contacts: the deepest are kept and the others reported as dropped.
// With room for one it rests on one corner at a time, never far from the ground.
TEST(Contact, DeepestContactsAreKeptWhenFull) {
  const auto room = [](int contacts) {
    Scene scene;
    scene.ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.5));
    EXPECT_EQ(DYN_OK, dyn_builder_set_contact_capacity(scene.builder(), contacts));
    return scene.finish();
  };
  dynBuilder* b = nullptr;
  ASSERT_EQ(DYN_OK, dyn_builder_new("none", &b));
  for (const int wrong : {-1, 1000001}) {
    EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_builder_set_contact_capacity(b, wrong));
    EXPECT_NE(nullptr, std::strstr(dyn_last_error(), std::to_string(wrong).c_str()));
  }
  dyn_builder_free(b);
  for (const auto& [asked, there] : {std::pair{0, 8}, {3, 3}, {1, 1}, {8, 8}, {100, 8}}) {  // 8 for the only pair
    Simulation play(room(asked));
    EXPECT_EQ(there, dyn_model_contact_capacity(play.m)) << asked;
    play.place({{0, 0, 0.1 - 1e-4}});
    play.steps(1);
    EXPECT_EQ(std::min(4, there), play.report().contacts) << asked;
    EXPECT_EQ(4 - std::min(4, there), play.report().dropped) << asked;
    play.steps(1000);
    EXPECT_NEAR(0.1, play.q[2], 2e-3) << asked;
  }
}

TEST(Contact, InitialOverlapIsRemovedWithoutVelocity) {
  Simulation run(Scene().ground().box("box", 1, {0.2, 0.2, 0.2}, material(0.5)).finish());
  run.place({{0, 0, 0.05}});
  double fastest = 0;
  for (int k = 0; k < 200; ++k) run.steps(1), fastest = std::max(fastest, std::abs(run.v[2]));
  EXPECT_NEAR(0.1, run.q[2], 1e-6);
  EXPECT_LT(fastest, 0.02);
}

// An unlimited arm falls folded onto itself: six contact points that nine degrees of freedom cannot separate.
// Impulses of 1e61, whose round-off hides any speed, must not pass for a solution.
TEST(Contact, ArmFallingOntoItselfLosesEnergy) {
  dynModel* m = nullptr;
  dynLoadOptions options;
  dyn_load_options_init(&options);
  options.base = DYN_BASE_FIXED;
  ASSERT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/robots/panda.urdf", &options, &m)) << dyn_last_error();
  Simulation run{Model(m)};
  ASSERT_EQ(DYN_OK, dyn_data_set_effects(run.m, run.d, 0, DYN_EFFECT_DAMPING | DYN_EFFECT_FRICTION | DYN_EFFECT_ARMATURE));
  // What overlaps at the beginning is not tested: its correction would lift the arm.
  std::vector<double> distances(std::size_t(dyn_model_npairs(run.m)));
  ASSERT_EQ(DYN_OK, dyn_distances(run.m, run.d, nullptr, distances.data()));
  for (std::size_t k = 0; k < distances.size(); ++k)
    if (distances[k] < -1e-9) {
      ASSERT_EQ(DYN_OK, dyn_data_set_pair(run.m, run.d, int(k), 0));
    }
  double before = run.energy();
  int unsolved = 0;
  for (int k = 0; k < 1000; ++k) {
    run.steps(1), unsolved += run.report().unsolved;
    const double now = run.energy();
    ASSERT_LT(now, before + 1e-6) << "step " << k;
    before = now;
  }
  EXPECT_LE(unsolved, 20);
  EXPECT_GE(run.contacts().size(), 6u);
}

// A table whose centre of mass is off the middle of its feet. All contacts as one press at a point below it with its weight,
// and with no moment about that point.
TEST(Contact, SensorOfTheNetForceFindsTheCentreOfPressure) {
  Scene scene;
  scene.ground().free("table", 3, {0.1, 0.1, 0.1}, {0.07, -0.04, 0});
  for (const double x : {-0.2, 0.2})
    for (const double y : {-0.1, 0.1})
      scene.shape("table", DYN_SHAPE_TYPE_SPHERE, {0.02, 0, 0}, material(0.5), {x, y, -0.1});
  dynSensor s;
  dyn_sensor_init(&s, DYN_QUANTITY_CONTACT);
  s.side = DYN_SIDE_LINK, s.reduction = DYN_REDUCTION_NETFORCE;
  s.values = DYN_VALUE_FOUND | DYN_VALUE_FORCE | DYN_VALUE_MOMENT | DYN_VALUE_POSITION;
  ASSERT_EQ(DYN_OK, dyn_builder_add_sensor(scene, "press", &s, "table", nullptr)) << dyn_last_error();
  Simulation run(scene.finish());
  run.exactly();
  run.place({{1, 2, 0.12}});
  run.steps(200);
  double x[10];
  ASSERT_EQ(10, dyn_model_nsensordata(run.m));
  ASSERT_EQ(DYN_OK, dyn_sensors(run.m, run.d, nullptr, nullptr, nullptr, x)) << dyn_last_error();
  EXPECT_EQ(4, x[0]);
  // forces are solved to 1e-9 of the speed
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(k == 2 ? -3 * g : 0, x[1 + k], 1e-5) << k;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(0, x[4 + k], 1e-6) << k;
  EXPECT_NEAR(1.07, x[7], 1e-6);
  EXPECT_NEAR(1.96, x[8], 1e-6);
  EXPECT_NEAR(0, x[9], 1e-6);
}

}  // namespace
}  // namespace dyn_test
