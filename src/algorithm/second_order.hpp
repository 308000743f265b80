// Second derivatives of inverse dynamics on the tangent space, contracted with a vector lambda, in O(n depth). lambda . tau is
// the power of the bodies' forces f at the velocities l that lambda gives them. With mu = l_p x S, L the composite of Y that
// moves with l, B(v) and B(l) the Coriolis maps of the two motions (2 B of Singh, Russell, Wensing 2022), Q = the sum of 2 B(v)^T
// l, P that of Y l,
//   d(lambda . tau)/dq_j = mu_j . f + psi''_j . P + psi'_j . Q      /dv_j = W_j . P + S_j . Q      /da_j = S_j . P,   W = psi' +
//   S'
// A step of q along S_k, k supporting j, turns all of this, which changes no product, and besides changes
//   mu_j by mu_k x S_j     psi'_j by psi'_k x S_j     psi''_j by psi''_k x S_j + 2 psi'_k x psi'_j
//   f by Y psi''_k + 2 B(v) psi'_k     P by Y mu_k     Q by 2 B(v)^T mu_k - 2 B(l)^T psi'_k
// What mu_k, psi'_k, psi''_k, S_k, W_k are multiplied with belongs to j alone: Fq, Fv, F = Y S as in the first derivatives, and
//   G_j = S_j x* P + Y mu_j     E_j = S_j x* Q + 2 B(v)^T mu_j - 2 B(l)^T psi'_j     H_j = -2 B(l)^T S_j
// so that, with k supporting j and the columns of one joint apart,
//   dq_j dq_k = dq_k dq_j = mu_k . Fq_j + psi''_k . G_j + psi'_k . E_j            dv_j dv_k = dv_k dv_j = S_k . H_j
//   dq_j dv_k = W_k . G_j + S_k . E_j     dq_k dv_j = mu_k . Fv_j + psi'_k . H_j     da_j dq_k = mu_k . F_j     da_k dq_j = S_k .
//   G_j
#pragma once

#include "algorithm/effects.hpp"
#include "algorithm/declarations.hpp"
#include "algorithm/rnea_derivatives.hpp"

namespace dyn {

// What does not depend on lambda: columns, also as rows of tiles, composites, F, Fq, Fv. fext 6 x njoints in joint frames, or
// nullptr.
template <class T>
void second_order_columns(const Model& m, Data<T>& d, const T* v, const T* a, const T* fext) {
  derivative_columns(m, d, d.expand(m, v, d.vx), d.expand(m, a, d.ax));
  if (fext) subtract_external_at_root(m, d, fext);
  composite_forces(m, d, static_cast<T*>(nullptr));
  for (std::ptrdiff_t i0 = 0; i0 < m.n.nvx; i0 += 4) {
    SecondOrderRows<T>& rows = d.rows[i0 / 4];
    Six<T>::transposed(d.S + i0).store(rows.S), Six<T>::transposed(d.dS + i0).store(rows.dS);
    Six<T>::transposed(d.ddS + i0).store(rows.ddS), Six<T>::transposed(d.W + i0).store(rows.W);
  }
}

// G, E, H of a degree of freedom whose subtree moves with l: L, P, Q are those of l.
template <class T>
struct Meeting {
  Force<T> G;
  Vec3<T> E, H;

