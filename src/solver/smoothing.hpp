// The smoothing Newton method (smoothing_method.hpp) on the dense matrix.
#pragma once

#include "solver/budget.hpp"

namespace dyn::solver {

// Starts from the best iterate. Returns true when the tolerance is met.
bool smoothing_newton(Workspace& w, Budget& b);

}  // namespace dyn::solver
