#include "dyn/simulation/island.hpp"

#include <climits>

namespace dyn::simulation {

namespace {
constexpr Index gone = INT_MAX;
}

bool Elimination::operator()(const Island& x) {
  const Index n = x.slots;
  auto each_end = [&](auto&& f) {
    for (Index k = 0; k < n; ++k) {
      const ActiveSlot& s = x.slot(k);
      f(2 * k, tree_a(s));
      if (tree_b(s) >= 0) f(2 * k + 1, tree_b(s));
    }
  };
  each_end([&](Index, Index t) { head[t] = tail[t] = -1, links[t] = t, count[t] = 0; });
  each_end([&](Index end, Index t) {  // in the slots' order
    next[end] = -1, ++count[t];
    if (tail[t] < 0) head[t] = end;
    else next[tail[t]] = end;
    tail[t] = end;
  });
  each_end([&](Index end, Index t) { shared[end] = next[end], first_head[t] = head[t]; });
  for (Index k = 0; k < n; ++k) {
    const Index b = tree_b(x.slot(k));
    degree[k] = count[tree_a(x.slot(k))] + (b < 0 ? 0 : count[b]);
    position[k] = -1;
  }
  first[0] = 0;
  for (Index step = 0; step < n; ++step)
    if (!contract(x, step)) return false;
  for (Index e = 0; e < first[n]; ++e) later[e] = position[later[e]];
  sort(n);
  return true;
}

bool Elimination::contract(const Island& x, Index step) {
  Index k = 0;
  for (Index i = 1; i < x.slots; ++i)
    if (degree[i] < degree[k]) k = i;
  const Index b_tree = tree_b(x.slot(k)), A = find(tree_a(x.slot(k))), B = b_tree < 0 ? A : find(b_tree);
  order[step] = k, position[k] = step, degree[k] = gone;
  // the slots that remain, once each, are those of the tree that both become
  Index fill = first[step], last = -1, kept = 0;
  const Index room = most_entries;
  bool fits = true;
  auto take = [&](Index end) {
    for (Index after; end >= 0; end = after) {
      after = next[end];
      const Index s = end / 2;
      if (degree[s] >= gone - 1) continue;  // eliminated, or taken
      if (fill == room) {
        fits = false;
        return;
      }
      later[fill++] = s, degree[s] = gone - 1, ++kept;
      if (last < 0) head[A] = end;
      else next[last] = end;
      last = end, next[end] = -1;
    }
  };
  const Index a_head = head[A], b_head = head[B];
  head[A] = -1;
  take(a_head);
  if (A != B) take(b_head);
  if (!fits) return false;
  links[B] = A, count[A] = kept;
  for (Index e = first[step]; e < fill; ++e) {
    const ActiveSlot& s = x.slot(later[e]);
    const Index a = find(tree_a(s)), b = tree_b(s) < 0 ? a : find(tree_b(s));
    degree[later[e]] = a == b ? count[a] : count[a] + count[b];
  }
  first[step + 1] = fill;
  return true;
}

// Twice transposed, lists are ascending.
void Elimination::sort(Index n) {
  std::fill_n(first_in, n + 2, 0);
  for (Index e = 0; e < first[n]; ++e) ++first_in[later[e] + 2];
  for (Index p = 0; p < n; ++p) first_in[p + 2] += first_in[p + 1];
  for (Index p = 0; p < n; ++p)
    for (Index e = first[p]; e < first[p + 1]; ++e) in[first_in[later[e] + 1]++] = p;
  Index* at = degree;
  std::copy_n(first, n, at);
  for (Index q = 0; q < n; ++q)
    for (Index i = first_in[q]; i < first_in[q + 1]; ++i) {
      const Index p = in[i], e = at[p]++;
      later[e] = q, earlier[e] = p, in[i] = e;
    }
}

}  // namespace dyn::simulation
