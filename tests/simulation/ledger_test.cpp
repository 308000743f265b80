// Error ledger: the work of forces and impulses equals the changes of energy and momentum, to the order of the steps.
#include <random>
#include <vector>

#include "common/every.hpp"

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

// A tree of sliders with random axes: M is constant, so that only what acts changes the kinetic energy. Damping from 1e-3 to
// `most`, armature, dry friction, servos on joints and on a tendon, and tau; or springs and gravity.
struct Sliders {
  static constexpr int joints = 5;
  std::mt19937 random;
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random); }
  double spread(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }

  Sliders(unsigned seed, double most, bool friction, bool springs) : random(seed) {
    dyn_builder_set_gravity(b, std::array<double, 3>{0, 0, springs ? -g : 0}.data());
    std::vector<dynTendonElement> elements;
    static const char* const names[] = {"a", "b", "c", "d", "e"};
    static const char* const links[] = {"la", "lb", "lc", "ld", "le"};
    for (int k = 0; k < joints; ++k) {
      const double damping = spread(1e-3, most), rotor = uniform(0, 2), dry = friction ? uniform(0, 3) : 0,
                   spring = springs ? spread(1, 1e3) : 0;
      Spec slide(names[k], DYN_JOINT_TYPE_PRISMATIC, k > 0 && uniform(0, 1) < 0.7 ? links[k - 1] : nullptr);
      slide.about(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      slide.damping = &damping, slide.armature = &rotor, slide.friction = &dry, slide.stiffness = &spring;
      b.joint(slide).body(links[k], names[k], uniform(0.1, 3));
      dynTendonElement e;
      dyn_tendon_element_init(&e, DYN_TENDON_ELEMENT_TYPE_JOINT);
      e.name = names[k], e.value = uniform(-1, 1), elements.push_back(e);
    }
    dynTendon t;
    dyn_tendon_init(&t, DYN_TENDON_TYPE_FIXED);
    t.damping = spread(1e-3, most), t.armature = friction ? uniform(0, 2) : 0;
    EXPECT_EQ(DYN_OK, dyn_builder_add_tendon(b, "sum", &t, elements.data(), joints)) << dyn_last_error();
    for (int k = 0; k < 2; ++k) {
      dynActuator servo;
      dyn_actuator_init(&servo, DYN_ACTUATOR_TYPE_VELOCITY);
      servo.kv = spread(1e-3, most), servo.gear = uniform(-2, 2);
      servo.transmission = k == 0 ? DYN_TRANSMISSION_JOINT : DYN_TRANSMISSION_TENDON;
      if (uniform(0, 1) < 0.5) servo.force_range[0] = -1, servo.force_range[1] = 2;
      EXPECT_EQ(DYN_OK, dyn_builder_add_actuator(b, k == 0 ? "wheel" : "winch", &servo, k == 0 ? "c" : "sum")) << dyn_last_error();
    }
  }
  // Largest defect of 50 steps, over the energies that they move.
  double defect(dynIntegrator by) {
    Simulation play(b.finish(), spread(1e-3, 1e-2));
    keep(play, by);
    Numbers q, v, tau;
    for (int k = 0; k < joints; ++k) q.push_back(uniform(-1, 1)), v.push_back(uniform(-3, 3)), tau.push_back(uniform(-5, 5));
    EXPECT_EQ(DYN_OK, dyn_data_set_state(play.m, play.d, q.data(), v.data(), nullptr, tau.data())) << dyn_last_error();
    control(play, {uniform(-2, 2), uniform(-2, 2)});
    double worst = 0;
    for (int k = 0; k < 50; ++k) {
      play.steps(1);
      const dynErrorLedger l = ledger_of(play);
      const double moved = std::abs(l.applied) + std::abs(l.actuators) + std::abs(l.damping) + std::abs(l.friction) +
                           std::abs(l.energy_change) + std::abs(l.limits) + play.energy();
      worst = std::max(worst, std::abs(l.energy_defect) / moved);
    }
    return worst;
  }
  Builder b;
};

// Impulses times their mean velocities are the change of the kinetic energy, however stiff what is implicit.
TEST(Ledger, StiffDampingClosesInEulerSteps) {
  for (const dynIntegrator by : {DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, DYN_INTEGRATOR_IMPLICIT_FAST})
    for (unsigned seed = 0; seed < 40; ++seed)
      EXPECT_LT(Sliders(seed, 1e3, seed % 2, false).defect(by), 1e-9) << "integrator " << by << ", seed " << seed;
}
// So does the midpoint rule, with springs and gravity: their potentials are quadratic. Its iteration refuses stiff damping.
TEST(Ledger, DampingClosesInMidpointSteps) {
  for (unsigned seed = 0; seed < 40; ++seed)
    EXPECT_LT(Sliders(seed, 2, false, true).defect(DYN_INTEGRATOR_IMPLICIT_MIDPOINT), 1e-9) << "seed " << seed;
}

// With damping too, the defect falls with the order: works are by the quadrature of the integrator.
TEST(Ledger, DefectUnderDampingHasTheIntegratorsOrder) {
  const struct {
    dynIntegrator integrator;
    double order, dt;
  } cases[] = {{DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1, 1e-3},
               {DYN_INTEGRATOR_RK4, 4, 2e-2},
               {DYN_INTEGRATOR_RK45, 5, 2e-2},
               {DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 2, 4e-3}};
  for (const auto& c : cases) {
    std::vector<double> defects;
    for (const double dt : {c.dt, c.dt / 2}) {
      Builder b;
      const double damping = 0.8, spring = 20;
      for (int k = 0; k < 2; ++k) {
        Spec hinge(k == 0 ? "a" : "b", DYN_JOINT_TYPE_REVOLUTE, k == 0 ? nullptr : "la", {0.3 * k, 0, 0});
        hinge.about(0, 1, 0.3 * k), hinge.damping = &damping, hinge.stiffness = &spring;
        b.joint(hinge).body(k == 0 ? "la" : "lb", k == 0 ? "a" : "b");
      }
      Simulation play(b.finish(), dt);
      keep(play, c.integrator);
      play.set({0.3, 0.8}, {1, -2});
      ASSERT_EQ(DYN_OK, dyn_advance(play.m, play.d, 0.4)) << dyn_last_error();
      const dynErrorLedger l = ledger_of(play);
      EXPECT_LT(l.damping, -0.1);
      defects.push_back(std::abs(l.energy_defect));
    }
    EXPECT_GT(std::log2(defects[0] / defects[1]), c.order - 0.6) << c.integrator << ' ' << defects[0];
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
  for (const dynIntegrator by : every<dynIntegrator>("dynIntegrator")) {
    const auto end = [&](bool kept) {
      Simulation play(Sliders(7, 2, false, true).b.finish());
      play.options.ledger = kept, play.options.integrator = by;
      EXPECT_EQ(DYN_OK, dyn_data_set_step_options(play.m, play.d, &play.options));
      play.set({0.1, -0.2, 0.3, 0, 0.5}, {1, 2, -1, 0, 1});
      dyn_advance(play.m, play.d, 0.02);  // explicit methods refuse what is stiff
      return Numbers(play.q, play.q + Sliders::joints);
    };
    EXPECT_EQ(end(false), end(true)) << by;
  }
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
