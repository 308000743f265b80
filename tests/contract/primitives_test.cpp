// The contract of a primitive joint (joint/joint.hpp), for every member of the list: a new one is tested by being listed.
// Differences are taken in quadruple precision, so that they show the joint's own error.
#include "common/eigen.hpp"
#include "common/quad.hpp"
#include "joint/list.hpp"

namespace dyn_test::primitives_test {
namespace {

constexpr double tol = 1e-14;  // some ten operations on numbers up to 10

template <class None, class... Js>
struct AllOf {
  using type = testing::Types<Js...>;
};
#define DYN_TEST_ENTRY(J) , J
using All = AllOf<void DYN_PRIMITIVES(DYN_TEST_ENTRY)>::type;
struct Name {
  template <class J>
  static std::string GetName(int) {
#define DYN_TEST_NAME(X) \
  if (std::is_same_v<J, X>) return #X;
    DYN_PRIMITIVES(DYN_TEST_NAME)
    return "?";
  }
};

template <class J>
class Primitive : public testing::Test {
 protected:
  static constexpr int nq = J::nq, nv = J::nv;
  Dice dice{17};
  Body body{};
  SE3<double> at{};  // the joint frame in the world

  Primitive() {
    body.pitch = 0.37;
    at = se3(dice.pose());
  }
  VectorXd configuration() {
    const std::vector<double> low(std::size_t(nq), -2), high(std::size_t(nq), 2);
    VectorXd q(nq);
    J::random(dice, low.data(), high.data(), q.data());
    return q;
  }
  template <class T>
  static SE3<T> place(const Body& b, const SE3<double>& from, const T* q) {
    using std::cos;
    using std::sin;
    SE3<T> X = cast<T>(from);
    T c{}, s{};
    if constexpr (J::angle) c = cos(q[0]), s = sin(q[0]);
    J::place(b, q, c, s, X);
    return X;
  }
  M4 pose(const VectorXd& q) { return eigen(place(body, at, q.data())); }
  static std::vector<Quad> quads(const VectorXd& x) {
    std::vector<Quad> out;
    for (double y : x) out.emplace_back(y);
    return out;
  }
  // q (+) (t v + t^2 / 2 a)
  static std::vector<Quad> path(const VectorXd& q, const VectorXd& v, const VectorXd& a, Quad t) {
    std::vector<Quad> from = quads(q), step, out = quads(q);
    for (int k = 0; k < nv; ++k) step.push_back(t * Quad(v[k]) + Quad(0.5) * t * t * Quad(a[k]));
    J::integrate(from.data(), step.data(), out.data());
    return out;
  }
  SE3<Quad> pose_on(const VectorXd& q, const VectorXd& v, const VectorXd& a, Quad t) {
    return place(body, at, path(q, v, a, t).data());
  }
};
TYPED_TEST_SUITE(Primitive, All, Name);

TYPED_TEST(Primitive, NeutralIsTheIdentity) {
  using J = TypeParam;
  VectorXd q(J::nq);
  J::neutral(q.data());
  EXPECT_EQ(0, gap(this->pose(q), eigen(this->at)));
  EXPECT_EQ(0, J::norm_error(q.data()));
}

TYPED_TEST(Primitive, VelocityAndAccelerationAreDerivativesOfThePose) {
  using J = TypeParam;
  for (int trial = 0; trial < 50; ++trial) {
    const VectorXd q = this->configuration(), v = this->dice.vector(J::nv, 2), a = this->dice.vector(J::nv, 2);
    const SE3<double> X = TestFixture::place(this->body, this->at, q.data());
    const V6 vel = eigen(J::velocity(this->body, X.R, v.data())),
             acc = eigen(J::acceleration(this->body, X.R, v.data(), a.data()));
    // central differences: errors h^2 = 1e-16 relative (first), and 1e-34 / h^2 = 1e-18 (second)
    const Quad h(1e-8);
    const SE3<Quad> P = this->pose_on(q, v, a, h), O = this->pose_on(q, v, a, Quad(0)), M = this->pose_on(q, v, a, -h);
    const Mat3<Quad> dR = (P.R - M.R) * (Quad(0.5) / h), ddR = (P.R + M.R - O.R * Quad(2)) * (Quad(1) / (h * h));
    EXPECT_LE(gap(eigen((P.p - M.p) * (Quad(0.5) / h)), vel.template head<3>()), tol);
    EXPECT_LE(gap(eigen(dR * transpose(O.R)), hat(vel.template tail<3>())), tol);
    EXPECT_LE(gap(eigen((P.p + M.p - O.p * Quad(2)) * (Quad(1) / (h * h))), acc.template head<3>()), 10 * tol);
    const M3 W = hat(vel.template tail<3>());
    EXPECT_LE(gap(eigen(ddR * transpose(O.R)), hat(acc.template tail<3>()) + W * W), 10 * tol);
  }
}

TYPED_TEST(Primitive, ColumnsSpanTheVelocity) {
  using J = TypeParam;
  for (int trial = 0; trial < 50; ++trial) {
    const Mat3<double> R = mat3(this->dice.rotation());
    const VectorXd v = this->dice.vector(J::nv);
    MatrixXd S(6, J::nv);
    for (int k = 0; k < J::nv; ++k) S.col(k) = eigen(J::column(this->body, R, k));
    EXPECT_LE(gap(eigen(J::velocity(this->body, R, v.data())), S * v), tol);
    EXPECT_EQ(J::nv, S.colPivHouseholderQr().rank());
    EXPECT_EQ(J::translates, S.topRows(3).norm() > 0);
    EXPECT_EQ(J::rotates, S.bottomRows(3).norm() > 0);
    // tau = S^T f
    const V6 f = this->dice.vector(6);
    VectorXd tau(J::nv);
    J::project(this->body, R, force(f), tau.data());
    EXPECT_LE(gap(tau, S.transpose() * f), tol);
  }
}

TYPED_TEST(Primitive, SIsConstantInTheBody) {
  using J = TypeParam;
  for (int trial = 0; trial < 50; ++trial) {
    const M3 A = this->dice.rotation(), B = this->dice.rotation();
    for (int k = 0; k < J::nv; ++k) {
      const V6 a = eigen(J::column(this->body, mat3(A), k)), b = eigen(J::column(this->body, mat3(B), k));
      EXPECT_LE(gap(A.transpose() * a.template head<3>(), B.transpose() * b.template head<3>()), tol);
      EXPECT_LE(gap(A.transpose() * a.template tail<3>(), B.transpose() * b.template tail<3>()), tol);
    }
  }
}

TYPED_TEST(Primitive, IntegrateAndDifferenceAreInverse) {
  using J = TypeParam;
  for (int trial = 0; trial < 200; ++trial) {
    const VectorXd q0 = this->configuration() * (J::nq == J::nv ? 1.0 : 1.7),
                   q1 = this->configuration() * (J::nq == J::nv ? 1.0 : 0.3);
    VectorXd v(J::nv), back(J::nq);
    J::difference(this->body, q0.data(), q1.data(), v.data());
    J::integrate(q0.data(), v.data(), back.data());
    EXPECT_LE(gap(this->pose(back), this->pose(q1)), 4 * tol);  // scaled positions reach 7
    // v shorter than half a turn
    const VectorXd u = this->dice.vector(J::nv, 1.7);
    J::integrate(q0.data(), u.data(), back.data());
    J::difference(this->body, q0.data(), back.data(), v.data());
    EXPECT_LE(gap(v, u), tol);
    EXPECT_LE(J::norm_error(back.data()), 4e-16);
    // in place
    VectorXd same = q0;
    J::integrate(same.data(), u.data(), same.data());
    EXPECT_EQ(0, gap(same, back));
    // nothing added, nothing moved
    const VectorXd none = VectorXd::Zero(J::nv);
    J::integrate(q0.data(), none.data(), back.data());
    EXPECT_LE(gap(this->pose(back), this->pose(q0)), tol);
    J::difference(this->body, q0.data(), q0.data(), v.data());
    EXPECT_LE(largest(v), 4e-16);
  }
}

TYPED_TEST(Primitive, JacobiansOfIntegrateAndDifference) {
  using J = TypeParam;
  constexpr int n = J::nv;
  const VectorXd none = VectorXd::Zero(n);
  // e = q (-) reference in quadruple precision
  auto off = [&](const std::vector<Quad>& reference, const std::vector<Quad>& q) {
    std::vector<Quad> e(static_cast<std::size_t>(n));
    J::difference(this->body, reference.data(), q.data(), e.data());
    return e;
  };
  auto column = [&](const std::vector<Quad>& plus, const std::vector<Quad>& minus, Quad h) {
    VectorXd out(n);
    for (int i = 0; i < n; ++i) out[i] = double((plus[std::size_t(i)] - minus[std::size_t(i)]) / (h + h));
    return out;
  };
  for (int trial = 0; trial < 50; ++trial) {
    const VectorXd q = this->configuration(), r = this->configuration(), v = this->dice.vector(n, trial % 2 ? 1.5 : 1e-5);
    MatrixXd dq = MatrixXd::Zero(n, n), dv = dq, d0 = dq, d1 = dq;
    J::integrate_jacobians(q.data(), v.data(), Block<double>{dq.data(), n}, Block<double>{dv.data(), n});
    J::difference_jacobians(this->body, q.data(), r.data(), Block<double>{d0.data(), n}, Block<double>{d1.data(), n});
    const Quad h(1e-12);  // error of the differences 1e-24
    const auto vq = this->quads(v), rq = this->quads(r), qq = this->quads(q);
    auto moved = [&](const std::vector<Quad>& from, const std::vector<Quad>& step) {
      std::vector<Quad> out(from);
      J::integrate(from.data(), step.data(), out.data());
      return out;
    };
    const auto target = moved(qq, vq);
    for (int k = 0; k < n; ++k) {
      const VectorXd e = VectorXd::Unit(n, k);
      auto nudged = [&](const VectorXd& from, Quad t) { return this->path(from, e, none, t); };
      auto plus = vq, minus = vq;
      plus[std::size_t(k)] += h, minus[std::size_t(k)] -= h;
      // near the identity the logarithm's coordinates are the displacement itself to second order
      EXPECT_LE(gap(dq.col(k), column(off(target, moved(nudged(q, h), vq)), off(target, moved(nudged(q, -h), vq)), h)), 10 * tol);
      EXPECT_LE(gap(dv.col(k), column(off(target, moved(qq, plus)), off(target, moved(qq, minus)), h)), 10 * tol);
      // the derivative of the logarithm grows near half a turn, at most to pi
      EXPECT_LE(gap(d0.col(k), column(off(nudged(q, h), rq), off(nudged(q, -h), rq), h)), 30 * tol);
      EXPECT_LE(gap(d1.col(k), column(off(qq, nudged(r, h)), off(qq, nudged(r, -h)), h)), 30 * tol);
    }
  }
}

TYPED_TEST(Primitive, ChartRateInvertsTheJacobianOfIntegrate) {
  using J = TypeParam;
  for (int trial = 0; trial < 50; ++trial) {
    const VectorXd q = this->configuration(), u = this->dice.vector(J::nv, trial % 2 ? 1.5 : 1e-9), v = this->dice.vector(J::nv);
    MatrixXd dq = MatrixXd::Zero(J::nv, J::nv), dv = dq;
    J::integrate_jacobians(q.data(), u.data(), Block<double>{dq.data(), J::nv}, Block<double>{dv.data(), J::nv});
    VectorXd du(J::nv);
    J::chart_rate(u.data(), v.data(), du.data());
    EXPECT_LE(gap(dv * du, v), 10 * tol);
  }
}

TYPED_TEST(Primitive, RandomIsFiniteWithinBoundsAndRepeats) {
  using J = TypeParam;
  const double huge = std::numeric_limits<double>::max();
  const double bounds[][2] = {{-infinity, infinity}, {-huge, huge}, {-infinity, 0.5}, {0.5, infinity},
                              {-1e300, 1e300},       {2, 2},        {-0.25, 0.5}};
  for (const auto& bound : bounds) {
    const std::vector<double> low(std::size_t(J::nq), bound[0]), high(std::size_t(J::nq), bound[1]);
    VectorXd seen_low = VectorXd::Constant(J::nq, infinity), seen_high = -seen_low;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      Random a{seed}, b{seed};
      VectorXd q(J::nq), again(J::nq);
      J::random(a, low.data(), high.data(), q.data());
      J::random(b, low.data(), high.data(), again.data());
      EXPECT_EQ(0, gap(q, again));
      EXPECT_LT(largest(q), infinity);
      EXPECT_LE(J::norm_error(q.data()), 4e-16);
      EXPECT_FALSE(J::zero_norm(q.data()));
      seen_low = seen_low.cwiseMin(q), seen_high = seen_high.cwiseMax(q);
    }
    const int bounded = J::nq == J::nv ? J::nq : J::nq == 7 ? 3 : 0;  // coordinates that are numbers, not parts of a rotation
    for (int i = 0; i < bounded; ++i) {
      EXPECT_GE(seen_low[i], bound[0]);
      EXPECT_LE(seen_high[i], bound[1]);
    }
    for (int i = bounded; i < J::nq; ++i)
      EXPECT_TRUE(seen_low[i] < -0.8 && seen_high[i] > 0.8) << "does not reach all orientations";
  }
}

TYPED_TEST(Primitive, NormaliseKeepsThePose) {
  using J = TypeParam;
  for (double scale : {1e-200, 1e-3, 1.0, 5.0, 1e200}) {
    VectorXd q = this->configuration();
    const int first = J::nq == J::nv ? J::nq : J::nq == 7 ? 3 : 0;
    q.tail(J::nq - first) *= scale;
    EXPECT_FALSE(J::zero_norm(q.data()));
    if (scale != 1.0 && first < J::nq) {
      EXPECT_GT(J::norm_error(q.data()), 0.5);
    }
    VectorXd unit = q;
    J::normalize(unit.data());
    EXPECT_LE(J::norm_error(unit.data()), 4e-16);
    EXPECT_EQ(0, gap(unit.head(first), q.head(first)));
    EXPECT_LE(gap(this->pose(unit), this->pose(q)), tol);
    q.tail(J::nq - first).setZero();
    EXPECT_EQ(first < J::nq, J::zero_norm(q.data()));
  }
}

}  // namespace
}  // namespace dyn_test::primitives_test
