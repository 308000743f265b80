// Rigid and articulated inertias against 6 x 6 matrices.
#include "common/eigen.hpp"

namespace dyn_test::inertia_test {
namespace {

constexpr double tol = 4e-14;  // up to six products of 3 x 3 matrices with elements up to 10: 6 * 9 * 10 * 1.1e-16

struct Sample {
  Dice dice;
  double m;
  V3 c;
  M3 Ic;
  M4 X;
  V6 v;
  explicit Sample(std::uint64_t seed) : dice(seed), m(dice.in(0.1, 3)), c(dice.vector(3)), X(dice.pose()), v(dice.vector(6)) {
    const M3 A = M3(dice.vector(9).data());
    Ic = A * A.transpose();
  }
  Inertia<double> rigid() const { return Inertia<double>::at_com(m, vec3(c), mat3(Ic)); }
  // Featherstone 2008, 2.63
  M6 matrix() const {
    M6 out;
    out << m * M3::Identity(), -m * hat(c), m * hat(c), Ic - m * hat(c) * hat(c);
    return out;
  }
  // any symmetric positive 6 x 6
  M6 articulated() {
    M6 A;
    for (int k = 0; k < 36; ++k) A.data()[k] = dice.in(-1, 1);
    return A * A.transpose();
  }
};
template <class F>
void for_samples(F&& f) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    Sample s(seed);
    f(s);
    if (testing::Test::HasFailure()) return;
  }
}
M6 dense(const Inertia<double>& Y) {
  M6 out;
  for (int k = 0; k < 6; ++k) out.col(k) = eigen(Y * motion(V6::Unit(k)));
  return out;
}
M6 dense(const ArticulatedInertia<double>& Y) {
  M6 out;
  for (int k = 0; k < 6; ++k) out.col(k) = eigen(Y * motion(V6::Unit(k)));
  return out;
}
ArticulatedInertia<double> from(const M6& A) {
  return {sym3(A.topLeftCorner<3, 3>()), mat3(A.topRightCorner<3, 3>()), sym3(A.bottomRightCorner<3, 3>())};
}
M6 translation(const V3& r) {
  M4 T = M4::Identity();
  T.topRightCorner<3, 1>() = r;
  return motion_matrix(T);
}

TEST(Inertia, AtCom) {
  for_samples([](Sample& s) {
    EXPECT_LE(gap(dense(s.rigid()), s.matrix()), tol);
    EXPECT_LE(gap(eigen(s.rigid().h), s.m * s.c), tol);
    EXPECT_LE(gap(eigen(s.rigid() * motion(s.v)), s.matrix() * s.v), tol);
  });
}

TEST(Inertia, ShiftedRotatedAndActed) {
  for_samples([](Sample& s) {
    const M6 I = s.matrix();
    const V3 r = s.X.topRightCorner<3, 1>();
    const M3 R = s.X.topLeftCorner<3, 3>();
    M4 turn = M4::Identity();
    turn.topLeftCorner<3, 3>() = R;
    auto moved = [&](const M6& X) { return M6(X.inverse().transpose() * I * X.inverse()); };
    EXPECT_LE(gap(dense(s.rigid().shifted(vec3(r))), moved(translation(r))), tol);
    EXPECT_LE(gap(dense(s.rigid().rotated(mat3(R))), moved(motion_matrix(turn))), tol);
    EXPECT_LE(gap(dense(act(se3(s.X), s.rigid())), moved(motion_matrix(s.X))), tol);
  });
}

TEST(Inertia, Sums) {
  for_samples([](Sample& s) {
    Sample t(s.dice.next());
    EXPECT_LE(gap(dense(s.rigid() + t.rigid()), s.matrix() + t.matrix()), tol);
    EXPECT_EQ(0, gap(dense(s.rigid() + Inertia<double>::zero()), dense(s.rigid())));
  });
}

TEST(Inertia, ArticulatedFromRigid) {
  for_samples([](Sample& s) { EXPECT_LE(gap(dense(ArticulatedInertia<double>::rigid(s.rigid())), s.matrix()), tol); });
}

TEST(Inertia, ArticulatedTimesMotionAndSums) {
  for_samples([](Sample& s) {
    const M6 A = s.articulated(), B = s.articulated();
    EXPECT_LE(gap(eigen(from(A) * motion(s.v)), A * s.v), tol);
    EXPECT_LE(gap(dense(from(A) + from(B)), A + B), tol);
    EXPECT_EQ(0, largest(dense(ArticulatedInertia<double>::zero())));
  });
}

TEST(Inertia, ArticulatedShiftedIsACongruence) {
  for_samples([](Sample& s) {
    const M6 A = s.articulated();
    const V3 r = s.X.topRightCorner<3, 1>();
    const M6 X = translation(r).inverse();
    EXPECT_LE(gap(dense(from(A).shifted(vec3(r))), X.transpose() * A * X), 2 * tol);
  });
}

TEST(Inertia, ArticulatedMinusOuter) {
  for_samples([](Sample& s) {
    const M6 A = s.articulated();
    const V6 U = A * s.v;
    const double D = s.v.dot(U);
    const M6 expected = A - U * U.transpose() / D;
    // U U^T / D may be large where v^T A v is small
    EXPECT_LE(gap(dense(from(A).minus_outer(force(U), 1 / D)), expected), tol * (1 + U.squaredNorm() / D));
    EXPECT_LE(largest(expected * s.v), 1e-13 * (1 + U.squaredNorm() / D));  // what moves freely resists no more
  });
}

}  // namespace
}  // namespace dyn_test::inertia_test
