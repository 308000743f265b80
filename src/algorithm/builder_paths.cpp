// Lengths of tendons that follow from configurations: where springs rest that do not say it, and those of couplings.
#include <cmath>
#include <new>

#include "algorithm/paths.hpp"
#include "model/block.hpp"
#include "model/builder_impl.hpp"

namespace dyn {

namespace {

// Lengths of the paths at q.
std::vector<double> lengths_at(const Model& m, const std::vector<double>& q) {
  const Zeros zeros(data_bytes<double>(m, DYN_PART_KINEMATICS));
  if (!zeros.memory) throw std::bad_alloc();
  Data<double> d;
  data_layout(m, DYN_PART_KINEMATICS, zeros.memory, d);
  std::copy(q.begin(), q.end(), d.q);
  d.changed(input_q);
  forward_kinematics<0>(m, d);
  measure_paths(m, d);
  return {d.path_length, d.path_length + m.n.paths};
}

}  // namespace

void settle_tendons(Model& m) {
  const double* const initial = m.configurations() + std::ptrdiff_t(m.simulation()->initial) * m.n.nq;
  std::vector<double> q(initial, initial + m.n.nq);
  auto* const paths = const_cast<PathRecord*>(m.paths());
  auto* const tendons = const_cast<TendonRecord*>(m.tendons());
  if (m.n.couplings > 0) {
    const std::vector<double> length = lengths_at(m, q);
    for (PathRecord *p = paths + m.n.tendons, *end = p + m.n.couplings; p != end; ++p) {
      p->neutral[0] = length[std::size_t(p->first)];
      p->neutral[1] = p->elements >= 0 ? length[std::size_t(p->elements)] : 0;
    }
  }
  for (Index i = 1; i < m.n.bodies; ++i)
    if (const Body& b = m.bodies()[i]; !b.follower && primitive_nq(b.type) == 1)
      q[std::size_t(b.user_q)] = m.spring_reference()[b.user_q];
  std::vector<double> length;
  for (Index k = 0; k < m.n.tendons; ++k) {
    double(&rest)[2] = tendons[k].spec.rest;
    if (!std::isnan(rest[0])) continue;
    if (length.empty()) length = lengths_at(m, q);
    rest[0] = rest[1] = length[std::size_t(k)];
  }
}

}  // namespace dyn
