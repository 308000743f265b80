// Smooth motion under constraints: integrators keep their order, constraints stay closed, mechanisms pass singular
// configurations.
#include <memory>

#include "simulation/scene.hpp"

namespace dyn_test {
namespace {

struct Linkage : Simulation {
  explicit Linkage(dynIntegrator integrator, double dt) : Simulation(load(), dt) {
    EXPECT_EQ(DYN_OK, dyn_data_set_effects(m, d, 0, DYN_EFFECT_ARMATURE));
    options.integrator = integrator;
    EXPECT_EQ(DYN_OK, dyn_data_set_step_options(m, d, &options));
    Numbers at = {-5.852, 6.519, 3.858}, rates(at.size(), 5);
    EXPECT_EQ(DYN_OK, dyn_data_new(m, DYN_PART_CONSTRAINTS, &other));
    EXPECT_EQ(DYN_OK, dyn_project(m, other, at.data(), rates.data(), nullptr, at.data(), rates.data(), nullptr))
        << dyn_last_error();
    set(at, rates);
  }
  ~Linkage() { dyn_data_free(other); }
  static Model load() {
    dynModel* loaded = nullptr;
    EXPECT_EQ(DYN_OK, dyn_model_load(DYN_MODELS_DIR "/mechanisms/four_bar.urdf", nullptr, &loaded)) << dyn_last_error();
    return Model(loaded);
  }
  double constraint_error() const {  // largest error of position and velocity
    int rows = 0;
    EXPECT_EQ(DYN_OK, dyn_data_constraint_rows(m, other, -1, nullptr, &rows));
    Numbers C(static_cast<std::size_t>(rows)), Jv(C);
    EXPECT_EQ(DYN_OK, dyn_constraint_terms(m, other, q, v, C.data(), nullptr, Jv.data(), nullptr)) << dyn_last_error();
    double most = 0;
    for (std::size_t k = 0; k < C.size(); ++k) most = std::max({most, std::abs(C[k]), std::abs(Jv[k])});
    return most;
  }
  dynData* other = nullptr;
};

double max_difference(const Simulation& a, const Simulation& b) {
  double most = 0;
  for (int k = 0; k < a.m.nv(); ++k) most = std::max({most, std::abs(a.q[k] - b.q[k]), std::abs(a.v[k] - b.v[k])});
  return most;
}

void check_order(dynIntegrator integrator, double order, int n) {
  Linkage reference(DYN_INTEGRATOR_REFERENCE, 0.05), coarse(integrator, 0.5 / n), fine(integrator, 0.25 / n);
  reference.steps(10), coarse.steps(n), fine.steps(2 * n);
  EXPECT_NEAR(order, std::log2(max_difference(coarse, reference) / max_difference(fine, reference)), 0.3)
      << max_difference(coarse, reference) << ' ' << max_difference(fine, reference);
  EXPECT_LT(fine.constraint_error(), 1e-12);
}

TEST(ConstrainedMotion, IntegratorsKeepTheirOrder) {
  check_order(DYN_INTEGRATOR_RK4, 4, 100);
  check_order(DYN_INTEGRATOR_RK45, 5, 50);
  check_order(DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 2, 200);
}

TEST(ConstrainedMotion, EnergyIsConservedAndLoopsStayClosed) {
  Linkage run(DYN_INTEGRATOR_REFERENCE, 0.05);
  const double before = run.energy();
  for (int k = 0; k < 100; ++k) {
    run.steps(1);
    ASSERT_LT(run.constraint_error(), 1e-12);
    EXPECT_NEAR(before, run.energy(), 1e-11);
  }
}

TEST(ConstrainedMotion, RequestedAccuracyIsMet) {
  Linkage reference(DYN_INTEGRATOR_REFERENCE, 0.05), run(DYN_INTEGRATOR_REFERENCE, 0.05);
  reference.steps(20);
  for (const double accuracy : {1e-6, 1e-9}) {
    Linkage asked(DYN_INTEGRATOR_REFERENCE, 0.05);
    asked.options.accuracy = accuracy;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(asked.m, asked.d, &asked.options));
    ASSERT_EQ(DYN_OK, dyn_advance(asked.m, asked.d, 1)) << dyn_last_error();
    EXPECT_LT(max_difference(asked, reference), 10 * accuracy);
  }
}

// Rods of 1 m and 1 kg in the x-y plane: uprights on the ground, couplers on top.
// When all rods are collinear, each window may fold by itself.
Model windows(int count) {
  const double down[3] = {0, -9.81, 0}, inertia[9] = {0, 0, 0, 0, 1. / 12, 0, 0, 0, 1. / 12};
  Builder b("windows");
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, down));
  for (int k = 0; k <= count; ++k) {
    const std::string upright = "upright" + std::to_string(k), coupler = "coupler" + std::to_string(k);
    b.joint(Spec(upright.c_str(), DYN_JOINT_TYPE_REVOLUTE, nullptr, {double(k), 0, 0}).about(0, 0, 1))
        .body((upright + "_rod").c_str(), upright.c_str(), 1, {0.5, 0, 0}, inertia);
    if (k < count)
      b.joint(Spec(coupler.c_str(), DYN_JOINT_TYPE_REVOLUTE, upright.c_str(), {1, 0, 0}).about(0, 0, 1))
          .body((coupler + "_rod").c_str(), coupler.c_str(), 1, {0.5, 0, 0}, inertia);
  }
  dynConstraint corner;
  dyn_constraint_init(&corner, DYN_CONSTRAINT_TYPE_CONNECT);
  corner.placement1[9] = corner.placement2[9] = 1;
  for (int k = 0; k < count; ++k)
    EXPECT_EQ(DYN_OK, dyn_builder_add_constraint(b, ("corner" + std::to_string(k)).c_str(), &corner,
                                                 ("coupler" + std::to_string(k) + "_rod").c_str(),
                                                 ("upright" + std::to_string(k + 1) + "_rod").c_str()))
        << dyn_last_error();
  return b.finish();
}
// One rod that moves as the uprights do, with the same inertia and weight about its pin.
Model one_upright(int count) {
  const double weight = 2 * ((count + 1) / 2. + count), about_pin = (count + 1) / 3. + count, down[3] = {0, -9.81, 0};
  const double inertia[9] = {about_pin, 0, 0, 0, about_pin, 0, 0, 0, about_pin - weight / 4};
  Builder b("upright");
  EXPECT_EQ(DYN_OK, dyn_builder_set_gravity(b, down));
  b.joint(Spec("pin", DYN_JOINT_TYPE_REVOLUTE).about(0, 0, 1)).body("rod", "pin", weight, {0.5, 0, 0}, inertia);
  return b.finish();
}

