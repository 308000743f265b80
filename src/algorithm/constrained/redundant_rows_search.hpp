// The search for redundant rows (redundant_rows.hpp): one system of equalities.
#pragma once

#include "algorithm/constrained/constrained_dynamics.hpp"
#include "algorithm/constrained/path_row.hpp"
#include "algorithm/constrained/redundant_rows.hpp"
#include "model/length.hpp"

namespace dyn {

inline constexpr double aligned = 1e-14;  // share of its terms by which joints move a row: smaller is rounding

// The rows of one system. Those that something moves have places, 0 .. acting - 1, in S, R and the vectors; the others are
// redundant as they are (rows across a planar mechanism).
class RedundantRows {
 public:
  RedundantRows(const Model& m_, Data<double>& d_, Index count_, double misalignment_)
      : m(m_), d(d_), work(row_work(m_, d_)), count(count_), misalignment(misalignment_), length(own_length(m_)) {
    for (Index i = 0; i < count; ++i) n += d.equality_rows[i].s->rows;
    ld = padded_rows(n);
  }
  Index drop();

 private:
  const Model& m;
  Data<double>& d;
  RowWork<double> work;
  Index count, n = 0, acting = 0;
  double misalignment, length;
  std::ptrdiff_t ld = 0;
  double *S = work.scaled, *R = work.range, *scale = work.vector(1), *remaining = work.vector(2), *weight = work.vector(3),
         *moved_by = work.vector(5), *bound_of = work.vector(6);
  Index *pivots = d.row_state, *place = pivots + padded_rows(m.n.constraint_rows);  // place: -1 if nothing moves the row
  Index* state = d.row_forced;                                                      // 0 open, 1 kept, 2 dropped

  // J and its bound by the user's degrees of freedom, rows in lanes.
  double* jacobian() const { return d.row_terms; }
  double* bound() const { return d.row_terms + row_lanes * std::ptrdiff_t(m.n.nv); }

  void terms(const EqualityRows& x) const;
  void couple_rows() const;
  void find_acting_rows();
  void scale_acting_rows() const;
  bool independent_rows() const;
  void weights(Index row, Index rank) const;
  double share_left(Index row) const;
  Index eliminate();
  bool is_singular(Index rank);
  void evaluate(const double* v) const;
  void allowed_motion(Index rank, double* w) const;
  void finish(Index rank);

  template <class F>
  void for_each_row(F&& f) const {
    for (Index i = 0, row = 0; i < count; row += d.equality_rows[i++].s->rows) f(d.equality_rows[i], row);
  }
  // f(constraint, its row, the row's place)
  template <class F>
  void for_each_acting_row(F&& f) const {
    for_each_row([&](const EqualityRows& x, Index row) {
      for (Index r = 0; r < x.s->rows; ++r)
        if (place[row + r] >= 0) f(x, r, place[row + r]);
    });
  }
};

}  // namespace dyn
