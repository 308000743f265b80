// What constraints between frames exert on their links in a step, for sensors of forces (Workspace::frame_forces).
#pragma once

#include "simulation/workspace.hpp"

namespace dyn::simulation {

struct Island;
struct ActiveConstraint;

// Of an equality, after a solve of impulses.
void note_frame_forces(const Island& x, const ActiveConstraint& a);
// After constrained dynamics.
void note_frame_forces(const Model& m, Data<double>& d);

}  // namespace dyn::simulation
