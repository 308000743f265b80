// Projected block Gauss-Seidel (sweep.hpp) with the dense matrix.
#pragma once

#include "solver/budget.hpp"
#include "solver/sweep.hpp"

namespace dyn::solver {

// G of a problem, by c = G y + g.
struct Dense {
  const Problem& p;
  double* c;
  Index size() const { return p.blocks; }
  Block& block(Index k) const { return p.block[k]; }
  template <int rows>
  void velocity(Index k, const double*, double* of) const {
    std::copy_n(c + block(k).first, rows, of);
  }
  template <int rows>
  void change(Index k, const double* by) const {
    const double* column[rows];
    for (int j = 0; j < rows; ++j) column[j] = p.G.column(block(k).first + j);
    for (Index i = 0; i < p.n; ++i) {
      double sum = c[i];
      for (int j = 0; j < rows; ++j) sum += column[j][i] * by[j];
      c[i] = sum;
    }
  }
};

// Starts from w.y and leaves the result there.
void pgs(Workspace& w, Budget& b);

}  // namespace dyn::solver
