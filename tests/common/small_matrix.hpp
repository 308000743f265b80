// N x N matrices in quadruple precision for references: exponential and its derivative by their defining series.
#pragma once

#include "common/quad.hpp"
#include "spatial/explog.hpp"

namespace dyn_test {

template <int N>
struct Square {
  Quad a[N][N];

  static Square zero() {
    Square out;
    for (auto& row : out.a)
      for (Quad& x : row) x = Quad(0);
    return out;
  }
  static Square identity() {
    Square out = zero();
    for (int i = 0; i < N; ++i) out.a[i][i] = Quad(1);
    return out;
  }
  friend Square operator+(Square x, const Square& y) {
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) x.a[i][j] += y.a[i][j];
    return x;
  }
  friend Square operator*(const Square& x, const Square& y) {
    Square out = zero();
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j)
        for (int k = 0; k < N; ++k) out.a[i][j] += x.a[i][k] * y.a[k][j];
    return out;
  }
  friend Square operator*(Square x, Quad s) {
    for (auto& row : x.a)
      for (Quad& y : row) y *= s;
    return x;
  }
  // Gauss and Jordan, pivots by column
  Square inverse() const {
    Square A = *this, B = identity();
    for (int c = 0; c < N; ++c) {
      int best = c;
      for (int r = c + 1; r < N; ++r)
        if (abs(A.a[r][c]) > abs(A.a[best][c])) best = r;
      for (int k = 0; k < N; ++k) std::swap(A.a[c][k], A.a[best][k]), std::swap(B.a[c][k], B.a[best][k]);
      const Quad d = Quad(1) / A.a[c][c];
      for (int k = 0; k < N; ++k) A.a[c][k] *= d, B.a[c][k] *= d;
      for (int r = 0; r < N; ++r) {
        if (r == c) continue;
        const Quad f = A.a[r][c];
        for (int k = 0; k < N; ++k) A.a[r][k] -= f * A.a[c][k], B.a[r][k] -= f * B.a[c][k];
      }
    }
    return B;
  }
};

// sum over k of A^k / (k + first)!: exp for first = 0. 90 terms suffice for |A| < 10 to 1e-33.
template <int N>
Square<N> exponential_series(const Square<N>& A, int first) {
  Square<N> term = Square<N>::identity(), sum = term;
  for (int k = 1; k < 90; ++k) {
    term = term * A * (Quad(1) / Quad(k + first));
    sum = sum + term;
  }
  return sum;
}

// [w] and the matrix of the twist m = [linear; angular] in SE(3), and m x, in quadruple precision
inline Square<3> hat3(const double* w) {
  Square<3> A = Square<3>::zero();
  A.a[2][1] = w[0], A.a[0][2] = w[1], A.a[1][0] = w[2];
  A.a[1][2] = -w[0], A.a[2][0] = -w[1], A.a[0][1] = -w[2];
  return A;
}
inline Square<4> hat4(const double* m) {
  Square<4> A = Square<4>::zero();
  const Square<3> W = hat3(m + 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) A.a[i][j] = W.a[i][j];
    A.a[i][3] = m[i];
  }
  return A;
}
inline Square<6> cross6(const double* m) {
  Square<6> A = Square<6>::zero();
  const Square<3> V = hat3(m), W = hat3(m + 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) A.a[i][j] = A.a[i + 3][j + 3] = W.a[i][j], A.a[i][j + 3] = V.a[i][j];
  return A;
}

// Right Jacobian of the exponential: the sum of (-ad)^k / (k + 1)!
template <int N>
Square<N> right_jacobian(const Square<N>& ad) {
  return exponential_series(ad * Quad(-1), 1);
}

}  // namespace dyn_test
