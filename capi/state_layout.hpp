// Which joint lies where in another library's state, and how each is stored there.
#pragma once

#include "algorithm/other_library_layout.hpp"
#include "joint/list.hpp"
#include "guard.hpp"

namespace dyn::capi {

// A joint of the peer: ours, and where it begins in the peer's q and v.
struct Item {
  Index joint;
  std::int64_t q, v;
};

class Layout {
 public:
  dynStatus status = DYN_OK;

  Layout(const dynModel* model, const dynStateLayout* layout);

  const Model& model() const { return *m; }
  std::int64_t nq() const { return sizes[0]; }
  std::int64_t nv() const { return sizes[1]; }
  const char* name(Index joint) const { return m->string(m->joints()[joint].name); }

  // f(item) for each joint of the peer, until one returns an error.
  template <class F>
  dynStatus each(F f) const {
    Item next = {0, 0, 0};
    const std::size_t count = l.joints ? l.joints_count : std::size_t(m->n.joints - 1);
    for (std::size_t k = 0; k < count; ++k) {
      next.joint = l.joints ? dyn_model_joint_id(handle, l.joints[k]) : Index(k + 1);
      if (!l.joints && follows(next.joint) && !has_followers()) continue;
      if (l.idx_q) next.q = l.idx_q[k], next.v = l.idx_v[k];
      if (const dynStatus s = f(next)) return s;
      const peer::Size n = size(next.joint);
      next.q += n.nq, next.v += n.nv;
    }
    return DYN_OK;
  }

  // f(form, our size) for each part of a joint that is stored in one way.
  template <class F>
  void parts(Index joint, F f) const {
    const JointRecord& r = m->joints()[joint];
    if (r.type == DYN_JOINT_TYPE_PLANAR && l.convention == DYN_CONVENTION_PINOCCHIO)
      return f(peer::Form::BodyPlanar, peer::Size{3, 3});
    for (Index i = r.first_body; i <= r.last_body; ++i) {
      const Body& b = m->bodies()[i];
      visit(b.type, [&]<class J>() { f(form(b), peer::Size{J::nq, J::nv}); });
    }
  }
  bool follows(Index joint) const { return m->joints()[joint].leader >= 0; }

  // Between the world and the joint, and between the joint and the frame whose pose the peer states.
  peer::Ends ends(Index joint) const;

 private:
  const dynModel* handle = nullptr;
  const Model* m = nullptr;
  dynStateLayout l{};
  std::int64_t sizes[2] = {0, 0};
  int child = -1;

  bool has_followers() const { return l.convention >= DYN_CONVENTION_MUJOCO; }

  peer::Form form(const Body& b) const;
  peer::Size size(Index joint) const;

  dynStatus read(const dynModel* model, const dynStateLayout* layout);

  // Sizes; where each joint lies.
  dynStatus place();

  // Each joint at most once, and all that move by themselves.
  dynStatus complete() const;

  // No two joints share a coordinate of the peer.
  dynStatus disjoint(bool of_q) const;
};

}  // namespace dyn::capi
