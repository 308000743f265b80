#include "simulation/island.hpp"

namespace dyn::simulation {

void find_segments(const Model& m, Segments& s) {
  const Index *parent = m.dof_parent(), *forks = m.dof_forks();
  Index begin = 0;
  s.count = 0;
  for (Index k = 0; k < m.n.nv; ++k) {
    if (k == 0 || parent[k] != k - 1 || forks[k - 1] || k - begin == segment_size) s.first[s.count++] = begin = k;
    s.of[k] = s.count - 1;
  }
  s.first[s.count] = m.n.nv;
}

// Supporting degrees of freedom descend, so those of a segment are consecutive.
bool Elimination::find_runs(const Island& x) {
  const Segments& s = x.w.segments;
  Index count = 0;
  for (Index k = 0; k < x.constraint_count; ++k) {
    const Index* const support = x.rows_of(k).support;
    for (Index n = 0; n < x.constraint(k).support_count; ++n) local[s.of[support[n]]] = -1;
  }
  size = 0;
  Index lanes = 0;
  for (Index k = 0; k < x.constraint_count; ++k) {
    const ActiveConstraint& a = x.constraint(k);
    const Index* const support = x.rows_of(k).support;
    first_run[k] = count;
    for (Index n = 0, last = -1; n < a.support_count; ++n) {
      const Index now = s.of[support[n]];
      if (now == last) continue;
      if (count == max_runs || (lanes += a.rows) > max_row_lanes) return false;
      last = now;
      if (local[now] < 0) segment[size] = now, first_of[size] = -1, local[now] = size++;
      runs[count] = {local[now], k, nullptr};
      next_of[count] = first_of[local[now]], first_of[local[now]] = count;
      ++count;
    }
  }
  first_run[x.constraint_count] = count;
  return true;
}

// A list node is a run (of its constraint) or max_runs + e (of the position of entry e).
template <class F>
void Elimination::for_each_listed(Index constraints, Index list, F&& f) const {
  if (list < constraints) for_each_run(list, [&](const ConstraintRun& r) { f(r.segment); });
  else
    for (Index e = first[list - constraints]; e < first[list - constraints + 1]; ++e) f(later[e]);
}

void Elimination::link(Index s) {
  const Index next = of_degree[degree[s]];
  before[s] = -1, after[s] = next, of_degree[degree[s]] = s;
  if (next >= 0) before[next] = s;
}

void Elimination::unlink(Index s) {
  if (after[s] >= 0) before[after[s]] = before[s];
  if (before[s] >= 0) after[before[s]] = after[s];
  else of_degree[degree[s]] = after[s];
}

// A constraint with the same segments as the one before adds nothing.
void Elimination::begin(Index constraints) {
  for (Index s = 0; s < size; ++s) lists[s] = mark[s] = of_degree[s] = -1;
  for (Index k = 0; k < constraints; ++k) {
    const Index n = first_run[k + 1] - first_run[k];
    const ConstraintRun* own = runs + first_run[k];
    const auto same_segment = [](const ConstraintRun& a, const ConstraintRun& b) { return a.segment == b.segment; };
    merged[k] = k > 0 && first_run[k] - first_run[k - 1] == n && std::equal(own, own + n, own - n, same_segment);
    for (Index r = first_run[k]; r < first_run[k + 1] && !merged[k]; ++r)
      next_list[r] = lists[runs[r].segment], lists[runs[r].segment] = r;
  }
  for (Index s = size - 1; s >= 0; --s) degree[s] = count(constraints, s, s), link(s);
  std::fill_n(mark, size, -1);
}

// Returns the degree of s and drops merged lists from its own.
Index Elimination::count(Index constraints, Index s, Index stamp) {
  Index sum = 0;
  mark[s] = stamp;
  for (Index *at = &lists[s], node; (node = *at) >= 0;) {
    const Index list = node < max_runs ? runs[node].constraint : constraints + earlier[node - max_runs];
    if (merged[list]) {
      *at = next_list[node];
      continue;
    }
    for_each_listed(constraints, list, [&](Index t) {
      if (mark[t] != stamp) mark[t] = stamp, ++sum;
    });
    at = &next_list[node];
  }
  return sum;
}

bool Elimination::eliminate(Index constraints, Index s, Index step) {
  unlink(s);
  order[step] = s, position[s] = step;
  Index fill = first[step];
  mark[s] = step;
  for (Index node = lists[s]; node >= 0; node = next_list[node]) {
    const Index list = node < max_runs ? runs[node].constraint : constraints + earlier[node - max_runs];
    if (merged[list]) continue;
    bool fits = true;
    for_each_listed(constraints, list, [&](Index t) {
      if (mark[t] == step) return;
      if (fill == max_entries) fits = false;
      else mark[t] = step, earlier[fill] = step, later[fill++] = t;
    });
    if (!fits) return false;
    merged[list] = true;
  }
  first[step + 1] = fill, merged[constraints + step] = false;
  for (Index e = first[step]; e < fill; ++e) {
    const Index t = later[e];
    next_list[max_runs + e] = lists[t], lists[t] = max_runs + e;
  }
  return true;
}

bool Elimination::find_order(const Island& x) {
  begin(x.constraint_count);
  first[0] = 0;
  Index least = 0, stamp = size;
  for (Index step = 0; step < size; ++step) {
    while (of_degree[least] < 0) ++least;
    if (!eliminate(x.constraint_count, of_degree[least], step)) return false;
    for (Index e = first[step]; e < first[step + 1]; ++e) {
      const Index t = later[e];
      unlink(t);
      degree[t] = count(x.constraint_count, t, stamp++), link(t);
      least = std::min(least, degree[t]);
    }
  }
  for (Index e = 0; e < first[size]; ++e) later[e] = position[later[e]];
  sort(), renumber(x.constraint_count);
  return true;
}

// From now on segments are numbered by position.
void Elimination::renumber(Index constraints) {
  Index* const old = degree;
  std::copy_n(segment, size, old);
  for (Index p = 0; p < size; ++p) segment[p] = old[order[p]];
  std::copy_n(first_of, size, old);
  for (Index p = 0; p < size; ++p) first_of[p] = old[order[p]];
  for (Index r = 0; r < first_run[constraints]; ++r) runs[r].segment = position[runs[r].segment];
}

// Two transpositions sort the entries of each position.
void Elimination::sort() {
  const Index n = size;
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
