// Newton's method on the augmented Lagrangian (Li, Sun and Toh 2018): for a given correction s = Gamma(z) the problem is convex,
//   min 1/2 x'Gx + x'(g + s) over K,   L(x) = 1/2 x'Gx + x'(g + s) + |z+(x)|^2 / (2 rho),  z+(x) = P_K*(z - rho x)
//   gradient G x + g + s - z+,  Hessian G + rho (I - P_K'(x - z / rho))
// and is solved by steps with a line search; then z <- z+, s <- Gamma(z), rho grows. Exact cones, and global convergence for a given s.
// The whole problem is finished by alart_curnier.hpp.
#pragma once

#include "dyn/solver/alart_curnier.hpp"

namespace dyn::solver {

void newton(Workspace& w, Budget& b);

}  // namespace dyn::solver
