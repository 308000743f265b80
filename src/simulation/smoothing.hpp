// Smoothing Newton method (solver/smoothing_method.hpp) on an island without a dense matrix: from far away and in jams it finds
// what Newton's method on the exact law misses.
#pragma once

#include "simulation/newton.hpp"
#include "solver/smoothing_method.hpp"

namespace dyn::simulation {

class Smoothing : Newton {
 public:
  explicit Smoothing(const Island& island) : Newton(island) {}
  // Starts from the island's lambda. At most max_steps steps. Sets lambda to the best impulses found, in their cones.
  void run(Index max_steps, dynContactReport& report);

  // of the operator
  using Newton::for_each;
  solver::LawMatrix& law(Index k) const { return w.newton[k].law; }
  bool factorize();
  void solve(const double* left, double* dy, double* dc) const;

 private:
  double* const left = g + room;
  solver::SmoothingMethod<Smoothing> path{*this, x.rows, y, c, dy, dc, left};
};

}  // namespace dyn::simulation
