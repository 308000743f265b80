// Steps of smooth dynamics: order of the integrators, drift of energy and momentum, rotations that stay rotations.
#include "common/every.hpp"
#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

Tree free_body() {
  Tree t;
  JointSpec s;
  s.name = "body", s.type = DYN_JOINT_TYPE_FREE_FLYER;
  t.joints.push_back(s);
  BodySpec b;
  b.name = "link", b.parent = "body", b.com = V3(0.1, -0.2, 0.05), b.inertia = V3(0.2, 0.5, 0.6).asDiagonal();
  t.bodies.push_back(b);
  return t;
}
Tree chain() {
  Tree t;
  const dynJointType types[] = {DYN_JOINT_TYPE_SPHERICAL, DYN_JOINT_TYPE_REVOLUTE,  DYN_JOINT_TYPE_SPHERICAL,
                                DYN_JOINT_TYPE_UNIVERSAL, DYN_JOINT_TYPE_PRISMATIC, DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED};
  Dice dice(21);
  for (int k = 0; k < 6; ++k) {
    JointSpec s = random_joint(dice, types[k]);
    s.name = "j" + std::to_string(k);
    if (k) s.parent.name = "j" + std::to_string(k - 1);
    t.joints.push_back(s);
    t.bodies.push_back(random_body(dice, "b" + std::to_string(k), s.name));
  }
  t.joints[5].mimic.clear();
  return t;
}
Tree geared() {
  Tree t = chain();
  JointSpec s = t.joints[1];
  s.name = "follower", s.parent.name = "j5", s.mimic = "j1", s.mimic_ratio = -0.7, s.mimic_offset = 0.2;
  t.joints.push_back(s);
  Dice dice(22);
  t.bodies.push_back(random_body(dice, "fb", "follower"));
  return t;
}

struct Flight {
  ModelPtr model;
  Work<double> w;
  explicit Flight(const Tree& t) : model(t.build()), w(*model) {
    const State x(*model, 3);
    w.q(x.q).v(x.v * 2);
    std::fill_n(w.d.effects, model->n.joints,
                std::uint32_t(DYN_EFFECT_ALL) & ~std::uint32_t(DYN_EFFECT_LIMITS));  // velocities jump at limits
    apply_effects(*model, w.d);
  }
  double energy() {
    w.d.changed(input_q), w.d.changed(input_v);
    kinetic_energy(*model, w.d), potential_energy(*model, w.d);
    return w.d.kinetic[0] + w.d.potential[0];
  }
  void advance(dynIntegrator integrator, double duration, int steps) {
    for (int k = 0; k < steps; ++k) ASSERT_EQ(0, take_step(*model, w.d, integrator, duration / steps));
  }
};
double apart(Flight& a, Flight& b) {
  VectorXd e(a.model->n.nv);
  difference(*a.model, a.w.d.q, b.w.d.q, e.data());
  return std::max(largest(e), gap(matrix(a.w.d.v, e.size()), matrix(b.w.d.v, e.size())));
}

class Steps : public testing::TestWithParam<Tree (*)()> {};

// error(h) / error(h / 2) = 2^order; in fewer steps where rounding is all that is left of the error.
double observed_order(Tree (*make)(), dynIntegrator integrator, int steps) {
  Flight reference(make());
  const double duration = 0.5;
  reference.advance(DYN_INTEGRATOR_REFERENCE, duration, 10);
  const auto error = [&](int n) {
    Flight flight(make());
    flight.advance(integrator, duration, n);
    return apart(flight, reference);
  };
  while (steps > 10 && error(steps) < 1e-10) steps /= 2;
  return std::log2(error(steps) / error(2 * steps));
}

