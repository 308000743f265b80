// Restitution: Moreau's law exactly, and impacts never gain energy.
#include "solver/scenes.hpp"

namespace dyn_test {
namespace {

// A row of touching balls, the first one at speed 1.
Scene cradle(int balls, double e) {
  Scene s;
  const int rows = balls - 1;
  s.minv.assign(balls, 1), s.J.assign(std::size_t(rows) * balls, 0);
  for (int k = 0; k < rows; ++k) s.J[k + rows * k] = -1, s.J[k + rows * (k + 1)] = 1;
  Vector v(balls, 0.0);
  v[0] = 1;
  s.from_jacobian(rows, v);
  s.friction.assign(rows, 0), s.rows_of.assign(rows, 1), s.restitution.assign(rows, e);
  return s;
}

// Three equal balls: impulses 4/3 and 2/3, velocities -1/3, 2/3, 2/3; energy is conserved.
TEST(Restitution, MoreauOnNewtonsCradle) {
  for (const dynContactSolverType type : all_solvers) {
    Scene s = cradle(3, 1);
    const Answer a = solve(s, with(type, 10000, 1e-15));
    EXPECT_NEAR(4.0 / 3, a.lambda[0], 1e-14);
    EXPECT_NEAR(2.0 / 3, a.lambda[1], 1e-14);
    EXPECT_NEAR(0, a.report.energy, 1e-14);
    EXPECT_EQ(1, a.report.restitution_scale);
  }
}

// One ball, any coefficient: it leaves at e times its speed.
TEST(Restitution, OneBallReboundsByItsCoefficient) {
  for (const dynContactSolverType type : all_solvers)
    for (const double e : {0.0, 0.3, 0.9, 1.0}) {
      Scene s;
      s.G = {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}, s.g = {0, 0, -2}, s.friction = {0.3}, s.restitution = {e};
      const Answer a = solve(s, with(type));
      EXPECT_NEAR(2 * e, a.velocity[2], 1e-12);
      // separating: no impulse
      s.g = {0, 0, 2};
      EXPECT_EQ((Vector{0, 0, 0}), solve(s, with(type)).lambda);
      // gravity acts in between: the rebound follows the velocity before
      s.g = {0, 0, -2.5}, s.v_minus = {0, 0, -2};
      EXPECT_NEAR(2 * e, solve(s, with(type)).velocity[2], 1e-12);
    }
}

// Equal coefficients without friction: work is -(1 - e) / (1 + e) L'GL / 2, for any simultaneous impacts.
TEST(Restitution, EqualCoefficientsLoseTheirShareOfEnergy) {
  for (const double e : {0.0, 0.5, 1.0})
    for (unsigned seed = 0; seed < 50; ++seed) {
      Scene s = random_scene(6, 30, 0, seed);
      for (int k = 0; k < 6; ++k) s.g[3 * k + 2] = -std::fabs(s.g[3 * k + 2]);
      s.restitution.assign(6, e);
      const Answer a = solve(s, with(DYN_CONTACT_SOLVER_TYPE_ADMM));
      double square = 0;
      for (int j = 0; j < 18; ++j)
        for (int i = 0; i < 18; ++i) square += a.lambda[i] * s.G[i + 18 * j] * a.lambda[j];
      EXPECT_NEAR(-0.5 * (1 - e) / (1 + e) * square, a.report.energy, 1e-8 * square);
      EXPECT_EQ(1, a.report.restitution_scale);
    }
}

// Kane and Levinson's double pendulum gains energy under Newton's law with friction.
// Here it never does, nor do random impacts with different coefficients.
TEST(Restitution, NeverGainsEnergy) {
  int reduced = 0;
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> u(0, 1);
  for (unsigned seed = 0; seed < 400; ++seed) {
    Scene s = random_scene(1 + int(seed % 5), 6 + int(seed % 7), u(generator), seed);
    for (std::size_t k = 0; k < s.friction.size(); ++k) s.restitution.push_back(u(generator));
    const Answer a = solve(s, with(all_solvers[seed % 3], 20000));
    double work = 0, size = 0;
    for (int i = 0; i < s.rows(); ++i) {
      double Gl = 0;
      for (int j = 0; j < s.rows(); ++j) Gl += s.G[i + s.rows() * j] * a.lambda[j];
      work += a.lambda[i] * (s.g[i] + 0.5 * Gl), size += std::fabs(a.lambda[i] * s.g[i]);
    }
    EXPECT_LE(work, 1e-8 * size) << seed;
    EXPECT_NEAR(work, a.report.energy, 1e-9 * size + 1e-15) << seed;
    EXPECT_GE(a.report.restitution_scale, 0);
    EXPECT_LE(a.report.restitution_scale, 1);
    reduced += a.report.restitution_scale < 1;
  }
  EXPECT_GT(reduced, 3);  // the law alone does gain energy
  // Kane's paradox: an oblique impact whose slip friction reverses
  Scene kane;
  kane.G = {5, 0, -4, 0, 5, 0, -4, 0, 5}, kane.g = {0.4, 0, -0.2}, kane.friction = {1.2}, kane.restitution = {1};
  const Answer a = solve(kane, with(DYN_CONTACT_SOLVER_TYPE_ADMM));
  EXPECT_LE(a.report.energy, 1e-9);
}

// A spring and damper as a row: a ball rests at m g / k and oscillates with the given frequency and decay.
TEST(Compliance, SpringRestsAndOscillates) {
  const double m = 2, k = 5000, dt = 1e-4;
  for (const bool hertz : {false, true}) {
    const double omega = std::sqrt(k / m), ratio = 0.05, d = 2 * ratio * m * omega;
    double z = -m * gravity / k - 1e-3, v = 0;  // gap
    double crossing = 0, first = 0;
    int crossings = 0;
    for (int step = 0; step < 20000; ++step) {
      double R = 0, b = 0, stiffness = k, damping = d;
      ASSERT_TRUE(!hertz || dyn_contact_stiffness_hertz(omega / (2 * pi), ratio, m, &stiffness, &damping) == DYN_OK);
      ASSERT_EQ(DYN_OK, dyn_contact_compliance(stiffness, damping, dt, z, &R, &b));
      Scene s;
      s.G = {1 / m}, s.g = {v - gravity * dt}, s.friction = {0}, s.rows_of = {1}, s.compliance = {R}, s.bias = {b};
      const Answer a = solve(s, with(all_solvers[step % 3]));
      v = s.g[0] + a.lambda[0] / m;
      const double before = z + m * gravity / k;
      z += dt * v;
      const double now = z + m * gravity / k;
      if (before < 0 && now >= 0 && crossings < 4) {
        (crossings == 0 ? first : crossing) = step * dt - dt * now / (now - before);
        ++crossings;
      }
    }
    EXPECT_NEAR(-m * gravity / k, z, 1e-2 * m * gravity / k);
    ASSERT_EQ(4, crossings);
    EXPECT_NEAR(2 * pi / (omega * std::sqrt(1 - ratio * ratio)), (crossing - first) / 3, 1e-2 * 2 * pi / omega);
  }
}

}  // namespace
}  // namespace dyn_test
