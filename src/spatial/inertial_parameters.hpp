// A body's ten inertial parameters pi = [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz], c the centre of mass and I the second moment
// about the origin, and two other forms of them:
//   pseudo-inertia  J = [S h; h^T m] (4 x 4), h = m c, S = tr(I) / 2 1 - I: the second moments of the density, so that the body
//   can
//                   exist when J is positive definite (Wensing, Kim, Slotine 2018, "Linear matrix inequalities for physically
//                   consistent inertial parameter identification")
//   log-Cholesky    theta = [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] with J = U U^T (Rucker, Wensing 2022, "Smooth
//                   parameterization of rigid-body inertia"): every theta is a body that can exist
//                       U = e^alpha [e^d1 s12 s13 t1; 0 e^d2 s23 t2; 0 0 e^d3 t3; 0 0 0 1]
#pragma once

#include <cmath>

#include "base/portable.hpp"
#include "spatial/inertia.hpp"

namespace dyn {

template <class T>
DYN_INLINE Inertia<T> load_parameters(const T* pi) {
  return {pi[0], load3(pi + 1), {Vec3<T>::make(pi[4], pi[6], pi[9]), Vec3<T>::make(pi[5], pi[8], pi[7])}};
}
template <class T>
DYN_INLINE void store_parameters(const Inertia<T>& Y, T* pi) {
  pi[0] = Y.m;
  store3(Y.h, pi + 1);
  pi[4] = Y.I(0, 0), pi[5] = Y.I(0, 1), pi[6] = Y.I(1, 1), pi[7] = Y.I(0, 2), pi[8] = Y.I(1, 2), pi[9] = Y.I(2, 2);
}

// J, 4 x 4, and back: linear.
template <class T>
inline void pseudo_inertia(const T* pi, T* J) {
  const Inertia<T> Y = load_parameters(pi);
  const T half_trace = (Y.I(0, 0) + Y.I(1, 1) + Y.I(2, 2)) * T(0.5);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) J[r + 4 * c] = r == c ? half_trace - Y.I(r, c) : -Y.I(r, c);
    J[3 + 4 * c] = J[12 + c] = Y.h[c];
  }
  J[15] = Y.m;
}
template <class T>
inline void parameters_of_pseudo_inertia(const T* J, T* pi) {
  const T x = J[0], y = J[5], z = J[10];
  store_parameters(Inertia<T>{J[15], load3(J + 12), {Vec3<T>::make(y + z, x + z, x + y), Vec3<T>::make(-J[4], -J[9], -J[8])}},
                   pi);
}

// U of J = U U^T, 4 x 4 upper triangular, from the last row to the first. False when J is not positive definite.
template <class T>
inline bool upper_cholesky(const T* J, T* U) {
  using std::sqrt;
  for (int k = 0; k < 16; ++k) U[k] = T(0);
  for (int c = 3; c >= 0; --c)
    for (int r = c; r >= 0; --r) {
      T x = J[r + 4 * c];
      for (int k = c + 1; k < 4; ++k) x -= U[r + 4 * k] * U[c + 4 * k];
      if (r == c && !(x > T(0))) return false;
      U[r + 4 * c] = r == c ? sqrt(x) : x / U[c + 4 * c];
    }
  return true;
}

// Where theta's elements stand in U: their diagonal ones are logarithms.
struct LogCholeskyPlace {
  int row, col;
};
inline constexpr LogCholeskyPlace log_cholesky_places[] = {{3, 3}, {0, 0}, {1, 1}, {2, 2}, {0, 1},
                                                           {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

// False when the body cannot exist.
template <class T>
inline bool log_cholesky(const T* pi, T* theta) {
  using math::log;
  T J[16], U[16];
  pseudo_inertia(pi, J);
  if (!upper_cholesky(J, U)) return false;
  for (int k = 0; k < 10; ++k) {
    const auto [r, c] = log_cholesky_places[k];
    const T x = U[r + 4 * c];
    theta[k] = k == 0 ? log(x) : r == c ? log(x / U[15]) : x / U[15];
  }
  return true;
}
template <class T>
inline void log_cholesky_factor(const T* theta, T* U) {
  using math::exp;
  for (int k = 0; k < 16; ++k) U[k] = T(0);
  const T scale = exp(theta[0]);
  U[15] = scale;
  for (int k = 1; k < 10; ++k) {
    const auto [r, c] = log_cholesky_places[k];
    U[r + 4 * c] = scale * (r == c ? exp(theta[k]) : theta[k]);
  }
}
// pi of A B^T + B A^T
template <class T>
inline void parameters_of_product(const T* A, const T* B, T* pi) {
  T J[16];
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) {
      T x = T(0);
      for (int k = 0; k < 4; ++k) x += A[r + 4 * k] * B[c + 4 * k] + B[r + 4 * k] * A[c + 4 * k];
      J[r + 4 * c] = x;
    }
  parameters_of_pseudo_inertia(J, pi);
}
template <class T>
inline void parameters_of_log_cholesky(const T* theta, T* pi) {
  T U[16];
  log_cholesky_factor(theta, U);
  parameters_of_product(U, U, pi);
  for (int k = 0; k < 10; ++k) pi[k] *= T(0.5);
}
// d pi / d theta, 10 x 10
template <class T>
inline void log_cholesky_jacobian(const T* theta, T* jacobian) {
  T U[16];
  log_cholesky_factor(theta, U);
  for (int k = 0; k < 10; ++k) {
    T dU[16] = {};
    const auto [r, c] = log_cholesky_places[k];
    if (k == 0)
      for (int i = 0; i < 16; ++i) dU[i] = U[i];
    else
      dU[r + 4 * c] = r == c ? U[r + 4 * c] : U[15];
    parameters_of_product(dU, U, jacobian + 10 * k);
  }
}

}  // namespace dyn
