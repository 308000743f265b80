// Projected block Gauss-Seidel (sweep.hpp) with the dense matrix.
#pragma once

#include "solver/budget.hpp"
#include "solver/sweep.hpp"

namespace dyn::solver {

// G of a workspace, by c = G y + g.
struct Dense {
  const Workspace& w;
  double* c;
  Index size() const { return w.problem.boxes + w.problem.cones; }
  Block& block(Index k) const { return w.blocks[k]; }
  template <int rows>
  void velocity(Index k, const double*, double* of) const {
    std::copy_n(c + block(k).first, rows, of);
  }
  template <int rows>
  void change(Index k, const double* by) const {
    const double* column[rows];
    for (int j = 0; j < rows; ++j) column[j] = w.problem.G.column(block(k).first + j);
    for (Index i = 0; i < w.problem.n; ++i) {
      double sum = c[i];
      for (int j = 0; j < rows; ++j) sum += column[j][i] * by[j];
      c[i] = sum;
    }
  }
};

// Prepares w.blocks.
void prepare_sweeps(Workspace& w);

// Starts from w.y and leaves the result there.
void pgs(Workspace& w, Budget& b);

}  // namespace dyn::solver
