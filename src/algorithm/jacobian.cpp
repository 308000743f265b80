#include "algorithm/center_of_mass.hpp"
#include "algorithm/coriolis.hpp"
#include "algorithm/energy.hpp"

namespace dyn {
template void joint_jacobians(const Model&, Data<double>&);
template void joint_jacobians_time_variation(const Model&, Data<double>&);
template void frame_jacobian(const Model&, const Data<double>&, Index, dynReference, double*);
template void frame_jacobian_time_variation(const Model&, const Data<double>&, Index, dynReference, double*);
template void frame_placement(const Model&, const Data<double>&, Index, double*);
template void frame_velocity(const Model&, const Data<double>&, Index, dynReference, double*);
template void frame_acceleration(const Model&, const Data<double>&, Index, dynReference, bool, double*);
template void center_of_mass(const Model&, Data<double>&, int);
template void center_of_mass_jacobian(const Model&, const Data<double>&, Index, double*);
template void kinetic_energy(const Model&, Data<double>&);
template void potential_energy(const Model&, Data<double>&);
template void coriolis_matrix(const Model&, Data<double>&);
}  // namespace dyn
