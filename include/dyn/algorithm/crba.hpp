// Joint-space inertia by the composite-rigid-body algorithm (Featherstone 2008, Table 6.2), in world axes at each body's
// origin: a force passes to the parent by a pure translation.
#pragma once

#include "dyn/algorithm/crba_deep.hpp"

namespace dyn {

// d.M, full and symmetric, rotors left out. With mimic joints M = G^T M_x G, q_x = G q: G has one entry, the ratio, in a row.
template <bool mimic, class T>
void crba_shallow(const Model& m, Data<T>& d) {
  const std::ptrdiff_t nv = m.n.nv;
  const Body* bodies = m.bodies();
  T* M = d.M;
  if constexpr (mimic)
    for (std::ptrdiff_t k = 0; k < nv * nv; ++k) M[k] = T(0);
  // entries of body j's degree of freedom dof against x, those of body i
  auto put = [&](const Body& bi, int ni, const Body& bj, int kj, const T* x, bool diagonal) DYN_INLINE_LAMBDA {
    const std::ptrdiff_t at = bj.user_v + kj;
    for (int k = 0; k < ni; ++k) {
      const std::ptrdiff_t other = bi.user_v + k;
      if constexpr (mimic) {
        const T y = x[k] * (T(bi.ratio) * T(bj.ratio));
        M[other + nv * at] += y;
        if (!diagonal || k != kj) M[at + nv * other] += y;
      } else {
        M[other + nv * at] = M[at + nv * other] = x[k];
      }
    }
  };

  for (Index i = 1; i < m.n.bodies; ++i) d.Ic[i] = world_inertia(bodies[i], d.R[i]);
  backward(m, Up<Inertia<T>>{Inertia<T>::zero()}, [&]<class J>(Index j, Up<Inertia<T>>& up) DYN_INLINE_LAMBDA {
    const Body& b = bodies[j];
    Inertia<T> Y = d.Ic[j];
    if (up.chain) Y = Y + up.x;
#pragma GCC unroll 6
    for (int k = 0; k < J::nv; ++k) {
      Force<T> F = momentum<J>(Y, J::column(b, d.R[j], k));
      T x[6];
      J::project(b, d.R[j], F, x);
      put(b, k + 1, b, k, x, true);
      for (Index i = j; bodies[i].parent != 0;) {
        F = shift(F, d.r[i]);
        i = bodies[i].parent;
        const Body& bi = bodies[i];
        if (bi.type == BodyType::Revolute) [[likely]] {
          x[0] = dot(d.R[i].z, F.angular);
          put(bi, 1, b, k, x, false);
        } else {
          visit(bi.type, [&]<class Ji>() {
            Ji::project(bi, d.R[i], F, x);
            put(bi, Ji::nv, b, k, x, false);
          });
        }
      }
    }
    up.x = Y.shifted(d.r[j]);
    up.chain = b.parent == j - 1;
    if (!up.chain && b.parent) d.Ic[b.parent] = d.Ic[b.parent] + up.x;
  });
}

// d.M, full and symmetric.
template <class T>
void crba(const Model& m, Data<T>& d) {
  ensure_position(m, d);
  if (m.has_mimic) crba_shallow<true>(m, d);
  else if (m.deep) crba_deep(m, d);
  else crba_shallow<false>(m, d);
  for (std::ptrdiff_t k = 0; k < m.n.nv; ++k) d.M[k + m.n.nv * k] += T(m.armature()[k]);
  d.done(Stage::Mass);
}

}  // namespace dyn
