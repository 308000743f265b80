// Newton's method: the path of interior.hpp, whose equations contain friction's law.
// Where it gets stuck: augmented Lagrangian steps (multipliers.hpp), each a convex problem with exact cones for a given
// correction Gamma. Newton's method on the whole problem finishes.
#pragma once

#include "solver/interior.hpp"
#include "solver/start.hpp"

namespace dyn::solver {

// Starts from w.y and leaves the result there.
void newton(Workspace& w, Budget& b);

}  // namespace dyn::solver
