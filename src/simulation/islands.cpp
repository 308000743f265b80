// Islands: trees that slots connect. Each is a problem of its own.
#include <algorithm>

#include "dyn/simulation/step.hpp"

namespace dyn::simulation {

namespace {

Index find(Index* links, Index tree) {
  while (links[tree] != tree) tree = links[tree] = links[links[tree]];
  return tree;
}

}  // namespace

void order_by_islands(const Model& m, Data<double>& d, Index slots) {
  Index* links = d.tree_links;
  for (Index i = 0; i < m.n.bodies; ++i) links[i] = i;
  for (Index k = 0; k < slots; ++k) {
    const ActiveSlot& x = d.active_slots[k];
    if (x.tree1 < 0 || x.tree2 < 0) continue;
    const Index a = find(links, x.tree1), b = find(links, x.tree2);
    links[std::max(a, b)] = std::min(a, b);  // named by its first tree
  }
  for (Index k = 0; k < slots; ++k) {
    ActiveSlot& x = d.active_slots[k];
    x.island = find(links, x.tree1 < 0 ? x.tree2 : x.tree1);
    d.slot_order[k] = k;
  }
  // stable by the numbers of the slots
  std::sort(d.slot_order, d.slot_order + slots, [&](Index a, Index b) {
    const ActiveSlot &x = d.active_slots[a], &y = d.active_slots[b];
    return x.island != y.island ? x.island < y.island : x.kind != y.kind ? x.kind < y.kind : a < b;
  });
}

}  // namespace dyn::simulation
