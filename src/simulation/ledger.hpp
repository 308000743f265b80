// Balance of energy and momentum in a step (dynErrorLedger).
// Work of an impulse: by its mean velocity, which is exactly its share in the change of kinetic energy. Those are rows, and in an
// Euler step the forces at joints: a stiff damper stops what it brakes within the step. Work of other forces: by the quadrature of
// the integrator's stages, in steps of order 1 and in steps for an accuracy through contacts by the trapezoidal rule.
// The position correction has its own entry. The remainder is the integrator's error.
#pragma once

#include "simulation/step.hpp"

namespace dyn::simulation {

// Opens the ledger before the first step of a call if the option asks for it, and closes it otherwise.
void open_ledger(const Model& m, Data<double>& d);
// Records a step of h that ends at the state in d.
void record_step(const Model& m, Data<double>& d, double h);
// Records a share of a step, in time, in which the powers are those of the state in d.
void record_powers(const Model& m, Data<double>& d, double share);
// Of an Euler step from v0 to d.v, before q moves. Records the impulses of tau and of resistance at the degrees of freedom
// first .. end - 1,
void record_joint_work(Data<double>& d, const double* v0, double h, Index first, Index end);
// and those of actuators and tendons.
void record_drive_work(const Model& m, Data<double>& d, const double* v0, double h);
// Records the impulses of an island.
struct Island;
void record_impulses(const Island& x);
// Records a position correction dq; without it the configuration would be q0 (+) hv.
void record_correction(const Model& m, Data<double>& d, const double* q0, const double* hv, const double* dq);
double ledger_potential(const Model& m, Data<double>& d);
// Records a projection onto the constraints; before: the potential energy then.
void record_projection(const Model& m, Data<double>& d, double before);
// Discards the impulses of a step that is repeated.
inline void reset_impulse_work(Data<double>& d) { d.step->ledger.rows = {}; }
inline bool has_open_ledger(const Data<double>& d) { return d.step && d.step->ledger.open; }

}  // namespace dyn::simulation
