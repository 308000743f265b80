#include "algorithm/centroidal_derivatives.hpp"

namespace dyn {
template void centroidal_map<false>(const Model&, Data<double>&);
template void centroidal_map<true>(const Model&, Data<double>&);
template void centroidal_momentum<false>(const Model&, Data<double>&);
template void centroidal_momentum<true>(const Model&, Data<double>&);
template void centroidal_derivatives(const Model&, Data<double>&);
}  // namespace dyn
