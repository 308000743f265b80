// How far a step corrects positions: coordinates that move a contact little, towers, mechanisms out of reach.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

// A ball on a short arm overlaps the ground by 1 cm: at a lever of 1 mm that would be a turn of half a radian. A step turns it
// by 0.1 rad. The rail keeps the arm away from the ground at first, so that the pair is tested.
TEST(Correction, NoCoordinateMovesFurtherThanATenthOfARadian) {
  const double none[3] = {0, 0, 0}, radius = 0.1, lever = 1e-3;
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  Spec rail("rail", DYN_JOINT_TYPE_PRISMATIC), hinge("hinge", DYN_JOINT_TYPE_REVOLUTE, "rail", {0, 0, radius - 0.01});
  rail.about(1, 0, 0), hinge.about(0, 1, 0);
  b.joint(rail).body("cart", "rail").joint(hinge).body("arm", "hinge", 1, {lever, 0, 0});
  dynShapeSpec box, ball;
  dyn_shape_spec_init(&box), dyn_shape_spec_init(&ball);
  box.body = "universe", box.type = DYN_SHAPE_TYPE_BOX, box.placement[9] = 6, box.placement[11] = -0.5;
  box.size[0] = box.size[1] = box.size[2] = 1, box.material = ball.material = material(0);
  ball.body = "arm", ball.type = DYN_SHAPE_TYPE_SPHERE, ball.size[0] = radius, ball.placement[9] = lever;
  for (const dynShapeSpec* shape : {&box, &ball}) ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, shape)) << dyn_last_error();
  Simulation run(b.finish());
  run.set({6, 0});
  run.steps(1);
  EXPECT_NEAR(-0.1, run.q[1], 1e-9);
  EXPECT_NEAR(6, run.q[0], 1e-9);
}

// A thigh overlaps a pelvis by 5 cm near its hip, whose two hinges have limits of 0.01 rad: no motion opens the overlap. The overlap
// stays. The hip turns by less than the overlap over the thigh's own length; from a lever of 2 cm alone it would be 0.7 rad.
TEST(Correction, AnOverlapThatLimitsLeaveNoWayOutStays) {
  const double none[3] = {0, 0, 0}, lower[1] = {-0.01}, upper[1] = {0.01};
  for (const double lever : {0.005, 0.02, 0.05}) {
    Builder b;
    EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
    Spec x("x", DYN_JOINT_TYPE_REVOLUTE, nullptr, {0, 0, -0.05}), y("y", DYN_JOINT_TYPE_REVOLUTE, "x");
    x.about(1, 0, 0), y.about(0, 1, 0);
    for (Spec* s : {&x, &y}) s->lower = lower, s->upper = upper;
    b.joint(x).body("hip", "x", 1).joint(y).body("thigh", "y", 3, {0, 0, -0.2});
    dynShapeSpec pelvis, thigh;
    dyn_shape_spec_init(&pelvis), dyn_shape_spec_init(&thigh);
    pelvis.body = "universe", thigh.body = "thigh", pelvis.name = "pelvis", thigh.name = "femur", pelvis.type = thigh.type = DYN_SHAPE_TYPE_SPHERE;
    pelvis.size[0] = 0.1, thigh.size[0] = 0.07, pelvis.material = thigh.material = material(0);
    thigh.placement[9] = lever, thigh.placement[10] = lever / 2, thigh.placement[11] = -0.06;
    for (const dynShapeSpec* shape : {&pelvis, &thigh}) ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, shape)) << dyn_last_error();
    ASSERT_EQ(DYN_OK, dyn_builder_add_pair(b, "pelvis", "femur", nullptr)) << dyn_last_error();
    Simulation run(b.finish(), 2e-3);
    run.set({0, 0});
    run.steps(1000);
    for (int k = 0; k < 2; ++k) EXPECT_LT(std::abs(run.q[k]), 0.03) << lever;
    for (int k = 0; k < 2; ++k) EXPECT_LT(std::abs(run.v[k]), 0.02) << lever;
    EXPECT_EQ(1u, run.contacts().size()) << lever;
  }
}

// Cubes of a tower overlap by 0.1 mm each. A step removes half of that, however high the tower is.
TEST(Correction, AStepStraightensATower) {
  for (const int count : {12, 50})
    for (const auto solver : {DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_PGS}) {
      Scene scene;
      scene.shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0}, material(0.5));
      Numbers at;
      for (int k = 0; k < count; ++k) {
        scene.box(("cube" + std::to_string(k)).c_str(), 1, {0.1, 0.1, 0.1}, material(0.5));
        at.insert(at.end(), {0, 0, 0.05 + 0.1 * k - 1e-4 * (k + 1), 0, 0, 0, 1});
      }
      Simulation run(scene.finish(), 1e-3, solver);
      run.set(at);
      run.steps(1);
      const std::size_t last = 7 * (std::size_t(count) - 1) + 2;
      const double lifted = (run.q[last] - at[last]) / (count * 1e-4);
      if (solver == DYN_CONTACT_SOLVER_TYPE_ADMM) {
        EXPECT_NEAR(0.5, lifted, 0.01) << count;
      } else if (count == 12) {
        EXPECT_NEAR(0.2, lifted, 0.02);  // twenty sweeps without friction; ten: 0.14, forty: 0.29
      }
    }
}

