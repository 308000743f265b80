// How the inertia and the momentum of moving bodies change, in axes at rest. The rate of an inertia is an inertia of mass zero.
#pragma once

#include "spatial/inertia.hpp"

namespace dyn {

// By members: a copy as a whole takes the padding along, by way of the stack.
template <class T>
DYN_INLINE void store(const Inertia<T>& Y, Inertia<T>& to) {
  to.m = Y.m, to.h = Y.h, to.I.d = Y.I.d, to.I.o = Y.I.o;
}

// -[a]x [b]x - [b]x [a]x = 2 (a.b) 1 - a b^T - b a^T: how a second moment depends on the point
template <class T>
DYN_INLINE Sym3<T> parallel_axis(const Vec3<T>& a, const Vec3<T>& b) {
  const Vec3<T> e = hadamard(a, b);
  return {(yzx(e) + zxy(e)) * T(2), Vec3<T>::zero() - hadamard(a, yzx(b)) - hadamard(yzx(a), b)};
}

// [w]x I - I [w]x
template <class T>
DYN_INLINE Sym3<T> turning(const Vec3<T>& w, const Sym3<T>& I) {
  const Vec3<T> e = hadamard(w, yzx(I.o));
  return {(yzx(e) - zxy(e)) * T(2),
          hadamard(yzx(w), yzx(I.o)) - hadamard(w, zxy(I.o)) + hadamard(zxy(w), I.d - yzx(I.d))};
}

// Of a body that turns with w, about a point that moves with it.
template <class T>
DYN_INLINE Inertia<T> rate(const Inertia<T>& Y, const Vec3<T>& w) {
  return {T(0), cross(w, Y.h), turning(w, Y.I)};
}

// d/dt of Y.shifted(r), given dY = dY/dt and dr = dr/dt.
template <class T>
DYN_INLINE Inertia<T> shifted_rate(const Inertia<T>& Y, const Inertia<T>& dY, const Vec3<T>& r, const Vec3<T>& dr) {
  const T half = Y.m * T(0.5);
  return {T(0), dY.h + dr * Y.m, dY.I + parallel_axis(dr, Y.h + r * half) + parallel_axis(r, dY.h + dr * half)};
}

// Of a composite body, at a fixed point: inertia, rate of the second moment, momentum and force.
template <class T>
struct CompositeMotion {
  Inertia<T> Y;
  Sym3<T> dI;
  Force<T> h, f;

  friend DYN_INLINE CompositeMotion operator+(const CompositeMotion& a, const CompositeMotion& b) {
    return {a.Y + b.Y, a.dI + b.dI, a.h + b.h, a.f + b.f};
  }
  // referred to the point from which r leads to this one
  DYN_INLINE CompositeMotion shifted(const Vec3<T>& r) const {
    return {Y.shifted(r), dI + parallel_axis(r, h.linear), shift(h, r), shift(f, r)};
  }
  friend DYN_INLINE void store(const CompositeMotion& C, CompositeMotion& to) {
    store(C.Y, to.Y);
    to.dI.d = C.dI.d, to.dI.o = C.dI.o;
    to.h.linear = C.h.linear, to.h.angular = C.h.angular, to.f.linear = C.f.linear, to.f.angular = C.f.angular;
  }
  // sum over its bodies of V x* Y x - Y (V x x) + x x* h, which sees the angular part w of x alone
  DYN_INLINE Force<T> B(const Vec3<T>& w) const { return {cross(w, h.linear) * T(2), dI * w + cross(w, h.angular)}; }
};

}  // namespace dyn
