#include "simulation/guarded_step.hpp"

namespace dyn::integrator {
template Index step(const Model&, Data<double>&, dynIntegrator, double, dynStepReport&, const double*);
template Index advance(const Model&, Data<double>&, dynIntegrator, double, double, dynStepReport&);
}  // namespace dyn::integrator
