#include "algorithm/constrained/derivatives.hpp"

namespace dyn {
template Index constrained_dynamics_derivatives(const Model&, Data<double>&, const double*, const double*, const double*,
                                                const ProximalOptions&, dynConstraintResult&);
template Index constraint_impulse_derivatives(const Model&, Data<double>&, const double*, const ProximalOptions&,
                                              dynConstraintResult&);
}  // namespace dyn
