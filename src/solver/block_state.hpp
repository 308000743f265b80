// State of a block in a Newton step on Alart and Curnier's function (newton_method.hpp), and the linear law in that state.
#pragma once

#include "solver/block.hpp"

namespace dyn::solver {

struct BlockState {
  enum Mode { open, stick, slip } mode;  // bounded rows count as sticking
  bool acts;                             // neither open nor at a bound
  double across, direction[5];           // of slip: k and d

  // Finds the state at y and c, and the known part of the step. Returns whether that part is not zero.
  DYN_INLINE bool find(const Block& s, const double* y, const double* c, double* step) {
    std::fill_n(step, s.rows, 0.0);
    mode = stick, acts = true;
    if (!s.is_cone()) {
      if (s.lower == -HUGE_VAL && s.upper == HUGE_VAL) return false;
      const double aim = y[0] - c[0], at = std::clamp(aim, s.lower, s.upper);
      if (at != aim) acts = false, step[0] = at - y[0];
      return step[0] != 0;
    }
    const Index size = s.rows - 1;
    for (Index i = 0; i < size; ++i) direction[i] = y[1 + i] - c[1 + i];
    const double normal = y[0] - c[0], length = norm(direction, size);
    bool known = false;
    if (normal <= 0) {
      mode = open, acts = false;
      for (Index i = 0; i < s.rows; ++i) step[i] = -y[i], known |= y[i] != 0;
    } else if (length > s.mu * normal) {
      mode = slip, across = s.mu * normal / length;
      double excess = s.mu * y[0];  // mu y_n - y_d
      for (Index i = 0; i < size; ++i) direction[i] /= length, excess -= y[1 + i] * direction[i];
      for (Index i = 0; i < size; ++i) step[1 + i] = excess * direction[i];
      known = excess != 0;
    }
    return known;
  }

  // law = E (F^T C E)^-1 F^T: the impulses by velocities, C with the added compliance and the block's own.
  void set_law(const Block& s, double compliance, LawMatrix& law) const {
    const bool slips = mode == slip;
    for (Index i = 0; i < s.rows; ++i) {
      for (Index j = 0; j < s.rows; ++j) law[i][j] = 0;
      if (!slips || i == 0) law[i][i] = 1 / (compliance + s.soft[i]);
    }
    if (!slips) return;
    const double K = 1 / (compliance + 1 / across - 1 + s.soft[1]);
    for (Index i = 1; i < s.rows; ++i) {
      law[i][0] = s.mu * law[0][0] * direction[i - 1];
      for (Index j = 1; j < s.rows; ++j) law[i][j] = K * ((i == j) - direction[i - 1] * direction[j - 1]);
    }
  }
};

}  // namespace dyn::solver
