// Mimic joints: who leads whom, and the sparsity of M that follows from it.
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "builder_impl.hpp"
#include "model/data.hpp"

namespace dyn {

// Follows mimic of mimic to the joint that moves by itself.
std::vector<Leader> resolve_mimic(const std::vector<JointEntry>& joints) {
  std::unordered_map<std::string, int> index;
  for (std::size_t j = 0; j < joints.size(); ++j) index[joints[j].spec.name] = int(j);
  const int n = int(joints.size());
  std::vector<Leader> leader(joints.size(), {-2, 1, 0});  // -2: not resolved yet
  std::vector<int> path;
  for (int j = 0; j < n; ++j) {
    path.clear();
    int at = j;
    while (leader[std::size_t(at)].joint == -2 && !joints[std::size_t(at)].spec.mimic.empty()) {
      if (int(path.size()) > n || std::find(path.begin(), path.end(), at) != path.end())
        throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(at)].spec.name +
                                           "': mimic goes round in a circle: one joint of it must move by itself");
      path.push_back(at);
      const JointSpec& s = joints[std::size_t(at)].spec;
      const auto it = index.find(s.mimic);
      if (it == index.end())
        throw Error(DYN_ERROR_NAME, "joint '" + s.name + "': mimics '" + s.mimic + "', which is no moving joint of this model");
      at = it->second;
      if (path.size() > 1000) throw Error(DYN_ERROR_LIMIT, "joint '" + s.name + "': mimic of mimic more than 1000 deep");
    }
    Leader base = leader[std::size_t(at)];
    if (base.joint < 0) base = {at, 1, 0};
    if (path.empty()) {
      if (leader[std::size_t(at)].joint == -2) leader[std::size_t(at)].joint = -1;
      continue;
    }
    if (spec_nq(joints[std::size_t(base.joint)].spec) != 1)
      throw Error(DYN_ERROR_INVALID, "joint '" + joints[std::size_t(j)].spec.name + "': mimics '" +
                                         joints[std::size_t(base.joint)].spec.name +
                                         "', which has more than one coordinate: only joints with one can lead");
    for (auto k = path.rbegin(); k != path.rend(); ++k) {
      const JointSpec& s = joints[std::size_t(*k)].spec;
      base = {base.joint, s.mimic_ratio * base.ratio, s.mimic_ratio * base.offset + s.mimic_offset};
      leader[std::size_t(*k)] = base;
    }
  }
  for (Leader& l : leader)
    if (l.joint == -2) l.joint = -1;
  return leader;
}

constexpr std::size_t limit = 50000000;  // entries of the pattern of M
constexpr const char* too_filled =
    "the model has too many mimic joints for its depth: M has no sparse factor; bind fewer joints by mimic";

// Gives degrees of freedom more ancestors, which is some zeros more in the factor, until the descendants of each follow it in
// number.
static void close_subtrees(std::vector<Index>& parent) {
  for (Index k = Index(parent.size()) - 1; k > 0; --k) {
    Index below = k - 1, above = parent[std::size_t(k)];  // to be its ancestor
    while (0 <= above && above < below) {
      while (parent[std::size_t(below)] > above) below = parent[std::size_t(below)];
      const Index before = std::exchange(parent[std::size_t(below)], above);
      if (before == above) break;
      below = above, above = before;
    }
  }
}

// Elimination tree of M (Liu 1990): with mimic joints the pattern is that of G^T M_x G.
void elimination_tree(const Model& m, std::vector<Index>& parent) {
  const Index nv = m.n.nv;
  parent.assign(std::size_t(nv), -1);
  const Body* bodies = m.bodies();
  if (!m.has_mimic) {
    std::vector<Index> last(std::size_t(m.n.bodies), -1);  // last degree of freedom at or above a body
    for (Index i = 1; i < m.n.bodies; ++i) {
      Index before = last[std::size_t(bodies[i].parent)];
      const Index end = i + 1 < m.n.bodies ? bodies[i + 1].idx_v : nv;
      for (Index k = bodies[i].idx_v; k < end; ++k) parent[std::size_t(k)] = before, before = k;
      last[std::size_t(i)] = before;
    }
    return;
  }
  // It is enough to join each degree of freedom with what carries it, up to the first that is no follower, and the leader of
  // a follower with all that hangs on the follower: elimination fills in the rest.
  std::vector<std::vector<Index>> row(static_cast<std::size_t>(nv));  // columns j < i of each row
  std::size_t joined = 0;
  auto join = [&](Index a, Index b) {
    if (a != b) row[std::size_t(std::max(a, b))].push_back(std::min(a, b));
    if (++joined > limit) throw Error(DYN_ERROR_LIMIT, too_filled);
  };
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = bodies[i];
    const Index nvb = first_dof(m, i + 1) - b.idx_v;
    for (Index k = 1; k < nvb; ++k) join(b.user_v + k, b.user_v + k - 1);
    for (Index s = b.parent; s != 0; s = bodies[s].parent) {
      for (Index k = 0; k < nvb; ++k)
        for (Index x = 0; x < first_dof(m, s + 1) - bodies[s].idx_v; ++x) join(b.user_v + k, bodies[s].user_v + x);
      if (!bodies[s].follower) break;
    }
    if (b.follower)
      for (Index k = first_dof(m, i + 1); k < first_dof(m, m.subtree_end()[i]); ++k) join(b.user_v, m.expand_v()[k]);
  }
  std::size_t filled = 0;
  for (Index i = nv - 1; i >= 0; --i) {
    auto& r = row[std::size_t(i)];
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
    if (r.empty()) continue;
    parent[std::size_t(i)] = r.back();
    auto& up = row[std::size_t(r.back())];
    up.insert(up.end(), r.begin(), r.end() - 1);
    if ((filled += r.size()) > limit) throw Error(DYN_ERROR_LIMIT, too_filled);
    std::vector<Index>().swap(r);
  }
  close_subtrees(parent);
}

}  // namespace dyn
