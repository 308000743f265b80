// One friction cone of any number of rows, solved exactly for the velocity b that it has without its own impulse y
// (Preclik, Eibl and Ruede 2018; Hwangbo, Lee and Hutter 2018 by bisection):
//   b_n >= 0            open: 0
//   -G^-1 b in K        stick
//   otherwise slip:     c_n = 0 and c_t = -a y_t for an a > 0, so y_t(a) = -(S + a I)^-1 b~,
//                       S = G_tt - G_tn G_nt / G_nn, b~ = b_t - G_tn b_n / G_nn;
//                       with S = Q E Q' one scalar equation mu y_n(a) = |y_t(a)|
#pragma once

#include "solver/cone.hpp"
#include "solver/tuning.hpp"

namespace dyn::solver {

struct LocalCone {
  Index rows;
  double G[6][6];                     // its own block; the normal is 0
  double q[5][5], e[5], coupling[5];  // eigenvectors (columns) and eigenvalues of S; by them, the coupling with the normal
  double resistance;                  // a of the last slip; 0 before the first
  bool decomposed;                    // q, e and coupling are set

  // block: column-major
  void set(const double* block, std::ptrdiff_t stride, Index size) {
    rows = size, resistance = 0, decomposed = false;
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0; j < rows; ++j) G[i][j] = block[i + stride * j];
  }
  void find_eigenvectors(double mu);
  // c -= G y
  template <int size>
  void leave_out(const double* y, double* c) const {
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) c[i] -= G[i][j] * y[j];
  }
  void solve(double mu, const double* b, double* y);
};

}  // namespace dyn::solver
