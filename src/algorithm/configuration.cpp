#include "algorithm/configuration.hpp"

namespace dyn {
template void integrate(const Model&, const double*, const double*, double*);
template void difference(const Model&, const double*, const double*, double*);
template void interpolate(const Model&, const double*, const double*, double, double*);
template double distance(const Model&, const double*, const double*);
void random_configuration(const Model& m, std::uint64_t seed, const double* lower, const double* upper, double* q) {
  Random g{seed};
  for_each_leader(m, [&]<class J>(const Body& b) { J::random(g, lower + b.user_q, upper + b.user_q, q + b.user_q); });
}
template void normalize(const Model&, double*);
template double norm_error(const Model&, const double*);
template Index zero_norm_joint(const Model&, const double*);
template void integrate_jacobians(const Model&, const double*, const double*, double*, double*);
template void difference_jacobians(const Model&, const double*, const double*, double*, double*);
}  // namespace dyn
