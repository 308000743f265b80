// What recursions and queries go along: chains of one joint type, vector spaces, limits, subtrees, ids by name.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/sincos.hpp"
#include "builder_compile.hpp"

namespace dyn {

void Compiler::add_runs() {
  make_runs(a.bodies, a.joint_runs, a.cache_blocks);
  n.joint_runs = Index(a.joint_runs.size()), n.cache_blocks = Index(a.cache_blocks.size());
  make_spans(a.bodies, a.euclidean_spans, a.manifold_joints);
  n.euclidean_spans = Index(a.euclidean_spans.size()), n.manifold_joints = Index(a.manifold_joints.size());
  n.tendons = Index(in.tendons.size()), n.couplings = Index(in.couplings.size());
  for (const ActuatorRecord& r : actuators_of(in.actuators, in.force_limits, id, a.joints, a.euclidean_spans, n)) {
    a.actuators.push_back(r);
    a.actuators.back().name = text.add(in.actuators[a.actuators.size() - 1].name);
  }
}

void Compiler::add_limits() {
  for (const EuclideanSpan& s : a.euclidean_spans)
    for (Index k = 0; k < s.count; ++k) {
      const Index q = s.first_q + k, v = s.first_v + k;
      if (!std::isfinite(a.lower_limit[std::size_t(q)]) && !std::isfinite(a.upper_limit[std::size_t(q)])) continue;
      const Index dof = n.mimic_v ? a.own_v[std::size_t(v)] : v;
      const auto after = std::upper_bound(a.bodies.begin() + 1, a.bodies.end(), dof,
                                          [](Index v, const Body& b) { return v < b.idx_v; });
      a.limits.push_back({q, Index(after - a.bodies.begin()) - 1, dof});
    }
  for (Index i = 1; i < n.bodies; ++i)
    if (const Body& b = a.bodies[std::size_t(i)]; b.type == BodyType::Spherical && a.lower_limit[std::size_t(b.user_q) + 3] >= 0)
      a.limits.push_back({b.user_q + 3, i, b.idx_v});
  n.limits = Index(a.limits.size());
  for (const CacheBlock& c : a.cache_blocks) n.sweep = std::max(n.sweep, padded_sweep(c.last_q - c.first_q));
}

void Compiler::add_subtrees() {
  a.subtree_end.assign(std::size_t(n.bodies), 0);
  for (Index i = n.bodies - 1; i >= 0; --i) {
    Index& end = a.subtree_end[std::size_t(i)];
    end = std::max(end, i + 1);
    if (i) {
      Index& up = a.subtree_end[std::size_t(a.bodies[std::size_t(i)].parent)];
      up = std::max(up, end);
    }
  }
  a.dof_end.assign(std::size_t(n.nvx + 3) / 4 * 4, 0);
  for (Index i = 1; i < n.bodies; ++i) {
    const Body& b = a.bodies[std::size_t(i)];
    const Index next = a.subtree_end[std::size_t(i)];
    for (int k = 0; k < primitive_nv(b.type); ++k)
      a.dof_end[std::size_t(b.idx_v + k)] = next < n.bodies ? a.bodies[std::size_t(next)].idx_v : n.nvx;
  }
  for (auto e = a.dof_end.begin(); e != a.dof_end.end(); e += 4)
    a.band_full.push_back(*std::min_element(e, e + 4)), a.band_end.push_back(*std::max_element(e, e + 4));
}

void Compiler::sort_names() {
  auto precedence = [&](Index k) { return a.frames[std::size_t(k)].type == DYN_FRAME_TYPE_BODY ? 1 : 0; };
  a.joints_by_name.resize(std::size_t(n.joints)), a.frames_by_name.resize(std::size_t(n.frames));
  std::iota(a.joints_by_name.begin(), a.joints_by_name.end(), 0);
  std::iota(a.frames_by_name.begin(), a.frames_by_name.end(), 0);
  const char* pool = text.pool.data();
  std::sort(a.joints_by_name.begin(), a.joints_by_name.end(), [&](Index x, Index y) {
    return std::strcmp(pool + a.joints[std::size_t(x)].name, pool + a.joints[std::size_t(y)].name) < 0;
  });
  std::sort(a.frames_by_name.begin(), a.frames_by_name.end(), [&](Index x, Index y) {
    const int c = std::strcmp(pool + a.frames[std::size_t(x)].name, pool + a.frames[std::size_t(y)].name);
    return c != 0 ? c < 0 : precedence(x) < precedence(y);
  });
}

void Compiler::close_text() {
  name = text.add(in.name);
  a.text.assign(text.pool.begin(), text.pool.end());
  n.text = Index(a.text.size());
}

}  // namespace dyn
