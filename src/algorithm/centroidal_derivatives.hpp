// Derivatives of the centroidal momentum and of its rate on the tangent space (Carpentier, Mansard 2018, "Analytical derivatives
// of rigid body dynamics algorithms"; Singh, Russell, Wensing 2022). A step of q along the column S of body i carries everything
// beyond rigidly with S, but for what the parent p adds to its motion. With the composite body's inertia Y, momentum h and force
// f,
//   dV = V_p x S                        dA = A_p x S + V_p x dV
//   dh/dq = S x* h + Y dV               dh'/dq = S x* f + Y dA + B dV              dh'/dv = Y (V_i x S + dV) + B S
// B x = sum of V x* Y x - Y (V x x) + x x* h. All at the body's origin, then passed on to the centre of mass.
#pragma once

#include "algorithm/centroidal.hpp"

namespace dyn {

// d.dh_dq, d.dhdot_dq, d.dhdot_dv; and d.Ag, which is also dhdot_da, d.Ig, d.hg, d.dhg.
template <class T>
void centroidal_derivatives(const Model& m, Data<T>& d) {
  const T *v = d.expand(m, d.v, d.vx), *a = d.expand(m, d.a, d.ax);
  const Body* bodies = m.bodies();
  const Motions<T> x = own_motions(d);
  const Sums<T> sums =
      place_forward(m, d, Sums<T>(d), [&]<class J>(Index i, Index, const SE3<T>& X, Sums<T>& s) DYN_INLINE_LAMBDA {
        const Body& b = bodies[i];
        const Vec3<T> r = s.place(d, i, X);
        move_body<2, J>(b, i, x, s.R, r, v, a);
        const Vec3<T> arm = s.lead(d, i, b.parent, r);
        const Inertia<T> Y = world_inertia(b, s.R);
        const Vec3<T> w = x.omega[i], u = x.vel[i], dw = x.alpha[i], du = x.acc[i], wh = cross(w, Y.h), Iw = Y.I * w;
        const Vec3<T> P = u * Y.m + wh, f = du * Y.m + cross(dw, Y.h) + cross(w, wh);
        const CompositeMotion<T> C = {
            Y, turning(w, Y.I) + parallel_axis(u, Y.h), {P, Iw + cross(Y.h, u)}, {f, Y.I * dw + cross(w, Iw) + cross(Y.h, du)}};
        store(C, d.CM[i]);
        s.mc += arm * Y.m + Y.h;
        s.linear += P;
        s.force += f;
      });
  const T inverse = inverse_mass<T>(m);
  const Vec3<T> c = sums.mc * inverse, vc = sums.linear * inverse, ac = sums.force * inverse;

  T *Ag = columns(m, d, 0, d.Ag), *dh_dq = columns(m, d, 1, d.dh_dq);
  T *dhdot_dq = columns(m, d, 2, d.dhdot_dq), *dhdot_dv = columns(m, d, 3, d.dhdot_dv);
  struct Composite {
    CompositeMotion<T> C;
    bool chain;
  };
  const Force<T> zero = Force<T>::zero();
  d.CM[0] = {Inertia<T>::zero(), Sym3<T>::zero(), zero, zero};
  backward(m, Composite{d.CM[0], false}, [&]<class J>(Index i, Composite& up) DYN_INLINE_LAMBDA {
    const Body& b = bodies[i];
    const Index p = b.parent;
    const Vec3<T> r = d.r[i], to_com = d.arm[i] - c, wp = x.omega[p];
    CompositeMotion<T> C = d.CM[i];
    if (up.chain) C = C + up.C;
    // velocities of body and parent, acceleration of the parent: spatial, at the body's origin
    const Motion<T> V = {x.vel[i], x.omega[i]}, Vp = shift(Motion<T>{x.vel[p], wp}, r);
    const Motion<T> Ap = shift(Motion<T>{x.acc[p] - cross(wp, x.vel[p]), x.alpha[p]}, r);
    for (int k = 0; k < J::nv; ++k) {
      const Motion<T> S = J::column(b, d.R[i], k), dV = cross(Vp, S);
      const Force<T> F = shift(momentum<J>(C.Y, S, k), to_com);
      Force<T> h = shift(cross(S, C.h) + C.Y * dV, to_com);
      Force<T> fq = shift(cross(S, C.f) + C.Y * (cross(Ap, S) + cross(Vp, dV)) + C.B(dV.angular), to_com);
      const Force<T> fv = shift(C.Y * (cross(V, S) + dV) + C.B(S.angular), to_com);
      // the centre of mass moves by F.linear / m
      h.angular -= cross(F.linear, vc);
      fq.angular -= cross(F.linear, ac);
      const Index at = 6 * (b.idx_v + k);
      store6(F, Ag + at), store6(h, dh_dq + at), store6(fq, dhdot_dq + at), store6(fv, dhdot_dv + at);
    }
    up.chain = p == i - 1 && p != 0;
    up.C = C.shifted(p ? r : to_com);
    if (!up.chain) store(d.CM[p] + up.C, d.CM[p]);
  });
  reduce_columns(m, Ag, d.Ag), reduce_columns(m, dh_dq, d.dh_dq);
  reduce_columns(m, dhdot_dq, d.dhdot_dq), reduce_columns(m, dhdot_dv, d.dhdot_dv);
  store6(d.CM[0].h, d.hg), store6(d.CM[0].f, d.dhg);
  store_inertia(d.CM[0].Y, d.Ig);
  sums.done(d);
  for (Stage s : {Stage::CentroidalMap, Stage::CentroidalMomentum, Stage::CentroidalMomentumRate,
                  Stage::CentroidalDerivatives, Stage::CentroidalRateDerivative})
    d.mark_fresh(s);
}

}  // namespace dyn
