// The interior-point method (solver/interior_point.hpp) on an island, from the guess moved inside by its error. Newton's method
// finishes. With a fixed correction: a convex problem (fixed_correction.cpp).
#pragma once

#include "simulation/newton.hpp"
#include "solver/interior_point.hpp"

namespace dyn::simulation {

class Interior : public Newton {
 public:
  using Newton::Newton;
  bool run(dynContactReport& report);
  bool run_fixed_correction(dynContactReport& report);

  // of the operator
  static constexpr bool inverse_laws = false;
  static constexpr double compliance = tuning::newton::min_compliance, edge = solver::tuning::interior::edge;
  template <class F>
  void for_each(F&& f) const {
    G.for_each(f);
  }
  solver::LawMatrix& law(Index k) const { return w.newton[k].law; }
  double correction(Index k) const { return w.newton[k].correction; }
  bool factorize(bool symmetric);
  void solve(double* r, double* a, double* G_a) const { solve_laws(r, a, G_a, 0); }

 private:
  // y_here, c_here: the iterate from which Newton's method is tried
  double *rhs = before + room, *U = before + 6 * room, *upper = U + room, *dU = upper + room, *dupper = dU + room;
  double *y_here = dupper + room, *c_here = y_here + room;
  solver::InteriorPoint<Interior> path{*this, x.rows, y, c, dy, dc, rhs, U, upper, dU, dupper};

  void start();
  bool step(dynContactReport& report) { return ++report.newton_steps, path.step(); }
  void update_correction();
  bool newton_refine(Index most, dynContactReport& report);
};

}  // namespace dyn::simulation