  // what does not depend on mu
  static DYN_INLINE Meeting of(const Data<T>& d, Index j, const MomentRates<T>& L, const Force<T>& P, const Vec3<T>& Q) {
    return {cross(d.S[j], P), cross(d.S[j].angular, Q) - L.coriolis_transposed(d.dS[j]), -L.coriolis_transposed(d.S[j])};
  }
  DYN_INLINE void add(const Composite<T>& c, const Motion<T>& mu) { G = G + c.Y * mu, E += c.rates.coriolis_transposed(mu); }
};

// mu, G, E, H of all degrees of freedom. lambda is expanded.
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
    const Motion<T> lp = d.lambda_motion[b.parent];
    for (int k = 0; k < J::nv; ++k) d.mu_S[b.idx_v + k] = cross(lp, d.S[b.idx_v + k]);
    d.lambda_motion[i] = lp + own(b, J::nv);
    d.contraction[i].rates = {Vec3<T>::zero(), Mat3<T>::zero()};
    d.contraction[i].Q = Vec3<T>::zero();
  });
  // contraction: of what moves relative to the body
  backward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = bodies[i];
    const Composite<T>& c = d.composite[i];
    const Contraction<T>& x = d.contraction[i];
    if (b.parent != 0) {
      const Motion<T> l = own(b, J::nv);
      const MomentRates<T> relative = x.rates + MomentRates<T>::of(c.Y, l);
      Contraction<T>& up = d.contraction[b.parent];
      up.rates.p += relative.p, up.rates.V = up.rates.V + relative.V;
      up.Q += x.Q + c.rates.coriolis_transposed(l);
    }
    const Motion<T> l = d.lambda_motion[i];
    const MomentRates<T> L = x.rates + MomentRates<T>::of(c.Y, l);
    const Vec3<T> Q = x.Q + c.rates.coriolis_transposed(l);
    const Force<T> P = d.P[i] = L.momentum();
    for (Index j = b.idx_v; j < b.idx_v + J::nv; ++j) {
      Meeting<T> met = Meeting<T>::of(d, j, L, P, Q);
      met.add(c, d.mu_S[j]);
      d.G[j] = met.G, d.E[j] = met.E, d.H[j] = met.H;
    }
  });
}

// One tile of each matrix; rows whose mu is zero are spared its products.
template <bool moves, class T, class Mask>
DYN_INLINE void second_order_tile(const Data<T>& d, const SecondOrder<TiledMatrix<T>>& out, const SecondOrderRows<T>& rows,
                                  const Six<T>& mu, std::ptrdiff_t i0, std::ptrdiff_t j0, Mask&& mask) {
  using P = Simd<T, 4>;
  const Six<T> S = Six<T>::load(rows.S), dS = Six<T>::load(rows.dS);
  auto tile = [&](auto&& entry) DYN_INLINE_LAMBDA { return Tile<T>::of(j0, mask, entry); };
  auto with_mu = [&](const P& x, const Force<T>& f) DYN_INLINE_LAMBDA -> P {
    if constexpr (moves) return x + mu.dot(f);
    return x;
  };
  if (out.dqdq.p) {
    const Six<T> ddS = Six<T>::load(rows.ddS);
    const Tile<T> t =
        tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return with_mu(ddS.dot(d.G[j]) + dS.dot_angular(d.E[j]), d.Fq[j]); });
    out.dqdq.store_pair(t, t.transposed(), i0, j0);
  }
  if (out.dvdv.p) {
    const Tile<T> t = tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return S.dot_angular(d.H[j]); });
    out.dvdv.store_pair(t, t.transposed(), i0, j0);
  }
  if (out.dqdv.p) {
    const Six<T> W = Six<T>::load(rows.W);
    out.dqdv.store_pair(
        tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return with_mu(dS.dot_angular(d.H[j]), d.Fv[j]); }),
        tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return W.dot(d.G[j]) + S.dot_angular(d.E[j]); }).transposed(), i0, j0);
  }
  if (out.dadq.p)
    out.dadq.store_pair(tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return S.dot(d.G[j]); }),
                        tile([&](std::ptrdiff_t j) DYN_INLINE_LAMBDA { return with_mu(P{}, d.F[j]); }).transposed(), i0, j0);
}