// The N-four-bar problem (IFToMM A02): five turns, ten passes through the singular configuration.
TEST(ConstrainedMotion, AccuracyIsMetThroughSingularConfigurations) {
  for (const int count : {1, 2, 8}) {
    Simulation one(one_upright(count));
    one.set({M_PI / 2}, {-1});
    one.options.accuracy = 1e-11;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(one.m, one.d, &one.options));
    ASSERT_EQ(DYN_OK, dyn_advance(one.m, one.d, 10)) << dyn_last_error();
    for (const double accuracy : {1e-3, 1e-4, 0.8e-4, 1e-5, 1e-6, 1e-7, 0.7e-7, 1e-8}) {
      Simulation all(windows(count));
      Numbers q, v;
      for (int k = 0; k <= count; ++k) {
        q.push_back(M_PI / 2), v.push_back(-1);
        if (k < count) q.push_back(-M_PI / 2), v.push_back(1);
      }
      all.set(q, v);
      all.options.accuracy = accuracy;
      ASSERT_EQ(DYN_OK, dyn_data_set_step_options(all.m, all.d, &all.options));
      ASSERT_EQ(DYN_OK, dyn_advance(all.m, all.d, 10)) << dyn_last_error();
      EXPECT_LE(std::max(std::abs(std::cos(all.q[0]) - std::cos(one.q[0])), std::abs(std::sin(all.q[0]) - std::sin(one.q[0]))),
                3 * accuracy)
          << count << " windows";
    }
  }
}

