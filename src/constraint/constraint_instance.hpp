// A constraint slot of a data: the constraint and its rows as last evaluated. Rows lie in SIMD lanes.
#pragma once

#include "constraint/constraint.hpp"

namespace dyn {

// Leading dimension of matrices by degrees of freedom and rows: whole packs.
inline std::ptrdiff_t padded_kkt(std::ptrdiff_t n) { return (n + row_lanes - 1) / row_lanes * row_lanes; }
// Leading dimension of matrices between rows. A pack that begins at any row stays within its column.
inline std::ptrdiff_t padded_rows(std::ptrdiff_t rows) { return (rows + row_lanes - 1) / row_lanes * row_lanes + row_lanes; }

// Angle limit of a ball joint: one row on the three degrees of freedom from v1 on, with factors c.axis.
inline bool of_ball(const Constraint& c) {
  return c.type == DYN_CONSTRAINT_TYPE_LIMIT && c.joint_type == DYN_JOINT_TYPE_SPHERICAL;
}

inline bool of_path(const Constraint& c) { return c.path != 0; }

template <class T>
struct ConstraintInstance {
  Constraint c;
  Index enabled;
  Index rows, first;  // number of rows when active, index of the first one among all
  Index dropped;      // bits of redundant rows that are left out (redundant_rows.hpp); none outside of a step
  Index support_count;      // degrees of freedom that the rows act on (Data::supporting_dofs)
  // unit wrenches of the rows on the two bodies, by components, about the roots of their trees
  alignas(64) T F1[6 * row_lanes], F2[6 * row_lanes];
  alignas(64) T error[row_lanes], rate[row_lanes], acceleration[row_lanes];
  alignas(64) T lower[row_lanes], upper[row_lanes];  // bounds of lambda
  T g1, g2;  // between joints: dC/dv1, dC/dv2
};

// Constraint of a system of equalities, with its propagated rows.
struct EqualityRows {
  ConstraintInstance<double>* s;
  const Index* support;
  double* Y;
};

}  // namespace dyn
