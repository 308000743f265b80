#include "algorithm/tree_groups.hpp"

namespace dyn {

Index list_trees(const Model& m, Trees* trees) {
  Index count = 0, run = 0;
  for (Index i = 1; i < m.n.bodies; i = m.subtree_end()[i]) {
    const Body& b = m.bodies()[i];
    while (m.joint_runs()[run].first < i) ++run;
    const Index end = m.subtree_end()[i];
    Index end_run = run;
    while (end_run < m.n.joint_runs && m.joint_runs()[end_run].first < end) ++end_run;
    const bool last = end == m.n.bodies;
    trees[count++] = {
        i, end, run, end_run, b.idx_q, last ? m.n.nq : m.bodies()[end].idx_q, b.idx_v, last ? m.n.nv : m.bodies()[end].idx_v};
  }
  return count;
}

ChosenTrees choose_trees(const Model& m, const TreeBuffers& room, Index groups) {
  ChosenTrees a{};
  a.first_run = room.joint_runs, a.first_cache_block = room.cache_blocks, a.first_span = room.euclidean_spans,
  a.first_curved = room.manifold_joints, a.groups = room.groups, a.group_count = groups;
  Index block = 0, span = 0, manifold_joints = 0;
  for (Index k = 0; k < groups; ++k) {
    const Trees& g = room.groups[k];
    for (; block < m.n.cache_blocks && m.cache_blocks()[block].last_run <= g.first_run; ++block) {}
    for (; block < m.n.cache_blocks && m.cache_blocks()[block].first_run < g.end_run; ++block) {
      CacheBlock c = m.cache_blocks()[block];
      const Index first = std::max(c.first_run, g.first_run), last = std::min(c.last_run, g.end_run);
      c.first = m.joint_runs()[first].first, c.first_run = first - g.first_run + a.of_runs,
      c.last_run = last - g.first_run + a.of_runs;
      room.cache_blocks[a.of_chunks++] = c;
      if (m.cache_blocks()[block].last_run > g.end_run) break;  // the next group uses the rest of it
    }
    std::copy(m.joint_runs() + g.first_run, m.joint_runs() + g.end_run, room.joint_runs + a.of_runs),
        a.of_runs += g.end_run - g.first_run;
    for (; span < m.n.euclidean_spans && m.euclidean_spans()[span].first_v + m.euclidean_spans()[span].count <= g.v; ++span) {}
    for (Index l = span; l < m.n.euclidean_spans && m.euclidean_spans()[l].first_v < g.v_end; ++l) {
      const EuclideanSpan& s = m.euclidean_spans()[l];
      const Index begin = std::max(s.first_v, g.v), end = std::min(s.first_v + s.count, g.v_end);
      room.euclidean_spans[a.of_spans++] = {s.first_q + (begin - s.first_v), begin, end - begin};
    }
    for (; manifold_joints < m.n.manifold_joints && m.manifold_joints()[manifold_joints] < g.first; ++manifold_joints) {}
    for (; manifold_joints < m.n.manifold_joints && m.manifold_joints()[manifold_joints] < g.end; ++manifold_joints)
      room.manifold_joints[a.of_curved++] = m.manifold_joints()[manifold_joints];
  }
  return a;
}

}  // namespace dyn