// The asymptotic order shows within a quarter where the error is near 1e-9, far above rounding.
TEST_P(Steps, RungeKuttaIsOfOrderFour) { EXPECT_NEAR(4, observed_order(GetParam(), DYN_INTEGRATOR_RK4, 250), 0.25); }
TEST_P(Steps, DormandPrinceIsOfOrderFive) { EXPECT_NEAR(5, observed_order(GetParam(), DYN_INTEGRATOR_RK45, 60), 0.4); }
TEST_P(Steps, TheMidpointRuleIsOfOrderTwo) {
  EXPECT_NEAR(2, observed_order(GetParam(), DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 500), 0.1);
}
TEST_P(Steps, EulerStepsAreOfOrderOne) {
  EXPECT_NEAR(1, observed_order(GetParam(), DYN_INTEGRATOR_SEMI_IMPLICIT_EULER, 1000), 0.1);
  EXPECT_NEAR(1, observed_order(GetParam(), DYN_INTEGRATOR_IMPLICIT_FAST, 1000), 0.1);
}

// Steps of the reference do not matter, and those that an accuracy takes keep it: an error that grows little within the time.
TEST_P(Steps, AccuracyIsKept) {
  Flight reference(GetParam()()), other(GetParam()());
  reference.advance(DYN_INTEGRATOR_REFERENCE, 0.5, 10);
  other.advance(DYN_INTEGRATOR_REFERENCE, 0.5, 1);
  EXPECT_LE(apart(reference, other), 1e-11);
  for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
    Flight flight(GetParam()());
    dynStepReport report{};
    ASSERT_EQ(0, integrator::advance(*flight.model, flight.w.d, DYN_INTEGRATOR_RK4, 0.5, accuracy, report));
    EXPECT_LE(apart(flight, reference), 30 * accuracy) << accuracy;
    EXPECT_LE(report.error_estimate, accuracy * (1 + 1e-12));
    EXPECT_EQ(0.5, report.time);
    EXPECT_EQ(2 + 12 * (report.steps + report.rejected), report.evaluations);
  }
}

// There and back again: the midpoint rule with -v retraces its steps.
TEST_P(Steps, TheMidpointRuleIsReversible) {
  Flight flight(GetParam()()), start(GetParam()());
  const auto turn = [&] { for (Index k = 0; k < flight.model->n.nv; ++k) flight.w.d.v[k] = -flight.w.d.v[k]; };
  flight.advance(DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 0.2, 200);
  turn();
  flight.advance(DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 0.2, 200);
  turn();
  EXPECT_LE(apart(flight, start), 1e-10);
}

