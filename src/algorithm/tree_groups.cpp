#include "algorithm/tree_groups.hpp"

namespace dyn {

Index list_trees(const Model& m, Trees* trees) {
  Index count = 0, run = 0;
  for (Index i = 1; i < m.n.bodies; i = m.subtree_end()[i]) {
    const Body& b = m.bodies()[i];
    while (m.runs()[run].first < i) ++run;
    const Index end = m.subtree_end()[i];
    Index end_run = run;
    while (end_run < m.n.runs && m.runs()[end_run].first < end) ++end_run;
    const bool last = end == m.n.bodies;
    trees[count++] = {i, end, run, end_run, b.idx_q, last ? m.n.nq : m.bodies()[end].idx_q, b.idx_v, last ? m.n.nv : m.bodies()[end].idx_v};
  }
  return count;
}

ChosenTrees choose_trees(const Model& m, const TreeBuffers& room, Index groups) {
  ChosenTrees a{};
  a.first_run = room.runs, a.first_chunk = room.chunks, a.first_span = room.spans, a.first_curved = room.curved, a.groups = room.groups, a.group_count = groups;
  Index chunk = 0, span = 0, curved = 0;
  for (Index k = 0; k < groups; ++k) {
    const Trees& g = room.groups[k];
    for (; chunk < m.n.chunks && m.chunks()[chunk].last_run <= g.first_run; ++chunk) {}
    for (; chunk < m.n.chunks && m.chunks()[chunk].first_run < g.end_run; ++chunk) {
      CacheBlock c = m.chunks()[chunk];
      const Index first = std::max(c.first_run, g.first_run), last = std::min(c.last_run, g.end_run);
      c.first = m.runs()[first].first, c.first_run = first - g.first_run + a.of_runs, c.last_run = last - g.first_run + a.of_runs;
      room.chunks[a.of_chunks++] = c;
      if (m.chunks()[chunk].last_run > g.end_run) break;  // the next group uses the rest of it
    }
    std::copy(m.runs() + g.first_run, m.runs() + g.end_run, room.runs + a.of_runs), a.of_runs += g.end_run - g.first_run;
    for (; span < m.n.spans && m.spans()[span].first_v + m.spans()[span].count <= g.v; ++span) {}
    for (Index l = span; l < m.n.spans && m.spans()[l].first_v < g.v_end; ++l) {
      const EuclideanSpan& s = m.spans()[l];
      const Index begin = std::max(s.first_v, g.v), end = std::min(s.first_v + s.count, g.v_end);
      room.spans[a.of_spans++] = {s.first_q + (begin - s.first_v), begin, end - begin};
    }
    for (; curved < m.n.curved && m.curved()[curved] < g.first; ++curved) {}
    for (; curved < m.n.curved && m.curved()[curved] < g.end; ++curved) room.curved[a.of_curved++] = m.curved()[curved];
  }
  return a;
}

}  // namespace dyn
