// Bodies in chains of one type, and the chains in chunks; coordinates in spans.
#include <algorithm>

#include "builder_impl.hpp"
#include "joint/list.hpp"

namespace dyn {

void make_runs(const std::vector<Body>& bodies, std::vector<JointRun>& runs, std::vector<CacheBlock>& chunks) {
  const Index n = Index(bodies.size());
  Index end_q = 0;
  std::vector<bool> forks(bodies.size(), false);  // carries a body other than the next one
  for (Index i = 1; i < n; ++i)
    if (bodies[std::size_t(i)].parent != i - 1) forks[std::size_t(bodies[std::size_t(i)].parent)] = true;
  for (Index i = 1; i < n; ++i) {
    const Body& b = bodies[std::size_t(i)];
    const bool chunk = (i - 1) % CacheBlock::size == 0;
    if (chunk) chunks.push_back({i, Index(runs.size()), 0, 0, 0});
    if (chunk || b.type != runs.back().type || b.parent != i - 1 || forks[std::size_t(i - 1)])
      runs.push_back({b.type, i, i, b.parent, b.idx_q, b.idx_v});
    runs.back().last = i + 1;
    CacheBlock& c = chunks.back();
    c.last_run = Index(runs.size());
    visit(b.type, [&]<class J>() {
      if (!J::angle) return;
      if (c.last_q == 0) c.first_q = b.idx_q;
      c.last_q = b.idx_q + 1;
    });
    end_q = b.idx_q + primitive_nq(b.type);
  }
  for (CacheBlock& c : chunks) c.first_q = std::min(c.first_q, (end_q + 7) / 8 * 8 - (c.last_q - c.first_q + 3) / 4 * 4);
}

void make_spans(const std::vector<Body>& bodies, std::vector<EuclideanSpan>& spans, std::vector<Index>& curved) {
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const Body& b = bodies[i];
    if (b.follower) continue;
    visit(b.type, [&]<class J>() {
      if (J::nq != J::nv || b.wraps)
        curved.push_back(Index(i));
      else if (!spans.empty() && spans.back().first_q + spans.back().count == b.user_q && spans.back().first_v + spans.back().count == b.user_v)
        spans.back().count += J::nv;
      else
        spans.push_back({b.user_q, b.user_v, J::nv});
    });
  }
}

Index make_dof_groups(const std::vector<Index>& parent, const std::vector<Index>& depth, const std::vector<Index>& end, DofGroup* groups) {
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
