#include <algorithm>

#include "algorithm/constrained/dependence.hpp"
#include "algorithm/constrained/redundant_rows_search.hpp"

namespace dyn {

namespace {

constexpr double suspicious = 1e-2;  // of the unit diagonal: pivots below it are looked at; a misaligned row has its square
constexpr double rounding = 1e-15;   // of the unit diagonal, a row: pivots that are rounding

double length_of(const Vec3<double>& x) { return std::sqrt(dot(x, x)); }

Vec3<double> lane(const double* F, int first, Index r) {
  return Vec3<double>::make(F[row_lanes * first + r], F[row_lanes * (first + 1) + r], F[row_lanes * (first + 2) + r]);
}

}  // namespace

// Entries of J, and what each would be without cancellation between its force and its joint's axis: |f| |v| + |t| |w| at the
// point where the row acts. Joints that move both bodies alike do not count. Degrees of freedom are in rad, or in lengths of the
// model.
void RedundantRows::terms(const EqualityRows& x) const {
  const ConstraintInstance<double>& s = *x.s;
  double *const J = jacobian(), *const B = bound();
  for (Index k = 0; k < x.s->support_count; ++k) {
    std::fill_n(J + row_lanes * x.support[k], row_lanes, 0.0);
    std::fill_n(B + row_lanes * x.support[k], row_lanes, 0.0);
  }
  const auto enter = [&](Index k, Index r, double entry, double least) {
    const Index user = m.has_mimic ? m.expand_v()[k] : k;
    const double ratio = m.has_mimic ? m.ratio_v()[k] : 1;
    J[row_lanes * user + r] += ratio * entry, B[row_lanes * user + r] += std::abs(ratio) * least;
  };
  if (of_path(s.c)) {  // in the user's coordinates
    for_each_path_dof(m, d, s, [&](Index, Index dof, double entry, Index) {
      J[row_lanes * dof] += entry, B[row_lanes * dof] += std::abs(entry);
    });
    return;
  }
  if (between_joints(s.c.type)) {
    enter(s.c.v1, 0, s.g1, std::abs(s.g1));
    if (s.c.body2) enter(s.c.v2, 0, s.g2, std::abs(s.g2));
    return;
  }
  struct Wrench {
    Vec3<double> force, moment, at;  // at: where it is a force and a couple along it
    double size, couple;
  };
  const auto wrench = [&](const double* F, Index r) {
    const Vec3<double> f = lane(F, 0, r), moment = lane(F, 3, r);
    const double force2 = dot(f, f);
    const Vec3<double> at = force2 > 0 ? cross(f, moment) * (1 / force2) : f;
    return Wrench{f, moment, at, std::sqrt(force2), length_of(moment - cross(at, f))};
  };
  Wrench on_a[max_rows], on_b[max_rows];
  for (Index r = 0; s.c.body1 && r < s.rows; ++r) on_a[r] = wrench(s.F1, r);
  for (Index r = 0; s.c.body2 && r < s.rows; ++r) on_b[r] = wrench(s.F2, r);
  const auto add = [&](Index body, const Wrench* wrenches) {
    for (Index k = m.bodies()[body].idx_v, end = first_dof(m, body + 1); k < end; ++k) {
      const Vec3<double>&v = d.S[k].linear, &w = d.S[k].angular;
      const double turn = length_of(w), unit = m.has_mimic || turn > 0 ? 1 : length;
      for (Index r = 0; r < s.rows; ++r) {
        const Wrench& x = wrenches[r];
        const double whole = x.size * length_of(v + cross(w, x.at)) + x.couple * turn;
        enter(k, r, unit * (dot(x.force, v) + dot(x.moment, w)), unit * whole);
      }
    }
  };
  for (Index a = s.c.body1, b = s.c.body2; a != b;) {
    if (a > b) add(a, on_a), a = m.bodies()[a].parent;
    else add(b, on_b), b = m.bodies()[b].parent;
  }
}

// The rows that something moves, until eliminate() in `state`. Scaled by `scale`, a diagonal entry of G is the square of the
// share of its terms that does not cancel.
void RedundantRows::find_acting_rows() {
  for_each_row([&](const EqualityRows& x, Index row) {
    terms(x);
    for (Index r = 0; r < x.s->rows; ++r) {
      double most = 0, whole = 0;
      for (Index k = 0; k < x.s->support_count; ++k) {
        const Index at = row_lanes * x.support[k] + r;
        most = std::max(most, std::abs(jacobian()[at])), whole = std::max(whole, bound()[at]);
      }
      const double entry = S[ld * (row + r) + row + r];
      double& share = d.row_share[x.s->first + r];
      share = whole > 0 ? most / whole : 0;
      place[row + r] = -1;
      if (!(entry > 0 && share > 0)) continue;
      state[acting] = row + r, bound_of[acting] = whole, scale[acting] = share / std::sqrt(entry);
      place[row + r] = acting++;
    }
  });
}

// S: the lower triangle, from that of G.
void RedundantRows::scale_acting_rows() const {
  for (Index b = 0; b < acting; ++b) {
    const double* const column = S + ld * state[b];
    for (Index a = b; a < acting; ++a) S[ld * b + a] = column[state[a]] * (scale[a] * scale[b]);
  }
}

// S: the lower triangle of G. Lanes beyond a constraint's rows are overwritten by the next.
void RedundantRows::couple_rows() const {
  const double* Dinv = inverse_pivots(m, d);
  for_each_row([&](const EqualityRows& a, Index i) {
    for_each_row([&](const EqualityRows& b, Index j) {
      if (j < i) return;
      const auto block = [&]<int columns>() {
        couple<columns>(a.support, a.s->support_count, a.Y, b.support, b.s->support_count, b.Y, Dinv, S + j + ld * i, ld);
      };
      with_row_count(a.s->rows, block);
    });
  });
}

// Whether no row depends on those before it. Mechanisms couple few of their rows: in this order L D L^T stays sparse.
bool RedundantRows::independent_rows() const {
  double *const W = work.factor, *const Dinv = work.vector(0);
  factor_rows(S, ld, acting, 0.0, 0.0, W, Dinv);
  for (Index row = 0; row < acting; ++row) {
    const double pivot = W[ld * row + row];
    if (pivot >= suspicious) continue;
    if (!(pivot > rounding * n)) return false;
    std::fill_n(weight, acting, 0.0);
    for (Index k = row - 1; k >= 0; --k) {  // L^T c = the row of L
      const double* const column = W + ld * k;
      double sum = column[row];
      for (Index j = k + 1; j < row; ++j) sum -= column[j] * weight[j];
      weight[k] = sum * Dinv[k];
    }
    if (share_left(row) < misalignment) return false;
  }
  return true;
}

// Coefficients, in S, of the kept rows in a row that they determine: R_K c = R_row.
void RedundantRows::weights(Index row, Index rank) const {
  std::fill_n(weight, acting, 0.0);
  for (Index k = rank - 1; k >= 0; --k) {
    double sum = R[ld * k + row];
    for (Index j = k + 1; j < rank; ++j) sum -= R[ld * k + pivots[j]] * weight[pivots[j]];
    weight[pivots[k]] = sum / R[ld * k + pivots[k]];
  }
}

// Share of its terms by which the joints move a row less what others, by their weights, determine of it.
double RedundantRows::share_left(Index row) const {
  for (Index a = 0; a < acting; ++a) weight[a] *= -scale[a];
  weight[row] = scale[row];
  double *const sum = d.row_sums, *const whole = d.row_sums + m.n.nv;
  for_each_row([&](const EqualityRows& x, Index) {
    for (Index k = 0; k < x.s->support_count; ++k) sum[x.support[k]] = whole[x.support[k]] = 0;
  });
  double most = 0, all = 0;
  for_each_row([&](const EqualityRows& x, Index first) {
    double of[max_rows], most = 0;
    for (Index r = 0; r < x.s->rows; ++r)
      of[r] = place[first + r] < 0 ? 0 : weight[place[first + r]], most = std::max(most, std::abs(of[r]));
    if (most == 0) return;
    terms(x);
    for (Index k = 0; k < x.s->support_count; ++k)
      for (Index r = 0; r < x.s->rows; ++r) {
        const Index at = row_lanes * x.support[k] + r;
        sum[x.support[k]] += of[r] * jacobian()[at], whole[x.support[k]] += std::abs(of[r]) * bound()[at];
      }
  });
  for_each_row([&](const EqualityRows& x, Index) {
    for (Index k = 0; k < x.s->support_count; ++k)
      most = std::max(most, std::abs(sum[x.support[k]])), all = std::max(all, whole[x.support[k]]);
  });
  return all > 0 ? most / all : 0;
}

// Pivoted Cholesky, R^T R = S. Returns the number of rows kept.
Index RedundantRows::eliminate() {
  Index rank = 0;
  mirror(S, ld, acting);
  for (Index i = 0; i < acting; ++i) remaining[i] = S[ld * i + i], state[i] = 0;
  for (Index k = 0; k < acting; ++k) {
    Index best = largest_entry(remaining, acting);
    if (state[best] != 0) best = Index(std::find(state, state + acting, 0) - state);  // no number: some overflowed
    const double pivot = remaining[best];
    remaining[best] = -HUGE_VAL;
    double share = pivot > 0;
    if (pivot > 0 && pivot < suspicious) weights(best, rank), share = share_left(best);
    if (!(pivot > rounding * n) || (share < misalignment)) {
      moved_by[best] = share;
      state[best] = 2;
      continue;
    }
    double* row = R + ld * rank;
    for (Index i = 0; i < acting; ++i) row[i] = S[ld * best + i];
    for (Index j = 0; j < rank; ++j) {
      const double x = R[ld * j + best];
      if (x == 0) continue;
      for (Index i = 0; i < acting; ++i) row[i] -= R[ld * j + i] * x;
    }
    const double factor = 1 / std::sqrt(pivot);
    for (Index i = 0; i < acting; ++i) row[i] *= factor, remaining[i] -= row[i] * row[i];
    row[best] = std::sqrt(pivot);
    state[best] = 1, pivots[rank++] = best;
  }
  return rank;
}

// Marks and clears the dropped rows. d.row_dependence: a column for each (dependence.hpp), its coefficients in the caller's
// units.
void RedundantRows::finish(Index rank) {
  Index& dropped = d.row_system[2];
  d.rows_dropped = 1;
  const auto is_dropped = [&](Index row) { return place[row] < 0 || state[place[row]] == 2; };
  for (Index i = 0; i < n; ++i) {
    if (!is_dropped(i)) continue;
    double* column = d.row_dependence + std::ptrdiff_t(rank) * dropped;
    d.row_system[3 + dropped++] = i;
    const Index a = place[i];
    if (a >= 0) weights(a, rank);
    for (Index b = 0; b < acting; ++b)
      if (state[b] != 2) *column++ = a >= 0 ? weight[b] * scale[b] / scale[a] : 0;
  }
  for_each_row([&](const EqualityRows& x, Index row) {
    for (Index r = 0; r < x.s->rows; ++r)
      if (is_dropped(row + r)) x.s->dropped |= 1 << r;
    clear_dropped(*x.s, x.Y);
  });
}

Index RedundantRows::drop() {
  d.row_system[0] = count, d.row_system[1] = n, d.row_system[2] = 0, d.row_moved[0] = 0;
  if (n == 0) return 0;
  couple_rows();
  find_acting_rows(), scale_acting_rows();
  if (independent_rows()) {
    std::fill_n(state, acting, 1);
    if (acting < n) finish(acting);
    return n - acting;
  }
  Index rank = eliminate();
  const auto misaligned = [&] {
    double most = 0;
    for (Index i = 0; i < acting; ++i)
      if (state[i] == 2 && moved_by[i] < misalignment) most = std::max(most, moved_by[i]);
    return most;
  };
  if (misaligned() > aligned && is_singular(rank)) misalignment = 0, rank = eliminate();
  d.row_moved[0] = misaligned();
  if (rank < n) finish(rank);
  return n - rank;
}

Index drop_redundant_rows(const Model& m, Data<double>& d, Index count, double misalignment) {
  return RedundantRows(m, d, count, misalignment).drop();
}

Index drop_redundant_rows(const Model& m, Data<double>& d, double misalignment) {
  Index count = 0;
  for_each_constraint(m, d, [&](ConstraintInstance<double>& s, Index k) {
    if (is_rigid_equality(s.c)) d.equality_rows[count++] = {&s, supporting_dofs_of(m, d, k), propagated_jacobian_of(m, d, k)};
  });
  return drop_redundant_rows(m, d, count, misalignment);
}

}  // namespace dyn
