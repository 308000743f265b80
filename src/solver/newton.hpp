// Newton's method: along the path of interior.hpp, whose equations hold friction's law whole; where that gets stuck, on the augmented
// Lagrangian: the joint steps of multipliers.hpp, each a convex problem with exact cones for a given correction Gamma, which is iterated.
// Finished by Newton's method on the whole problem.
#pragma once

#include "solver/interior.hpp"
#include "solver/start.hpp"

namespace dyn::solver {

// From w.y to w.y.
void newton(Workspace& w, Budget& b);

}  // namespace dyn::solver
