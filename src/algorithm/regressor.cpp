#include "algorithm/torque_regressor.hpp"

namespace dyn {
template double joint_torque_regressor(const Model&, Data<double>&);
template void static_regressor(const Model&, Data<double>&);
template void kinetic_energy_regressor(const Model&, Data<double>&);
template void potential_energy_regressor(const Model&, Data<double>&);
template void inertial_parameters(const Model&, double*);
}  // namespace dyn
