#include "algorithm/aba_derivatives.hpp"

namespace dyn {
template void rnea_derivatives(const Model&, Data<double>&, const double*, const double*, const double*);
template Index minverse(const Model&, Data<double>&);
template Index aba_derivatives(const Model&, Data<double>&, const double*, const double*, const double*);
}  // namespace dyn
