#include "algorithm/constrained/inverse.hpp"
#include "algorithm/constrained/project.hpp"

namespace dyn {
template void project_velocity(const Model&, Data<double>&, const double*, double*, dynConstraintResult&);
template Index project(const Model&, Data<double>&, int, bool, double, double*, dynConstraintResult&, double, double);
template Index constrained_inverse_dynamics(const Model&, Data<double>&, const double*, const double*, const double*,
                                            const std::int32_t*, double*, dynConstraintResult&);
}  // namespace dyn
