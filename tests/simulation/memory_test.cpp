// Memory of the data of steps: as small as stated, and the same results where rows exceed what it keeps.
#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

Model on_ground(const Model& bare) {
  dynBuilder* b = nullptr;
  dynModel* m = nullptr;
  dynShapeSpec ground;
  dyn_shape_spec_init(&ground);
  ground.type = DYN_SHAPE_TYPE_HALF_SPACE, ground.body = "universe";
  EXPECT_EQ(DYN_OK, dyn_builder_from_model(bare, &b)) << dyn_last_error();
  EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &ground)) << dyn_last_error();
  EXPECT_EQ(DYN_OK, dyn_builder_finish(b, &m)) << dyn_last_error();
  dyn_builder_free(b);
  return Model(m);
}

// Links of 0.1 m, side by side, each held up by its joint's limit.
Model beam(int links) {
  Builder b;
  std::string last;
  for (int k = 0; k < links; ++k) {
    const std::string joint = "j" + std::to_string(k), body = "b" + std::to_string(k);
    const double lower = -1, upper = 0;
    Spec s(joint.c_str(), DYN_JOINT_TYPE_REVOLUTE, last.empty() ? nullptr : last.c_str(), {k ? 0.1 : 0, 0, 0});
    s.about(0, 1, 0), s.lower = &lower, s.upper = &upper;
    b.joint(s).body(body.c_str(), joint.c_str(), 1, {0.05, 0, 0});
    last = joint;
  }
  return b.finish();
}

TEST(StepMemory, OfAQuadrupedOnTheGround) {
  const Model m = on_ground(robot("go2", DYN_BASE_FLOATING));
  const double bytes = double(dyn_data_size(m, DYN_PART_SIMULATION));
  EXPECT_LT(bytes, 400e3);
  EXPECT_LT(4096 * bytes, 2e9);
}

TEST(StepMemory, OfALongChainWithLimits) {
  EXPECT_LT(double(dyn_data_size(beam(10000), DYN_PART_SIMULATION)), 200e6);
}

// All limits of a beam act. Their rows have more columns than are kept. Free, its joints would reach 1 rad/s.
TEST(StepMemory, RowsThatAreNotKeptAct) {
  Simulation run(beam(150));
  run.steps(5);
  EXPECT_EQ(150, run.report().rows);
  for (int k = 0; k < run.m.nv(); ++k) ASSERT_NEAR(0, run.v[k], 0.02) << k;
}

// Ten legs of three joints under a plate, on feet with four corners each.
Model centipede(int contacts, double torsion) {
  Builder b;
  EXPECT_EQ(DYN_OK, dyn_builder_set_contact_capacity(b, contacts));
  dynShapeSpec s;
  const auto shape = [&](const char* body, dynShapeType type, std::array<double, 3> size) {
    dyn_shape_spec_init(&s);
    s.body = body, s.type = type, s.material.friction = 0.6, s.material.torsion = torsion;
    std::copy(size.begin(), size.end(), s.size);
    EXPECT_EQ(DYN_OK, dyn_builder_add_shape(b, &s)) << dyn_last_error();
  };
  b.joint(Spec("float", DYN_JOINT_TYPE_FREE_FLYER)).body("plate", "float", 10, {0, 0, 0});
  shape("universe", DYN_SHAPE_TYPE_HALF_SPACE, {0, 0, 0});
  for (int k = 0; k < 10; ++k) {
    const std::string id = std::to_string(k), hip = "hip" + id, knee = "knee" + id, ankle = "ankle" + id, foot = "foot" + id;
    const double stiffness = 400, damping = 10;
    std::string parent = "float";
    for (const std::string& joint : {hip, knee, ankle}) {
      Spec j(joint.c_str(), DYN_JOINT_TYPE_REVOLUTE, parent.c_str(),
             {joint == hip ? 0.2 * k : 0, joint == hip ? 0.2 * (k % 2) : 0, joint == hip ? 0 : -0.2});
      j.about(joint == hip ? 1 : 0, joint == hip ? 0 : 1, 0), j.stiffness = &stiffness, j.damping = &damping;
      b.joint(j).body(joint == ankle ? foot.c_str() : ("part" + joint).c_str(), joint.c_str(), 0.5, {0, 0, -0.1});
      parent = joint;
    }
    shape(foot.c_str(), DYN_SHAPE_TYPE_BOX, {0.1, 0.1, 0.02});
  }
  return b.finish();
}
// report: of the first step
Numbers played(Model m, bool exactly, int steps, dynStepReport& report) {
  Simulation run(std::move(m));
  if (exactly) run.exactly();
  Numbers q(run.q, run.q + run.m.nq()), v(std::size_t(run.m.nv()), 0.0);
  q[2] = 0.41, v[0] = 0.3, v[5] = 0.2;
  run.set(q, v), run.steps(1);
  report = run.report();
  run.steps(steps - 1);
  return Numbers(run.q, run.q + run.m.nq());
}

TEST(StepMemory, RoomForMoreContactsChangesNothing) {
  dynStepReport few{}, many{};
  const Numbers a = played(centipede(40, 0), false, 200, few), b = played(centipede(400, 0), false, 200, many);
  EXPECT_EQ(40, few.contacts);
  EXPECT_EQ(0, few.dropped);
  EXPECT_EQ(40, many.contacts);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k], b[k]) << k;
}

// Forty contacts with torsion, of which sweeps keep sixteen cones.
TEST(StepMemory, ConesThatAreNotKeptActAlike) {
  dynStepReport few{}, many{};
  const Numbers a = played(centipede(80, 0.01), true, 20, few), b = played(centipede(400, 0.01), true, 20, many);
  EXPECT_EQ(160, few.rows);
  EXPECT_EQ(0, few.dropped);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-7) << k;
}

// Without room for rows by segments either, sweeps solve the step.
TEST(StepMemory, SweepsSolveWhatExceedsTheRoom) {
  dynStepReport report{};
  played(centipede(60, 0.01), false, 1, report);
  EXPECT_EQ(160, report.rows);
  EXPECT_EQ(0, report.dropped);
  EXPECT_LT(report.residual, 1e-3);
}

// Rows of contacts with torsion are more than three each. The deepest contacts count.
TEST(StepMemory, ContactsWithoutRoomForTheirRowsAreReported) {
  Simulation run(centipede(40, 0.01));
  Numbers q(run.q, run.q + run.m.nq());
  q[2] = 0.41;
  run.set(q), run.steps(1);
  EXPECT_EQ(36, run.report().contacts);
  EXPECT_EQ(4, run.report().dropped);
  EXPECT_EQ(144, run.report().rows);
}

}  // namespace
}  // namespace dyn_test
