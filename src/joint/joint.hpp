// The joint contract. A primitive joint is one moving body and the way it moves; every other joint is a chain of
// primitives with massless bodies between them (kind.hpp). Each is one file; list.hpp names the primitives.
//
// A primitive J derives from Joint<J> and gives, as static members,
//   nq, nv            sizes of its coordinates
//   angle             it reads (cos q, sin q) from the vectorised sweep
//   rotates           its columns have an angular part
//   translates        its columns have a linear part
//   rotates_at(k), translates_at(k)   the same of the k-th column alone
//   place(b, q, c, s, X)        X: the joint frame in the parent -> the body in the parent
//   velocity(b, R, v)           motion of the body relative to the joint frame
//   acceleration(b, R, v, a)    its derivative in the joint frame
//   column(b, R, k)             k-th column of the motion subspace S
//   project(b, R, f, tau)       tau = S^T f
//   neutral, integrate, difference, random, ... on its own coordinates (defaults here: a vector space)
// Vectors of the others are in world axes and refer to the body's origin; R = R_WB. S is constant in the body's frame.
// The body's own axis, if it has one, is its z (the builder turns the frames so).
#pragma once

#include <cmath>

#include "base/portable.hpp"
#include "base/types.hpp"
#include "joint/body.hpp"
#include "spatial/explog.hpp"

namespace dyn {

// A small deterministic generator (SplitMix64: Steele, Lea, Flood 2014).
struct Random {
  std::uint64_t state;
  DYN_INLINE std::uint64_t next() {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  DYN_INLINE double uniform() { return double(next() >> 11) * 0x1p-53; }  // [0, 1)
  // between two finite bounds, without overflow
  DYN_INLINE double uniform(double lower, double upper) {
    const double u = uniform();
    return lower * (1 - u) + upper * u;
  }
  double normal() {  // Box and Muller
    const double r = std::sqrt(-2 * math::log(1 - uniform()));
    return r * math::cos(6.283185307179586 * uniform());
  }
};

// A square block of a Jacobian on tangent spaces: element (i, j) is p[i + j * ld].
template <class T>
struct Block {
  T* p;
  Index ld;
  DYN_INLINE T& operator()(int i, int j) const { return p[i + std::ptrdiff_t(j) * ld]; }
};
template <class T>
inline void set_block(const Block<T>& B, int row, int col, const Mat3<T>& A) {
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) B(row + i, col + j) = A(i, j);
}

template <class J>
struct Joint {
  static constexpr bool angle = false;
  static constexpr bool rotates_at(int) { return J::rotates; }
  static constexpr bool translates_at(int) { return J::translates; }

  // Configurations: q in R^n unless the joint says otherwise.
  template <class T>
  static void neutral(T* q) {
    for (int i = 0; i < J::nq; ++i) q[i] = T(0);
  }
  template <class T>
  static void integrate(const T* q, const T* v, T* out) {
    for (int i = 0; i < J::nq; ++i) out[i] = q[i] + v[i];
  }
  template <class T>
  static void difference(const Body&, const T* q0, const T* q1, T* v) {
    for (int i = 0; i < J::nv; ++i) v[i] = q1[i] - q0[i];
  }
  template <class T>
  static void normalize(T*) {}
  // largest | |x| - 1 | over its quaternions and (cos, sin) pairs
  template <class T>
  static T norm_error(const T*) {
    return T(0);
  }
  // 0: valid; otherwise q has a part of norm zero
  template <class T>
  static bool zero_norm(const T*) {
    return false;
  }
  // uniform between lower and upper; unbounded coordinates from the given half width about zero
  static constexpr double default_range = 1;
  static void random(Random& g, const double* lower, const double* upper, double* q) {
    for (int i = 0; i < J::nq; ++i) q[i] = bounded(g, lower[i], upper[i], J::default_range);
  }
  // d(q + v)/dq, d(q + v)/dv and d(q1 - q0)/dq0, dq1, written on the diagonal blocks
  template <class T>
  static void integrate_jacobians(const T*, const T*, Block<T> dq, Block<T> dv) {
    for (int i = 0; i < J::nv; ++i) dq(i, i) = dv(i, i) = T(1);
  }
  template <class T>
  static void difference_jacobians(const Body&, const T*, const T*, Block<T> d0, Block<T> d1) {
    for (int i = 0; i < J::nv; ++i) d0(i, i) = T(-1), d1(i, i) = T(1);
  }

  // see chart_rate in algorithm/configuration.hpp
  template <class T>
  static void chart_rate(const T*, const T* v, T* du) {
    for (int i = 0; i < J::nv; ++i) du[i] = v[i];
  }

  static double bounded(Random& g, double lower, double upper, double half_width) {
    const bool below = lower >= -1e300, above = upper <= 1e300;
    if (!below && !above) return g.uniform(-half_width, half_width);
    if (!below) return g.uniform(upper - 2 * half_width, upper);
    if (!above) return g.uniform(lower, lower + 2 * half_width);
    return g.uniform(lower, upper);
  }
};

}  // namespace dyn
