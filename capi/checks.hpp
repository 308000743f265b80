// Checks of inputs and results that several wrappers share.
#pragma once

#include "guard.hpp"

namespace dyn::capi {

// Kinematics beyond these bounds (accelerations: their squares) are refused: within them no product overflows that a frame query
// or a Jacobian forms, or a derivative of theirs.
inline constexpr double most = 1e100, max_to_differentiate = 1e40;
// Placements (level 0), velocities (1) and accelerations (2) of the bodies are within bounds; otherwise they are dropped and the
// inputs of this call are taken back.
bool no_overflow(Call& call, int level, double bound = most);
// The same of all that carries a frame; nothing is taken back.
bool no_overflow_frame(Call& call, int frame, int level, double bound = most);
// The universe's column does not count.
inline bool check_fext(Call& call, const double* fext) { return call.finite("fext", fext, 6 * call.m().n.joints, 6); }
// Forward dynamics failed at a joint.
dynStatus singular(Call& call, Index joint, Stage stage);
// d.M is finite. With placements within bounds only models that may overflow are checked.
bool finite_mass(Call& call);
// Products of the columns d.S to d.Q, as they are in the data, do not overflow. false: they may.
bool small_columns(const Call& call);
// Call::numeric of derivatives of a force, nv x nv, in the time of its pairs when the columns it is made of are small.
bool numeric_pairs(Call& call, const double* x, const char* what, Stage stage, bool small_columns);
// Factorises d.M.
dynStatus factor(Call& call);

}  // namespace dyn::capi
