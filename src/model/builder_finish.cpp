// Compiles what a builder has collected into a model: depth-first order, internal frames with z along each axis, merged
// inertias, the expanded coordinates of mimic joints, and one block of memory.
#include <algorithm>

#include "builder_compile.hpp"

namespace dyn {

Compiler::Compiler(const Builder::Impl& impl) : in(impl), order(depth_first(in.joints)), leaders(resolve_mimic(in.joints)), id(in.joints.size()) {
  for (std::size_t k = 0; k < order.size(); ++k) id[std::size_t(order[k])] = Index(k + 1);
  n.joints = Index(order.size() + 1);
}

ModelPtr Builder::finish() const {
  Compiler c(*impl);
  c.add_universe();
  c.assign_coordinates();
  c.size_coordinate_arrays();
  c.add_joints();
  c.add_frames();
  c.add_wanted_pairs();
  c.add_shapes();
  c.add_pairs();
  c.add_reports();
  c.add_constraints();
  c.add_configurations();
  c.add_runs();
  c.add_configuration_states();
  c.add_limits();
  c.add_subtrees();
  c.sort_names();
  c.close_text();

  c.allocate();
  c.fill_header();
  c.copy_arrays();
  c.settle_configurations();
  c.fill_elimination_tree();

  Model& m = *c.model;
  check_dynamics(m, c.order, impl->joints, impl->frames);
  check_constraints(m);
  if (lists_pairs(m)) {
    judge_pairs(m, c.array<PairRecord>(Model::Field::pairs));
    if (c.has_pair_report() && !tests_nothing(m)) --m.n.reports;
    m.n.contacts = Index(contact_capacity_of(m, 0));
    return std::move(c.model);
  }
  // pairs that overlap are listed: once more, with them
  if (GeomPairs found = dyn::overlapping(m); !found.empty()) {
    found.insert(found.end(), impl->overlapping.begin(), impl->overlapping.end());
    impl->overlapping = std::move(found);
    ModelPtr again = finish();
    impl->overlapping.clear();
    return again;
  }
  const Arrays& a = c.a;
  const auto moving = std::count_if(a.geoms.begin(), a.geoms.end(), [&](const GeomRecord& g) {
    return a.frames[std::size_t(a.shapes[std::size_t(g.shape)].frame)].joint > 0;
  });
  m.n.contacts = Index(contact_capacity_of(m, moving));
  return std::move(c.model);
}

}  // namespace dyn
