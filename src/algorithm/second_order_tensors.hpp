// The second derivatives of each torque: the product with the unit vector e_i. Bodies beyond joint i then move as one, with S_i,
// so that L, P, Q come from the composites at once; what carries the joint meets those of its body; all others meet nothing.
#pragma once

#include "algorithm/second_order.hpp"

namespace dyn {

// Adds to mu, P, G, E, H what the expanded degree of freedom k of body i contributes.
template <class T>
void add_unit(const Model& m, Data<T>& d, Index i, Index k, T ratio) {
  const Body* bodies = m.bodies();
  const Motion<T> l = d.S[k] * ratio;
  auto add = [&](Index x, const MomentRates<T>& L, const Force<T>& P, const Vec3<T>& Q, auto&& moved) DYN_INLINE_LAMBDA {
    d.P[x] = d.P[x] + P;
    for (Index j = bodies[x].idx_v; j < first_dof(m, x + 1); ++j) {
      Meeting<T> met = Meeting<T>::of(d, j, L, P, Q);
      moved(j, met);
      d.G[j] = d.G[j] + met.G, d.E[j] += met.E, d.H[j] += met.H;
      d.active[j] = 1;
    }
  };
  for (Index x = i; x < m.subtree_end()[i]; ++x) {
    const Composite<T>& c = d.composite[x];
    const MomentRates<T> L = MomentRates<T>::of(c.Y, l);
    add(x, L, L.momentum(), c.rates.coriolis_transposed(l), [&](Index j, Meeting<T>& met) DYN_INLINE_LAMBDA {
      if (x == i) return;
      const Motion<T> mu = cross(l, d.S[j]);
      met.add(c, mu);
      d.mu_S[j] = d.mu_S[j] + mu;
    });
  }
  const Composite<T>& c = d.composite[i];
  const MomentRates<T> L = MomentRates<T>::of(c.Y, l);
  const Force<T> P = L.momentum();
  const Vec3<T> Q = c.rates.coriolis_transposed(l);
  for (Index x = bodies[i].parent; x != 0; x = bodies[x].parent) add(x, L, P, Q, [](Index, Meeting<T>&) DYN_INLINE_LAMBDA {});
}

// d.mu_S, d.P, d.G, d.E, d.H, d.active of lambda = e_u.
template <class T>
void unit_composites(const Model& m, Data<T>& d, Index u) {
  const Index n = m.n.nvx;
  std::fill_n(d.mu_S, n, Motion<T>::zero()), std::fill_n(d.G, n, Force<T>::zero()),
      std::fill_n(d.P, m.n.bodies, Force<T>::zero());
  std::fill_n(d.E, n, Vec3<T>::zero()), std::fill_n(d.H, n, Vec3<T>::zero()), std::fill_n(d.active, n, Index(0));
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    const Index k = b.idx_v + u - b.user_v;
    if (k >= b.idx_v && k < first_dof(m, i + 1)) add_unit(m, d, i, k, T(b.ratio));
  }
}

// Links the tiles that have active degrees of freedom, and answers the first of them.
template <class T>
std::ptrdiff_t link_tiles(const Model& m, Data<T>& d) {
  std::ptrdiff_t next = m.n.nvx;
  for (std::ptrdiff_t i0 = padded_tiles(m.n.nvx) - 4; i0 >= 0; i0 -= 4) {
    d.next_tile[i0 / 4] = Index(next);
    const Index* a = d.active + i0;
    if (a[0] | a[1] | a[2] | a[3]) next = i0;
  }
  return next;
}

// Of each tau_i, after second_order_columns: nv matrices one after another.
template <class T>
void second_order_derivatives(const Model& m, Data<T>& d, const SecondOrder<T*>& out) {
  const std::ptrdiff_t square = std::ptrdiff_t(m.n.nv) * m.n.nv, expanded_square = std::ptrdiff_t(m.n.mimic_v) * m.n.mimic_v;
  auto cleared = [&](T* tensor, T* expanded, Index i) {
    if (!tensor) return tensor;
    T* matrix = tensor + square * i;
    m.has_mimic ? std::fill_n(expanded, expanded_square, T(0)) : std::fill_n(matrix, square, T(0));
    return matrix;
  };
  for (Index i = 0; i < m.n.nv; ++i) {
    unit_composites(m, d, i);
    const std::ptrdiff_t first = link_tiles(m, d);
    const SecondOrder<T*> of_i{cleared(out.dqdq, d.dqx, i), cleared(out.dvdv, d.dvx, i), cleared(out.dqdv, d.Mx, i),
                               cleared(out.dadq, d.d2x, i)};
    second_order_matrices(
        m, d, [&](auto&& begin, auto&& f) DYN_INLINE_LAMBDA { for_each_tile_among<T>(m, d.next_tile, first, begin, f); }, of_i);
    add_resistance_second_order(m, d, d.v, [&](Index k) { return T(k == i); }, of_i.dqdq, of_i.dvdv);
  }
}

// Bounds what the second derivatives are made of: below 1e70 none of them overflows.
template <class T>
T second_order_size(const Model& m, const Data<T>& d) {
  Vec3<T> sum = Vec3<T>::zero();
  auto add = [&](const auto& x) DYN_INLINE_LAMBDA { sum += sizes(x.linear) + sizes(x.angular); };
  for (Index k = 0; k < m.n.nvx; ++k)
    add(d.S[k]), add(d.dS[k]), add(d.ddS[k]), add(d.W[k]), add(d.F[k]), add(d.Fq[k]), add(d.Fv[k]);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Composite<T>& c = d.composite[i];
    for (const Mat3<T>* A : {&c.Y.P, &c.rates.V}) sum += sizes(A->x) + sizes(A->y) + sizes(A->z);
    sum += sizes(c.Y.h) + sizes(c.rates.p);
    sum += Vec3<T>::make(c.Y.m, T(0), T(0));
  }
  return sum[0] + sum[1] + sum[2];
}

}  // namespace dyn
