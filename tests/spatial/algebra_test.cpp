// Placements, motions, forces and their products against 4 x 4 and 6 x 6 matrices.
#include "common/eigen.hpp"

namespace dyn_test {
namespace {

constexpr double tol = 4e-15;  // sums of at most 12 products of numbers below 2, each rounded to 1.1e-16

struct Sample {
  Dice dice;
  M4 A, B;
  V6 m, n;
  V6 f;
  explicit Sample(std::uint64_t seed)
      : dice(seed), A(dice.pose()), B(dice.pose()), m(dice.vector(6)), n(dice.vector(6)), f(dice.vector(6)) {}
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

TEST(Algebra, Vectors) {
  for_samples([](Sample& s) {
    const V3 a = s.m.head<3>(), b = s.m.tail<3>();
    EXPECT_LE(gap(eigen(cross(vec3(a), vec3(b))), a.cross(b)), tol);
    EXPECT_LE(std::abs(dot(vec3(a), vec3(b)) - a.dot(b)), tol);
    EXPECT_EQ(0, gap(eigen(vec3(a) + vec3(b)), a + b));
    EXPECT_EQ(0, gap(eigen(vec3(a) - vec3(b)), a - b));
    EXPECT_EQ(0, gap(eigen(-vec3(a)), -a));
    EXPECT_EQ(0, gap(eigen(2.0 * vec3(a)), V3(2 * a)));
    EXPECT_EQ(0, gap(eigen(skew(vec3(a))), hat(a)));
    EXPECT_LE(gap(eigen(outer(vec3(a), vec3(b))), a * b.transpose()), tol);
  });
}

TEST(Algebra, Matrices) {
  for_samples([](Sample& s) {
    const M3 A = s.A.topLeftCorner<3, 3>() * 1.7, B = s.B.topLeftCorner<3, 3>();
    const V3 x = s.m.head<3>();
    EXPECT_LE(gap(eigen(mat3(A) * mat3(B)), A * B), tol);
    EXPECT_LE(gap(eigen(mat3(A) * vec3(x)), A * x), tol);
    EXPECT_LE(gap(eigen(transpose_times(mat3(A), vec3(x))), A.transpose() * x), tol);
    EXPECT_EQ(0, gap(eigen(transpose(mat3(A))), A.transpose()));
    EXPECT_LE(gap(eigen(cross(vec3(x), mat3(B))), hat(x) * B), tol);
    EXPECT_LE(gap(eigen(times_skew(mat3(B), vec3(x))), B * hat(x)), tol);
    EXPECT_LE(
        gap(eigen(rotate_z(mat3(B), std::cos(0.7), std::sin(0.7))), B * Eigen::AngleAxisd(0.7, V3::UnitZ()).toRotationMatrix()),
        tol);
    const M3 S = A + A.transpose();
    EXPECT_EQ(0, gap(eigen(sym3(S)), S));
    EXPECT_LE(gap(eigen(sym3(S) * vec3(x)), S * x), tol);
    EXPECT_LE(gap(eigen(plus_transpose(mat3(A))), S), tol);
    EXPECT_LE(gap(eigen(congruence(mat3(B), mat3(S))), B * S * B.transpose()), 3 * tol);
    EXPECT_LE(gap(eigen(symmetric_outer(vec3(x), vec3(2 * x))), 2 * x * x.transpose()), tol);
    EXPECT_LE(gap(eigen(times_skew(sym3(S), vec3(x))), S * hat(x)), tol);
    double buffer[9];
    store33(mat3(A), buffer);
    EXPECT_EQ(0, gap(eigen(load33(buffer)), A));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_EQ(A(i, j), mat3(A)(i, j));
  });
}

TEST(Algebra, PlacementsAreHomogeneousMatrices) {
  for_samples([](Sample& s) {
    EXPECT_LE(gap(eigen(se3(s.A) * se3(s.B)), s.A * s.B), tol);
    EXPECT_LE(gap(eigen(se3(s.A).inverse()), s.A.inverse()), tol);
    EXPECT_LE(gap(eigen(se3(s.A).inverse() * se3(s.A)), M4::Identity()), tol);
    EXPECT_EQ(0, gap(eigen(se3(s.A) * SE3<double>::identity()), s.A));
    const V3 x = s.m.head<3>();
    EXPECT_LE(gap(eigen(se3(s.A).act(vec3(x))), (s.A * x.homogeneous()).head<3>()), tol);
    EXPECT_LE(gap(eigen(se3(s.A).act_inverse(vec3(x))), (s.A.inverse() * x.homogeneous()).head<3>()), tol);
  });
}

TEST(Algebra, MotionsAndForcesTransformBySixBySixMatrices) {
  for_samples([](Sample& s) {
    const SE3<double> X = se3(s.A);
    const M6 A = motion_matrix(s.A), dual = A.inverse().transpose();
    EXPECT_LE(gap(eigen(X.act(motion(s.m))), A * s.m), tol);
    EXPECT_LE(gap(eigen(X.act_inverse(motion(s.m))), A.inverse() * s.m), tol);
    EXPECT_LE(gap(eigen(X.act(force(s.f))), dual * s.f), tol);
    EXPECT_LE(gap(eigen(X.act_inverse(force(s.f))), dual.inverse() * s.f), tol);
    // power does not depend on the frame
    EXPECT_LE(std::abs(dot(X.act(motion(s.m)), X.act(force(s.f))) - s.m.dot(s.f)), 3 * tol);
  });
}

TEST(Algebra, CrossProducts) {
  for_samples([](Sample& s) {
    const Motion<double> m = motion(s.m), n = motion(s.n), l = motion(s.f);
    const Force<double> f = force(s.f);
    EXPECT_LE(gap(eigen(cross(m, n)), cross_matrix(s.m) * s.n), tol);
    EXPECT_LE(gap(eigen(cross(m, f)), -cross_matrix(s.m).transpose() * s.f), tol);
    // duality: (m x n) . f = -n . (m x* f)
    EXPECT_LE(std::abs(dot(cross(m, n), f) + dot(n, cross(m, f))), 3 * tol);
    EXPECT_EQ(0, largest(eigen(cross(m, m)).tail<3>()));
    EXPECT_LE(gap(eigen(cross(m, n)), -eigen(cross(n, m))), tol);
    // Jacobi
    EXPECT_LE(largest(eigen(cross(m, cross(n, l)) + cross(n, cross(l, m)) + cross(l, cross(m, n)))), 4 * tol);
    // both commute with placements
    const SE3<double> X = se3(s.A);
    EXPECT_LE(gap(eigen(X.act(cross(m, n))), eigen(cross(X.act(m), X.act(n)))), 8 * tol);
    EXPECT_LE(gap(eigen(X.act(cross(m, f))), eigen(cross(X.act(m), X.act(f)))), 8 * tol);
  });
}

TEST(Algebra, ShiftsAreTranslations) {
  for_samples([](Sample& s) {
    const V3 r = s.A.topRightCorner<3, 1>();
    M4 T = M4::Identity();
    T.topRightCorner<3, 1>() = r;
    const M6 X = motion_matrix(T);
    EXPECT_LE(gap(eigen(shift(motion(s.m), vec3(r))), X.inverse() * s.m), tol);
    EXPECT_LE(gap(eigen(shift(force(s.f), vec3(r))), X.inverse().transpose() * s.f), tol);
  });
}

TEST(Algebra, TheFourthLaneStaysZero) {
#if DYN_LANES == 4
  for_samples([](Sample& s) {
    const SE3<double> X = se3(s.A) * se3(s.B);
    const Mat3<double> T = transpose(X.R) * X.R;
    for (const Vec3<double>& a :
         {X.p, X.R.x, T.y, T.z, cross(X.p, X.R.y), -X.p, X.act(motion(s.m)).linear, X.act(force(s.f)).angular})
      EXPECT_EQ(0, a.v[3]);
  });
#else
  GTEST_SKIP() << "3-vectors have three lanes here";
#endif
}

}  // namespace
}  // namespace dyn_test
