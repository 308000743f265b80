#include "algorithm/kinematics.hpp"

namespace dyn {
template void forward_kinematics<0>(const Model&, Data<double>&);
template void forward_kinematics<1>(const Model&, Data<double>&);
template void forward_kinematics<2>(const Model&, Data<double>&);
template void ensure_position(const Model&, Data<double>&);
template void ensure_velocity(const Model&, Data<double>&);
template void ensure_acceleration(const Model&, Data<double>&);
}  // namespace dyn
