// Second derivatives of inverse dynamics on the tangent space, contracted with a vector lambda, in O(n depth). lambda . tau is the
// power of the bodies' forces f at the velocities l that lambda gives them. With mu = l_p x S, L the composite of Y that moves with l,
// B(v) and B(l) the Coriolis maps of the two motions (2 B of Singh, Russell, Wensing 2022), Q = the sum of 2 B(v)^T l, P that of Y l,
//   d(lambda . tau)/dq_j = mu_j . f + psi''_j . P + psi'_j . Q      /dv_j = W_j . P + S_j . Q      /da_j = S_j . P,   W = psi' + S'
// A step of q along S_k, k supporting j, turns all of this, which changes no product, and besides changes
//   mu_j by mu_k x S_j     psi'_j by psi'_k x S_j     psi''_j by psi''_k x S_j + 2 psi'_k x psi'_j
//   f by Y psi''_k + 2 B(v) psi'_k     P by Y mu_k     Q by 2 B(v)^T mu_k - 2 B(l)^T psi'_k
// What mu_k, psi'_k, psi''_k, S_k, W_k are multiplied with belongs to j alone: Fq, Fv, F = Y S as in the first derivatives, and
//   G_j = S_j x* P + Y mu_j     E_j = S_j x* Q + 2 B(v)^T mu_j - 2 B(l)^T psi'_j     H_j = -2 B(l)^T S_j
// so that, with k supporting j and the columns of one joint apart,
//   dq_j dq_k = dq_k dq_j = mu_k . Fq_j + psi''_k . G_j + psi'_k . E_j            dv_j dv_k = dv_k dv_j = S_k . H_j
//   dq_j dv_k = W_k . G_j + S_k . E_j     dq_k dv_j = mu_k . Fv_j + psi'_k . H_j     da_j dq_k = mu_k . F_j     da_k dq_j = S_k . G_j
#pragma once

#include "dyn/algorithm/declarations.hpp"
#include "dyn/algorithm/rnea_derivatives.hpp"

namespace dyn {

// What does not depend on lambda: columns, composites, F, Fq, Fv. fext 6 x njoints in joint frames, or nullptr.
template <class T>
void second_order_columns(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext) {
  derivative_columns(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax));
  if (fext) subtract_external_at_root(m, d, fext);
  composite_forces(m, d, static_cast<T*>(nullptr));
}

// mu, G, E, H of the active degrees of freedom; of the others they are zero. lambda is expanded.
template <class T>
void contract_composites(const Model& m, Data<T>& d, const T* lambda) {
  const Body* bodies = m.bodies();
  d.lambda_motion[0] = Motion<T>::zero();
  auto own = [&](const Body& b, int nv) DYN_INLINE_LAMBDA {
    Motion<T> l = Motion<T>::zero();
    for (int k = 0; k < nv; ++k) l = l + d.S[b.idx_v + k] * lambda[b.idx_v + k];
    return l;
  };
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = bodies[i];
    if (!d.active[b.idx_v]) {
      for (int k = 0; k < J::nv; ++k) {
        const Index at = b.idx_v + k;
        d.mu_S[at] = Motion<T>::zero(), d.G[at] = Force<T>::zero(), d.E[at] = d.H[at] = Vec3<T>::zero();
      }
      return;
    }
    const Motion<T> lp = d.lambda_motion[b.parent];
    for (int k = 0; k < J::nv; ++k) d.mu_S[b.idx_v + k] = cross(lp, d.S[b.idx_v + k]);
    d.lambda_motion[i] = lp + own(b, J::nv);
    d.contraction[i].rates = {Vec3<T>::zero(), Mat3<T>::zero()};
    d.contraction[i].Q = Vec3<T>::zero();
  });
  // contraction: until its body's turn what moves with lambda relative to the body, then in all
  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = bodies[i];
    if (!d.active[b.idx_v]) return;
    const Composite<T>& c = d.composite[i];
    Contraction<T>& x = d.contraction[i];
    if (b.parent != 0) {
      const Motion<T> l = own(b, J::nv);
      const MomentRates<T> relative = x.rates + MomentRates<T>::of(c.Y, l);
      MomentRates<T>& up = d.contraction[b.parent].rates;
      up.p += relative.p, up.V = up.V + relative.V;
      d.contraction[b.parent].Q += x.Q + c.rates.coriolis_transposed(l);
    }
    const Motion<T> l = d.lambda_motion[i];
    const MomentRates<T> L = x.rates + MomentRates<T>::of(c.Y, l);
    const Vec3<T> Q = x.Q + c.rates.coriolis_transposed(l);
    x.rates.p = L.p, x.rates.V = L.V, x.Q = Q;
    const Force<T> P = L.momentum();
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      const Motion<T> S = d.S[at], mu = d.mu_S[at];
      d.G[at] = cross(S, P) + c.Y * mu;
      d.E[at] = cross(S.angular, Q) + c.rates.coriolis_transposed(mu) - L.coriolis_transposed(d.dS[at]);
      d.H[at] = -L.coriolis_transposed(S);
    }
  });
}

