// Rows of equalities that are redundant but for a small misalignment: the joints together move them by less than a stated share
// of what each joint alone would. Rounded numbers of a model make such rows (a hinge tilted by 4e-6 rad in a planar four-bar).
// Taken for constraints, they would lock a mechanism that moves. The measure knows no masses. Rows that are small only at a
// singular configuration stay: a motion that the other rows allow changes them in second order.
#pragma once

#include "algorithm/constrained/delassus.hpp"

namespace dyn {

// Share of a row's terms below which their sum counts as zero: a misalignment in rad, or over the mechanism's length.
inline constexpr double misalignment_tolerance = 5e-4;

// Marks the redundant rows of d.equality_rows[0 .. count) in ConstraintInstance::dropped and clears them in Y. Returns their
// number. The rows that stay determine the others: share_errors knows how. Needs evaluated and propagated rows.
Index drop_redundant_rows(const Model& m, Data<double>& d, Index count, double misalignment);

// The same for all equalities of the data.
Index drop_redundant_rows(const Model& m, Data<double>& d, double misalignment);

// errors: of the rows of the last drop_redundant_rows. The kept rows get the errors whose removal minimises the sum of squares
// over all rows; the others get zero.
void share_errors(const Model& m, Data<double>& d, double* errors);

// Largest error (m or rad) that the misalignment of the rows of the last drop_redundant_rows explains, and no contradiction.
double explained_error(const Model& m, const Data<double>& d);

// Clears what dropped rows ask for.
template <class T>
void clear_dropped_rows(const Model& m, Data<T>& d, T* b) {
  for_each_constraint(m, d, [&](const ConstraintInstance<T>& s, Index) {
    for (Index r = 0; s.dropped && r < s.rows; ++r)
      if (s.dropped >> r & 1) b[s.first + r] = T(0);
  });
}

// Makes all rows count again.
template <class T>
void keep_all_rows(const Model& m, Data<T>& d) {
  if (!d.rows_dropped) return;  // slots are many in models without constraints
  for_each_constraint(m, d, [](ConstraintInstance<T>& s, Index) { s.dropped = 0; });
  d.rows_dropped = 0;
}

// Whether errors of a constraint are removed at once, so that redundant rows of it may be left out.
inline bool is_rigid_equality(const Constraint& c) { return !one_sided(c.type) && !(c.stiffness > 0 || c.damping > 0); }

}  // namespace dyn
