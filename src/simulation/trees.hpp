// Trees of bodies: islands consist of whole ones, and a step goes through those that it is asked to.
#pragma once

#include "algorithm/passes.hpp"

namespace dyn::simulation {

// Trees of bodies side by side, with all of their coordinates.
struct Trees {
  Index first, end;  // bodies
  Index first_run, end_run;
  Index q, q_end, v, v_end;
};

// Those that a step goes through.
struct AllTrees : WholeModel {
  template <class F>
  static void for_each_group(const Model& m, F&& f) { f(Trees{1, m.n.bodies, 0, m.n.runs, 0, m.n.nq, 0, m.n.nv}); }
};
struct ChosenTrees : SomeTrees {
  const Trees* groups;
  Index group_count;
  template <class F>
  void for_each_group(const Model&, F&& f) const {
    for (Index k = 0; k < group_count; ++k) f(groups[k]);
  }
};

// Room for what chosen trees consist of.
struct TreeBuffers {
  JointRun* runs;
  CacheBlock* chunks;
  Trees* groups;
  EuclideanSpan* spans;
  Index* curved;
};
template <class F>
void for_each_array(const Model& m, TreeBuffers& r, F&& f) {
  f(r.runs, m.n.runs), f(r.chunks, m.n.chunks + m.n.bodies), f(r.groups, m.n.bodies), f(r.spans, m.n.spans + m.n.bodies), f(r.curved, m.n.curved);
}

// One by one, ascending; of a model without mimic joints. Answers how many.
Index list_trees(const Model& m, Trees* trees);

// Those of `groups`, which are room.groups: neighbours together, ascending.
ChosenTrees choose(const Model& m, const TreeBuffers& room, Index groups);

// The next tree becomes one of `groups`, of which there are so many.
inline void append(const Trees& t, Trees* groups, Index& count) {
  if (count > 0 && groups[count - 1].end == t.first) {
    Trees& g = groups[count - 1];
    g.end = t.end, g.end_run = t.end_run, g.q_end = t.q_end, g.v_end = t.v_end;
  } else {
    groups[count++] = t;
  }
}

}  // namespace dyn::simulation
