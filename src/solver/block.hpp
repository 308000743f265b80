// Rows of a constraint in units that make friction cones round and diagonals of G about 1. The normal comes first.
#pragma once

#include "base/row_count.hpp"
#include "solver/local_cone.hpp"
#include "solver/point_contact.hpp"

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
  // e = y - P_K(y - u), with de Saxce's correction u of the velocity c
  void natural_map(const double* y, const double* c, double* e) const {
    if (is_cone()) return solver::natural_map(mu, rows, y, c, e);
    for (Index i = 0; i < rows; ++i) e[i] = y[i] - std::clamp(y[i] - c[i], lower, upper);
  }
  // e: Alart and Curnier's function, zero at solutions (newton_method.hpp)
  DYN_INLINE void alart_curnier(const double* y, const double* c, double* e) const {
    if (!is_cone()) {
      for (Index i = 0; i < rows; ++i) e[i] = y[i] - std::clamp(y[i] - c[i], lower, upper);
      return;
    }
    const double r = std::max(0.0, y[0] - c[0]);
    e[0] = y[0] - r;
    for (Index i = 1; i < rows; ++i) e[i] = y[i] - c[i];
    const double length = norm(e + 1, rows - 1), within = length > mu * r ? mu * r / length : 1;
    for (Index i = 1; i < rows; ++i) e[i] = y[i] - within * e[i];
  }
};

using LawMatrix = double[Block::max_rows][Block::max_rows];  // a block's impulses (first index) by its velocities

// Calls f.template operator()<number of rows>().
template <class F>
DYN_INLINE void by_rows(const Block& s, F&& f) {
  if (s.rows == 3) f.template operator()<3>();  // most contacts
  else with_row_count(s.rows, f);
}

}  // namespace dyn::solver
