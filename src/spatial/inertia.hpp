// Inertias about a point: rigid (mass, first moment, second moment) and articulated (a symmetric 6 x 6 in blocks).
#pragma once

#include "spatial/se3.hpp"
#include "spatial/sym3.hpp"

namespace dyn {

// Ten parameters, linear in the mass distribution: sums of inertias are sums of members.
template <class T>
struct Inertia {
  T m;        // mass
  Vec3<T> h;  // m c, the first moment about the point
  Sym3<T> I;  // second moment about the point

  static DYN_INLINE Inertia zero() { return {T(0), Vec3<T>::zero(), Sym3<T>::zero()}; }
  // from the centre of mass c and the inertia about it: I = I_c - m [c]x [c]x
  static DYN_INLINE Inertia at_com(T m, const Vec3<T>& c, const Mat3<T>& I_c) {
    return Inertia{m, Vec3<T>::zero(), Sym3<T>::from(I_c)}.shifted(c);
  }
  friend DYN_INLINE Inertia operator+(const Inertia& a, const Inertia& b) { return {a.m + b.m, a.h + b.h, a.I + b.I}; }

  // momentum of the velocity v, or the force that the acceleration v takes from rest
  friend DYN_INLINE Force<T> operator*(const Inertia& Y, const Motion<T>& v) {
    return {v.linear * Y.m + cross(v.angular, Y.h), Y.I * v.angular + cross(Y.h, v.linear)};
  }
  // the same body referred to the point from which r leads to this one
  DYN_INLINE Inertia shifted(const Vec3<T>& r) const {
    // I' = I + 2 (r.g) 1 - r g^T - g r^T with g = h + m r / 2
    const Vec3<T> g = h + r * (m * T(0.5)), e = hadamard(r, g);
    return {m, h + r * m, {I.d + (yzx(e) + zxy(e)) * T(2), I.o - hadamard(r, yzx(g)) - hadamard(yzx(r), g)}};
  }
  // the same body in rotated axes
  DYN_INLINE Inertia rotated(const Mat3<T>& R) const { return {m, R * h, congruence(R, I.full())}; }
  // X_AB.act: an inertia given in B, in A
  friend DYN_INLINE Inertia act(const SE3<T>& X, const Inertia& Y) { return Y.rotated(X.R).shifted(X.p); }
};

// f = IA a in blocks: [f; n] = [M H; H^T I] [a; alpha]
template <class T>
struct ArticulatedInertia {
  Sym3<T> M;
  Mat3<T> H;
  Sym3<T> I;

  static DYN_INLINE ArticulatedInertia zero() { return {Sym3<T>::zero(), Mat3<T>::zero(), Sym3<T>::zero()}; }
  static DYN_INLINE ArticulatedInertia rigid(const Inertia<T>& Y) { return {Sym3<T>::diagonal(Y.m, Y.m, Y.m), skew(-Y.h), Y.I}; }

  friend DYN_INLINE ArticulatedInertia operator+(const ArticulatedInertia& a, const ArticulatedInertia& b) {
    return {a.M + b.M, a.H + b.H, a.I + b.I};
  }
  friend DYN_INLINE Force<T> operator*(const ArticulatedInertia& Y, const Motion<T>& a) {
    return {Y.M * a.linear + Y.H * a.angular, transpose(Y.H) * a.linear + Y.I * a.angular};
  }
  // this - U U^T / D
  DYN_INLINE ArticulatedInertia minus_outer(const Force<T>& U, T inverse_D) const {
    const Force<T> V = U * inverse_D;
    return {M - symmetric_outer(U.linear, V.linear), H - outer(U.linear, V.angular), I - symmetric_outer(U.angular, V.angular)};
  }
  // referred to the point from which r leads to this one
  DYN_INLINE ArticulatedInertia shifted(const Vec3<T>& r) const {
    const Mat3<T> H_p = H - times_skew(M, r);
    // I' = I - H^T [r] + [r] H' = I + A + A^T with A = [r] (H + H') / 2
    return {M, H_p, I + plus_transpose(cross(r, (H + H_p) * T(0.5)))};
  }
};

}  // namespace dyn
