// Kinematic trees: islands consist of whole trees, and a step visits only the trees it is asked for.
#pragma once

#include "algorithm/passes.hpp"

namespace dyn {

// Consecutive trees with all of their coordinates.
struct Trees {
  Index first, end;  // bodies
  Index first_run, end_run;
  Index q, q_end, v, v_end;
};

// The trees that a step visits.
struct AllTrees : WholeModel {
  template <class F>
  static void for_each_group(const Model& m, F&& f) { f(Trees{1, m.n.bodies, 0, m.n.joint_runs, 0, m.n.nq, 0, m.n.nv}); }
};
struct ChosenTrees : SomeTrees {
  const Trees* groups;
  Index group_count;
  template <class F>
  void for_each_group(const Model&, F&& f) const {
    for (Index k = 0; k < group_count; ++k) f(groups[k]);
  }
};

// Calls f(first, end) for the user's degrees of freedom of the trees.
template <class Part, class F>
void for_each_dof_range(const Model& m, const Part& part, F&& f) {
  if constexpr (std::is_base_of_v<SomeTrees, Part>) part.for_each_group(m, [&](const Trees& t) { f(t.v, t.v_end); });
  else f(Index(0), m.n.nv);
}

// Buffers of a choice of trees.
struct TreeBuffers {
  JointRun* joint_runs;
  CacheBlock* cache_blocks;
  Trees* groups;
  EuclideanSpan* euclidean_spans;
  Index* manifold_joints;
};
template <class F>
void for_each_array(const Model& m, TreeBuffers& r, F&& f) {
  f(r.joint_runs, m.n.joint_runs), f(r.cache_blocks, m.n.cache_blocks + m.n.bodies), f(r.groups, m.n.bodies),
      f(r.euclidean_spans, m.n.euclidean_spans + m.n.bodies), f(r.manifold_joints, m.n.manifold_joints);
}

// Lists the trees of a model without mimic joints in ascending order. Returns their number.
Index list_trees(const Model& m, Trees* trees);

// Builds the choice from `groups` groups of buffers.groups, which are in ascending order.
ChosenTrees choose_trees(const Model& m, const TreeBuffers& room, Index groups);

// Appends a tree to `groups`; adjacent trees form one group.
inline void append_tree(const Trees& t, Trees* groups, Index& count) {
  if (count > 0 && groups[count - 1].end == t.first) {
    Trees& g = groups[count - 1];
    g.end = t.end, g.end_run = t.end_run, g.q_end = t.q_end, g.v_end = t.v_end;
  } else {
    groups[count++] = t;
  }
}

}  // namespace dyn