// The matrices, in the expanded coordinates; what no lambda reaches is left as it is.
template <class T>
void second_order_tiles(const Model& m, const Data<T>& d, const SecondOrder<T>& out) {
  const std::ptrdiff_t n = m.n.nvx;
  const TiledMatrix<T> dqdq{out.dqdq, n}, dvdv{out.dvdv, n}, dqdv{out.dqdv, n}, dadq{out.dadq, n};
  struct Rows {
    Six<T> S, dS, ddS, W, mu;
  };
  for_each_tile<T>(
      m,
      [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA {
        return Rows{Six<T>::transposed(d.S + i0), Six<T>::transposed(d.dS + i0), Six<T>::transposed(d.ddS + i0), Six<T>::transposed(d.W + i0),
                    Six<T>::transposed(d.mu_S + i0)};
      },
      [&](const Rows& rows, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        if (!(d.active[j0] | d.active[j0 + 1] | d.active[j0 + 2] | d.active[j0 + 3])) return;
        auto tile = [&](auto&& entry) DYN_INLINE_LAMBDA { return Tile<T>::of(j0, mask, entry); };
        if (out.dqdq) {
          const Tile<T> t = tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.mu.dot(d.Fq[j]) + rows.ddS.dot(d.G[j]) + rows.dS.dot_angular(d.E[j]); });
          dqdq.store_pair(t, t.transposed(), i0, j0);
        }
        if (out.dvdv) {
          const Tile<T> t = tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot_angular(d.H[j]); });
          dvdv.store_pair(t, t.transposed(), i0, j0);
        }
        if (out.dqdv)
          dqdv.store_pair(tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.mu.dot(d.Fv[j]) + rows.dS.dot_angular(d.H[j]); }),
                          tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.W.dot(d.G[j]) + rows.S.dot_angular(d.E[j]); }).transposed(), i0, j0);
        if (out.dadq)
          dadq.store_pair(tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.S.dot(d.G[j]); }),
                          tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return rows.mu.dot(d.F[j]); }).transposed(), i0, j0);
      });
  // columns of one joint turn together, and none of them changes the others' psi', psi'' and mu by its velocity
  for_each_pair_in_a_body(m, [&](Index i, std::ptrdiff_t r, std::ptrdiff_t c) {
    if (!d.active[r]) return;
    if (out.dqdq) dqdq.p[r + n * c] = dot(d.mu_S[c], d.Fq[r]) + dot(d.ddS[c], d.G[r]) + dot(d.dS[c].angular, d.E[r]);
    if (out.dvdv) {
      const T turned = dot(d.S[r], cross(d.S[c], d.contraction[i].rates.momentum()));
      dvdv.p[r + n * c] -= turned, dvdv.p[c + n * r] -= turned;
    }
    if (out.dqdv) dqdv.p[c + n * r] = dot(d.mu_S[c], d.Fv[r]) + dot(d.dS[c].angular, d.H[r]);
    if (out.dadq) dadq.p[r + n * c] = dot(d.mu_S[c], d.F[r]);
  });
}