// A slider overlaps two walls, the one by 1.2 mm, the other by 0.8 mm; a step corrects halves. Rows that contradict each other
// give way by a tenth of what they push: with the pushes A and B, A - B = 0.6 mm - 0.1 A = 0.1 B - 0.4 mm, so the slider moves by
// 0.2 mm / 2.1. Twenty sweeps leave an eighth.
TEST(Correction, ErrorsThatContradictGiveWay) {
  const double none[3] = {0, 0, 0};
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  // pairs are tested of links that are no neighbours, and that are apart at first
  Spec lift("lift", DYN_JOINT_TYPE_PRISMATIC), rail("rail", DYN_JOINT_TYPE_PRISMATIC, "lift");
  lift.about(0, 0, 1), rail.about(1, 0, 0);
  b.joint(lift).body("platform", "lift", 1).joint(rail).body("cart", "rail", 2);
  dynShapeSpec ball, wall;
  dyn_shape_spec_init(&ball), dyn_shape_spec_init(&wall);
  ball.body = "cart", ball.type = DYN_SHAPE_TYPE_SPHERE, ball.size[0] = 0.1, ball.material = wall.material = material(0);
  wall.body = "universe", wall.type = DYN_SHAPE_TYPE_BOX, wall.size[0] = wall.size[1] = wall.size[2] = 1;
  ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &ball)) << dyn_last_error();
  for (const double side : {-1.0, 1.0}) {
    wall.placement[9] = 6 + side * 0.599;
    ASSERT_EQ(DYN_OK, dyn_builder_add_shape(b, &wall)) << dyn_last_error();
  }
  Simulation run(b.finish());
  run.set({0, 6 + 2e-4});
  run.steps(1);
  EXPECT_EQ(2u, run.contacts().size());
  EXPECT_NEAR(1, (6 + 2e-4 - run.q[1]) / (2e-4 / 2.1), 0.15);
  run.steps(100);
  EXPECT_NEAR(6, run.q[1], 5e-5);
}

// An arm of two links of 0.5 m, its tip tied to a point of its plane.
Model tied_arm(double x, double z) {
  const double none[3] = {0, 0, 0};
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  Spec first("first", DYN_JOINT_TYPE_REVOLUTE), second("second", DYN_JOINT_TYPE_REVOLUTE, "first", {0.5, 0, 0});
  first.about(0, 1, 0), second.about(0, 1, 0);
  b.joint(first).body("upper", "first", 1, {0.5, 0, 0}).joint(second).body("lower", "second", 1, {0.5, 0, 0});
  dynConstraint tie;
  dyn_constraint_init(&tie, DYN_CONSTRAINT_TYPE_CONNECT);
  tie.placement1[9] = 0.5, tie.placement2[9] = x, tie.placement2[11] = z;
  EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(b, "tie", &tie, "lower", "universe")) << dyn_last_error();
  return b.finish();
}

// The tie is open, so the joints have to turn. RK4 closes half a millimetre at once; more than a thousandth of the reach first
// closes by half, in a step of order 1.
TEST(Correction, WideOpenConstraintsCloseFirst) {
  const double angle = std::acos(0.8);
  for (const double open : {5e-4, 2e-3}) {
    Simulation run(tied_arm(0.8 + open, 0));
    integrate_by(run, DYN_INTEGRATOR_RK4);
    run.set({angle, -2 * angle}, {0, 0});
    run.steps(1);
    const double whole = -open / (2 * 0.5 * std::sin(angle));  // x = 2 (0.5 cos q)
    EXPECT_NEAR(open < 1e-3 ? whole : whole / 2, run.q[0] - angle, 0.01 * open) << open;
  }
}

// The arm of 1 m is tied to a point at 1.27 m. Softness of a hundredth makes it slow to settle: tenfold, it would have turned
// by 0.31 rad.
TEST(Correction, AnArmOutOfReachSettlesInManySteps) {
  Simulation run(tied_arm(0.9, 0.9));
  run.set({0.1, 0.3}, {0, 0});
  run.steps(100);
  EXPECT_NEAR(-0.4523, run.q[0], 2e-3);
}

// A hinge that a weld asks to turn back by one radian. Without gravity a step removes 1e-3 rad of an error of angles, as it
// removes 1e-3 of the length of a distance.
TEST(Correction, AnAngleThatIsFarOffClosesBitByBit) {
  const double none[3] = {0, 0, 0};
  Builder b;
  ASSERT_EQ(DYN_OK, dyn_builder_set_gravity(b, none));
  Spec hinge("hinge", DYN_JOINT_TYPE_REVOLUTE);
  b.joint(hinge.about(0, 0, 1)).body("arm", "hinge", 1, {0.5, 0, 0});
  dynConstraint weld;
  dyn_constraint_init(&weld, DYN_CONSTRAINT_TYPE_WELD);
  ASSERT_EQ(DYN_OK, dyn_builder_add_constraint(b, "weld", &weld, "arm", "universe")) << dyn_last_error();
  Simulation run(b.finish());
  run.set({1}, {0});
  run.steps(1);
  EXPECT_NEAR(1e-3, 1 - run.q[0], 2e-5);  // rows of errors that are far off are a hundredth softer
}

}  // namespace
}  // namespace dyn_test
