// What a new data needs before it can step with contacts, limits and constraints.
#pragma once

#include "dyn/model/data.hpp"

namespace dyn::simulation {

template <class D>
void set_up(const Model& m, D& d) {
  // trees; those that mimic joints couple are one
  d.tree_of[0] = -1;
  for (Index i = 1; i < m.n.bodies; ++i) d.tree_of[i] = m.bodies()[i].parent ? d.tree_of[m.bodies()[i].parent] : i;
  if (m.has_mimic)
    for (Index i = 1; i < m.n.bodies; ++i) {
      const auto leader = std::find_if(m.bodies() + 1, m.bodies() + i, [&](const Body& b) { return b.user_v == m.bodies()[i].user_v; });
      const Index one = d.tree_of[leader - m.bodies()], other = d.tree_of[i];
      if (one != other)
        for (Index k = 1; k < m.n.bodies; ++k)
          if (d.tree_of[k] == other) d.tree_of[k] = one;
    }
  for (Index k = 0; k < m.n.geoms; ++k) d.materials[k] = m.materials()[m.shapes()[m.geoms()[k].shape].material];
  solver::place(*d.contact_workspace, m.n.island_rows(), d.solver_memory);
  d.contact_count = d.contacts_before_count = 0;
}

}  // namespace dyn::simulation
