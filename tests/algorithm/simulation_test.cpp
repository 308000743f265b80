// Steps of smooth dynamics: order of the integrators, drift of energy and momentum, rotations that stay rotations.
#include "algorithm/trees.hpp"

namespace dyn_test {
namespace {

Tree free_body() {
  Tree t;
  JointSpec s;
  s.name = "body", s.type = DYN_JOINT_FREE_FLYER;
  t.joints.push_back(s);
  BodySpec b;
  b.name = "link", b.parent = "body", b.com = V3(0.1, -0.2, 0.05), b.inertia = V3(0.2, 0.5, 0.6).asDiagonal();
  t.bodies.push_back(b);
  return t;
}
Tree chain() {
  Tree t;
  const dynJointType types[] = {DYN_JOINT_SPHERICAL, DYN_JOINT_REVOLUTE, DYN_JOINT_SPHERICAL, DYN_JOINT_UNIVERSAL, DYN_JOINT_PRISMATIC, DYN_JOINT_REVOLUTE_UNBOUNDED};
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
  }
  double energy() {
    w.d.changed(input_q), w.d.changed(input_v);
    kinetic_energy(*model, w.d), potential_energy(*model, w.d);
    return w.d.kinetic[0] + w.d.potential[0];
  }
  void advance(bool rk4, double duration, int steps) {
    for (int k = 0; k < steps; ++k) ASSERT_EQ(0, rk4 ? step_rk4(*model, w.d, duration / steps) : step_semi_implicit_euler(*model, w.d, duration / steps));
  }
};
double apart(Flight& a, Flight& b) {
  VectorXd e(a.model->n.nv);
  difference(*a.model, a.w.d.q, b.w.d.q, e.data());
  return std::max(largest(e), gap(matrix(a.w.d.v, e.size()), matrix(b.w.d.v, e.size())));
}

class Steps : public testing::TestWithParam<Tree (*)()> {};

// error(h) / error(h / 2) = 2^order
double observed_order(Tree (*make)(), bool rk4, int steps) {
  Flight reference(make()), coarse(make()), fine(make());
  const double duration = 0.5;
  reference.advance(true, duration, 4000);
  coarse.advance(rk4, duration, steps);
  fine.advance(rk4, duration, 2 * steps);
  return std::log2(apart(coarse, reference) / apart(fine, reference));
}

TEST_P(Steps, RungeKuttaIsOfOrderFour) {
  // the asymptotic order shows within a quarter at steps of 2 ms, where the error is near 1e-9, far above rounding
  EXPECT_NEAR(4, observed_order(GetParam(), true, 250), 0.25);
}
TEST_P(Steps, SemiImplicitEulerIsOfOrderOne) { EXPECT_NEAR(1, observed_order(GetParam(), false, 1000), 0.1); }

TEST_P(Steps, RungeKuttaKeepsEnergyToItsOrder) {
  double drift[2];
  for (int k : {0, 1}) {
    Flight flight(GetParam()());
    const double before = flight.energy();
    flight.advance(true, 0.5, 250 << k);
    drift[k] = std::abs(flight.energy() - before);
    EXPECT_LE(drift[k], 1e-6 * (1 + std::abs(before)));
  }
  EXPECT_GE(std::log2(drift[0] / drift[1]), 3.5) << drift[0] << " " << drift[1];
}
TEST_P(Steps, OrientationsStayUnit) {
  Flight flight(GetParam()());
  flight.advance(true, 1, 300);
  flight.advance(false, 1, 300);
  EXPECT_LE(norm_error(*flight.model, flight.w.d.q), 4e-16);
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
    const V3 w = eigen(flight.w.d.w[1]), u = eigen(flight.w.d.u[1]), p = eigen(flight.w.d.p[1]);
    const M3 R = eigen(flight.w.d.R[1]);
    const V3 c = R * t.bodies[0].com, linear = u + w.cross(c);  // mass 1
    V6 h;
    h << linear, (p + c).cross(linear) + R * t.bodies[0].inertia * R.transpose() * w;
    return h;
  };
  const V6 before = momentum();
  flight.advance(true, 2, 2000);
  EXPECT_LE(gap(momentum(), before), 1e-10);  // the method's error at steps of 1 ms: h^4 = 1e-12 times two seconds of turning
}

TEST(Steps, FreeFallIsExact) {
  // Runge-Kutta of order 4 solves a parabola to rounding
  Tree t = free_body();
  t.bodies[0].com.setZero();
  Flight flight(t);
  flight.w.v(VectorXd::Zero(6));
  const V3 start(flight.w.d.q);
  flight.advance(true, 1, 10);
  EXPECT_LE(gap(V3(flight.w.d.q), start + 0.5 * t.gravity), 1e-14);
}

}  // namespace
}  // namespace dyn_test