TEST_P(Steps, RungeKuttaKeepsEnergyToItsOrder) {
  const auto drift = [&](int steps) {  // the largest on the way: at one instant it may pass through zero
    Flight flight(GetParam()());
    const double before = flight.energy();
    double most = 0;
    for (int k = 0; k < steps; ++k) {
      flight.advance(DYN_INTEGRATOR_RK4, 0.5 / steps, 1);
      most = std::max(most, std::abs(flight.energy() - before) / (1 + std::abs(before)));
    }
    return most;
  };
  EXPECT_LE(drift(250), 1e-6);
  int steps = 250;
  while (steps > 10 && drift(steps) < 1e-11) steps /= 2;  // above rounding
  EXPECT_GE(std::log2(drift(steps) / drift(2 * steps)), 3.5) << drift(steps);
}
TEST_P(Steps, OrientationsStayUnit) {
  for (const dynIntegrator i : every<dynIntegrator>("dynIntegrator")) {
    Flight flight(GetParam()());
    flight.advance(i, 1, 600);
    EXPECT_LE(norm_error(*flight.model, flight.w.d.q), 4e-16) << i;
  }
}
// What their memory holds before is nobody's: checked builds fill it with NaN.
TEST_P(Steps, BeginWithAnyMemory) {
  for (const dynIntegrator i : every<dynIntegrator>("dynIntegrator")) {
    Flight plain(GetParam()()), filled(GetParam()());
    const ModelSizes& n = plain.model->n;
    std::fill_n(plain.w.d.stages, integrator_stage_count(n.nq, n.nv, n.na), 0.0);
    std::fill_n(filled.w.d.stages, integrator_stage_count(n.nq, n.nv, n.na), std::numeric_limits<double>::quiet_NaN());
    plain.advance(i, 1e-2, 2), filled.advance(i, 1e-2, 2);
    EXPECT_TRUE(std::equal(plain.w.d.q, plain.w.d.q + n.nq, filled.w.d.q)) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Robots, Steps, testing::Values(free_body, chain, geared), [](const auto& p) {
  return std::string(p.index == 0 ? "FreeBody" : p.index == 1 ? "Chain" : "Mimic");
});

TEST(Steps, AFreeBodyKeepsItsMomentum) {
  Tree t = free_body();
  t.gravity.setZero();
  Flight flight(t);
  auto momentum = [&] {
    flight.w.d.changed(input_q), flight.w.d.changed(input_v);
    forward_kinematics<1>(*flight.model, flight.w.d);
    const V3 w = eigen(flight.w.d.omega[1]), u = eigen(flight.w.d.vel[1]), p = eigen(flight.w.d.p[1]);
    const M3 R = eigen(flight.w.d.R[1]);
    const V3 c = R * t.bodies[0].com, linear = u + w.cross(c);  // mass 1
    V6 h;
    h << linear, (p + c).cross(linear) + R * t.bodies[0].inertia * R.transpose() * w;
    return h;
  };
  const V6 before = momentum();
  flight.advance(DYN_INTEGRATOR_RK4, 2, 2000);
  EXPECT_LE(gap(momentum(), before), 1e-10);  // the method's error at steps of 1 ms: h^4 = 1e-12 times two seconds of turning
}

TEST(Steps, FreeFallIsExact) {
  // Runge-Kutta of order 4 solves a parabola to rounding
  Tree t = free_body();
  t.bodies[0].com.setZero();
  Flight flight(t);
  flight.w.v(VectorXd::Zero(6));
  const V3 start(flight.w.d.q);
  flight.advance(DYN_INTEGRATOR_RK4, 1, 10);
  EXPECT_LE(gap(V3(flight.w.d.q), start + 0.5 * t.gravity), 1e-14);
}

TEST(Steps, TheMidpointRuleKeepsTheEnergyOfAPendulumForever) {
  Tree t;
  JointSpec s;
  s.name = "pin", s.axis = {0, 1, 0};
  t.joints.push_back(s);
  BodySpec b;
  b.name = "bob", b.parent = "pin", b.com = V3(0, 0, -1), b.inertia.setZero();
  t.bodies.push_back(b);
  Flight flight(t);
  flight.w.q(std::vector{2.0}).v(std::vector{0.0});
  const double before = flight.energy();
  double early = 0, late = 0;
  for (int k = 0; k < 20000; ++k) {
    flight.advance(DYN_INTEGRATOR_IMPLICIT_MIDPOINT, 0.05, 1);
    double& drift = k < 1000 ? early : late;
    drift = std::max(drift, std::abs(flight.energy() - before));
  }
  EXPECT_LE(late, 1.05 * early) << early;  // no drift over 1000 s
}

// A spring a million times too stiff for the step: implicit_fast settles, with semi-implicit Euler it would burst.
TEST(Steps, ImplicitFastBearsAnySpring) {
  for (const double stiffness : {1e2, 1e6, 1e12}) {
    Tree t;
    JointSpec s;
    s.name = "pin", s.stiffness = {stiffness}, s.spring_reference = {0.3};
    t.joints.push_back(s);
    BodySpec b;
    b.name = "disc", b.parent = "pin", b.com = V3::Zero(), b.inertia = M3::Identity();
    t.bodies.push_back(b);
    Flight flight(t);
    flight.w.q(std::vector{1.0}).v(std::vector{0.0});
    flight.advance(DYN_INTEGRATOR_IMPLICIT_FAST, 200, 4000);
    EXPECT_NEAR(0.3, flight.w.d.q[0], 1e-9) << stiffness;
  }
}

}  // namespace
}  // namespace dyn_test
