// Quaternions: products, normalisation over the whole range of double, conversion from and to matrices.
#include "common/eigen.hpp"
#include "common/quad.hpp"
#include "spatial/exponent.hpp"

namespace dyn_test::quaternion_test {
namespace {

constexpr double tol = 2e-15;  // a dozen operations on numbers of size 1

Quaternion<double> quaternion_of(const Eigen::Vector4d& x) { return load_quaternion(x.data()); }
Eigen::Vector4d coefficients(const Quaternion<double>& a) { return Eigen::Vector4d(a.v[0], a.v[1], a.v[2], a.w); }
Eigen::Vector4d random_unit(Dice& dice) {
  return Eigen::Vector4d(dice.normal(), dice.normal(), dice.normal(), dice.normal()).normalized();
}

TEST(Quaternion, ProductConjugateAndMatrix) {
  Dice dice(3);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector4d a = random_unit(dice), b = random_unit(dice);
    const Eigen::Quaterniond A(a[3], a[0], a[1], a[2]), B(b[3], b[0], b[1], b[2]);
    EXPECT_LE(gap(coefficients(quaternion_of(a) * quaternion_of(b)), (A * B).coeffs()), tol);
    EXPECT_LE(gap(coefficients(quaternion_of(a).conjugate()), A.conjugate().coeffs()), tol);
    EXPECT_LE(gap(eigen(rotation(quaternion_of(a))), A.toRotationMatrix()), tol);
  }
  EXPECT_EQ(0, gap(eigen(rotation(Quaternion<double>::identity())), M3::Identity()));
}

// q / |q| in quadruple precision
Eigen::Vector4d normalized_reference(Eigen::Vector4d x) {
  take_exponent(x);
  Quad n2(0);
  for (double c : x) n2 += Quad(c) * Quad(c);
  const Quad n = sqrt(n2);
  Eigen::Vector4d out;
  for (int i = 0; i < 4; ++i) out[i] = double(Quad(x[i]) / n);
  return out;
}

TEST(Quaternion, NormalisedForEveryNorm) {
  Dice dice(4);
  for (int exponent = -307; exponent <= 307; ++exponent) {
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector4d x = random_unit(dice);
      if (k == 1) x *= 1 / largest(x);
      if (k == 2) x = Eigen::Vector4d::Unit(dice.below(4));
      x *= std::pow(10.0, exponent);
      const Eigen::Vector4d expected = normalized_reference(x), got = coefficients(normalized(quaternion_of(x)));
      EXPECT_LE(gap(got, expected), 4e-16) << "norm 1e" << exponent;  // a rounding of |q|, of the root, of the product
      EXPECT_LE(std::abs(got.norm() - 1), 4e-16) << "norm 1e" << exponent;
      const Eigen::Quaterniond Q(expected[3], expected[0], expected[1], expected[2]);
      EXPECT_LE(gap(eigen(rotation(quaternion_of(x))), Q.toRotationMatrix()), tol) << "norm 1e" << exponent;
    }
  }
}

TEST(Quaternion, NormalisedAtTheEdgesOfDouble) {
  const double big = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  for (const Eigen::Vector4d& x :
       {Eigen::Vector4d(big, -big, big, big), Eigen::Vector4d(0, tiny, 0, 0), Eigen::Vector4d(tiny, 0, -tiny, 0),
        Eigen::Vector4d(1, 1e-300, 0, 0), Eigen::Vector4d(1e-310, 2e-310, 0, 1e-310)}) {
    EXPECT_LE(gap(coefficients(normalized(quaternion_of(x))), normalized_reference(x)), 4e-16) << x.transpose();
  }
}

TEST(Quaternion, OfAMatrix) {
  Dice dice(5);
  std::vector<M3> rotations;
  for (int k = 0; k < 500; ++k) rotations.push_back(dice.rotation());
  // half turns and nearly half turns about every kind of axis: the trace is -1
  for (const V3& axis :
       {V3(1, 0, 0), V3(0, 1, 0), V3(0, 0, 1), V3(1, 1, 0), V3(0, 1, -1), V3(1, 1, 1), V3(1e-9, 1, 0), V3(-1, 2, 3)})
    for (double angle : {pi, pi - 1e-9, -pi + 1e-3, pi / 2, 2 * pi / 3, -2 * pi / 3 - 1e-12, 1e-12})
      rotations.push_back(Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix());
  for (const M3& R : rotations) {
    const Quaternion<double> q = quaternion(mat3(R));
    EXPECT_GE(q.w, 0);
    EXPECT_LE(std::abs(coefficients(q).norm() - 1), tol);
    EXPECT_LE(gap(eigen(rotation(q)), R), tol) << R;
  }
}

TEST(Quaternion, TheLogarithmKeepsTinyRotations) {
  for (double s : {1e-8, 1e-16, 1e-100, 1e-160, 1e-300, 4e-320}) {
    const Vec3<double> v = Vec3<double>::make(2 * s, -s, 2 * s);
    for (double w : {1.0, -1.0}) {
      const V3 got = eigen(log_quaternion(Quaternion<double>{v, w}));
      EXPECT_LE(gap(got, V3(2 * w * eigen(v))), 4e-16 * 4 * s) << s;
    }
  }
  EXPECT_EQ(0, largest(eigen(log_quaternion(Quaternion<double>::identity()))));
}

}  // namespace
}  // namespace dyn_test::quaternion_test
