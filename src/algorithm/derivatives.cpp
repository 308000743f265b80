#include "dyn/algorithm/rnea_derivatives.hpp"

namespace dyn {
template void rnea_derivatives(const Model&, Data<double>&, const double*, const double*, const double*);
}  // namespace dyn
