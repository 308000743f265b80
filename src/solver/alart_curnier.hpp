// Newton's method on the whole problem, nonsmooth and nonsymmetric, started near a solution (Alart and Curnier 1991). Zeros of:
//   boxes   y - P(y - c)
//   cones   y_n - max(0, r),  y_t - P_B(mu max(0, r)) (y_t - c_t),  r = y_n - c_n
// States: open: y = 0; stick: c = 0; slip along d = a / |a|, a = y_t - c_t: c_n = 0 and y_t = mu r d.
// In slip, y_d = mu y_n + ... is eliminated; rows across d are divided by k = mu r / |a|, which adds 1/k - 1 >= 0 to the
// diagonal. The matrix is then that of G's rows, except for mu G(:, d) added to the columns of normals.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Steps from y with c = G y + g while the error falls; the best iterate goes to w.y. Returns true when the tolerance is met.
// damped_steps: for distant starts. If no step length helps, steps are damped; then the error need only fall below one of the
// last twelve (nonmonotone: Grippo, Lampariello and Lucidi 1986).
bool alart_curnier(Workspace& w, Budget& b, const double* y, const double* c, bool damped_steps = false);

}  // namespace dyn::solver
