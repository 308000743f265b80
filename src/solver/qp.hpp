// The contact problem as a quadratic program with linear or conic rows, in CSC (dynQp of dyn.h).
#pragma once

#include "solver/problem.hpp"

namespace dyn::solver {

// Sizes of q; with arrays, fills those that are not null.
void friction_cone_qp(const dynContactProblem& x, Index facets, bool inscribed, dynQp& q);

}  // namespace dyn::solver