// The matrices in the expanded coordinates. for_tiles(begin, f) goes over the tiles.
template <class T, class Tiles>
void second_order_tiles(const Model& m, const Data<T>& d, Tiles&& for_tiles, const SecondOrder<T*>& p) {
  const std::ptrdiff_t n = m.n.nvx;
  const SecondOrder<TiledMatrix<T>> out{{p.dqdq, n}, {p.dvdv, n}, {p.dqdv, n}, {p.dadq, n}};
  struct Rows {
    const SecondOrderRows<T>& fixed;
    Six<T> mu;
    bool moves;
  };
  for_tiles(
      [&](std::ptrdiff_t i0) DYN_INLINE_LAMBDA {
        const Motion<T>* mu = d.mu_S + i0;
        const bool moves = !(is_zero(mu[0]) && is_zero(mu[1]) && is_zero(mu[2]) && is_zero(mu[3]));
        return Rows{d.rows[i0 / 4], moves ? Six<T>::transposed(mu) : Six<T>{}, moves};
      },
      [&](const Rows& rows, std::ptrdiff_t i0, std::ptrdiff_t j0, auto&& mask) DYN_INLINE_LAMBDA {
        if (rows.moves)
          second_order_tile<true>(d, out, rows.fixed, rows.mu, i0, j0, mask);
        else
          second_order_tile<false>(d, out, rows.fixed, rows.mu, i0, j0, mask);
      });
  // columns of one joint turn together, and none of them changes the others' psi', psi'' and mu by its velocity
  for_each_block(m, [&](Index i, std::ptrdiff_t first, int nv) {
    if (!d.active[first]) return;  // zero
    const bool rooted = m.bodies()[i].parent == 0;  // psi' = mu = 0
    for (std::ptrdiff_t c = first + 1; c < first + nv; ++c) {
      const Force<T> turned = cross(d.S[c], d.P[i]);
      for (std::ptrdiff_t r = first; r < c; ++r) {
        const T by_turning = dot(d.S[r], turned);
        if (p.dqdq)
          p.dqdq[r + n * c] = dot(d.ddS[c], d.G[r]) + (rooted ? T(0) : dot(d.mu_S[c], d.Fq[r]) + dot(d.dS[c].angular, d.E[r]));
        if (p.dvdv) p.dvdv[r + n * c] -= by_turning, p.dvdv[c + n * r] -= by_turning;
        if (p.dqdv) p.dqdv[c + n * r] = rooted ? T(0) : dot(d.mu_S[c], d.Fv[r]) + dot(d.dS[c].angular, d.H[r]);
        if (p.dadq) p.dadq[r + n * c] = rooted ? T(0) : dot(d.mu_S[c], d.F[r]);
      }
    }
  });
}

// The matrices from mu, G, E, H.
template <class T, class Tiles>
void second_order_matrices(const Model& m, Data<T>& d, Tiles&& for_tiles, const SecondOrder<T*>& out) {
  if (!m.has_mimic) return second_order_tiles(m, d, for_tiles, out);
  second_order_tiles(m, d, for_tiles, SecondOrder<T*>{d.dqx, d.dvx, d.Mx, d.d2x});
  if (out.dqdq) contract(m, d.dqx, out.dqdq);
  if (out.dvdv) contract_symmetric(m, d.dvx, out.dvdv);
  if (out.dqdv) contract(m, d.Mx, out.dqdv);
  if (out.dadq) contract(m, d.d2x, out.dadq);
}

// Of lambda . tau, after second_order_columns. Entries of unrelated joints must be zero before.
template <class T>
void second_order_product(const Model& m, Data<T>& d, const T* lambda, const SecondOrder<T*>& out) {
  std::fill_n(d.active, m.n.nvx, Index(1));
  contract_composites(m, d, d.expand(m, lambda, d.lambdax));
  second_order_matrices(m, d, [&](auto&& begin, auto&& f) DYN_INLINE_LAMBDA { for_each_tile<T>(m, begin, f); }, out);
  add_resistance_second_order(m, d, d.v, [&](Index k) { return lambda[k]; }, out.dqdq, out.dvdv);
}

}  // namespace dyn
