#include "base/portable.hpp"
#include "solver/qp.hpp"

namespace dyn::solver {

namespace {

double at(const double* x, Index i) { return x ? x[i] : 0.0; }

// Rows of a contact: tangential pair, rolling pair, torsion, each with its coefficient.
struct Part {
  Index first, size;
  double coefficient;
};

struct Parts {
  Index rows, normal, count = 0, held = 0;  // held: rows without a coefficient
  Part part[3];
  Index hold[5];
};

Parts parts_of(const dynContactProblem& x, Index k) {
  Parts p{};
  p.rows = rows_of(x, k), p.normal = p.rows == 1 ? 0 : 2;
  const auto add = [&](Index first, Index size, double coefficient) {
    if (coefficient > 0)
      p.part[p.count++] = {first, size, coefficient};
    else
      for (Index i = 0; i < size; ++i) p.hold[p.held++] = first + i;
  };
  if (p.rows >= 3) add(0, 2, at(x.friction, k));
  if (p.rows == 6) add(3, 2, at(x.rolling, k));
  if (p.rows >= 4) add(p.rows - 1, 1, at(x.torsion, k));
  return p;
}

// Calls entry(row of A, column, value) and bound(row, lower, upper). Returns the number of rows.
template <class Entry, class Bound>
Index constraints(const dynContactProblem& x, Index facets, bool inscribed, Entry&& entry, Bound&& bound) {
  constexpr double pi = 3.14159265358979323846;
  Index m = 0, column = x.equalities;
  const auto row = [&](double lower, double upper) { bound(m, lower, upper), ++m; };
  for (Index i = 0; i < x.boxes; ++i) entry(m, column++, 1.0), row(x.lower[i], x.upper[i]);
  for (Index k = 0; k < x.contacts; column += rows_of(x, k), ++k) {
    const Parts p = parts_of(x, k);
    const Index normal = column + p.normal;
    if (facets == 0 && p.count > 0) {
      const double mu = p.part[0].coefficient;
      entry(m, normal, mu), row(-HUGE_VAL, HUGE_VAL);
      for (Index j = 0; j < p.count; ++j)
        for (Index i = 0; i < p.part[j].size; ++i)
          entry(m, column + p.part[j].first + i, mu / p.part[j].coefficient), row(-HUGE_VAL, HUGE_VAL);
    } else {
      entry(m, normal, 1.0), row(0, HUGE_VAL);
      for (Index j = 0; j < p.count; ++j) {
        const Part& part = p.part[j];
        const Index sides = part.size == 1 ? 2 : facets;
        double mu = part.coefficient;
        if (inscribed) mu *= (part.size == 1 ? 1 : math::cos(pi / facets)) / std::sqrt(double(p.count));
        for (Index s = 0; s < sides; ++s) {
          const double angle = 2 * pi * s / sides, along[2] = {math::cos(angle), math::sin(angle)};
          for (Index i = 0; i < part.size; ++i) entry(m, column + part.first + i, along[i]);
          entry(m, normal, -mu), row(-HUGE_VAL, 0);
        }
      }
    }
    for (Index i = 0; i < p.held; ++i) entry(m, column + p.hold[i], 1.0), row(0, 0);
  }
  return m;
}

// CSC of the entries that enumerate(entry) lists.
template <class Enumerate>
Index compress(Index n, int32_t* columns, int32_t* rows, double* values, Enumerate&& enumerate) {
  Index count = 0;
  if (!columns) {
    enumerate([&](Index, Index, double) { ++count; });
    return count;
  }
  std::fill_n(columns, n + 1, 0);
  enumerate([&](Index, Index j, double) { ++columns[j + 1], ++count; });
  for (Index j = 0; j < n; ++j) columns[j + 1] += columns[j];
  // each column's start moves to its end as it is filled
  enumerate([&](Index i, Index j, double value) {
    const Index k = columns[j]++;
    if (rows) rows[k] = i;
    if (values) values[k] = value;
  });
  for (Index j = n; j > 0; --j) columns[j] = columns[j - 1];
  columns[0] = 0;
  return count;
}

}  // namespace

void friction_cone_qp(const dynContactProblem& x, Index facets, bool inscribed, dynQp& q) {
  const Index n = Index(row_count(x));
  const std::ptrdiff_t stride = x.G_stride ? x.G_stride : n;
  q.n = n;
  q.H_nonzeros = compress(n, q.H_columns, q.H_rows, q.H, [&](auto&& entry) {
    for (Index j = 0; j < n && x.G; ++j)
      for (Index i = 0; i < n; ++i) {
        const double value = x.G[i + j * stride] + (i == j ? at(x.compliance, i) : 0);
        if (value != 0 || i == j) entry(i, j, value);
      }
  });
  q.A_nonzeros = compress(n, q.A_columns, q.A_rows, q.A, [&](auto&& entry) {
    q.m = constraints(x, facets, inscribed, entry, [](Index, double, double) {});
  });
  constraints(x, facets, inscribed, [](Index, Index, double) {}, [&](Index i, double lower, double upper) {
    if (q.lower) q.lower[i] = lower;
    if (q.upper) q.upper[i] = upper;
  });
  if (!q.g) return;
  for (Index i = 0; i < n; ++i) q.g[i] = at(x.g, i) + at(x.bias, i);
  for (Index k = 0, row = x.equalities + x.boxes; k < x.contacts; row += rows_of(x, k), ++k) {
    const Index normal = row + (rows_of(x, k) == 1 ? 0 : 2);
    q.g[normal] += at(x.restitution, k) * std::min(0.0, at(x.v_minus ? x.v_minus : x.g, normal));
  }
}

}  // namespace dyn::solver
