// Compliances of a model, by what they are of.
#include <algorithm>

#include "builder_compile.hpp"

namespace dyn {

void Compiler::add_compliances() {
  if (!in.compliant || mimic) return;  // no MJCF file makes mimic joints
  const auto add = [&](const Compliance& law) {
    a.compliances.push_back({law, {0, 0}, in.impratio, in.pyramidal ? 1.0 : 0.0});
  };
  for (const GeomRecord& g : a.geoms) add(in.shapes[std::size_t(g.shape)].shape.compliance);
  for (const LimitRecord& r : a.limits)
    add(in.joints[std::size_t(order[std::size_t(a.bodies[std::size_t(r.body)].joint) - 1])].spec.compliance);
  for (const ConstraintEntry& c : in.constraints) add(c.compliance);
  for (const TendonEntry& t : in.tendons) add(t.compliance);
  for (const TendonCoupling& c : in.couplings) add(c.compliance);
  for (const Compliance& c : material_compliances) add(c);
  for (std::size_t j = 1; j < a.joints.size(); ++j)
    for (Index k = 0; k < a.joints[j].nv; ++k) add(in.joints[std::size_t(order[j - 1])].spec.friction_compliance);
  for (const TendonEntry& t : in.tendons) add(t.friction_compliance);
  n.friction_rows = Index(std::count_if(a.friction.begin(), a.friction.end(), [](double x) { return x > 0; }));
  n.compliances = Index(a.compliances.size());
}

}  // namespace dyn
