#include "integrator/advance.hpp"

namespace dyn {
template void inverse_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template void rigid_inverse_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template Index forward_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template void crba(const Model&, Data<double>&);
template Index factorize(const Model&, Data<double>&);
template bool solve(const Model&, const Data<double>&, const double*, double*, double*);
template void invert(const Model&, Data<double>&);
template Index integrator::step(const Model&, Data<double>&, dynIntegrator, double, dynStepReport&);
template Index integrator::advance(const Model&, Data<double>&, dynIntegrator, double, double, dynStepReport&);
}  // namespace dyn
