// The library's small vectors as Eigen matrices, plain matrix forms of the spatial operators, and how far two results lie apart.
#pragma once

#include <gtest/gtest.h>

#define EIGEN_DONT_VECTORIZE  // plain loops: quicker to compile, and GCC 12 warns about its own AVX-512 headers (GCC bug 105593).
// All of a program must: how Eigen aligns what it allocates depends on it, and the linker keeps one of two.
#include <Eigen/Dense>
#include <limits>

#include "joint/joint.hpp"
#include "spatial/explog.hpp"
#include "spatial/inertia.hpp"

namespace dyn_test {

using namespace dyn;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using V3 = Eigen::Vector3d;
using M3 = Eigen::Matrix3d;
using M4 = Eigen::Matrix4d;
using V6 = Eigen::Matrix<double, 6, 1>;
using M6 = Eigen::Matrix<double, 6, 6>;

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
V3 eigen(const Vec3<T>& a) {
  return V3(double(a[0]), double(a[1]), double(a[2]));
}
template <class T>
M3 eigen(const Mat3<T>& A) {
  M3 out;
  out << eigen(A.x), eigen(A.y), eigen(A.z);
  return out;
}
template <class T>
M3 eigen(const Sym3<T>& A) {
  return eigen(A.full());
}
template <class T>
V6 eigen(const Motion<T>& m) {
  V6 out;
  out << eigen(m.linear), eigen(m.angular);
  return out;
}
template <class T>
V6 eigen(const Force<T>& f) {
  V6 out;
  out << eigen(f.linear), eigen(f.angular);
  return out;
}
template <class T>
M6 eigen(const Mat6<T>& A) {
  M6 out;
  out << eigen(A.ll), eigen(A.la), eigen(A.al), eigen(A.aa);
  return out;
}
template <class T>
M4 eigen(const SE3<T>& X) {
  M4 out = M4::Identity();
  out.topLeftCorner<3, 3>() = eigen(X.R);
  out.topRightCorner<3, 1>() = eigen(X.p);
  return out;
}
inline M4 eigen(const double* placement) { return eigen(load_se3(placement)); }

inline M3 hat(const V3& a) {
  M3 out;
  out << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return out;
}
// coordinates of motions in B to those in A
inline M6 motion_matrix(const M4& X) {
  const M3 R = X.topLeftCorner<3, 3>();
  M6 out;
  out << R, hat(X.topRightCorner<3, 1>()) * R, M3::Zero(), R;
  return out;
}
// m x
inline M6 cross_matrix(const V6& m) {
  M6 out;
  out << hat(m.tail<3>()), hat(m.head<3>()), M3::Zero(), hat(m.tail<3>());
  return out;
}

inline Vec3<double> vec3(const V3& a) { return Vec3<double>::make(a[0], a[1], a[2]); }
inline Mat3<double> mat3(const M3& A) { return {vec3(A.col(0)), vec3(A.col(1)), vec3(A.col(2))}; }
inline Sym3<double> sym3(const M3& A) { return Sym3<double>::from(mat3(A)); }
inline Motion<double> motion(const V6& m) { return {vec3(m.head<3>()), vec3(m.tail<3>())}; }
inline Force<double> force(const V6& f) { return {vec3(f.head<3>()), vec3(f.tail<3>())}; }

// Largest absolute coefficient; infinite when one is NaN.
template <class A>
double largest(const A& matrix) {
  const MatrixXd a = matrix;
  double worst = 0;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    const double x = std::abs(a.data()[k]);
    if (!(x <= std::numeric_limits<double>::max())) return infinity;
    if (x > worst) worst = x;
  }
  return worst;
}
template <class A, class B>
double gap(const A& a, const B& b) {
  return largest((a - b).eval());
}

// Random things for tests, the same on every machine.
struct Dice : Random {
  explicit Dice(std::uint64_t seed) : Random{seed} {
    for (int i = 0; i < 4; ++i) next();
  }
  double in(double lower, double upper) { return uniform(lower, upper); }
  int below(int n) { return int(next() % std::uint64_t(n)); }
  bool chance(double p) { return uniform() < p; }
  VectorXd vector(Eigen::Index n, double half_width = 1) {
    VectorXd x(n);
    for (Eigen::Index i = 0; i < n; ++i) x[i] = in(-half_width, half_width);
    return x;
  }
  V3 direction() { return V3(normal(), normal(), normal()).normalized(); }
  M3 rotation() { return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix(); }
  M4 pose(double half_width = 1) {
    M4 X = M4::Identity();
    X.topLeftCorner<3, 3>() = rotation();
    X.topRightCorner<3, 1>() = vector(3, half_width);
    return X;
  }
};
inline SE3<double> se3(const M4& X) { return {mat3(X.topLeftCorner<3, 3>()), vec3(X.topRightCorner<3, 1>())}; }

}  // namespace dyn_test
