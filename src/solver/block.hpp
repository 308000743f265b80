// Rows of a constraint in units that make friction cones round and diagonals of G about 1. The normal comes first.
#pragma once

#include "solver/local_cone.hpp"
#include "solver/point_contact.hpp"
#include "solver/residuals.hpp"

namespace dyn::solver {

struct Block {
  static constexpr int max_rows = 6;
  enum class Kind { rows, point, cone };  // bounded rows; a friction cone of three rows with a regular block; any other

  Kind kind;
  Index first, rows;
  const Index* order;           // permutation of the constraint's rows
  double mu, lower, upper;
  double unit[max_rows];        // of impulses
  double per_speed[max_rows];   // 1 / unit of velocities, which leaves out the lengths of torsion and rolling
  double soft[max_rows];        // compliance
  double response[max_rows];    // 1 / (G_ii + soft) of bounded rows; 0 where nothing moves
  PointContact point;
  LocalCone* cone;              // of Kind::cone

  bool is_cone() const { return kind != Kind::rows; }
  // y = P_K(w)
  void project(const double* w, double* y) const {
    if (is_cone()) return void(project_cone(mu, rows, w, y));
    for (Index i = 0; i < rows; ++i) y[i] = std::clamp(w[i], lower, upper);
  }
};

// Natural map |y - P_K(y - u)| of blocks (residuals.hpp), as velocities.
struct BlockError {
  double worst = 0, most = 0;  // most: largest impulse, as a velocity

  void take(const Block& s, const double* y, const double* u) {
    double wrong[Block::max_rows];
    if (s.is_cone()) natural_map({0, s.rows, s.mu}, y, u, wrong);
    else
      for (Index i = 0; i < s.rows; ++i)
        wrong[i] = s.response[i] > 0 ? y[i] - std::clamp(y[i] - u[i], s.lower, s.upper) : 0;
    for (Index i = 0; i < s.rows; ++i) {
      const double error = std::abs(wrong[i]) * s.per_speed[i];
      most = std::max(most, std::abs(y[i]) * s.per_speed[i]);
      if (!(error <= worst)) worst = error >= 0 ? error : HUGE_VAL;  // NaN counts as infinite
    }
  }
  double error(double fastest) const { return is_lost_to_round_off(most, fastest) ? HUGE_VAL : worst; }
};

}  // namespace dyn::solver
