// Where small motions, gaps and errors begin to count: on one side of each threshold nothing acts, on the other something does.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

constexpr double g = 9.81, radius = 0.1;
using Gravity = std::array<double, 3>;
using Place = std::array<double, 3>;

// A ball of 1 kg over the ground, its lowest point at a height, with a vertical velocity.
struct Ball : Simulation {
  Ball(double gap, double speed, double dt, Gravity gravity = {0, 0, 0}, double restitution = 0)
      : Simulation(Scene(gravity).ground().sphere("ball", 1, radius, material(0.5, restitution)).finish(), dt) {
    set({0, 0, radius + gap, 0, 0, 0, 1}, {0, 0, speed, 0, 0, 0});
  }
  double force() const { return contacts().empty() ? 0 : contacts()[0].force_on_b[2]; }
  double after_step() {
    steps(1);
    return q[2] - radius;
  }
};

// The unit of length of thresholds: five times sqrt(tr I / m).
const double length = 5 * std::sqrt(3 * 0.4) * radius;

// Overlap of a billionth of the length is left alone; half of more is removed in a step.
TEST(Thresholds, OverlapOfRoundingIsLeft) {
  EXPECT_EQ(-3e-10 - radius + radius, Ball(-3e-10, 0, 1e-3).after_step());
  EXPECT_NEAR(-5e-10, Ball(-1e-9, 0, 1e-3).after_step(), 1e-16);
}

// Deep overlap is removed at a thousandth of the length in a step, or at the speed of a fall over a twentieth of it.
TEST(Thresholds, DeepOverlapIsRemovedAtAStatedSpeed) {
  for (const double h : {1e-3, 1e-4}) {
    EXPECT_NEAR(1e-3 * length, Ball(-0.05, 0, h).after_step() + 0.05, 1e-9);
    EXPECT_NEAR(std::sqrt(g * length / 10) * h, Ball(-0.05, 0, h, {0, 0, -g}).after_step() + 0.05, 0.02 * h);
  }
}

// A touching ball that closes by 1e-12 of its radius in a step needs no impulse, nor one that closes by 1e-6 of g h^2.
TEST(Thresholds, ClosingByRoundingNeedsNoImpulse) {
  const auto without_gravity = [](double closing) {
    Ball ball(0, -closing / 1e-3, 1e-3);
    ball.steps(1);
    return ball.force();
  };
  EXPECT_EQ(0, without_gravity(3e-14));
  EXPECT_NEAR(3e-13 / 1e-6, without_gravity(3e-13), 1e-9);
  const auto falling = [](double closing) {
    const double h = 1e-5;
    Ball ball(0, g * h - closing / h, h, {0, 0, -g});
    ball.steps(1);
    return ball.force();
  };
  EXPECT_EQ(0, falling(3e-16));
  EXPECT_NEAR(3e-15 / 1e-10, falling(3e-15), 1e-8);
}

// From where a ball rebounds: from twice what gravity adds in a step, in long steps from a twentieth of the speed of that fall.
TEST(Thresholds, ReboundsBeginAtAStatedSpeed) {
  for (const double dt : {1e-2, 1e-4}) {
    double low = 0, high = 1;
    for (int k = 0; k < 20; ++k) {
      const double middle = 0.5 * (low + high);
      Ball ball(0, -middle, dt, {0, 0, -g}, 0.5);
      ball.steps(1);
      (ball.v[2] > 0 ? high : low) = middle;
    }
    EXPECT_NEAR(std::min(2 * g * dt, 0.05 * 0.32 * std::sqrt(g * length)), high, 1e-3 * high) << dt;
  }
}

// Contacts that bounce or are soft are solved at any approach and depth. One throws the ball back, the other presses k times its
// depth.
TEST(Thresholds, BouncingAndSoftContactsAlwaysAct) {
  Ball bouncing(0, -5e-11, 1e-3, {0, 0, 0}, 0.5);  // the same approach of a ball without restitution is left
  bouncing.steps(1);
  EXPECT_NEAR((1 + 0.5) * 5e-11 / 1e-3, bouncing.force(), 1e-12);
  const double stiffness = 1e6, depth = 1e-10, dt = 1e-6;
  dynMaterial soft = material(0);
  soft.stiffness = stiffness;
  Simulation run(Scene({0, 0, 0}).ground().sphere("ball", 1, radius, soft).finish(), dt);
  run.set({0, 0, radius - depth, 0, 0, 0, 1});
  run.steps(1);
  ASSERT_EQ(1u, run.contacts().size());
  EXPECT_NEAR(stiffness * depth, run.contacts()[0].force_on_b[2], 1e-5 * stiffness * depth);  // the step is implicit: h^2 k / m
}

