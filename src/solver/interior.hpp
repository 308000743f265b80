// The interior-point method (interior_point.hpp) with the dense matrix, from impulses that stop all motion.
// Extreme mass ratios and redundant contacts do not slow it down. Newton's method on the whole problem finishes.
// It can get stuck where friction decides a contact's state; it then returns false.
#pragma once

#include "solver/alart_curnier.hpp"

namespace dyn::solver {

// Starts with `factor` times the impulses that stop all motion; the result goes to w.y. Returns true when the tolerance is met.
bool interior(Workspace& w, Budget& b, double factor);

}  // namespace dyn::solver
