// Error ledger: the work of forces and impulses equals the changes of energy and momentum, to the order of the steps.
#include <vector>

#include "simulation/scene.hpp"

namespace {

using namespace dyn_test;

dynErrorLedger ledger_of(Simulation& play) {
  dynErrorLedger out{};
  out.struct_size = sizeof out;
  EXPECT_EQ(DYN_OK, dyn_data_ledger(play.m, play.d, &out)) << dyn_last_error();
  return out;
}
void keep(Simulation& play, dynIntegrator integrator = DYN_INTEGRATOR_SEMI_IMPLICIT_EULER) {
  play.options.ledger = 1, play.options.integrator = integrator;
  ASSERT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options)) << dyn_last_error();
}
double sources(const dynErrorLedger& l) {
  return l.applied + l.actuators + l.wrenches + l.damping + l.friction + l.fluid + l.contact_normal + l.contact_friction +
         l.limits + l.constraints + l.correction;
}

// A block slides to rest: friction takes m v^2 / 2, in every step to rounding.
TEST(Ledger, FrictionWorkEqualsSlidingLoss) {
  Simulation play(Scene().ground().box("block", 2, {0.2, 0.2, 0.2}, material(0.4)).finish());
  keep(play);
  play.set({0, 0, 0.1, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 0});
  ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.5)) << dyn_last_error();
  const dynErrorLedger l = ledger_of(play);
  EXPECT_EQ(500, l.steps);
  EXPECT_NEAR(-1.0, l.energy_change, 1e-9);
  EXPECT_NEAR(-1.0, l.contact_friction, 1e-8);
  EXPECT_NEAR(0, l.energy_defect, 1e-8);
  EXPECT_NEAR(l.energy_change, sources(l) + l.energy_defect, 1e-14);
  for (const double p : l.momentum_defect) EXPECT_NEAR(0, p, 1e-12);
  EXPECT_LE(l.cone, 1e-6);
  EXPECT_LE(l.complementarity, 1e-6);
}

// An impact loses (1 - e^2) of the energy along the normal.
TEST(Ledger, ImpactWorkMatchesRestitution) {
  Simulation play(Scene({0, 0, 0}).ground().sphere("ball", 1, 0.1, material(0, 0.5)).finish());
  keep(play);
  play.set({0, 0, 0.3, 0, 0, 0, 1}, {0, 0, -2, 0, 0, 0});
  ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.3)) << dyn_last_error();
  const dynErrorLedger l = ledger_of(play);
  EXPECT_NEAR(-1.5, l.contact_normal, 1e-9);
  EXPECT_NEAR(-1.5, l.energy_change, 1e-9);
  EXPECT_NEAR(0, l.energy_defect, 1e-9);
  for (const double p : l.momentum_defect) EXPECT_NEAR(0, p, 1e-12);
}

// A sunk ball is pushed out without velocity: corrections lift its weight by the overlap, m g times it.
TEST(Ledger, CorrectionIsTheWeightTimesTheOverlap) {
  const double overlap = 0.01;
  Simulation play(Scene().ground().sphere("ball", 1, 0.1, material(0)).finish());
  keep(play);
  play.set({0, 0, 0.1 - overlap, 0, 0, 0, 1});
  ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.5)) << dyn_last_error();
  const dynErrorLedger l = ledger_of(play);
  EXPECT_NEAR(g * overlap, l.correction, 1e-6);
  EXPECT_NEAR(g * overlap, l.energy_change, 1e-6);
  EXPECT_NEAR(0, l.energy_defect, 1e-6);
}

// A stone of which a quarter of the weight is held falls with 3/4 g. The quarter's work is negative, and stands at `wrenches`.
TEST(Ledger, GravityCompensationIsWorkOfWrenches) {
  const double m = 2, share = 0.25, time = 0.1, fall = (1 - share) * g * time * time / 2;
  Scene scene;
  scene.free("stone", m, {0.1, 0.2, 0.25});
  ASSERT_EQ(DYN_OK, dyn_builder_set_gravity_compensation(scene.builder(), "stone", share));
  Simulation play(scene.finish());
  keep(play);
  ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, time)) << dyn_last_error();
  const dynErrorLedger l = ledger_of(play);
  EXPECT_NEAR(-share * m * g * fall, l.wrenches, 1e-10);  // the mean power of a step is exact
  for (const double p : l.momentum_defect) EXPECT_NEAR(0, p, 1e-12);
}

// The defect is the integrator's error and falls with its order.
TEST(Ledger, DefectHasTheIntegratorsOrder) {
  const struct {
    dynIntegrator integrator;
    double order;
  } cases[] = {{DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1}, {DYN_INTEGRATOR_RK4, 4}, {DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 2}};
  for (const auto& c : cases) {
    std::vector<double> defects;
    for (const double dt : {4e-3, 2e-3}) {
      dynModel* m = nullptr;
      const char* text =
          "<mujoco><compiler angle='radian'/><worldbody><body><joint axis='0 1 0'/><geom type='capsule' size='.02' fromto='0 0 0 "
          ".5 0 0' contype='0' conaffinity='0'/>"
          "<body pos='.5 0 0'><joint axis='0 1 0'/><geom type='capsule' size='.02' fromto='0 0 0 .5 0 0' contype='0' "
          "conaffinity='0'/></body></body></worldbody></mujoco>";
      ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
      Simulation play(Model(m), dt);
      keep(play, c.integrator);
      play.set({0.3, 0.8}, {1, -2});
      ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.4)) << dyn_last_error();
      const dynErrorLedger l = ledger_of(play);
      EXPECT_EQ(l.energy_change, l.energy_defect);  // no other effect acts
      defects.push_back(std::abs(l.energy_defect));
    }
    EXPECT_NEAR(c.order, std::log2(defects[0] / defects[1]), 0.5) << c.integrator;
  }
}

// The ledger changes no bit of a step.
TEST(Ledger, ChangesNoBit) {
  const auto run = [](bool kept, double accuracy) {
    Simulation play(
        Scene().ground().box("a", 1, {0.2, 0.2, 0.2}, material(0.5, 0.3)).box("b", 1, {0.2, 0.2, 0.2}, material(0.5)).finish());
    play.options.accuracy = accuracy;
    play.options.ledger = kept;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
    play.set({0, 0, 0.15, 0, 0, 0, 1, 0.05, 0, 0.4, 0.1, 0, 0, 0.995}, {0.5, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0});
    EXPECT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.3)) << dyn_last_error();
    const dynErrorLedger l = ledger_of(play);
    EXPECT_EQ(kept, l.steps > 0);
    EXPECT_NEAR(l.energy_change, sources(l) + l.energy_defect, 1e-12);
    return Numbers(play.q, play.q + 14);
  };
  EXPECT_EQ(run(false, 0), run(true, 0));
  EXPECT_EQ(run(false, 1e-3), run(true, 1e-3));
}

TEST(Ledger, NeedsTheEnergyPart) {
  Model m(Scene().ground().finish());
  dynData* d = nullptr;
  ASSERT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_SIMULATION, &d));
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.ledger = 1;
  EXPECT_EQ(DYN_ERROR_PART, dyn_data_set_step_options(m, d, &options));
  dynErrorLedger l{};
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_data_ledger(m, d, &l));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_data_ledger(m, d, nullptr));
  dyn_data_free(d);
}

}  // namespace