// The matrices of one lambda, expanded, for which d.active is set.
template <class T>
void second_order_contracted(const Model& m, Data<T>& d, const T* lambda, const SecondOrder<T>& out) {
  contract_composites(m, d, lambda);
  if (!m.has_mimic) return second_order_tiles(m, d, out);
  second_order_tiles(m, d, SecondOrder<T>{d.dqx, d.dvx, d.Mx, d.d2x});
  if (out.dqdq) contract(m, d.dqx, out.dqdq);
  if (out.dvdv) contract_symmetric(m, d.dvx, out.dvdv);
  if (out.dqdv) contract(m, d.Mx, out.dqdv);
  if (out.dadq) contract(m, d.d2x, out.dadq);
}

// Of lambda . tau, after second_order_columns. Entries of unrelated joints must be zero before.
template <class T>
void second_order_product(const Model& m, Data<T>& d, const T* lambda, const SecondOrder<T>& out) {
  std::fill_n(d.active, m.n.nvx, Index(1));
  second_order_contracted(m, d, d.expand(m, lambda, d.lambdax), out);
}

// d.active: degrees of freedom that carry, or are carried by, joints that move with the user's u-th velocity.
template <class T>
void activate(const Model& m, Data<T>& d, Index u) {
  const Body* bodies = m.bodies();
  std::fill_n(d.active, m.n.nvx, Index(0));
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Index first = bodies[i].idx_v, end = first_dof(m, i + 1);
    if (u < bodies[i].user_v || u >= bodies[i].user_v + end - first) continue;
    std::fill(d.active + first, d.active + m.dof_end()[first], Index(1));
    for (Index p = bodies[i].parent; p != 0; p = bodies[p].parent) std::fill(d.active + bodies[p].idx_v, d.active + first_dof(m, p + 1), Index(1));
  }
}

// Of each tau_i, after second_order_columns: nv matrices one after another.
template <class T>
void second_order_derivatives(const Model& m, Data<T>& d, const SecondOrder<T>& out) {
  const std::ptrdiff_t n = m.n.nv, squares = n * n, nx = m.n.mimic_v;
  auto matrix = [&](T* tensor, T* expanded, Index i) {
    if (!tensor) return tensor;
    std::fill_n(m.has_mimic ? expanded : tensor + squares * i, m.has_mimic ? nx * nx : squares, T(0));
    return tensor + squares * i;
  };
  for (Index i = 0; i < n; ++i) {
    activate(m, d, i);
    std::fill_n(d.unit, n, T(0));
    d.unit[i] = T(1);
    second_order_contracted(m, d, d.expand(m, d.unit, d.lambdax),
                            SecondOrder<T>{matrix(out.dqdq, d.dqx, i), matrix(out.dvdv, d.dvx, i), matrix(out.dqdv, d.Mx, i), matrix(out.dadq, d.d2x, i)});
  }
}

// Bounds what the second derivatives are made of: below 1e70 none of them overflows.
template <class T>
T second_order_size(const Model& m, const Data<T>& d) {
  Vec3<T> sum = Vec3<T>::zero();
  auto add = [&](const auto& x) DYN_INLINE_LAMBDA { sum += sizes(x.linear) + sizes(x.angular); };
  for (Index k = 0; k < m.n.nvx; ++k) add(d.S[k]), add(d.dS[k]), add(d.ddS[k]), add(d.W[k]), add(d.F[k]), add(d.Fq[k]), add(d.Fv[k]);
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Composite<T>& c = d.composite[i];
    for (const Mat3<T>* A : {&c.Y.P, &c.rates.V}) sum += sizes(A->x) + sizes(A->y) + sizes(A->z);
    sum += sizes(c.Y.h) + sizes(c.rates.p);
    sum += Vec3<T>::make(c.Y.m, T(0), T(0));
  }
  return sum[0] + sum[1] + sum[2];
}

}  // namespace dyn
