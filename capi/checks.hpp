// Checks of inputs and results that several wrappers share.
#pragma once

#include "guard.hpp"

namespace dyn::capi {

// Placements (level 0), velocities (1) and accelerations (2) of the bodies are within bounds; otherwise they are dropped and the
// inputs of this call are taken back.
bool moderate(Call& call, int level);
// The universe's column does not count.
inline bool check_fext(Call& call, const double* fext) { return call.finite("fext", fext, 6 * call.m().n.joints, 6); }
// Forward dynamics failed at a joint.
dynStatus singular(Call& call, Index joint, Stage stage);
// d.M is finite: its diagonal is when it is, for placements within bounds.
bool finite_mass(Call& call);
// Factorises d.M.
dynStatus factor(Call& call);

}  // namespace dyn::capi
