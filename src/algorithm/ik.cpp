#include "algorithm/ik.hpp"

namespace dyn {
template bool inverse_kinematics(const Model&, Data<double>&, const IkTasks&, const dynIkOptions&, dynIkResult&);
template double ik_cost(const Model&, const Data<double>&, const dynIkTask&, IkResidual&);
}  // namespace dyn
