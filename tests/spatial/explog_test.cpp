// Exponentials, logarithms and their Jacobians on SO(3) and SE(3) through the angles 0 and pi, against the defining power
// series in quadruple precision (another method as well as another precision: no closed form, no branch on the angle).
#include "common/eigen.hpp"
#include "common/small_matrix.hpp"
#include "spatial/exponent.hpp"

namespace dyn_test::explog_test {
namespace {

constexpr double tol =
    1e-14;  // relative to the norm of the result, as promised; where the map itself is ill-conditioned the test says so

const double angles[] = {0, 1e-160, 1e-20, 1e-9, 1e-3, 0.5, 0.999, 1, 1.001, 1.999, 2, 2.001, 3, pi - 1e-3, pi - 1e-9, pi};
const double beyond[] = {pi + 1e-9, 4, 5, 6};  // only of the exponential and its Jacobian
constexpr int axes = 8;

template <int N>
MatrixXd dense(const Square<N>& A) {
  MatrixXd out(N, N);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) out(i, j) = double(A.a[i][j]);
  return out;
}

struct Sample {
  double angle;
  V3 w;  // close to angle long
  V6 m;  // [linear; w]
  bool at_pi() const { return angle > pi - 1e-12; }
};
template <class F>
void for_samples(bool past_pi, F&& f) {
  Dice dice(1);
  auto one = [&](double angle) {
    for (int k = 0; k < axes; ++k) {
      SCOPED_TRACE(testing::Message() << "angle " << angle << " axis " << k);
      // coordinate axes first: their zeros take the edges of every branch
      const V3 axis = k < 3 ? V3(V3::Unit(k)) : k == 3 ? V3(-V3::UnitZ()) : dice.direction();
      Sample s{angle, angle * axis, V6::Zero()};
      s.m << dice.vector(3) * (k % 2 ? 1.0 : 1e3), s.w;
      f(s);
    }
  };
  for (double angle : angles) one(angle);
  if (past_pi)
    for (double angle : beyond) one(angle);
}

// The error of a against b, relative to b; both zero is no error.
double relative(const MatrixXd& a, const MatrixXd& b) {
  const double error = gap(a, b), scale = largest(b);
  return error == 0 ? 0 : error / scale;
}

TEST(Exp3, Rotation) {
  for_samples(true, [](const Sample& s) {
    const auto R = exponential_series(hat3(s.w.data()), 0);
    const M3 got = eigen(exp3(vec3(s.w)));
    EXPECT_LE(relative(got, dense(R)), tol);
    // of small rotations the direction, too: R - R^T = 2 sin(t) [axis]
    auto odd = R;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) odd.a[i][j] = R.a[i][j] - R.a[j][i];
    if (s.angle < 1) {
      EXPECT_LE(relative(got - got.transpose(), dense(odd)), tol);
    }
  });
}

TEST(Exp3, Quaternion) {
  for_samples(true, [](const Sample& s) {
    const auto q = exp_quaternion(vec3(s.w));
    V3 w = s.w;
    const Quad unit(std::ldexp(1.0, take_exponent(w)));
    Quad t2(0);
    for (double x : w) t2 += Quad(x) * Quad(x);
    const Quad t = sqrt(t2) * unit, half = t * Quad(0.5);
    Eigen::Vector4d expected(0, 0, 0, double(cos(half)));
    for (int i = 0; i < 3; ++i) expected[i] = s.angle == 0 ? 0 : double(Quad(s.w[i]) / t * sin(half));
    EXPECT_LE(relative(eigen(q.v), expected.head<3>()), tol);
    EXPECT_LE(std::abs(q.w - expected[3]), tol);  // relative to the norm, 1: near pi it is a small difference of the angle
  });
}

TEST(Exp3, Jacobian) {
  for_samples(
      true, [](const Sample& s) { EXPECT_LE(relative(eigen(Jexp3(vec3(s.w))), dense(right_jacobian(hat3(s.w.data())))), tol); });
}

TEST(Log3, OfAMatrix) {
  for_samples(false, [](const Sample& s) {
    const M3 R = dense(exponential_series(hat3(s.w.data()), 0));
    const V3 w = eigen(log3(mat3(R)));
    EXPECT_LE(w.norm(), pi * (1 + 4e-16));
    // at pi, w and -w are the same rotation
    if (s.at_pi()) {
      EXPECT_LE(std::min(gap(w, s.w), gap(w, -s.w)) / pi, tol);
    } else {
      EXPECT_LE(relative(w, s.w), tol);
    }
  });
}

