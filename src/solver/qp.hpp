// The contact problem as a quadratic program with linear or conic rows, in CSC (dynQp of dyn.h).
#pragma once

#include "solver/problem.hpp"

namespace dyn::solver {

// Sets the sizes of q, and fills those arrays that are not null.
void friction_cone_qp(const dynContactProblem& x, Index facets, bool inscribed, dynQp& q);

}  // namespace dyn::solver
