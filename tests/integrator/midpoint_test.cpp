// The implicit midpoint rule's equations are solved to rounding, in few evaluations, or refused.
#include "common/random_tree.hpp"
#include "common/work.hpp"
#include "integrator/implicit_midpoint.hpp"

namespace dyn_test {
namespace {

using namespace integrator;

// Links of 0.1 m in a vertical plane, each `ratio` times as heavy as the one before.
Tree chain(int links, double ratio) {
  Tree t;
  for (int k = 0; k < links; ++k) {
    JointSpec s;
    s.name = "joint" + std::to_string(k), s.axis = {0, 1, 0};
    if (k) s.parent.name = "joint" + std::to_string(k - 1), s.placement[11] = -0.1;
    t.joints.push_back(s);
    BodySpec b;
    b.name = "link" + std::to_string(k), b.parent = s.name, b.mass = std::pow(ratio, k), b.com = V3(0, 0, -0.1);
    b.inertia = 1e-3 * b.mass * M3::Identity();
    t.bodies.push_back(b);
  }
  return t;
}

struct Motion {
  ModelPtr model;
  Work<double> w;
  Stages<double> stages;
  std::int64_t evaluations = 0;
  Motion(int links, double ratio, int phase = 0) : model(chain(links, ratio).build()), w(*model), stages(*model, w.d) {
    VectorXd q(links), v(links);
    for (int k = 0; k < links; ++k) q[k] = 0.3 * std::sin(1 + phase + 3 * k), v[k] = std::cos(2 * k + phase);
    w.q(q).v(v);
  }
  VectorXd q() const { return matrix(w.d.q, model->n.nq); }
  VectorXd v() const { return matrix(w.d.v, model->n.nv); }
  Index step(double h) { return implicit_midpoint_step(*model, w.d, stages, h, evaluations); }
};

// Joints of a chain turn by h w in a step, w the mean velocity. Noise of the accelerations stalls the iterations of heavy chains.
TEST(ImplicitMidpoint, EquationsAreSolvedToRounding) {
  for (const auto& [links, ratio, h] : {std::tuple(3, 1.0, 1e-2), {12, 1.0, 1e-3}, {12, 10.0, 1e-4}, {30, 1.0, 1e-2}}) {
    Motion x(links, ratio);
    constexpr int steps = 10;
    for (int k = 0; k < steps; ++k) {
      const VectorXd q = x.q(), v = x.v();
      ASSERT_EQ(0, x.step(h)) << links << ", " << ratio;
      const VectorXd mean = 0.5 * (v + x.v());
      EXPECT_LT((x.q() - q - h * mean).cwiseAbs().maxCoeff(), 400 * 2.2e-16 * h * largest(mean) + 1e-15);
    }
    EXPECT_LE(x.evaluations, steps * (links < 30 ? 10 : 20)) << links << ", " << ratio;
  }
}

// Heavy links hang on light ones: noise of the accelerations is a hundred times the rounding. A step ends three iterations after
// the residual has stopped to fall by half, which takes 6.3 evaluations; after one such iteration it would take 5.4, and where a
// residual of 32 times the rounding were asked for, a third of the last runs would end in a step that does not converge.
TEST(ImplicitMidpoint, NoiseEndsTheIteration) {
  std::int64_t evaluations = 0;
  for (int phase = 0; phase < 20; ++phase) {
    Motion x(8, 30, phase);
    for (int k = 0; k < 10; ++k) ASSERT_EQ(0, x.step(1e-4)) << phase;
    evaluations += x.evaluations;
  }
  EXPECT_NEAR(6.3, double(evaluations) / 200, 0.5);
  int failed = 0;
  for (int phase = 0; phase < 60; ++phase)
    for (const auto& [links, ratio] : {std::pair(6, 300.0), {7, 100.0}}) {
      Motion x(links, ratio, phase);
      bool ends = false;
      for (int k = 0; k < 10 && !ends; ++k) ends = x.step(1e-4) != 0;
      failed += ends;
    }
  EXPECT_LE(failed, 25);
}

// Steps too long for the iteration are refused, the state is kept.
TEST(ImplicitMidpoint, LongStepsAreRefused) {
  Motion x(6, 10);
  const VectorXd q = x.q(), v = x.v();
  EXPECT_EQ(not_converged, x.step(0.1));
  EXPECT_EQ(q, x.q());
  EXPECT_EQ(v, x.v());
  EXPECT_LE(x.evaluations, 300);
}

}  // namespace
}  // namespace dyn_test
