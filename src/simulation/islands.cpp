// Islands: trees connected by constraints. Each is solved on its own.
#include <algorithm>

#include "simulation/step.hpp"

namespace dyn::simulation {

namespace {

Index find(Index* links, Index tree) {
  while (links[tree] != tree) tree = links[tree] = links[links[tree]];
  return tree;
}

}  // namespace

void order_by_islands(const Model& m, Data<double>& d, Index slots) {
  Workspace& w = *d.step;
  Index* links = w.tree_links;
  for (Index k = 0; k < slots; ++k)
    for (const Index tree : {w.active[k].tree1, w.active[k].tree2})
      if (tree >= 0) links[tree] = tree;
  const auto each_path_tree = [&](const ActiveConstraint& x, auto&& f) {
    for (Index n = 0; n < x.support_count; ++n)
      f(w.tree_of[body_of_dof(m, m.has_mimic ? m.own_v()[x.kept.support[n]] : x.kept.support[n])]);
  };
  const auto join = [&](Index tree1, Index tree2) {
    const Index a = find(links, tree1), b = find(links, tree2);
    links[std::max(a, b)] = std::min(a, b);  // the first tree names the island
  };
  for (Index k = 0; k < (m.n.path_rows > 0 ? slots : 0); ++k)
    if (is_path_row(w.active[k])) each_path_tree(w.active[k], [&](Index tree) { links[tree] = tree; });
  for (Index k = 0; k < slots; ++k) {
    const ActiveConstraint& x = w.active[k];
    if (x.tree1 >= 0 && x.tree2 >= 0) join(x.tree1, x.tree2);
  }
  for (Index k = 0; k < (m.n.path_rows > 0 ? slots : 0); ++k)
    if (const ActiveConstraint& x = w.active[k]; is_path_row(x)) each_path_tree(x, [&](Index tree) { join(x.tree1, tree); });
  for (Index k = 0; k < slots; ++k) {
    ActiveConstraint& x = w.active[k];
    x.island = find(links, x.tree1 < 0 ? x.tree2 : x.tree1);
    w.order[k] = k;
  }
  // stable order
  const auto before = [&](Index a, Index b) {
    const ActiveConstraint &x = w.active[a], &y = w.active[b];
    return x.island != y.island ? x.island < y.island : x.kind != y.kind ? x.kind < y.kind : a < b;
  };
  if (!std::is_sorted(w.order, w.order + slots, before)) std::sort(w.order, w.order + slots, before);
}

}  // namespace dyn::simulation