// An approach slower than a twentieth of the speed of that fall is rest: no rebound.
TEST(Thresholds, GentleApproachDoesNotRebound) {
  const auto after = [](double approach) {
    Ball ball(0, -approach, 1e-2, {0, 0, -g}, 1);
    ball.steps(1);
    return ball.v[2];
  };
  EXPECT_NEAR(0, after(0.02), 1e-9);
  EXPECT_NEAR(0.07, after(0.07), 1e-9);
}

// Shapes that move side by side nearer than a fiftieth of the smaller one's radius are contacts, by lists of pairs and by
// boxes.
TEST(Thresholds, NearShapesAreContacts) {
  for (const int far_away : {0, 3000})
    for (const double gap : {0.012, 0.03}) {
      Scene scene({0, 0, 0});
      scene.sphere("a", 1, radius, material(0.5)).sphere("b", 1, radius, material(0.5));
      dynShapeSpec s;
      dyn_shape_spec_init(&s);
      s.body = "universe", s.type = DYN_SHAPE_TYPE_BOX, s.placement[11] = -50, s.size[0] = s.size[1] = s.size[2] = 0.5;
      for (int k = 0; k < far_away; ++k) ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
      Simulation run(scene.finish());
      run.set({0, 0, 0, 0, 0, 0, 1, (2 + gap) * radius, 0, 0, 0, 0, 0, 1}, {0, 2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0});
      run.steps(1);
      EXPECT_EQ(gap < 0.02 ? 1u : 0u, run.contacts().size()) << far_away;
    }
}

// A ball passes another one, above it at the end of the step by 0.5 mm. A contact that turns by less than acos(0.9) keeps its
// normal; else that of the end counts.
TEST(Thresholds, NormalOfTheEndCountsWhereAContactTurns) {
  for (const double degrees : {20.0, 24.0, 28.0, 35.0}) {
    const double above = 2 * radius + 5e-4, angle = degrees / 180 * 3.14159265358979, behind = above * std::tan(angle), h = 1e-2;
    Simulation run(Scene({0, 0, 0}).sphere("a", 1, radius, material(0.5)).sphere("b", 1, radius, material(0.5)).finish(), h);
    run.set({0, 0, 0, 0, 0, 0, 1, -behind, 0, above, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0, behind / h, 0, 0, 0, 0, 0});
    run.steps(1);
    ASSERT_EQ(1u, run.contacts().size()) << degrees;
    EXPECT_NEAR(degrees < 25.8 ? -std::sin(angle) : 0, run.contacts()[0].contact.normal[0], 1e-12) << degrees;
  }
}

// A ball passes over another one, whose contact turns by 34 degrees: the normal of the end counts, if their gap at the start is
// more than 1e-4 of the radius. Else they touch, and the normal of the start does.
TEST(Thresholds, NormalOfTheStartCountsWhereShapesTouch) {
  const double angle = 17.0 / 180 * 3.14159265358979, h = 1e-2;
  for (const double share : {5e-5, 5e-4}) {
    const double apart = (2 + share) * radius, behind = apart * std::sin(angle);
    Simulation run(Scene({0, 0, 0}).sphere("a", 1, radius, material(0.5)).sphere("b", 1, radius, material(0.5)).finish(), h);
    run.set({0, 0, 0, 0, 0, 0, 1, -behind, 0, apart * std::cos(angle), 0, 0, 0, 1},
            {0, 0, 0, 0, 0, 0, 2 * behind / h, 0, 0, 0, 0, 0});
    run.steps(1);
    ASSERT_EQ(1u, run.contacts().size()) << share;
    EXPECT_NEAR((share > 1e-4 ? 1 : -1) * std::sin(angle), run.contacts()[0].contact.normal[0], 1e-12) << share;
  }
}

