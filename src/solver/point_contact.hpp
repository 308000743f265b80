// One contact of three rows (normal, two tangents), solved exactly for the velocity b that it has without its own impulse y:
//   open   b_n >= 0:               y = 0
//   stick  y = -G^-1 b in the cone
//   slip   c_n = 0, c_t = -a y_t for an a > 0; with the eigenvectors of S = G_tt - G_tn G_nt / G_nn one scalar equation
//   (local_cone.hpp)
#pragma once

#include "solver/bracketed_newton.hpp"
#include "solver/cone.hpp"
#include "solver/tuning.hpp"

namespace dyn::solver {

struct PointContact {
  double G[6];         // 00, 01, 02, 11, 12, 22; the normal is 0
  double inverse[6];   // of G
  double cosine, sine, e[2], coupling[2];  // eigenvectors and eigenvalues of S, coupling with the normal; set by the first slip
  double resistance;   // a of the last slip; 0 before the first

  // Returns false if the block is too nearly singular for its inverse.
  bool set(const double* block, std::ptrdiff_t stride) {
    const auto at = [&](int i, int j) { return block[i + stride * j]; };
    G[0] = at(0, 0), G[1] = at(0, 1), G[2] = at(0, 2), G[3] = at(1, 1), G[4] = at(1, 2), G[5] = at(2, 2);
    const double a = G[3] * G[5] - G[4] * G[4], b = G[2] * G[4] - G[1] * G[5], c = G[1] * G[4] - G[2] * G[3];
    const double det = G[0] * a + G[1] * b + G[2] * c;
    resistance = 0;
    if (!(det > tuning::pgs::singular_block * G[0] * G[3] * G[5])) return false;
    const double per = 1 / det;
    inverse[0] = a * per, inverse[1] = b * per, inverse[2] = c * per;
    inverse[3] = (G[0] * G[5] - G[2] * G[2]) * per, inverse[4] = (G[1] * G[2] - G[0] * G[4]) * per,
    inverse[5] = (G[0] * G[3] - G[1] * G[1]) * per;
    return true;
  }

  // c -= G y
  template <int rows>
  void leave_out(const double* y, double* c) const {
    static_assert(rows == 3);
    c[0] -= G[0] * y[0] + G[1] * y[1] + G[2] * y[2];
    c[1] -= G[1] * y[0] + G[3] * y[1] + G[4] * y[2];
    c[2] -= G[2] * y[0] + G[4] * y[1] + G[5] * y[2];
  }
  void solve(double mu, const double* b, double* y) {
    y[0] = y[1] = y[2] = 0;
    if (b[0] >= 0) return;
    const double n = -(inverse[0] * b[0] + inverse[1] * b[1] + inverse[2] * b[2]);
    const double t = -(inverse[1] * b[0] + inverse[3] * b[1] + inverse[4] * b[2]),
                 u = -(inverse[2] * b[0] + inverse[4] * b[1] + inverse[5] * b[2]);
    if (n > 0 && t * t + u * u <= mu * mu * n * n) y[0] = n, y[1] = t, y[2] = u;
    else slip(mu, b, y);
  }

 private:
  void find_eigenvectors() {
    const double per = 1 / G[0], S00 = G[3] - G[1] * G[1] * per, S01 = G[4] - G[1] * G[2] * per, S11 = G[5] - G[2] * G[2] * per;
    const double theta = S01 != 0 ? (S11 - S00) / (2 * S01) : HUGE_VAL;
    const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    cosine = 1 / std::sqrt(t * t + 1), sine = t * cosine;
    e[0] = S00 - t * S01, e[1] = S11 + t * S01;
    coupling[0] = cosine * G[1] - sine * G[2], coupling[1] = sine * G[1] + cosine * G[2];
  }

  void slip(double mu, const double* b, double* y) {
    using namespace tuning::pgs;
    if (resistance == 0) find_eigenvectors();
    const double per_G = 1 / G[0];
    const double b0 = cosine * b[1] - sine * b[2] - coupling[0] * b[0] * per_G,
                 b1 = sine * b[1] + cosine * b[2] - coupling[1] * b[0] * per_G;
    double n = 0, y0 = 0, y1 = 0, slope = 0;
    // mu lambda_n / |lambda_t| - 1 at the resistance a, and its slope
    const auto at = [&](double a) {
      const double give0 = 1 / (e[0] + a), give1 = 1 / (e[1] + a);
      y0 = -b0 * give0, y1 = -b1 * give1;
      n = (-b[0] - coupling[0] * y0 - coupling[1] * y1) * per_G;
      const double per = 1 / std::sqrt(y0 * y0 + y1 * y1);
      const double dn = (coupling[0] * y0 * give0 + coupling[1] * y1 * give1) * per_G,
                   dl = -(y0 * y0 * give0 + y1 * y1 * give1) * per;
      slope = mu * (dn - n * dl * per) * per;
      return mu * n * per - 1;
    };
    const double guess = resistance > 0 ? resistance : std::sqrt(b0 * b0 + b1 * b1) * G[0] / (mu * -b[0]);
    resistance = bracketed_newton(at, slope, guess, slip_tolerance);
    y[0] = n, y[1] = cosine * y0 + sine * y1, y[2] = cosine * y1 - sine * y0;
    project_cone(mu, 3, y, y);
  }
};

}  // namespace dyn::solver
