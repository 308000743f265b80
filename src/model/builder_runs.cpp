// Bodies in chains of one type, and the chains in cache blocks; coordinates in Euclidean spans.
#include <algorithm>

#include "builder_impl.hpp"
#include "joint/list.hpp"

namespace dyn {

void make_runs(const std::vector<Body>& bodies, std::vector<JointRun>& joint_runs, std::vector<CacheBlock>& cache_blocks) {
  const Index n = Index(bodies.size());
  Index end_q = 0;
  std::vector<bool> forks(bodies.size(), false);  // carries a body other than the next one
  for (Index i = 1; i < n; ++i)
    if (bodies[std::size_t(i)].parent != i - 1) forks[std::size_t(bodies[std::size_t(i)].parent)] = true;
  for (Index i = 1; i < n; ++i) {
    const Body& b = bodies[std::size_t(i)];
    const bool block = (i - 1) % CacheBlock::size == 0;
    if (block) cache_blocks.push_back({i, Index(joint_runs.size()), 0, 0, 0});
    if (block || b.type != joint_runs.back().type || b.parent != i - 1 || forks[std::size_t(i - 1)])
      joint_runs.push_back({b.type, i, i, b.parent, b.idx_q, b.idx_v});
    joint_runs.back().last = i + 1;
    CacheBlock& c = cache_blocks.back();
    c.last_run = Index(joint_runs.size());
    visit(b.type, [&]<class J>() {
      if (!J::angle) return;
      if (c.last_q == 0) c.first_q = b.idx_q;
      c.last_q = b.idx_q + 1;
    });
    end_q = b.idx_q + primitive_nq(b.type);
  }
  for (CacheBlock& c : cache_blocks) c.first_q = std::min(c.first_q, (end_q + 7) / 8 * 8 - (c.last_q - c.first_q + 3) / 4 * 4);
}

void make_spans(const std::vector<Body>& bodies, std::vector<EuclideanSpan>& euclidean_spans,
                std::vector<Index>& manifold_joints) {
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const Body& b = bodies[i];
    if (b.follower) continue;
    visit(b.type, [&]<class J>() {
      if (J::nq != J::nv || b.wraps)
        manifold_joints.push_back(Index(i));
      else if (!euclidean_spans.empty() && euclidean_spans.back().first_q + euclidean_spans.back().count == b.user_q &&
          euclidean_spans.back().first_v + euclidean_spans.back().count == b.user_v)
        euclidean_spans.back().count += J::nv;
      else
        euclidean_spans.push_back({b.user_q, b.user_v, J::nv});
    });
  }
}

Index make_dof_groups(const std::vector<Index>& parent, const std::vector<Index>& depth, const std::vector<Index>& end,
                      DofGroup* groups) {
  Index count = 0;
  for (std::size_t k = 0; k < parent.size(); ++k) {
    DofGroup* g = groups + count - 1;
    const bool only_child = k > 0 && parent[k] == Index(k) - 1 && end[k] == end[k - 1];
    if (only_child && g->count < 4) ++g->count;
    else groups[count++] = {Index(k), 1, depth[k], parent[k], end[k]};
  }
  return count;
}

}  // namespace dyn
