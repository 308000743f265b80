// What every recursion shares: a loop over bodies in runs of one joint type, and the placing of a body.
#pragma once

#include "dyn/base/sincos.hpp"
#include "dyn/joint/list.hpp"
#include "dyn/model/data.hpp"

namespace dyn {

// f.template operator()<J>(body index), root to leaves. One dispatch a run.
template <class F>
DYN_INLINE void forward(const Model& m, F&& f) {
  const Run* runs = m.runs();
  for (Index k = 0; k < m.n.runs; ++k)
    visit(runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (Index i = runs[k].first; i < runs[k].last; ++i) f.template operator()<J>(i);
    });
}

// The same with something carried from body to body: f(index, carry). The copy within a run can stay in registers. Answers what
// the last body leaves.
template <class Carry, class F>
DYN_INLINE Carry forward(const Model& m, Carry carry, F&& f) {
  const Run* runs = m.runs();
  for (Index k = 0; k < m.n.runs; ++k)
    visit(runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      for (Index i = runs[k].first; i < runs[k].last; ++i) f.template operator()<J>(i, here);
      carry = here;
    });
  return carry;
}

// Leaves to root.
template <class F>
DYN_INLINE void backward(const Model& m, F&& f) {
  const Run* runs = m.runs();
  for (Index k = m.n.runs - 1; k >= 0; --k)
    visit(runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (Index i = runs[k].last - 1; i >= runs[k].first; --i) f.template operator()<J>(i);
    });
}
template <class Carry, class F>
DYN_INLINE Carry backward(const Model& m, Carry carry, F&& f) {
  const Run* runs = m.runs();
  for (Index k = m.n.runs - 1; k >= 0; --k)
    visit(runs[k].type, [&]<class J>() DYN_INLINE_LAMBDA {
      Carry here = carry;
      for (Index i = runs[k].last - 1; i >= runs[k].first; --i) f.template operator()<J>(i, here);
      carry = here;
    });
  return carry;
}

// What a body passes to its parent: carried to the next body when that is the parent, else added in memory.
template <class X>
struct Up {
  X x;
  bool chain = false;
};

// Expanded q, the sines and cosines of its angles, and each body's placement X in its parent: all that does not depend on the
// other bodies, so that what follows along a chain is one product of matrices.
template <class T>
DYN_INLINE const T* place_joints(const Model& m, Data<T>& d) {
  const T* q = d.expand_q(m);
  const Index* at = m.angle_q();
  for (Index k = 0; k < m.n.angles; ++k) d.angle[k] = q[at[k]];
  sincos_sweep(d.angle, m.n.angles, d.cosine, d.sine);
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    T c{}, s{};
    if constexpr (J::angle) c = d.cosine[b.angle], s = d.sine[b.angle];
    SE3<T> X = {cast<T>(b.F), cast<T>(b.r)};
    J::place(b, q + b.idx_q, c, s, X);
    d.X[i] = X;
  });
  return q;
}

// R_WB, p_WB, and r from the parent's origin to the body's. R is that of body i - 1 on entry, which is the parent's in a
// chain: kept in registers, it need not come back from memory.
template <class T>
DYN_INLINE void place_body(const Body& b, Index i, Data<T>& d, Mat3<T>& R, Vec3<T>& r) {
  if (b.parent != i - 1) R = d.R[b.parent];
  const SE3<T>& X = d.X[i];
  r = R * X.p;
  const Vec3<T> x = R * X.R.x, y = R * X.R.y, z = R * X.R.z;
  R.x = x, R.y = y, R.z = z;
  Mat3<T>& kept = d.R[i];
  kept.x = x, kept.y = y, kept.z = z;
  d.r[i] = r;
  d.p[i] = d.p[b.parent] + r;
}

// The body's inertia in world axes, about its origin.
template <class T>
DYN_INLINE Inertia<T> world_inertia(const Body& b, const Mat3<T>& R) {
  return {T(b.m), R * cast<T>(b.h), congruence(R, cast<T>(b.I))};
}

// Y s, with what is zero in the columns of J left out.
template <class J, class T>
DYN_INLINE Force<T> momentum(const Inertia<T>& Y, const Motion<T>& s) {
  if constexpr (!J::translates)
    return {cross(s.angular, Y.h), Y.I * s.angular};
  else if constexpr (!J::rotates)
    return {s.linear * Y.m, cross(Y.h, s.linear)};
  else
    return Y * s;
}

}  // namespace dyn
