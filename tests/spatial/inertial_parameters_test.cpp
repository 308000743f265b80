// Inertial parameters, pseudo-inertia and log-Cholesky parameters: against sums over points, the published formulas, and
// differences in quadruple precision.
#include "spatial/inertial_parameters.hpp"

#include "common/eigen.hpp"
#include "common/quad.hpp"

namespace dyn_test {
namespace {

using V10 = Eigen::Matrix<double, 10, 1>;

// A body of points: its parameters and its pseudo-inertia by definition.
struct Points {
  V10 pi = V10::Zero();
  M4 J = M4::Zero();
  void add(double mass, const V3& p) {
    M3 I = mass * (p.squaredNorm() * M3::Identity() - p * p.transpose());
    V10 own;
    own << mass, mass * p, I(0, 0), I(0, 1), I(1, 1), I(0, 2), I(1, 2), I(2, 2);
    pi += own;
    J += mass * p.homogeneous() * p.homogeneous().transpose();
  }
};
Points cloud(std::uint64_t seed, int points = 8) {
  Dice dice(seed);
  Points out;
  for (int k = 0; k < points; ++k) out.add(dice.in(0.1, 1), V3(dice.vector(3)));
  return out;
}
bool consistent(const V10& pi) {
  M4 J, U;
  pseudo_inertia(pi.data(), J.data());
  return upper_cholesky(J.data(), U.data());
}

TEST(InertialParameters, PseudoInertiaIsTheSecondMomentOfTheDensity) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Points x = cloud(seed);
    M4 J;
    V10 pi;
    pseudo_inertia(x.pi.data(), J.data());
    EXPECT_LE(gap(J, x.J), 1e-14 * largest(x.J));
    parameters_of_pseudo_inertia(x.J.data(), pi.data());
    EXPECT_LE(gap(pi, x.pi), 1e-14 * largest(x.pi));
    EXPECT_TRUE(consistent(x.pi));
    const Inertia<double> Y = load_parameters(x.pi.data());
    EXPECT_EQ(x.pi[0], Y.m);
    EXPECT_EQ(x.pi[5], Y.I(0, 1));
    EXPECT_EQ(x.pi[7], Y.I(0, 2));
    EXPECT_EQ(x.pi[8], Y.I(1, 2));
    store_parameters(Y, pi.data());
    EXPECT_EQ(0, gap(pi, x.pi));
  }
}

TEST(InertialParameters, BodiesThatCannotExist) {
  V10 unit;
  unit << 1, 0, 0, 0, 1, 0, 1, 0, 0, 1;
  EXPECT_TRUE(consistent(unit));
  auto with = [&](int k, double x) {
    V10 pi = unit;
    pi[k] = x;
    return pi;
  };
  EXPECT_FALSE(consistent(with(0, 0)));
  EXPECT_FALSE(consistent(with(0, -1)));
  EXPECT_FALSE(consistent(with(4, -1)));
  EXPECT_FALSE(consistent(with(4, 2)));  // triangle inequality: Ixx = Iyy + Izz is a rod
  EXPECT_FALSE(consistent(with(4, 2.1)));
  EXPECT_TRUE(consistent(with(4, 1.9)));
  EXPECT_FALSE(consistent(with(1, 0.8)));  // too little inertia for a centre that far
  EXPECT_TRUE(consistent(with(1, 0.7)));
  EXPECT_FALSE(consistent(V10::Zero()));
  Points rod, plate;
  for (int k = -1; k <= 1; ++k) rod.add(1, V3(k, 0, 0)), plate.add(1, V3(k, 1, 0)), plate.add(1, V3(0, k, 0));
  EXPECT_FALSE(consistent(rod.pi));
  EXPECT_FALSE(consistent(plate.pi));
}

// The formula of Rucker and Wensing 2022, written out.
V10 published(const V10& t) {
  const double d1 = std::exp(t[1]), d2 = std::exp(t[2]), d3 = std::exp(t[3]), s12 = t[4], s23 = t[5], s13 = t[6], t1 = t[7],
               t2 = t[8], t3 = t[9];
  V10 pi;
  pi << 1, t1, t2, t3, s23 * s23 + t2 * t2 + t3 * t3 + d2 * d2 + d3 * d3, -s12 * d2 - s13 * s23 - t1 * t2,
      s12 * s12 + s13 * s13 + t1 * t1 + t3 * t3 + d1 * d1 + d3 * d3, -s13 * d3 - t1 * t3, -s23 * d3 - t2 * t3,
      s12 * s12 + s13 * s13 + s23 * s23 + t1 * t1 + t2 * t2 + d1 * d1 + d2 * d2;
  return std::exp(2 * t[0]) * pi;
}

TEST(LogCholesky, EveryThetaIsABody) {
  Dice dice(1);
  for (int k = 0; k < 500; ++k) {
    const V10 theta = dice.vector(10, 2);
    V10 pi, back;
    parameters_of_log_cholesky(theta.data(), pi.data());
    EXPECT_LE(gap(pi, published(theta)), 1e-14 * largest(pi));
    ASSERT_TRUE(log_cholesky(pi.data(), back.data()));
    EXPECT_LE(gap(back, theta), 1e-9) << "the conversion back loses what cond(J) takes";
  }
}

TEST(LogCholesky, RoundTripOfBodies) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const Points x = cloud(seed);
    V10 theta, pi;
    ASSERT_TRUE(log_cholesky(x.pi.data(), theta.data()));
    parameters_of_log_cholesky(theta.data(), pi.data());
    EXPECT_LE(gap(pi, x.pi), 1e-14 * largest(x.pi));
  }
  V10 theta, rod;
  rod << 1, 0, 0, 0, 2, 0, 1, 0, 0, 1;
  EXPECT_FALSE(log_cholesky(rod.data(), theta.data()));
}

TEST(LogCholesky, Jacobian) {
  Dice dice(2);
  for (int trial = 0; trial < 100; ++trial) {
    const V10 theta = dice.vector(10, 1.5);
    Eigen::Matrix<double, 10, 10> jacobian, differences;
    log_cholesky_jacobian(theta.data(), jacobian.data());
    const Quad h(1e-12);
    for (int k = 0; k < 10; ++k) {
      Quad plus[10], minus[10], a[10], b[10];
      for (int i = 0; i < 10; ++i) plus[i] = minus[i] = Quad(theta[i]);
      plus[k] += h, minus[k] -= h;
      parameters_of_log_cholesky(plus, a), parameters_of_log_cholesky(minus, b);
      for (int i = 0; i < 10; ++i) differences(i, k) = double((a[i] - b[i]) / (Quad(2) * h));
    }
    EXPECT_LE(gap(jacobian, differences), 1e-14 * largest(jacobian));
  }
}

}  // namespace
}  // namespace dyn_test
