// Proximal ADMM: the alternating steps of multipliers.hpp. What it finds roughly, which contacts are apart, stuck, sliding, Newton's method
// on the whole problem finishes; where the steps get nowhere (light bodies that slide under heavy ones) the path of interior.hpp does it.
#pragma once

#include "solver/interior.hpp"
#include "solver/start.hpp"

namespace dyn::solver {

// From w.y to w.y.
void admm(Workspace& w, Budget& b);

}  // namespace dyn::solver