// Accelerations lose digits near singular configurations. Errors below are no reason for shorter steps.
TEST(ConstrainedMotion, SingularConfigurationsCostFewEvaluations) {
  const auto turning = [](double dt) {
    auto run = std::make_unique<Simulation>(windows(2), dt);
    run->set({M_PI / 2, -M_PI / 2, M_PI / 2, -M_PI / 2, M_PI / 2}, {-1, 1, -1, 1, -1});
    return run;
  };
  for (const auto& [accuracy, evaluations] : {std::pair(1e-6, 1860), {1e-10, 5900}, {1e-12, 10800}}) {
    const auto run = turning(1e-3);
    run->options.accuracy = accuracy;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(run->m, run->d, &run->options));
    ASSERT_EQ(DYN_OK, dyn_advance(run->m, run->d, 10)) << dyn_last_error();
    EXPECT_NEAR(evaluations, double(run->report().evaluations), 0.1 * evaluations) << accuracy;
  }
  const auto run = turning(0.5);
  integrate_by(*run, DYN_INTEGRATOR_REFERENCE);
  double evaluations = 0;
  for (int k = 0; k < 20; ++k) run->steps(1), evaluations += double(run->report().evaluations);
  EXPECT_NEAR(13800, evaluations, 1400);
}

// An open loop closes first, in steps of order 1, by at most 1 m/s.
TEST(ConstrainedMotion, OpenLoopsClose) {
  Linkage run(DYN_INTEGRATOR_RK4, 1e-3);
  Numbers at(run.q, run.q + run.m.nq());
  at[0] += 0.1;
  run.set(at);
  EXPECT_GT(run.constraint_error(), 1e-2);
  run.steps(200);
  EXPECT_LT(run.constraint_error(), 1e-12);
}

// A weld stretches an arm whose wrist axes are aligned but for rounding of decimals in a file.
// The weld's rows contradict one another by 1e-8 of the velocities; only impulses of 1e8 times the arm's weight would fix that.
TEST(ConstrainedMotion, InconsistentWeldKeepsImpulsesBounded) {
  const char* text =
      R"(<mujoco><option gravity='.3 -1.2 -9.7'/><worldbody><body pos='0 0 .1'><joint axis='0 0 1'/><geom type='capsule' fromto='0 0 0 0 0 .1' size='.03'/>
      <body pos='0 0 .05'><joint axis='0 1 0'/><geom type='capsule' fromto='0 0 0 .06 0 .3' size='.03'/>
      <body pos='.06 0 .3'><joint axis='0 1 1e-10'/><geom type='capsule' fromto='0 0 0 .2 0 0' size='.03'/>
      <body pos='.2 0 0'><joint axis='1 1e-10 0'/><geom type='capsule' fromto='0 0 0 .1 0 0' size='.03'/>
      <body pos='.1 0 0'><joint axis='1e-10 1 0'/><geom type='capsule' fromto='0 0 0 .07 0 0' size='.03'/>
      <body name='hand' pos='.07 0 0'><joint axis='1 0 1e-10'/><geom type='capsule' fromto='0 0 0 .05 .01 0' size='.03'/>
      <body pos='.04 .1 0'><joint type='slide' axis='0 1 0' limited='true' range='0 .1'/><geom type='box' size='.02 .01 .02'/></body>
      </body></body></body></body></body></body></worldbody><equality><weld body1='hand'/></equality></mujoco>)";
  dynModel* m = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_load_string(text, nullptr, &m)) << dyn_last_error();
  Simulation run(Model(m), 2e-3);
  const double tau[] = {3, -2, 1, 5, -4, 6, -1};
  ASSERT_EQ(DYN_OK, dyn_data_set_state(run.m, run.d, nullptr, nullptr, nullptr, tau));
  int iterations = 0;
  for (int k = 0; k < 100; ++k) run.steps(1), iterations += run.report().iterations;
  EXPECT_LT(iterations, 100 * 40);
  EXPECT_LT(run.residual, 1e-6);
}

}  // namespace
}  // namespace dyn_test
