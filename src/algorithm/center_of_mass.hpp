// Centre of mass of what moves, its derivatives and its Jacobian. What is welded to the world does not count.
#pragma once

#include "algorithm/jacobian.hpp"

namespace dyn {

// level 0: com and subtree moments; 1: and vcom; 2: and acom.
template <class T>
void center_of_mass(const Model& m, Data<T>& d, int level) {
  if (level == 0) ensure_position(m, d);
  if (level == 1) ensure_velocity(m, d);
  if (level == 2) ensure_acceleration(m, d);
  // subtree moments about each body's origin
  for (Index i = 0; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    d.msub[i] = i ? T(b.m) : T(0);
    d.hsub[i] = i ? d.R[i] * cast<T>(b.h) : Vec3<T>::zero();
  }
  Vec3<T> momentum = Vec3<T>::zero(), rate = Vec3<T>::zero();
  for (Index i = m.n.bodies - 1; i >= 1; --i) {
    const Body& b = m.bodies()[i];
    if (level >= 1) {
      const Vec3<T> h = d.R[i] * cast<T>(b.h), wh = cross(d.omega[i], h);
      momentum += d.vel[i] * T(b.m) + wh;
      if (level >= 2) rate += d.acc[i] * T(b.m) + cross(d.alpha[i], h) + cross(d.omega[i], wh);
    }
    d.msub[b.parent] += d.msub[i];
    d.hsub[b.parent] += d.hsub[i] + d.r[i] * d.msub[i];
  }
  // a robot without mass has no centre of mass: its origin stands for it
  const T inverse = d.msub[0] > T(0) ? T(1) / d.msub[0] : T(0);
  store3(d.hsub[0] * inverse, d.com);
  d.mark_fresh(Stage::Com);
  if (level >= 1) store3(momentum * inverse, d.vcom), d.mark_fresh(Stage::Vcom);
  if (level >= 2) store3(rate * inverse, d.acom), d.mark_fresh(Stage::Acom);
}

// Jacobian, 3 x nv, of the centre of mass of the subtree that hangs on body root (0: everything). Needs Stage::Com.
template <class T>
void center_of_mass_jacobian(const Model& m, const Data<T>& d, Index root, T* Jcom) {
  for (Index k = 0; k < 3 * m.n.nv; ++k) Jcom[k] = T(0);
  const T inverse = d.msub[root] > T(0) ? T(1) / d.msub[root] : T(0);
  auto add = [&](Index i, T mass, const Vec3<T>& h) {
    const Body& b = m.bodies()[i];
    visit(b.type, [&]<class J>() {
      for (int k = 0; k < J::nv; ++k) {
        const Motion<T> s = J::column(b, d.R[i], k);
        const Vec3<T> x = (s.linear * mass + cross(s.angular, h)) * (inverse * T(b.ratio));
        for (int c = 0; c < 3; ++c) Jcom[3 * (b.user_v + k) + c] += x[c];
      }
    });
  };
  const Index first = root ? root : 1;
  for (Index i = first; i < m.subtree_end()[root]; ++i) add(i, d.msub[i], d.hsub[i]);
  // what carries the subtree moves it as a whole
  if (root == 0) return;
  Vec3<T> h = d.hsub[root];
  for (Index i = root; m.bodies()[i].parent != 0;) {
    h += d.r[i] * d.msub[root];
    i = m.bodies()[i].parent;
    add(i, d.msub[root], h);
  }
}

}  // namespace dyn
