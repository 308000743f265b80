#include "algorithm/cholesky.hpp"
#include "algorithm/crba.hpp"
#include "algorithm/forward_dynamics.hpp"
#include "algorithm/rnea.hpp"

namespace dyn {
template void inverse_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template void rigid_inverse_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template Index forward_dynamics(const Model&, Data<double>&, const double*, const double*, const double*, double*);
template void crba(const Model&, Data<double>&);
template Index factorize(const Model&, Data<double>&);
template bool solve(const Model&, const Data<double>&, const double*, double*, double*);
template void invert(const Model&, Data<double>&);
}  // namespace dyn
