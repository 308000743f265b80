// Where the energy and the momentum of a step went (dynErrorLedger): what forces do, by the trapezoidal rule over the step; what impulses of rows do, each by
// the mean velocity of its row, which is their share in the change of the kinetic energy; what the correction of the configuration does. The
// rest is the step's error.
#pragma once

#include "simulation/step.hpp"

namespace dyn::simulation {

// Before the first step of a call, where the option asks for it or did so before.
void open_ledger(const Model& m, Data<double>& d);
// After a step of h: to the state that d holds.
void record_step(const Model& m, Data<double>& d, double h);
// After the impulses of an island.
struct Island;
void record_impulses(const Island& x);
// After the configuration was corrected: dq of it is dq, q without it lies h v from q0.
void record_correction(const Model& m, Data<double>& d, const double* q0, const double* hv, const double* dq);
// What rows did in a step that is made anew.
inline void reset_impulse_work(Data<double>& d) { d.step->ledger.rows = {}; }
inline bool has_open_ledger(const Data<double>& d) { return d.step && d.step->ledger.open; }

}  // namespace dyn::simulation
