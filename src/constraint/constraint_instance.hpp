// A slot of a data: a constraint, and what the last evaluation found of its rows. Rows lie in lanes.
#pragma once

#include "constraint/constraint.hpp"

namespace dyn {

// The leading dimension of matrices by degrees of freedom and rows: whole packs.
inline std::ptrdiff_t padded_kkt(std::ptrdiff_t n) { return (n + row_lanes - 1) / row_lanes * row_lanes; }
// The leading dimension of matrices between rows: whole packs from any row on stay within a column.
inline std::ptrdiff_t padded_rows(std::ptrdiff_t rows) { return (rows + row_lanes - 1) / row_lanes * row_lanes + row_lanes; }

// A limit of the angle of a ball joint: one row, carried by three degrees of freedom from v1 on, whose factors are c.axis.
inline bool of_ball(const Constraint& c) { return c.type == DYN_CONSTRAINT_TYPE_LIMIT && c.joint_type == DYN_JOINT_TYPE_SPHERICAL; }

template <class T>
struct ConstraintInstance {
  Constraint c;
  Index enabled;
  Index rows, first;  // rows it has when it acts, number of the first one among all
  Index support;      // degrees of freedom that carry it (Data::support)
  // unit wrenches of the rows on the two bodies, by components, about the roots of their trees
  alignas(64) T F1[6 * row_lanes], F2[6 * row_lanes];
  alignas(64) T error[row_lanes], rate[row_lanes], acceleration[row_lanes];
  alignas(64) T lower[row_lanes], upper[row_lanes];  // bounds of lambda
  T g1, g2;  // of joints: dC/dv1, dC/dv2
};

}  // namespace dyn
