// Norms of what a configuration holds of norm 1: quaternions and (cos, sin) pairs.
#pragma once

#include "joint/list.hpp"
#include "model/model.hpp"

namespace dyn {

// f.template operator()<J>(body) for every body whose coordinates are no vector space.
template <class F>
DYN_INLINE void for_each_manifold_joint(const Model& m, F&& f) {
  for (Index k = 0; k < m.n.manifold_joints; ++k) {
    const Body& b = m.bodies()[m.manifold_joints()[k]];
    visit(b.type, [&]<class J>() DYN_INLINE_LAMBDA { f.template operator()<J>(b); });
  }
}

template <class T>
void normalize(const Model& m, T* q) {
  for_each_manifold_joint(m, [&]<class J>(const Body& b) { J::normalize(q + b.user_q); });
}

// Largest | |x| - 1 |.
template <class T>
T norm_error(const Model& m, const T* q) {
  T worst = T(0);
  for_each_manifold_joint(m, [&]<class J>(const Body& b) {
    const T e = J::norm_error(q + b.user_q);
    if (e > worst) worst = e;
  });
  return worst;
}

// The last joint whose quaternion or (cos, sin) is zero, or 0.
template <class T>
Index zero_norm_joint(const Model& m, const T* q) {
  Index joint = 0;
  for_each_manifold_joint(m, [&]<class J>(const Body& b) {
    if (J::zero_norm(q + b.user_q)) joint = b.joint;
  });
  return joint;
}

}  // namespace dyn
