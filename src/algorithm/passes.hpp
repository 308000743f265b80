// What every recursion shares: a loop over bodies in runs of one joint type, and the placing of a body.
#pragma once

#include "algorithm/padding.hpp"
#include "base/sincos.hpp"
#include "joint/list.hpp"
#include "model/data.hpp"

namespace dyn {

// f.template operator()<J>(body index), root to leaves. One dispatch a run.
template <class F>
DYN_INLINE void forward(const Model& m, F&& f) {
  const JointRun* joint_runs = m.joint_runs();
  for (Index k = 0; k < m.n.joint_runs; ++k)
    visit(joint_runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (Index i = joint_runs[k].first; i < joint_runs[k].last; ++i) f.template operator()<J>(i);
    });
}

// The same with something carried from body to body: f(index, carry). The copy within a run can stay in registers. Returns what
// the last body leaves.
template <class Carry, class F>
DYN_INLINE Carry forward(const Model& m, Carry carry, F&& f) {
  const JointRun* joint_runs = m.joint_runs();
  for (Index k = 0; k < m.n.joint_runs; ++k)
    visit(joint_runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      for (Index i = joint_runs[k].first; i < joint_runs[k].last; ++i) f.template operator()<J>(i, here);
      carry = here;
    });
  return carry;
}

// Leaves to root.
template <class F>
DYN_INLINE void backward(const Model& m, F&& f) {
  const JointRun* joint_runs = m.joint_runs();
  for (Index k = m.n.joint_runs - 1; k >= 0; --k)
    visit(joint_runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (Index i = joint_runs[k].last - 1; i >= joint_runs[k].first; --i) f.template operator()<J>(i);
    });
}
template <class Carry, class F>
DYN_INLINE Carry backward(const Model& m, Carry carry, F&& f) {
  const JointRun* joint_runs = m.joint_runs();
  for (Index k = m.n.joint_runs - 1; k >= 0; --k)
    visit(joint_runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      for (Index i = joint_runs[k].last - 1; i >= joint_runs[k].first; --i) f.template operator()<J>(i, here);
      carry = here;
    });
  return carry;
}

// What a pass goes along: all, or the chains and coordinates of some trees.
struct WholeModel {
  static DYN_INLINE const JointRun* joint_runs(const Model& m) { return m.joint_runs(); }
  static DYN_INLINE Index joint_run_count(const Model& m) { return m.n.joint_runs; }
  static DYN_INLINE const CacheBlock* cache_blocks(const Model& m) { return m.cache_blocks(); }
  static DYN_INLINE Index cache_block_count(const Model& m) { return m.n.cache_blocks; }
  static DYN_INLINE const EuclideanSpan* euclidean_spans(const Model& m) { return m.euclidean_spans(); }
  static DYN_INLINE Index euclidean_span_count(const Model& m) { return m.n.euclidean_spans; }
  static DYN_INLINE const Index* manifold_joints(const Model& m) { return m.manifold_joints(); }
  static DYN_INLINE Index manifold_joint_count(const Model& m) { return m.n.manifold_joints; }
};
struct SomeTrees {
  const JointRun* first_run;
  const CacheBlock* first_cache_block;  // of these runs
  const EuclideanSpan* first_span;
  const Index* first_curved;
  Index of_runs, of_chunks, of_spans, of_curved;
  DYN_INLINE const JointRun* joint_runs(const Model&) const { return first_run; }
  DYN_INLINE Index joint_run_count(const Model&) const { return of_runs; }
  DYN_INLINE const CacheBlock* cache_blocks(const Model&) const { return first_cache_block; }
  DYN_INLINE Index cache_block_count(const Model&) const { return of_chunks; }
  DYN_INLINE const EuclideanSpan* euclidean_spans(const Model&) const { return first_span; }
  DYN_INLINE Index euclidean_span_count(const Model&) const { return of_spans; }
  DYN_INLINE const Index* manifold_joints(const Model&) const { return first_curved; }
  DYN_INLINE Index manifold_joint_count(const Model&) const { return of_curved; }
};

// Root to leaves along chains: f(body, its first degree of freedom, carry); the carry's enter(d, parent) where a chain starts,
// its leave(d, body) where one ends.
template <class T, class Carry, class F, class Part = WholeModel>
DYN_INLINE void forward_chains(const Model& m, Data<T>& d, Carry carry, F&& f, const Part& part = {}) {
  for (Index l = 0; l < part.joint_run_count(m); ++l) {
    const JointRun& run = part.joint_runs(m)[l];
    visit(run.type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      if (run.parent != run.first - 1) here.enter(d, run.parent);
      for (Index i = 0; i < run.last - run.first; ++i) f.template operator()<J>(run.first + i, run.idx_v + J::nv * i, here);
      here.leave(d, run.last - 1);
      carry = here;
    });
  }
}

// Leaves to root along chains: f(body, its first degree of freedom, whether it ends the chain, carry), where the carry is what
// the body receives from the next one of the chain, zero at a leaf, and becomes what it passes on; add(parent, carry) where the
// parent is not the next.
template <class Carry, class F, class Add, class Part = WholeModel>
DYN_INLINE void backward_chains(const Model& m, const Carry& zero, F&& f, Add&& add, const Part& part = {}) {
  const JointRun* joint_runs = part.joint_runs(m);
  Carry carry = zero;
  for (Index k = part.joint_run_count(m) - 1; k >= 0; --k) {
    const JointRun& run = joint_runs[k];
    visit(run.type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      for (Index i = run.last - 1 - run.first; i >= 0; --i)
        f.template operator()<J>(run.first + i, run.idx_v + J::nv * i, run.first + i == run.last - 1, here);
      carry = here;
    });
    if (run.parent != run.first - 1) add(run.parent, carry), carry = zero;
  }
}

