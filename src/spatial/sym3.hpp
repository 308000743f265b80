// Symmetric 3 x 3 matrices: the diagonal, and the off-diagonal (xy, yz, zx). In this order every product below is made of
// whole vectors and their cyclic shifts.
#pragma once

#include "spatial/mat3.hpp"

namespace dyn {

template <class T>
struct Sym3 {
  Vec3<T> d, o;

  static DYN_INLINE Sym3 zero() { return {Vec3<T>::zero(), Vec3<T>::zero()}; }
  static DYN_INLINE Sym3 diagonal(T x, T y, T z) { return {Vec3<T>::make(x, y, z), Vec3<T>::zero()}; }
  // a symmetric matrix
  static DYN_INLINE Sym3 from(const Mat3<T>& A) {
    return {Vec3<T>::make(A(0, 0), A(1, 1), A(2, 2)), Vec3<T>::make(A(0, 1), A(1, 2), A(2, 0))};
  }
  DYN_INLINE Mat3<T> full() const {
    return {Vec3<T>::make(d[0], o[0], o[2]), Vec3<T>::make(o[0], d[1], o[1]), Vec3<T>::make(o[2], o[1], d[2])};
  }
  DYN_INLINE T operator()(int row, int col) const { return row == col ? d[row] : o[row + col == 1 ? 0 : row + col == 3 ? 1 : 2]; }

  friend DYN_INLINE Sym3 operator+(const Sym3& a, const Sym3& b) { return {a.d + b.d, a.o + b.o}; }
  friend DYN_INLINE Sym3 operator-(const Sym3& a, const Sym3& b) { return {a.d - b.d, a.o - b.o}; }
  friend DYN_INLINE Sym3 operator*(const Sym3& a, T s) { return {a.d * s, a.o * s}; }
  friend DYN_INLINE Vec3<T> operator*(const Sym3& A, const Vec3<T>& x) {
    return hadamard(A.d, x) + hadamard(A.o, yzx(x)) + hadamard(zxy(A.o), zxy(x));
  }
};

// a b^T, which is symmetric (b a multiple of a)
template <class T>
DYN_INLINE Sym3<T> symmetric_outer(const Vec3<T>& a, const Vec3<T>& b) {
  return {hadamard(a, b), hadamard(a, yzx(b))};
}
// A + A^T
template <class T>
DYN_INLINE Sym3<T> plus_transpose(const Mat3<T>& A) {
  return {Vec3<T>::make(A(0, 0), A(1, 1), A(2, 2)) * T(2),
          Vec3<T>::make(A(0, 1) + A(1, 0), A(1, 2) + A(2, 1), A(2, 0) + A(0, 2))};
}
#if DYN_LANES == 4
template <>
DYN_INLINE Sym3<double> plus_transpose(const Mat3<double>& A) {
  // lanes picked from the three columns without leaving their places
  const Double4 xy = shuffle<0, 5, 2, 3>(A.x.v, A.y.v);  // x0 y1 x2 .
  const Double4 diagonal = shuffle<0, 1, 6, 3>(xy, A.z.v);
  const Double4 zx = shuffle<0, 5, 2, 3>(A.z.v, A.x.v);  // z0 x1 z2 .
  const Double4 lower = shuffle<0, 1, 6, 3>(zx, A.y.v);  // z0 x1 y2
  const Double4 yz = shuffle<0, 5, 2, 3>(A.y.v, A.z.v);  // y0 z1 y2 .
  const Double4 upper = shuffle<0, 1, 6, 3>(yz, A.x.v);  // y0 z1 x2: (xy, yz, zx)
  return {{diagonal + diagonal}, Vec3<double>{upper} + yzx(Vec3<double>{lower})};
}
#endif
// R A R^T for a symmetric A
template <class T>
DYN_INLINE Sym3<T> congruence(const Mat3<T>& R, const Mat3<T>& A) {
  const Mat3<T> P = R * A;
  return {hadamard(P.x, R.x) + hadamard(P.y, R.y) + hadamard(P.z, R.z),
          hadamard(P.x, yzx(R.x)) + hadamard(P.y, yzx(R.y)) + hadamard(P.z, yzx(R.z))};
}
// B [a]x for a symmetric B: columns of B by cyclic shifts
template <class T>
DYN_INLINE Mat3<T> times_skew(const Sym3<T>& B, const Vec3<T>& a) {
  return times_skew(B.full(), a);
}

}  // namespace dyn
