#include "simulation/data_layout.hpp"

namespace dyn {
template std::size_t data_bytes<double>(const Model&, dynParts);
template void data_layout(const Model&, dynParts, void*, Data<double>&);
}  // namespace dyn
