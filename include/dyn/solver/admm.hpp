// Proximal ADMM: the alternating steps of multipliers.hpp. What it finds roughly, which contacts are apart, stuck, sliding, Newton's method
// on the whole problem finishes; where the steps get nowhere (extreme mass ratios) a joint one is put between.
#pragma once

#include "dyn/solver/start.hpp"

namespace dyn::solver {

// From w.y to w.y.
void admm(Workspace& w, Budget& b);

}  // namespace dyn::solver
