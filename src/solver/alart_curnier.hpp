// Newton's method on the whole problem, nonsmooth and nonsymmetric, from a start near a solution (Alart and Curnier 1991): zeros of
//   boxes   y - P(y - c)
//   cones   y_n - max(0, r),  y_t - P_B(mu max(0, r)) (y_t - c_t),  r = y_n - c_n
// By state of a block: apart: y = 0; stuck: c = 0; sliding along d = a / |a|, a = y_t - c_t: c_n = 0 and y_t = mu r d.
// Sliding, y_d = mu y_n + ... is eliminated, and the rows across d divided by k = mu r / |a| are those of G with 1/k - 1 >= 0 added to the
// diagonal: the matrix is that of G's rows but for mu G(:, d), which the columns of normals take.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Steps from y with c = G y + g as long as they make the error smaller; the best iterate goes to w.y. true: it is good enough.
// patient, for starts that are not near: where no step does, it is damped, and from then on need but be smaller than one of the last twelve
// (Grippo, Lampariello and Lucidi 1986).
bool alart_curnier(Workspace& w, Budget& b, const double* y, const double* c, bool damped_steps = false);

}  // namespace dyn::solver
