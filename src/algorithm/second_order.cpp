#include "algorithm/second_order_tensors.hpp"

namespace dyn {
template void second_order_columns(const Model&, Data<double>&, const double*, const double*, const double*);
template double second_order_size(const Model&, const Data<double>&);
template void second_order_product(const Model&, Data<double>&, const double*, const SecondOrder<double*>&);
template void second_order_derivatives(const Model&, Data<double>&, const SecondOrder<double*>&);
}  // namespace dyn