TEST(Log3, OfAQuaternion) {
  for_samples(false, [](const Sample& s) {
    Quaternion<double> q = exp_quaternion(vec3(s.w));
    for (int sign : {1, -1}) {
      const V3 w = eigen(log_quaternion(Quaternion<double>{q.v * double(sign), q.w * sign}));
      if (s.at_pi()) {
        EXPECT_LE(std::min(gap(w, s.w), gap(w, -s.w)) / pi, tol);
      } else {
        EXPECT_LE(relative(w, s.w), tol);
      }
    }
  });
}

TEST(Log3, Jacobian) {
  for_samples(false, [](const Sample& s) {
    const auto J = right_jacobian(hat3(s.w.data())).inverse();
    EXPECT_LE(relative(eigen(Jlog3(vec3(s.w))), dense(J)), tol);
  });
}

TEST(Exp6, Pose) {
  for_samples(true, [](const Sample& s) {
    const MatrixXd X = dense(exponential_series(hat4(s.m.data()), 0));
    const M4 got = eigen(exp6(motion(s.m)));
    EXPECT_LE(relative(got.topLeftCorner<3, 3>(), X.topLeftCorner<3, 3>()), tol);
    // beyond pi a screw turns back: the translation can be small beside the way that was gone
    EXPECT_LE(gap(got.topRightCorner<3, 1>(), X.topRightCorner<3, 1>()), tol * largest(s.m.head<3>()));
  });
}

TEST(Log6, OfAPose) {
  for_samples(false, [](const Sample& s) {
    const M4 X = dense(exponential_series(hat4(s.m.data()), 0));
    const V6 m = eigen(log6(se3(X)));
    const double length = largest(s.m.head<3>());
    if (!s.at_pi()) {
      EXPECT_LE(relative(m.tail<3>(), s.w), tol);
      EXPECT_LE(gap(m.head<3>(), s.m.head<3>()), tol * length);
    }
    // the twist leads to the pose: holds on either side of pi
    const M4 back = dense(exponential_series(hat4(m.data()), 0));
    EXPECT_LE(gap(back.topLeftCorner<3, 3>(), X.topLeftCorner<3, 3>()), tol);
    EXPECT_LE(gap(back.topRightCorner<3, 1>(), X.topRightCorner<3, 1>()), tol * length);
  });
}

TEST(Exp6, Jacobian) {
  for_samples(true, [](const Sample& s) {
    const MatrixXd J = dense(right_jacobian(cross6(s.m.data())));
    const M6 got = eigen(Jexp6(motion(s.m)));
    EXPECT_LE(relative(got, J), tol);
    EXPECT_LE(relative(got.topLeftCorner<3, 3>(), J.topLeftCorner<3, 3>()), tol);
    EXPECT_LE(relative(got.bottomRightCorner<3, 3>(), J.bottomRightCorner<3, 3>()), tol);
    EXPECT_EQ(0, largest(got.bottomLeftCorner<3, 3>()));
  });
}

TEST(Log6, Jacobian) {
  for_samples(false, [](const Sample& s) {
    const MatrixXd J = dense(right_jacobian(cross6(s.m.data())).inverse());
    const M6 got = eigen(Jlog6(motion(s.m)));
    EXPECT_LE(relative(got, J), tol);
    EXPECT_LE(relative(got.topLeftCorner<3, 3>(), J.topLeftCorner<3, 3>()), tol);
    EXPECT_EQ(0, largest(got.bottomLeftCorner<3, 3>()));
  });
}

TEST(ExpLog, InQuadruplePrecisionToItsOwnPrecision) {
  // the same templates for another scalar: what references elsewhere rely on
  for (double angle : {1e-3, 0.5, 1.5, 2.5, 3.1}) {
    const double m[6] = {0.3, -0.7, 0.2, 0.48 * angle, -0.6 * angle, 0.64 * angle};
    Quad x[6];
    for (int k = 0; k < 6; ++k) x[k] = Quad(m[k]);
    const auto X = exponential_series(hat4(m), 0);
    const SE3<Quad> got = exp6(load_motion(x));
    const Motion<Quad> back = log6(got);
    const auto J = right_jacobian(cross6(m));
    const Mat6<Quad> Jgot = Jexp6(load_motion(x));
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(double(abs(got.p[i] - X.a[i][3])), 1e-31) << angle;  // 1e-34 times the number of operations
      EXPECT_LE(double(abs(back.linear[i] - x[i])), 1e-31) << angle;
      EXPECT_LE(double(abs(back.angular[i] - x[3 + i])), 1e-31) << angle;
      for (int j = 0; j < 3; ++j) {
        EXPECT_LE(double(abs(got.R(i, j) - X.a[i][j])), 1e-31) << angle;
        EXPECT_LE(double(abs(Jgot.la(i, j) - J.a[i][3 + j])), 1e-31) << angle;
        EXPECT_LE(double(abs(Jgot.aa(i, j) - J.a[3 + i][3 + j])), 1e-31) << angle;
      }
    }
  }
}

}  // namespace
}  // namespace dyn_test::explog_test
