// Coriolis matrix C with C v + g = nle and dM/dt = C + C^T (Echeandia and Wensing 2021, "Numerical methods to compute the
// Coriolis matrix and Christoffel symbols for rigid-body systems", algorithm 1), in world axes at the root of each tree.
#pragma once

#include "dyn/algorithm/jacobian.hpp"

namespace dyn {

// B(I, v) = ((v x*) I + (I v) xbar* - I (v x)) / 2, h xbar* x = x x* h
template <class T>
inline MotionToForce<T> body_coriolis(const Inertia<T>& Y, const Motion<T>& v) {
  const Mat3<T> W = skew(v.angular), V = skew(v.linear), H = skew(Y.h), I = Y.I.full(), m1 = Mat3<T>::diagonal(Y.m, Y.m, Y.m);
  const Force<T> h = Y * v;
  const Mat3<T> F = skew(h.linear), N = skew(h.angular), mH = H * T(-1);  // I = [m -H; H I]
  const MotionToForce<T> vI = {W * m1, W * mH, V * m1 + W * H, V * mH + W * I};
  const MotionToForce<T> Iv = {m1 * W, m1 * V + mH * W, H * W, H * V + I * W};
  auto half = [](const Mat3<T>& A) { return A * T(0.5); };
  return {half(vI.ll - Iv.ll), half(vI.la - Iv.la - F), half(vI.al - Iv.al - F), half(vI.aa - Iv.aa - N)};
}

// d.coriolis, nv x nv, fully written.
template <class T>
void coriolis_matrix(const Model& m, Data<T>& d) {
  ensure_velocity(m, d);
  const std::ptrdiff_t nv = m.n.nv;
  T* C = d.coriolis;
  for (std::ptrdiff_t k = 0; k < nv * nv; ++k) C[k] = T(0);
  for (Index i = m.n.bodies - 1; i >= 1; --i) {
    d.BC[i] = {Mat3<T>::zero(), Mat3<T>::zero(), Mat3<T>::zero(), Mat3<T>::zero()};
    d.YC[i] = Inertia<T>::zero();
  }
  // bodies in the coordinates of their tree's root: axes of the world, origin of the first body
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Body& b = m.bodies()[i];
    d.root[i] = b.parent == 0 ? Vec3<T>::zero() : d.root[b.parent] + d.r[i];
  }
  auto velocity = [&](Index i) { return shift(Motion<T>{d.u[i], d.w[i]}, -d.root[i]); };
  auto column = [&]<class J>(Index i, int k) { return shift(J::column(m.bodies()[i], d.R[i], k), -d.root[i]); };
  for (Index j = m.n.bodies - 1; j >= 1; --j) {
    const Body& bj = m.bodies()[j];
    const Inertia<T> Y = world_inertia(bj, d.R[j]).shifted(d.root[j]);
    d.YC[j] = d.YC[j] + Y;
    d.BC[j] = d.BC[j] + body_coriolis(Y, velocity(j));
    visit(bj.type, [&]<class Jj>() {
      for (int kj = 0; kj < Jj::nv; ++kj) {
        const Motion<T> psi = column.template operator()<Jj>(j, kj), dpsi = cross(velocity(j), psi);
        const Force<T> F1 = d.YC[j] * dpsi + d.BC[j] * psi, F2 = d.YC[j] * psi, F3 = d.BC[j].transposed_times(psi);
        const std::ptrdiff_t uj = bj.user_v + kj;
        for (Index i = j; i != 0; i = m.bodies()[i].parent) {
          const Body& bi = m.bodies()[i];
          const T ratio = T(bi.ratio) * T(bj.ratio);
          visit(bi.type, [&]<class Ji>() {
            for (int ki = 0; ki < Ji::nv; ++ki) {
              const Motion<T> phi = column.template operator()<Ji>(i, ki), dphi = cross(velocity(i), phi);
              const std::ptrdiff_t ui = bi.user_v + ki;
              C[ui + nv * uj] += ratio * dot(phi, F1);
              if (i != j) C[uj + nv * ui] += ratio * (dot(dphi, F2) + dot(phi, F3));
            }
          });
        }
      }
    });
    if (bj.parent) d.YC[bj.parent] = d.YC[bj.parent] + d.YC[j], d.BC[bj.parent] = d.BC[bj.parent] + d.BC[j];
  }
  d.done(Stage::Coriolis);
}

}  // namespace dyn