// Two balls at rest, nearer than a fiftieth of the radius, are a contact of a search by boxes, too, while a third one is fast: only
// what is as near as that may meet by its impulses.
TEST(Thresholds, BoxesCoverTheSearchMargin) {
  for (const int far_away : {0, 3000}) {
    Scene scene({0, 0, 0});
    for (const char* name : {"a", "b", "fast"}) scene.sphere(name, 1, radius, material(0.5));
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.body = "universe", s.type = DYN_SHAPE_TYPE_BOX, s.placement[11] = -50, s.size[0] = s.size[1] = s.size[2] = 0.5;
    for (int k = 0; k < far_away; ++k) ASSERT_EQ(DYN_OK, dyn_builder_add_shape(scene.builder(), &s)) << dyn_last_error();
    Simulation run(scene.finish());
    Numbers v(18, 0.0);
    v[12] = 2;
    run.set({0, 0, 0, 0, 0, 0, 1, 2.015 * radius, 0, 0, 0, 0, 0, 1, 0, 5, 0, 0, 0, 0, 1}, v);
    run.steps(1);
    EXPECT_EQ(1u, run.contacts().size()) << far_away;
  }
}

// A ball passes a capsule that spins about its axis. The search for their contact on the way knows of the spin only how fast any
// point moves: beyond fifty steps it ends, and the pair counts as met.
TEST(Thresholds, SearchOnTheWayIsBounded) {
  for (const double spin : {0.0, 2e3, 5e3}) {  // rad/s
    Scene scene({0, 0, 0});
    Simulation run(scene.rod("rod", 1, radius, 0.4, material(0)).sphere("ball", 1, radius, material(0)).finish(), 1e-2);
    run.set({0, 0, 0, 0, 0, 0, 1, -0.3, 0.25, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, spin, 60, 0, 0, 0, 0, 0});
    run.steps(1);
    EXPECT_EQ(spin < 4e3 ? 0u : 1u, run.contacts().size()) << spin;
  }
}

// A hinge nearer than 1e-4 rad to its limit has a row, however slow it is.
TEST(Thresholds, NearLimitsAreRows) {
  for (const double gap : {5e-5, 5e-4}) {
    const double lower = -1, upper = 0.5, none[3] = {0, 0, 0};
    Builder b;
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
    hinge.lower = &lower, hinge.upper = &upper;
    Simulation run(b.joint(hinge).body("arm", "hinge").finish());
    run.set({upper - gap}, {0});
    run.steps(1);
    EXPECT_EQ(gap < 1e-4 ? 1 : 0, run.report().rows);
  }
}

// A slide along the ground that is tilted by 1e-8 rad moves a ball along the contact's normal by rounding only: the contact does
// not hold it. A slide of a larger tilt is held.
TEST(Thresholds, ContactThatNothingMovesIsLeftOut) {
  for (const double tilt : {3e-9, 3e-8}) {
    const double none[3] = {0, 0, 0};
    Builder b;
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec across("across", DYN_JOINT_TYPE_PRISMATIC), slide("slide", DYN_JOINT_TYPE_PRISMATIC, "across", {0, 0, radius});
    across.about(0, 1, 0), slide.about(std::cos(tilt), 0, std::sin(tilt));  // bodies of one joint and the world do not collide
    b.joint(across).body("rail", "across").joint(slide).body("ball", "slide", 1, {0, 0, 0});
    for (const char* body : {"universe", "ball"}) {
      dynShapeSpec shape;
      dyn_shape_spec_init(&shape);
      shape.body = body, shape.type = body[0] == 'u' ? DYN_SHAPE_TYPE_HALF_SPACE : DYN_SHAPE_TYPE_SPHERE;
      shape.size[0] = radius, shape.material = material(0.5);
      ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &shape)) << dyn_last_error();
    }
    Simulation run(b.finish());
    run.options.tolerance = 1e-12;  // the contact closes by the tilt of 1 m/s
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run.m, run.d, &run.options));
    run.set({0, 0}, {0, -1});
    run.steps(1);
    ASSERT_EQ(1u, run.contacts().size());
    EXPECT_EQ(tilt > 1e-8, run.contacts()[0].force_on_b[2] != 0) << tilt;
  }
}