// What goes along a chain in registers: the pose of the body before, and the sum of the sizes of all p.
// A pass with more to carry derives from it.
template <class T>
struct Pose {
  Mat3<T> R;
  Vec3<T> p, extent;

  explicit DYN_INLINE Pose(const Data<T>& d) : R(d.R[0]), p(d.p[0]), extent(Vec3<T>::zero()) {}
  // a chain that starts at this body; one that ends there
  DYN_INLINE void enter(const Data<T>& d, Index parent) { R = d.R[parent], p = d.p[parent]; }
  DYN_INLINE void leave(Data<T>&, Index) const {}
  DYN_INLINE void done(Data<T>& d) const {
    d.extent[0] = extent[0] + extent[1] + extent[2];
    d.mark_fresh(Stage::Position);
  }
  // To the next body: R_WB, p_WB. Returns r, from the parent's origin to the body's.
  DYN_INLINE Vec3<T> place(Data<T>& d, Index i, const SE3<T>& X) {
    const Vec3<T> r = R * X.p;
    const Vec3<T> x = R * X.R.x, y = R * X.R.y, z = R * X.R.z;
    R.x = x, R.y = y, R.z = z;
    Mat3<T>& kept = d.R[i];
    kept.x = x, kept.y = y, kept.z = z;
    d.r[i] = r;
    p += r;
    d.p[i] = p;
    extent += sizes(p);
    return r;
  }
};

// With the body's origin relative to that of its tree's root, where algorithms collect what belongs to different bodies: distance
// from the world's origin costs no digits.
template <class T>
struct RelativePose : Pose<T> {
  Vec3<T> rel;

  explicit DYN_INLINE RelativePose(const Data<T>& d) : Pose<T>(d), rel(Vec3<T>::zero()) {}
  DYN_INLINE void enter(const Data<T>& d, Index parent) { Pose<T>::enter(d, parent), rel = d.rel[parent]; }
  DYN_INLINE void place(Data<T>& d, Index i, const SE3<T>& X, bool root) {
    const Vec3<T> r = Pose<T>::place(d, i, X);
    rel = root ? Vec3<T>::zero() : rel + r;
    d.rel[i] = rel;
  }
  // the k-th column of the motion subspace, there
  template <class J>
  DYN_INLINE Motion<T> column(const Body& b, int k) const {
    const Motion<T> s = J::column(b, this->R, k);
    return J::rotates_at(k) ? shift(s, -rel) : s;
  }
};

// Root to leaves, f(body, its first degree of freedom, its placement X in its parent, carry): the sines and cosines of a
// block's angles come first, then the X of a chain, which depend on no other body, so that what follows along the chain is one
// product of matrices. Returns the carry.
template <class T, class Carry, class F, class Part = WholeModel>
DYN_INLINE Carry place_forward(const Model& m, Data<T>& d, Carry carry, F&& f, const Part& part = {}) {
  const T* q = d.expand_q(m);
  for (Index k = 0; k < part.cache_block_count(m); ++k) {
    const CacheBlock& block = part.cache_blocks(m)[k];
    sincos_sweep(q + block.first_q, block.last_q - block.first_q, d.cosine, d.sine);
    for (Index l = block.first_run; l < block.last_run; ++l) {
      const JointRun& run = part.joint_runs(m)[l];
      visit(run.type, [&]<class J>() DYN_INLINE_LAMBDA {
        const Index n = run.last - run.first, angle = run.idx_q - block.first_q;
        SE3<T>* X = d.X + (run.first - block.first);
        for (Index i = 0; i < n; ++i) {
          SE3<T> x = cast<T>(m.joint_placement()[run.first + i]);
          T c{}, s{};
          if constexpr (J::angle) c = d.cosine[angle + i], s = d.sine[angle + i];
          J::place(m.bodies()[run.first + i], q + run.idx_q + J::nq * i, c, s, x);
          X[i] = x;
        }
        Carry here = carry;
        if (run.parent != run.first - 1) here.enter(d, run.parent);
        for (Index i = 0; i < n; ++i) f.template operator()<J>(run.first + i, run.idx_v + J::nv * i, X[i], here);
        here.leave(d, run.last - 1);
        carry = here;
      });
    }
  }
  return carry;
}

// The body's inertia in world axes, about its origin.
template <class T>
DYN_INLINE Inertia<T> world_inertia(const Body& b, const Mat3<T>& R) {
  return {T(b.m), R * cast<T>(b.h), congruence(R, cast<T>(b.I))};
}

// Y s for the k-th column s of J, with what is zero in it left out.
template <class J, class T>
DYN_INLINE Force<T> momentum(const Inertia<T>& Y, const Motion<T>& s, int k) {
  if (!J::translates_at(k)) return {cross(s.angular, Y.h), Y.I * s.angular};
  if (!J::rotates_at(k)) return {s.linear * Y.m, cross(Y.h, s.linear)};
  return Y * s;
}

}  // namespace dyn
