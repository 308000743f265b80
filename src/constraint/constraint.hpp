// The constraint contract. A constraint between frames has rows on the motion of frame B (first) relative to frame A (second), in
// A's axes. r is the vector from A's origin to B's, R the axes of B in A, v and w the velocities of r and R:
//   C_i = error_i        dC_i/dt = f_i . v + t_i . w        d2C_i/dt2 = f_i . dv + t_i . dw + extra_i
// f_i and t_i are also the unit wrench of the row: force lambda_i f_i at B's origin and moment lambda_i t_i on B, the opposite on
// A. Each type is one file with its C, J and drift derived at its top; list.hpp lists them. A type K has static members
//   type                       its dynConstraintType
//   rows(c)                    number of rows
//   evaluate(c, X, out)        out(i, f_i, t_i, error_i, extra_i[, change]) for each row, i ascending. change(by) gives the row's
//                              derivatives (RowChange) where they differ from dC/dt
// A constraint between joints has one row C(q1, q2) = C1(q1) + C2(q2) and gives
//   evaluate(c, q1, q2)        C and its derivatives (JointRow)
#pragma once

#include "dyn.h"
#include "base/types.hpp"
#include "spatial/explog.hpp"
#include "spatial/se3.hpp"

namespace dyn {

inline constexpr int max_rows = 6;  // of a constraint
inline constexpr int row_lanes = 8;

// A constraint as the algorithms read it.
struct Constraint {
  SE3<double> X1, X2;      // poses of the first and second frame in their bodies' internal frames
  Vec3<double> axis, n1, n2, axis2;  // LOOP: unit axis in A, two unit vectors perpendicular to it; universal: second axis in B
  double pitch, length, force, lower, upper, coefficients[5];
  double stiffness, damping, restitution;
  Index body1, body2;      // between joints: bodies of the coordinates; 0: none
  Index q1, q2, v1, v2;    // between joints: user's coordinates, expanded degrees of freedom
  Index path;              // 1 + the path whose length the row is of, or 0: then nothing else but type, and stiffness .. armature
  double armature;         // of a force along a path (PathForce), with stiffness, damping, and force at the beginning
  dynConstraintType type;
  dynJointType joint_type;
};

// Motion of B relative to A.
template <class T>
struct Relative {
  Vec3<T> r, v, w;
  Mat3<T> R;
};

// Derivatives of a row by a small translation and rotation of B relative to A; of extra also by v and w.
template <class T>
struct RowChange {
  bool of_error;  // whether derivatives of the error are needed
  Vec3<T> error_step, error_turn;
  Mat3<T> f_step, t_turn;
  Vec3<T> extra_step, extra_turn, extra_v, extra_w;

  // For a row with constant f and t.
  static RowChange fixed(const Vec3<T>& f, const Vec3<T>& t, bool of_error) {
    const Vec3<T> o = Vec3<T>::zero();
    return {of_error, f, t, {o, o, o}, {o, o, o}, o, o, o, o};
  }
};

// A row between joints.
template <class T>
struct JointRow {
  T error, g1, g2, curvature;  // C; factors of a1, a2 and v2^2 in d2C/dt2: dC/dq1, dC/dq2, d2C/dq2^2
  T slope = T(0), third = T(0);  // dC/dq1 where it is not constant; d3C/dq2^3
};

template <class T>
DYN_INLINE Vec3<T> unit3(int i) {
  return Vec3<T>::make(T(i == 0), T(i == 1), T(i == 2));
}

}  // namespace dyn