// Two masses of 1 kg on slides and two couplings of slopes 1 and 1 + angle, the second of which is off by an error: together they
// hold where q = -error / angle. Returns how far a step goes there, over the error.
double correction_of(double angle) {
  const double none[3] = {0, 0, 0}, error = 1e-5;
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  for (const char* name : {"a", "b"})
    b.joint(Spec(name, DYN_JOINT_TYPE_PRISMATIC)).body((std::string(name) + "_mass").c_str(), name, 1, {0, 0, 0});
  dynConstraint row;
  dyn_constraint_init(&row, DYN_CONSTRAINT_TYPE_COUPLING);
  EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(b, "same", &row, "a", "b")) << dyn_last_error();
  row.coefficients[0] = error, row.coefficients[1] = 1 + angle;
  EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(b, "off", &row, "a", "b")) << dyn_last_error();
  Simulation run(b.finish());
  run.set({0, 0}, {0, 0});
  run.steps(1);
  return -run.q[0] / error;
}

// Half of an error goes in a step, also by rows that are almost dependent; but no error moves a mass more than 125 times as far:
// rows are soft by a millionth, and the error of one by itself moves it by a quarter.
TEST(Thresholds, CorrectionsOfAlmostDependentRowsAreBounded) {
  EXPECT_NEAR(0.5 / 0.1, correction_of(0.1), 0.01);
  double most = 0;
  for (double angle = 1e-1; angle > 1e-5; angle /= 1.2) most = std::max(most, correction_of(angle));
  EXPECT_LT(most, 0.25 * 0.5 * std::sqrt(1e6));
  EXPECT_GT(most, 60);
}

// Sweeps correct overlaps until they change little: half of that of three balls, one on the other, goes but for a hundredth.
TEST(Thresholds, CorrectionsBySweepsEndNearHalf) {
  const double deep = 1e-5;
  Scene scene({0, 0, 0});
  scene.ground();
  std::vector<Place> at;
  for (int k = 0; k < 3; ++k) {
    scene.sphere(("ball" + std::to_string(k)).c_str(), 1, radius, material(0.5));
    at.push_back({0, 0, (1 + 2 * k) * radius - (k + 1) * deep});
  }
  Simulation run(scene.finish());
  run.place(at);
  run.steps(1);
  double off = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = run.q[7 * k + 2] - (k ? run.q[7 * k - 5] + 2 * radius : radius);
    off = std::max(off, std::abs(gap / deep + 0.5));
  }
  EXPECT_LT(off, 0.03);
  EXPECT_GT(off, 0.005);  // the next steps correct the rest
}

// One mass of 1 kg on a spring.
struct Spring : Simulation {
  Spring(double stiffness, double dt, dynIntegrator by) : Simulation(model(stiffness), dt) {
    integrate_by(*this, by);
    set({0.01}, {0});
  }
  static Model model(double stiffness) {
    const double none[3] = {0, 0, 0};
    Builder b;
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec slide("slide", DYN_JOINT_TYPE_PRISMATIC);
    slide.stiffness = &stiffness;
    return b.joint(slide).body("mass", "slide", 1, {0, 0, 0}).finish();
  }
};

// Half a radian of a spring's oscillation in a step is the bound of explicit springs, which keep their energy; implicit ones
// lose it.
TEST(Thresholds, StiffSpringsAreImplicitInEulerSteps) {
  for (const double square : {0.1, 0.6}) {  // (h rate)^2
    Spring run(square * 1e6, 1e-3, DYN_INTEGRATOR_SEMI_IMPLICIT_EULER);
    run.steps(200);
    const double amplitude = 100 * std::hypot(run.q[0], run.v[0] / (1e3 * std::sqrt(square)));
    EXPECT_LT(amplitude, square < 0.25 ? 1.3 : 1e-3);
    EXPECT_GT(amplitude, square < 0.25 ? 0.7 : 0);
  }
}

// The dt that a refused explicit step names is stable, and not much shorter than need be.
TEST(Thresholds, RefusedExplicitStepsNameAStableLength) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_RK4, DYN_INTEGRATOR_RK45}) {
    Spring refused(1e6, 0.05, by);
    ASSERT_EQ(DYN_ERROR_NUMERIC, dyn_step(refused.m, refused.d));
    const char* found = std::strstr(dyn_last_error(), "a dt below ");
    ASSERT_NE(nullptr, found) << dyn_last_error();
    const double named = std::atof(found + 11);
    Spring stable(1e6, 0.9 * named, by);
    stable.steps(100);
    EXPECT_LT(std::abs(stable.q[0]), 0.03);
    Spring longer(1e6, 1.2 * named, by);
    EXPECT_EQ(DYN_ERROR_NUMERIC, dyn_step(longer.m, longer.d));
  }
}

}  // namespace
}  // namespace dyn_test
