#include "algorithm/constrained/constrained_dynamics.hpp"

namespace dyn {
template Index constraint_factor(const Model&, Data<double>&);
template Index constrained_dynamics(const Model&, Data<double>&, const double*, const double*, const double*,
                                    const ProximalOptions&, double*, dynConstraintResult&);
template Index constraint_impulse(const Model&, Data<double>&, const double*, const ProximalOptions&, double*,
                                  dynConstraintResult&);
template void propagate_rows(const Model&, Data<double>&);
template void delassus(const Model&, Data<double>&, Index, double*);
template void delassus_times(const Model&, Data<double>&, const double*, double*, double*);
template void constraint_jacobian(const Model&, Data<double>&, double*, std::ptrdiff_t);
}  // namespace dyn
