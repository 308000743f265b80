#include "algorithm/center_of_mass_derivatives.hpp"
#include "algorithm/frame_derivatives.hpp"
#include "algorithm/gravity_derivatives.hpp"

namespace dyn {
template void frame_velocity_derivatives(const Model&, const Data<double>&, Index, dynReference, double*, double*);
template void frame_acceleration_derivatives(const Model&, const Data<double>&, Index, dynReference, bool, double*, double*,
                                             double*);
template void frame_kinematic_hessian(const Model&, Data<double>&, Index, dynReference, double*);
template void gravity_derivatives(const Model&, Data<double>&, const double*, double*);
template void static_torque_derivatives(const Model&, Data<double>&, const double*, double*);
template void center_of_mass_velocity_derivatives(const Model&, Data<double>&);
}  // namespace dyn
