// Compiles what a builder has collected into a model: depth-first order, internal frames with z along each axis, merged
// inertias, the expanded coordinates of mimic joints, and one block of memory.
#include <algorithm>

#include "builder_compile.hpp"
#include "model/contact_capacity.hpp"

namespace dyn {

Compiler::Compiler(const Builder::Impl& impl, const Findings& findings)
    : in(impl), known(findings), order(depth_first(in.joints)), leaders(resolve_mimic(in.joints)), id(in.joints.size()) {
  for (std::size_t k = 0; k < order.size(); ++k) id[std::size_t(order[k])] = Index(k + 1);
  n.joints = Index(order.size() + 1);
}

ModelPtr Compiler::compile() {
  add_universe();
  assign_coordinates();
  size_coordinate_arrays();
  add_joints();
  add_frames();
  add_wanted_pairs();
  add_shapes();
  add_ellipsoids();
  add_pairs();
  add_reports();
  add_constraints();
  add_configurations();
  add_runs();
  add_configuration_states();
  add_paths();
  add_sensors();
  add_limits();
  add_compliances();
  add_subtrees();
  sort_names();
  close_text();

  allocate();
  fill_header();
  copy_arrays();
  settle_configurations();
  fill_elimination_tree();
  fill_path_dofs();

  massless = check_dynamics(*model, order, in.joints, in.frames, in.allow_massless);
  check_constraints(*model);
  if (model->n.paths > 0) settle_tendons(*model);
  if (model->n.compliances > 0) settle_compliances(*model);
  model->n.contacts = Index(contact_capacity_of(*model));
  return std::move(model);
}

ModelPtr Builder::finish() const {
  const Findings none;
  Compiler first(*impl, none);
  ModelPtr model = first.compile();
  Findings found;
  found.overlapping = dyn::overlapping(*model, found.all_looked_at), found.massless = first.massless;
  return found.overlapping.empty() && found.massless.empty() ? std::move(model) : Compiler(*impl, found).compile();
}

}  // namespace dyn
