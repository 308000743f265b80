// Joints, bodies, coordinates, and what is derived from their order.
#include <algorithm>

#include "block_check.hpp"
#include "base/sincos.hpp"
#include "joint/kinds.hpp"
#include "model/data.hpp"
#include "table/enums.hpp"

namespace dyn {

namespace {

// f(type, wraps) of each primitive of a simple joint; how many numbers it has.
struct Sizes {
  Index nq = 0, nv = 0;
};
template <class F>
Sizes primitives(dynJointType type, F&& f) {
  Sizes out;
  visit_kind(type, [&]<class K>() {
    const JointGeometry any{z_axis, x_axis, x_axis, y_axis, 0};
    for (const Element& e : K::elements(any)) f(e.type, e.wraps);
    out = {K::nq, K::nv};
  });
  return out;
}

}  // namespace

bool BlockChecker::simple(dynJointType type) {
  return require(is_value(type) && type != DYN_JOINT_TYPE_FIXED && type != DYN_JOINT_TYPE_COMPOSITE, "type of a joint");
}

// q, v, qx, vx: its first coordinates; then those of the next one.
bool BlockChecker::joint(Index j, Index& q, Index& v, Index& qx, Index& vx) {
  const JointRecord& r = m.joints()[j];
  const Index first = m.joints()[j - 1].last_body + 1;
  if (!text(r.name) || !index(r.parent, j, "parent of a joint") || !require(r.first_body == first && r.last_body >= first &&
      r.last_body < n.bodies, "bodies of a joint")) return false;
  const bool follows = r.leader != -1;
  if (follows) {
    if (!index(r.leader, n.joints, "leader of a joint") ||
        !require(r.leader > 0 && m.joints()[r.leader].leader == -1, "leader of a joint"))
      return false;
    const JointRecord& l = m.joints()[r.leader];
    if (!require(r.idx_q == l.idx_q && r.idx_v == l.idx_v && l.nq == 1 && l.nv == 1 && r.nq == 0 &&
        r.nv == 0, "coordinates of a joint that follows")) return false;
  } else if (!require(r.idx_q == q && r.idx_v == v, "coordinates of a joint")) {
    return false;
  }
  Index body = first, at_q = r.idx_q, at_v = r.idx_v;
  bool good = true;
  const auto one = [&](BodyType type, bool wraps) {
    if (!good || !(good = require(body <= r.last_body, "bodies of a joint"))) return;
    const Body& b = m.bodies()[body];
    good = require(b.type == type && bool(b.wraps) == wraps &&
                       b.parent == (body == first ? m.joints()[r.parent].last_body : body - 1) && b.joint == j,
                   "body of a joint") &&
           require(b.idx_q == qx && b.idx_v == vx && b.user_q == at_q && b.user_v == at_v && b.follower == Index(follows),
                   "coordinates of a body") &&
           require(std::isfinite(b.m) && b.m >= 0 && is_finite(b.h) && is_finite(b.I) && std::isfinite(b.pitch) &&
                       std::isfinite(b.ratio),
                   "inertia of a body") &&
           require(is_finite(m.joint_placement()[body]), "placement of a joint");
    ++body, at_q += nq_of(type), at_v += nv_of(type), qx += nq_of(type), vx += nv_of(type);
  };
  Sizes own;
  if (r.type == DYN_JOINT_TYPE_COMPOSITE) {
    if (!require(r.parts > 0 && r.first_part >= 0 && r.first_part <= n.parts - r.parts, "parts of a joint")) return false;
    for (const PartRecord *p = m.parts() + r.first_part, *end = p + r.parts; p != end; ++p) {
      if (!simple(p->type) || !require(are_finite(p->axis) && are_finite(p->axis2) && std::isfinite(p->pitch) &&
          are_finite(p->placement), "a part of a joint")) return false;
      const Sizes part = primitives(p->type, one);
      own.nq += part.nq, own.nv += part.nv;
    }
  } else {
    if (!simple(r.type) || !require(r.parts == 0, "parts of a joint")) return false;
    own = primitives(r.type, one);
  }
  if (!good || !require(body == r.last_body + 1, "bodies of a joint")) return false;
  if (follows ? !require(own.nq == 1 && own.nv == 1, "a joint that follows has several coordinates") : !require(r.nq == own.nq &&
      r.nv == own.nv, "coordinates of a joint")) return false;
  if (!follows) q += own.nq, v += own.nv;
  const double scalars[] = {
#define COEFFICIENT(name, has, sentence) r.name,
#include "effect/coefficients.def"
      r.ratio, r.offset, r.pitch, r.spring_reference};
  return require(is_finite(r.C) && are_finite(r.axis) && are_finite(r.axis2) && are_finite(r.placement) && are_finite(scalars),
                 "a number of a joint");
}

bool BlockChecker::joints() {
  const JointRecord& universe = m.joints()[0];
  const Body& world = m.bodies()[0];
  if (!text(universe.name) ||
      !require(universe.type == DYN_JOINT_TYPE_FIXED && universe.parent == 0 && universe.first_body == 0 &&
                   universe.last_body == 0 && universe.nq == 0 && universe.nv == 0 && universe.idx_q == 0 &&
                   universe.idx_v == 0 && universe.leader == -1 && universe.parts == 0,
               "the universe") ||
      !require(world.parent == 0 && world.idx_q == 0 && world.idx_v == 0 && world.joint == 0 && int(world.type) == 0 &&
                   is_finite(world.h) && is_finite(world.I) && is_finite(m.joint_placement()[0]),
               "the world"))
    return false;
  Index q = 0, v = 0, qx = 0, vx = 0;
  bool follower = false;
  return each(1, n.joints, [&](Index j) { return follower |= m.joints()[j].leader != -1, joint(j, q, v, qx, vx); }) &&
         require(q == n.nq && v == n.nv && qx == n.nqx && vx == n.nvx && follower == (m.has_mimic == 1),
                 "coordinates of the joints") &&
         require(m.joints()[n.joints - 1].last_body == n.bodies - 1, "bodies of the joints");
}

bool BlockChecker::expanded() {
  if (!m.has_mimic) return true;
  Index followers = 0;
  return each(1, n.bodies, [&](Index i) {
    const Body& b = m.bodies()[i];
    return each(nq_of(b.type), [&](Index k) {
      const Index x = b.idx_q + k;
      return require(m.expand_q()[x] == b.user_q + k && std::isfinite(m.ratio_q()[x]) && std::isfinite(m.offset_q()[x]),
                     "expanded coordinates");
    }) && each(nv_of(b.type), [&](Index k) {
      const Index x = b.idx_v + k;
      if (!require(m.expand_v()[x] == b.user_v + k && std::isfinite(m.ratio_v()[x]), "expanded velocities")) return false;
      if (!b.follower) return require(m.own_v()[b.user_v + k] == x, "expanded velocities");
      return index(followers, n.nvx - n.nv, "a follower") && require(m.followers()[followers++] == x, "followers");
    });
  }) && require(followers == n.nvx - n.nv, "followers");
}

bool BlockChecker::order() {
  const Body* const b = m.bodies();
  // depth first: who carries the next body is the body before, or one that carries that one, and the subtrees between end there
  Index at = 0;
  const auto close = [&](Index to, Index end) {
    for (; at > to; at = b[at].parent)
      if (!require(m.subtree_end()[at] == end, "end of a subtree")) return false;
    return require(at == to, "order of the bodies");
  };
  if (!each(1, n.bodies, [&](Index i) { return close(b[i].parent, i) && (at = i, true); }) || !close(0, n.bodies)) return false;
  if (!require(m.subtree_end()[0] == n.bodies, "end of a subtree")) return false;
  if (!each(1, n.bodies, [&](Index i) {
        return each(nv_of(b[i].type), [&](Index k) {
          return require(m.dof_end()[b[i].idx_v + k] == first_dof(m, m.subtree_end()[i]), "end of a subtree");
        });
      }))
    return false;
  const Index padded = (n.nvx + 3) / 4 * 4;
  if (!each(n.nvx, padded, [&](Index k) { return require(m.dof_end()[k] == 0, "end of a subtree"); })) return false;
  if (!each(padded / 4, [&](Index k) {
        const Index* e = m.dof_end() + 4 * k;
        return require(m.band_full()[k] == *std::min_element(e, e + 4) && m.band_end()[k] == *std::max_element(e, e + 4),
                       "bands");
      }))
    return false;

  Index joint_runs = 0, cache_blocks = 0, sweep = 0;
  CacheBlock c{};
  const auto close_run = [&](Index end) {
    return joint_runs == 0 || require(m.joint_runs()[joint_runs - 1].last == end, "end of a run");
  };
  const auto close_chunk = [&] {
    if (cache_blocks == 0) return true;
    const Index first = std::min(c.first_q, (n.nqx + 7) / 8 * 8 - (c.last_q - c.first_q + 3) / 4 * 4);
    const CacheBlock& x = m.cache_blocks()[cache_blocks - 1];
    sweep = std::max(sweep, padded_sweep(c.last_q - first));
    return require(x.first == c.first && x.first_run == c.first_run && x.last_run == joint_runs && x.first_q == first &&
                       x.last_q == c.last_q,
                   "a cache block");
  };
  return each(1, n.bodies, [&](Index i) {
    const bool block = (i - 1) % CacheBlock::size == 0, forks = i > 1 && m.subtree_end()[i] < m.subtree_end()[i - 1];
    if (block) {
      if (!close_chunk() || !index(cache_blocks++, n.cache_blocks, "a cache block")) return false;
      c = {i, joint_runs, 0, 0, 0};
    }
    if (block || b[i].type != m.joint_runs()[joint_runs - 1].type || b[i].parent != i - 1 || forks) {
      if (!close_run(i) || !index(joint_runs++, n.joint_runs, "a run")) return false;
      const JointRun& r = m.joint_runs()[joint_runs - 1];
      if (!require(
              r.type == b[i].type && r.first == i && r.parent == b[i].parent && r.idx_q == b[i].idx_q && r.idx_v == b[i].idx_v,
              "a run"))
        return false;
    }
    visit(b[i].type, [&]<class J>() {
      if (!J::angle) return;
      if (c.last_q == 0) c.first_q = b[i].idx_q;
      c.last_q = b[i].idx_q + 1;
    });
    return true;
  }) && close_run(n.bodies) && close_chunk() && require(joint_runs == n.joint_runs && cache_blocks == n.cache_blocks &&
      sweep == n.sweep, "chains and cache blocks");
}

bool BlockChecker::coordinates() {
  Index euclidean_spans = 0, manifold_joints = 0, limits = 0;
  EuclideanSpan s{};
  const auto close = [&] {
    if (euclidean_spans == 0) return true;
    const EuclideanSpan& x = m.euclidean_spans()[euclidean_spans - 1];
    return require(x.first_q == s.first_q && x.first_v == s.first_v && x.count == s.count, "coordinates of a vector space");
  };
  if (!each(1, n.bodies,
            [&](Index i) {
              const Body& b = m.bodies()[i];
              if (b.follower) return true;
              if (nq_of(b.type) != nv_of(b.type) || b.wraps)
                return index(manifold_joints, n.manifold_joints, "a manifold joint") &&
                       require(m.manifold_joints()[manifold_joints++] == i, "a manifold joint");
              if (euclidean_spans > 0 && s.first_q + s.count == b.user_q && s.first_v + s.count == b.user_v)
                return s.count += nv_of(b.type), true;
              if (!close() || !index(euclidean_spans++, n.euclidean_spans, "coordinates of a vector space")) return false;
              s = {b.user_q, b.user_v, nv_of(b.type)};
              return true;
            }) ||
      !close() ||
      !require(euclidean_spans == n.euclidean_spans && manifold_joints == n.manifold_joints, "coordinates of vector spaces"))
    return false;
  return each(n.euclidean_spans, [&](Index k) {
    const EuclideanSpan& span = m.euclidean_spans()[k];
    return each(span.count, [&](Index i) {
      const Index q = span.first_q + i, v = span.first_v + i;
      if (!std::isfinite(m.lower_limit()[q]) && !std::isfinite(m.upper_limit()[q])) return true;
      if (!index(limits, n.limits, "a limit")) return false;
      const LimitRecord& l = m.limits()[limits++];
      const Index dof = n.mimic_v ? m.own_v()[v] : v;
      return index(l.body, n.bodies, "body of a limit") &&
             require(l.q == q && l.dof == dof && l.body > 0 && m.bodies()[l.body].idx_v <= dof && dof < first_dof(m, l.body + 1),
                     "a limit");
    });
  }) && each(1, n.bodies, [&](Index i) {
    const Body& b = m.bodies()[i];
    if (b.type != BodyType::Spherical || !(m.lower_limit()[b.user_q + 3] >= 0)) return true;
    if (!index(limits, n.limits, "a limit")) return false;
    const LimitRecord& l = m.limits()[limits++];
    return require(l.q == b.user_q + 3 && l.body == i && l.dof == b.idx_v && m.lower_limit()[l.q] < 1, "a limit of a ball joint");
  }) && require(limits == n.limits, "limits");
}

// One of them carries the other in the elimination tree.
bool BlockChecker::joined(Index a, Index b) {
  Index x = std::max(a, b);
  const Index to = std::min(a, b);
  while (x > to) x = m.dof_parent()[x];
  return require(x == to, "the elimination tree");
}

bool BlockChecker::elimination() {
  const Index *const parent = m.dof_parent(), *const end = m.dof_descendants_end(), nv = n.nv;
  Index at = -1, carriers = 0;
  const auto close = [&](Index to, Index last) {
    for (; at > to; at = parent[at])
      if (!require(end[at] == last, "end of descendants")) return false;
    return require(at == to, "order of the elimination tree");
  };
  const bool ordered = each(nv, [&](Index k) {
    const Index p = parent[k];
    if (!require(p >= -1 && p < k, "the elimination tree") || !close(p, k)) return false;
    at = k;
    const Index depth = p >= 0 ? m.dof_depth()[p] + 1 : 0;
    carriers = std::max(carriers, std::min(nv, 2 * (depth + 1)));
    return require(m.dof_depth()[k] == depth && m.dof_run()[k] == (k > 0 && p == k - 1 ? m.dof_run()[k - 1] : k),
                   "depths of the elimination tree");
  });
  for (Index k = 0; k < n.paths; ++k) carriers = std::max(carriers, m.paths()[k].dofs);
  if (!ordered || !close(-1, nv) || !require(carriers == n.carriers, "depths of the elimination tree")) return false;
  if (!each(nv, [&](Index k) {
        const bool forks = k + 1 < nv && parent[k + 1] == k && end[k + 1] < end[k];
        return require(m.dof_forks()[k] == Index(forks), "forks of the elimination tree");
      }))
    return false;

  Index groups = 0;
  DofGroup g{};
  const auto close_group = [&] {
    if (groups == 0) return true;
    const DofGroup& x = m.dof_groups()[groups - 1];
    return require(x.first == g.first && x.count == g.count && x.depth == g.depth && x.parent == g.parent && x.end == g.end,
                   "a group of degrees of freedom");
  };
  if (!each(nv, [&](Index k) {
        if (k > 0 && parent[k] == k - 1 && end[k] == end[k - 1] && g.count < 4) return ++g.count, true;
        if (!close_group()) return false;
        ++groups, g = {k, 1, m.dof_depth()[k], parent[k], end[k]};
        return true;
      }) ||
      !close_group() || !require(groups == m.groups, "groups of degrees of freedom"))
    return false;

  const Body* const b = m.bodies();
  const auto dofs = [&](Index i) { return first_dof(m, i + 1) - b[i].idx_v; };
  if (!m.has_mimic)
    return each(1, n.bodies, [&](Index i) {
      return each(dofs(i), [&](Index k) {
        const Index before = k > 0 ? b[i].idx_v + k - 1 : b[i].parent ? first_dof(m, b[i].parent + 1) - 1 : -1;
        return require(parent[b[i].idx_v + k] == before, "the elimination tree");
      });
    });
  // what M couples is on one branch (builder_mimic.cpp)
  return each(1, n.bodies, [&](Index i) {
    if (!each(1, dofs(i), [&](Index k) { return joined(b[i].user_v + k, b[i].user_v + k - 1); })) return false;
    for (Index s = b[i].parent; s != 0; s = b[s].parent) {
      if (!each(dofs(i),
                [&](Index k) { return each(dofs(s), [&](Index x) { return joined(b[i].user_v + k, b[s].user_v + x); }); }))
        return false;
      if (!b[s].follower) break;
    }
    return !b[i].follower || each(first_dof(m, i + 1), first_dof(m, m.subtree_end()[i]),
                                  [&](Index k) { return joined(b[i].user_v, m.expand_v()[k]); });
  });
}

}  // namespace dyn
