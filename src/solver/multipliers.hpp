// Multipliers of x = y in K, in min 1/2 x'Gx + x'(g + s). s = Gamma(z) is the de Saxce correction of the velocity z, the dual
// variable:
//   L(x, y, z) = 1/2 x'Gx + x'(g + s) - z'(x - y) + rho/2 |x - y|^2
// Two kinds of step:
//   ADMM (Carpentier, Le Lidec and Montaut 2024)
//     x <- (G + rho I)^-1 (rho y + z - g - s),  y <- P_K(x^ - z / rho) with x^ = x over-relaxed,  z <- z - rho (x^ - y)
//   augmented Lagrangian (Li, Sun and Toh 2018): x minimises L(x, y(x), z) by Newton's method with a line search
//     gradient G x + g + s - z+,  z+ = rho (y - x) + z,  Hessian G + rho (I - P_K'(x - z / rho)),  then z <- z+
// ADMM is cheap and follows Gamma closely; the augmented Lagrangian does not depend on the condition of G.
// In both, z is in K* and orthogonal to y.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

class Multipliers {
 public:
  // Starts from w.y and w.c, the result of one projected Gauss-Seidel step.
  Multipliers(Workspace& w, Budget& b);

  // They return false if the matrix cannot be factorised.
  bool admm_step();
  bool augmented_lagrangian_step(Index max_steps);

  double error = HUGE_VAL;   // max(|x - y|, rho |change of y|), as velocities
  double rho = tuning::multipliers::first_rho, joint_rho = 1;
  double* y;                 // in K
  // w.newton_c = G y + g
  void velocity() { times(p.G, y, p.g, w.newton_c, p.n); }

 private:
  Workspace& w;
  Budget& b;
  const Problem& p;
  double *x, *z, *s, *r, *y_before;
  double factor_rho = 0, primal_before = HUGE_VAL;
  Index changed = 0;  // steps since rho changed

  void correct();
  double lagrangian(const double* at, const double* c);
  bool hessian(double damping);
  void balance(double primal, double dual);
};

}  // namespace dyn::solver
