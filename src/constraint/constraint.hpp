// The constraint contract. A constraint between frames is a number of rows of the motion of frame B (first) as seen from frame A
// (second), in A's axes: with r the vector from A's origin to B's, R the axes of B in A, v, w the velocities of r and R,
//   C_i = error_i        dC_i/dt = f_i . v + t_i . w        d2C_i/dt2 = f_i . dv + t_i . dw + extra_i
// f_i and t_i are also the unit wrench of the row: lambda_i f_i at B's origin and the moment lambda_i t_i on B, the opposite on A.
// Each type is one file, its C, J and drift derived at its top; list.hpp names them. A type K gives, as static members,
//   type                       its dynConstraintType
//   rows(c)                    number of rows
//   evaluate(c, X, out)        out(i, f_i, t_i, error_i, extra_i[, change]) for each row, i ascending; change(by) says how the row
//                              changes with a small displacement of B (RowChange) where that is not what dC/dt says
// One between joints has a single row C(q1, q2) = C1(q1) + C2(q2) of two coordinates and gives
//   evaluate(c, q1, q2)        C and its derivatives (JointRow)
#pragma once

#include "dyn.h"
#include "base/types.hpp"
#include "spatial/explog.hpp"
#include "spatial/se3.hpp"

namespace dyn {

inline constexpr int max_rows = 6;  // of a constraint
inline constexpr int row_lanes = 8;

// What a slot holds, as the algorithms read it.
struct Constraint {
  SE3<double> X1, X2;      // first and second frame of the constraint, in their bodies' internal frames
  Vec3<double> axis, n1, n2, axis2;  // LOOP: unit axis in A, two unit vectors across it; universal: the second axis in B
  double pitch, length, force, lower, upper, coefficients[5];
  double stiffness, damping, restitution;
  Index body1, body2;      // of joints: the bodies of their coordinates; 0: none
  Index q1, q2, v1, v2;    // of joints: the user's coordinates, expanded degrees of freedom
  dynConstraintType type;
  dynJointType joint_type;
};

// B as seen from A.
template <class T>
struct Relative {
  Vec3<T> r, v, w;
  Mat3<T> R;
};

// Derivatives of a row by a displacement of B as seen from A: a step of its origin and a turn of its axes; of extra by v and w as well.
template <class T>
struct RowChange {
  bool of_error;  // whether those of the error are wanted
  Vec3<T> error_step, error_turn;
  Mat3<T> f_step, t_turn;
  Vec3<T> extra_step, extra_turn, extra_v, extra_w;

  // of a row whose f and t are fixed
  static RowChange fixed(const Vec3<T>& f, const Vec3<T>& t, bool of_error) {
    const Vec3<T> o = Vec3<T>::zero();
    return {of_error, f, t, {o, o, o}, {o, o, o}, o, o, o, o};
  }
};

// Of a row between joints.
template <class T>
struct JointRow {
  T error, g1, g2, curvature;  // C; of its second derivative the factors of a1, a2 and v2^2: dC/dq1, dC/dq2, d2C/dq2^2
  T slope = T(0), third = T(0);  // of C by q1, where it is not constant; d3C/dq2^3
};

template <class T>
DYN_INLINE Vec3<T> unit3(int i) {
  return Vec3<T>::make(T(i == 0), T(i == 1), T(i == 2));
}

}  // namespace dyn
