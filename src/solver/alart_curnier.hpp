// Newton's method on the exact law (newton_method.hpp) by the dense Delassus matrix, started near a solution.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Steps from y with c = G y + g while the error falls; the best iterate goes to w.y. Returns true when the tolerance is met.
// damped_steps > 0: at most so many, for distant starts. If no step length helps, steps are damped; then the error need only fall
// below one of the last twelve (nonmonotone: Grippo, Lampariello and Lucidi 1986).
bool alart_curnier(Workspace& w, Budget& b, const double* y, const double* c, Index damped_steps = 0);

}  // namespace dyn::solver
