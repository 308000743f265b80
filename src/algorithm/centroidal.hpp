// Momentum about the centre of mass in world axes: h_g = A_g v, dh_g = A_g a + dA_g v (Orin, Goswami, Lee 2013, "Centroidal
// dynamics of a humanoid robot"). Composite inertias are referred to each body's own origin, as in CRBA; a column of A_g is the
// momentum of the composite body under a unit velocity, passed on to the centre of mass. Rotors are left out.
#pragma once

#include "algorithm/jacobian.hpp"
#include "spatial/inertia_rate.hpp"

namespace dyn {

// What the bodies so far add up to: moments about the origin of the first body.
template <class T>
struct Sums : Pose<T> {
  Vec3<T> mc;               // first moment
  Vec3<T> linear, angular;  // momentum
  Vec3<T> force, moment;    // rate of the momentum

  explicit DYN_INLINE Sums(const Data<T>& d) : Pose<T>(d) { mc = linear = angular = force = moment = Vec3<T>::zero(); }
  // d.arm[i], from the first body's origin to that of body i: distance from the world's origin costs no digits
  DYN_INLINE Vec3<T> lead(Data<T>& d, Index i, Index parent, const Vec3<T>& r) const {
    if (i == 1) d.arm[0] = -r;
    return d.arm[i] = d.arm[parent] + r;
  }
};

// Velocities and accelerations of these passes: not those of the kinematics, whose last bits must not depend on which algorithm
// came before.
template <class T>
DYN_INLINE Motions<T> own_motions(const Data<T>& d) {
  return {d.omega_centroidal, d.vel_centroidal, d.alpha_centroidal, d.acc_centroidal};
}
// A robot without mass has no centre of mass: the first body's origin stands for it.
template <class T>
DYN_INLINE T inverse_mass(const Model& m) {
  return m.total_mass > 0 ? T(1) / T(m.total_mass) : T(0);
}

// Where a pass writes its n-th 6 x nv matrix: followers of a mimic have columns of their own, which reduce_columns adds to those
// of their leaders.
template <class T>
DYN_INLINE T* columns(const Model& m, const Data<T>& d, int n, T* matrix) {
  return m.has_mimic ? d.columnsx + n * 6 * std::ptrdiff_t(m.n.nvx) : matrix;
}
template <class T>
void reduce_columns(const Model& m, const T* expanded, T* matrix) {
  if (!m.has_mimic) return;
  for (Index k = 0; k < 6 * m.n.nv; ++k) matrix[k] = T(0);
  for (Index k = 0; k < m.n.nvx; ++k)
    for (int x = 0; x < 6; ++x) matrix[6 * m.expand_v()[k] + x] += T(m.ratio_v()[k]) * expanded[6 * k + x];
}

// 6 x 6, [m 1, 0; 0, I], of an inertia about its centre of mass.
template <class T>
void store_inertia(const Inertia<T>& Y, T* Ig) {
  for (int k = 0; k < 36; ++k) Ig[k] = T(0);
  for (int c = 0; c < 3; ++c) {
    Ig[7 * c] = Y.m;
    for (int r = 0; r < 3; ++r) Ig[21 + 6 * c + r] = Y.I(r, c);
  }
}

// d.Ag, d.Ig, and d.hg = A_g v; with rate also d.dAg. In a frame that moves with body i its S = [l; w] changes by
// dS = w_i x S, and F = Y S by dF = Y dS + dY S.
template <bool rate, class T>
void centroidal_map(const Model& m, Data<T>& d) {
  const T* v = d.expand(m, d.v, d.vx);
  const Body* bodies = m.bodies();
  const Motions<T> x = own_motions(d);
  const Sums<T> sums =
      place_forward(m, d, Sums<T>(d), [&]<class J>(Index i, Index, const SE3<T>& X, Sums<T>& s) DYN_INLINE_LAMBDA {
        const Body& b = bodies[i];
        const Vec3<T> r = s.place(d, i, X);
        const Vec3<T> arm = s.lead(d, i, b.parent, r);
        const Inertia<T> Y = world_inertia(b, s.R);
        store(Y, d.Yc[i]);
        s.mc += arm * Y.m + Y.h;
        if constexpr (rate) {
          move_body<1, J>(b, i, x, s.R, r, v, v);
          const Inertia<T> dY = dyn::rate(Y, x.omega[i]);
          store(dY, d.dYc[i]);
          s.linear += x.vel[i] * Y.m + dY.h;
        }
      });
  const Vec3<T> c = sums.mc * inverse_mass<T>(m), vc = sums.linear * inverse_mass<T>(m);

  T *Ag = columns(m, d, 0, d.Ag), *dAg = columns(m, d, 1, d.dAg);
  struct Composite {
    Inertia<T> Y, dY;
    Force<T> h;
    bool chain;
  };
  d.Yc[0] = Inertia<T>::zero();
  const Composite all =
      backward(m, Composite{d.Yc[0], d.Yc[0], Force<T>::zero(), false}, [&]<class J>(Index i, Composite& up) DYN_INLINE_LAMBDA {
        const Body& b = bodies[i];
        const Mat3<T>& R = d.R[i];
        const Vec3<T> to_com = d.arm[i] - c;
        Inertia<T> Y = d.Yc[i], dY;
        Vec3<T> speed;
        if (up.chain) Y = Y + up.Y;
        if constexpr (rate) {
          dY = d.dYc[i];
          if (up.chain) dY = dY + up.dY;
          speed = x.vel[i] - vc;
        }
        for (int k = 0; k < J::nv; ++k) {
          const Motion<T> s = J::column(b, R, k);
          const Force<T> F = momentum<J>(Y, s, k), Fg = shift(F, to_com);
          store6(Fg, Ag + 6 * (b.idx_v + k));
          up.h = up.h + Fg * v[b.idx_v + k];
          if constexpr (rate) {
            Motion<T> ds = s;
            if constexpr (J::translates) ds.linear = cross(x.omega[i], s.linear);
            if constexpr (J::rotates) ds.angular = cross(x.omega[i], s.angular);
            Force<T> dF = shift(momentum<J>(Y, ds, k) + momentum<J>(dY, s, k), to_com);
            dF.angular += cross(speed, F.linear);
            store6(dF, dAg + 6 * (b.idx_v + k));
          }
        }
        up.chain = b.parent == i - 1 && b.parent != 0;
        up.Y = Y.shifted(b.parent ? d.r[i] : to_com);
        if (!up.chain) store(d.Yc[b.parent] + up.Y, d.Yc[b.parent]);
        if constexpr (rate)
          if (b.parent) {
            up.dY = shifted_rate(Y, dY, d.r[i], x.vel[i] - x.vel[b.parent]);
            if (!up.chain) store(d.dYc[b.parent] + up.dY, d.dYc[b.parent]);
          }
      });
  reduce_columns(m, Ag, d.Ag);
  if (rate) reduce_columns(m, dAg, d.dAg);
  store6(all.h, d.hg);
  store_inertia(d.Yc[0], d.Ig);
  sums.done(d);
  d.mark_fresh(Stage::CentroidalMap), d.mark_fresh(Stage::CentroidalMomentum);
  if (rate) d.mark_fresh(Stage::CentroidalMapRate);
}

// d.hg, and with rate d.dhg, without columns: sums over the bodies of
//   f = m u + w x h                     n = I w + h x u
// and of the force and moment of RNEA without gravity.
template <bool rate, class T>
void centroidal_momentum(const Model& m, Data<T>& d) {
  const T *v = d.expand(m, d.v, d.vx), *a = rate ? d.expand(m, d.a, d.ax) : nullptr;
  const Motions<T> x = own_motions(d);
  const Sums<T> sums =
      place_forward(m, d, Sums<T>(d), [&]<class J>(Index i, Index, const SE3<T>& X, Sums<T>& s) DYN_INLINE_LAMBDA {
        const Body& b = m.bodies()[i];
        const Vec3<T> r = s.place(d, i, X);
        move_body<rate ? 2 : 1, J>(b, i, x, s.R, r, v, a);
        const Vec3<T> arm = s.lead(d, i, b.parent, r);
        const Mat3<T> Rt = transpose(s.R), I = cast<T>(b.I);
        const Vec3<T> h = s.R * cast<T>(b.h), w = x.omega[i], u = x.vel[i], wB = Rt * w, nB = I * wB, wh = cross(w, h),
                      f = u * T(b.m) + wh;
        s.mc += arm * T(b.m) + h;
        s.linear += f;
        s.angular += s.R * nB + cross(h, u) + cross(arm, f);
        if constexpr (rate) {
          const Vec3<T> dw = x.alpha[i], du = x.acc[i], df = du * T(b.m) + cross(dw, h) + cross(w, wh);
          s.force += df;
          s.moment += s.R * (I * (Rt * dw) + cross(wB, nB)) + cross(h, du) + cross(arm, df);
        }
      });
  const Vec3<T> c = sums.mc * inverse_mass<T>(m);
  store6(shift(Force<T>{sums.linear, sums.angular}, -c), d.hg);
  if (rate) store6(shift(Force<T>{sums.force, sums.moment}, -c), d.dhg);
  sums.done(d);
  d.mark_fresh(Stage::CentroidalMomentum);
  if (rate) d.mark_fresh(Stage::CentroidalMomentumRate);
}

}  // namespace dyn
