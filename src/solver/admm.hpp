// Proximal ADMM: the alternating steps of multipliers.hpp. They find roughly which contacts are open, stick or slip;
// Newton's method on the whole problem finishes. The path of interior.hpp takes over where ADMM stalls (light bodies sliding
// under heavy ones).
#pragma once

#include "solver/interior.hpp"
#include "solver/start.hpp"

namespace dyn::solver {

// Starts from w.y and leaves the result there.
void admm(Workspace& w, Budget& b);

}  // namespace dyn::solver
