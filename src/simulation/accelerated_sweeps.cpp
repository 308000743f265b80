#include "simulation/accelerated_sweeps.hpp"

#include "algorithm/constrained/delassus.hpp"
#include "solver/pgs.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::acceleration;

template <int W>
DYN_INLINE double sum_of(const Simd<double, W>& a) {
  double half[W / 2];
  for (int k = 0; k < W / 2; ++k) half[k] = a[k] + a[k + W / 2];
  return (half[0] + half[2]) + (half[1] + half[3]);
}

double dot(const double* a, const double* b, Index n) {
  using P = Simd<double, 8>;
  P sum = P::zero();
  Index k = 0;
  for (; k + 8 <= n; k += 8) sum = sum + P::load(a + k) * P::load(b + k);
  double rest = 0;
  for (; k < n; ++k) rest += a[k] * b[k];
  return sum_of(sum) + rest;
}

constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

// Solves A x = b, positive definite with a small ridge, by Cholesky. Returns false if it is singular.
bool solve_gram(const double (*A)[depth], int n, double* b) {
  double L[depth][depth];
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i) {
      double sum = A[i][j] + (i == j ? ridge * A[i][i] : 0);
      for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      if (i == j && !(sum > 0)) return false;
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
    b[i] /= L[i][i];
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) b[i] -= L[k][i] * b[k];
    b[i] /= L[i][i];
  }
  return true;
}

}  // namespace

AcceleratedSweeps::AcceleratedSweeps(const Island& island) : x(island), w(x.w), e(w.elimination), room(padded_rows(x.rows)) {
  const double* Dinv = inverse_pivots(x.m, x.d);
  const Segments& segments = w.segments;
  double* to = w.run_rows;
  Index boxes = 0, contacts = 0;
  for_each([&](const ActiveConstraint& a, SweepBlock& s, Index k) {
    const ConstraintBlock& own = w.blocks[k];
    const Index all = a.s->rows;
    const double mu = a.kind == RowKind::Contact ? x.friction[contacts] : 0;
    const bool cone = a.kind == RowKind::Contact && all > 1 && mu > 0;
    s.order = cone ? order_of[all] : as_they_are + (a.kind == RowKind::Contact ? normal_row(all) : 0);
    s.first = rows, s.rows = a.kind == RowKind::Contact && !cone ? 1 : all;
    s.mu = mu, s.cone = cone, s.lower = a.kind == RowKind::Contact ? 0 : -HUGE_VAL, s.upper = HUGE_VAL;
    if (a.kind == RowKind::Box) s.lower = x.lower[boxes], s.upper = x.upper[boxes], ++boxes;
    contacts += a.kind == RowKind::Contact;
    for (Index i = 0; i < s.rows; ++i) {
      const Index at = s.order[i], in = a.s->first + at;
      s.scale[i] = cone ? own.scale[i] : 1;
      const double G = s.scale[i] * s.scale[i] * (own.diagonal[at] + x.compliance[in]);
      s.soft[i] = s.scale[i] * s.scale[i] * x.compliance[in];
      s.inverse[i] = G > 0 ? 1 / G : 0, s.speed[i] = s.scale[i] * (own.diagonal[at] + x.compliance[in]);
      y[rows + i] = s.scale[i] > 0 ? x.lambda[in] / s.scale[i] : 0;
      wanted[rows + i] = s.scale[i] * (x.g[in] + x.bias[in]), weight[rows + i] = std::sqrt(G);
    }
    if (cone) {
      for (Index j = 0; j < s.rows; ++j)
        for (Index i = 0; i < s.rows; ++i) s.G[i + max_rows * j] = own.G[i + row_lanes * j];
      solver::Problem p;
      p.G = {s.G, max_rows};
      s.local = solver::local_cone(p, {0, s.rows, mu});
    }
    rows += s.rows;
    Index n = 0;
    const double* carried = a.Y;
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      ConstraintRun& run = e.runs[r];
      const Index of = e.segment[run.segment], first = segments.first[of];
      run.rows = to;
      std::fill_n(to, W * s.rows, 0.0);
      for (; n < a.s->support_count && segments.of[a.support[n]] == of; ++n, carried += row_lanes) {
        const double root = std::sqrt(Dinv[a.support[n]]);
        for (Index i = 0; i < s.rows; ++i) to[W * i + a.support[n] - first] = root * s.scale[i] * carried[s.order[i]];
      }
      to += W * s.rows;
    }
  });
}

template <int rows_>
DYN_INLINE void AcceleratedSweeps::gather(Index constraint, double* c) const {
  P sum[rows_];
  for (int i = 0; i < rows_; ++i) sum[i] = P::zero();
  for (Index r = e.first_run[constraint]; r < e.first_run[constraint + 1]; ++r) {
    const ConstraintRun& run = e.runs[r];
    const P z = P::load(w.by_segment + W * run.segment);
#pragma GCC unroll 6
    for (int i = 0; i < rows_; ++i) sum[i] = sum[i] + P::load(run.rows + W * i) * z;
  }
  for (int i = 0; i < rows_; ++i) c[i] = sum_of(sum[i]);
}

template <int rows_>
DYN_INLINE void AcceleratedSweeps::scatter(Index constraint, const double* by) const {
  for (Index r = e.first_run[constraint]; r < e.first_run[constraint + 1]; ++r) {
    const ConstraintRun& run = e.runs[r];
    double* const to = w.by_segment + W * run.segment;
    P z = P::load(to);
#pragma GCC unroll 6
    for (int i = 0; i < rows_; ++i) z = z + P::load(run.rows + W * i) * by[i];
    z.store(to);
  }
}

// z' = Y' lambda
void AcceleratedSweeps::start() const {
  std::fill_n(w.by_segment, W * std::ptrdiff_t(e.size), 0.0);
  for_each([&](const ActiveConstraint&, const SweepBlock& s, Index k) {
    with_row_count(s.rows, [&]<int n>() { scatter<n>(k, y + s.first); });
  });
}

// One row of a box or an equality. Returns the change of its velocity.
template <int rows_>
DYN_INLINE double AcceleratedSweeps::row(SweepBlock& s, Index k, Index r, double lower, double upper) const {
  if (!(s.inverse[r] > 0)) return 0;
  double c[rows_], by[rows_] = {}, &l = y[s.first + r];
  gather<rows_>(k, c);
  const double to = std::clamp(l - (wanted[s.first + r] + c[r] + s.soft[r] * l) * s.inverse[r], lower, upper);
  by[r] = to - l;
  if (by[r] == 0) return 0;
  l = to;
  scatter<rows_>(k, by);
  return std::abs(by[r]) * s.speed[r];
}

template <int rows_>
DYN_INLINE double AcceleratedSweeps::cone(SweepBlock& s, Index k) const {
  double c[rows_], b[rows_], to[rows_], by[rows_], *l = y + s.first;
  gather<rows_>(k, c);
  for (int i = 0; i < rows_; ++i) {
    b[i] = wanted[s.first + i] + c[i] + s.soft[i] * l[i];
    for (int j = 0; j < rows_; ++j) b[i] -= s.G[i + max_rows * j] * l[j];
  }
  solver::solve_cone({0, rows_, s.mu}, s.local, s.G[0], b, to);
  double most = 0;
  for (int i = 0; i < rows_; ++i) {
    by[i] = to[i] - l[i], l[i] = to[i];
    most = std::max(most, std::abs(by[i]) * s.speed[i]);
  }
  if (most > 0) scatter<rows_>(k, by);
  return most;
}

// One sweep. Returns the largest change of a row's velocity by its own impulse.
double AcceleratedSweeps::sweep() const {
  double most = 0;
  for_each([&](const ActiveConstraint&, SweepBlock& s, Index k) {
    if (s.cone) {
      if (s.rows == 3) most = std::max(most, cone<3>(s, k));
      else if (s.rows == 4) most = std::max(most, cone<4>(s, k));
      else most = std::max(most, cone<6>(s, k));
      return;
    }
    with_row_count(s.rows, [&]<int n>() {
      for (Index r = 0; r < n; ++r) most = std::max(most, row<n>(s, k, r, s.lower, s.upper));
    });
  });
  return most;
}

// Onto the cones and the bounds.
void AcceleratedSweeps::project() const {
  for_each([&](const ActiveConstraint&, const SweepBlock& s, Index) {
    double* const l = y + s.first;
    if (s.cone) solver::project_cone(s.mu, s.rows, l, l);
    else
      for (Index i = 0; i < s.rows; ++i) l[i] = std::clamp(l[i], s.lower, s.upper);
  });
}

// y after a sweep becomes the combination of the last results whose changes are least (least squares).
void AcceleratedSweeps::accelerate(bool grew) {
  for (Index i = 0; i < rows; ++i) from[i] = weight[i] * (y[i] - from[i]);  // the change
  if (grew) kept = next = 0;
  if (has_last && !grew) {
    double *const df = results + next * room, *const dr = changes + next * room;
    for (Index i = 0; i < rows; ++i) df[i] = y[i] - result[i], dr[i] = from[i] - change[i];
    kept = std::min(kept + 1, depth);
    for (int k = 0; k < kept; ++k) gram[k][next] = gram[next][k] = dot(changes + k * room, dr, rows);
    next = (next + 1) % depth;
  }
  std::copy_n(y, rows, result), std::copy_n(from, rows, change), has_last = true;
  if (kept == 0) return;
  double gamma[depth];
  for (int k = 0; k < kept; ++k) gamma[k] = dot(changes + k * room, from, rows);
  if (!solve_gram(gram, kept, gamma)) {
    kept = next = 0;
    return;
  }
  for (int k = 0; k < kept; ++k)
    for (Index i = 0; i < rows; ++i) y[i] -= gamma[k] * results[k * room + i];
  project(), start();
}

void AcceleratedSweeps::write(const double* of) const {
  for_each([&](const ActiveConstraint& a, const SweepBlock& s, Index) {
    for (Index i = 0; i < s.rows; ++i) x.lambda[a.s->first + s.order[i]] = s.scale[i] * of[s.first + i];
  });
}

bool AcceleratedSweeps::run(Index most, dynContactReport& report) {
  const double speed = x.speed(), tolerated = x.tolerance * speed;
  double least = HUGE_VAL, least_before = HUGE_VAL, last = HUGE_VAL, checked = HUGE_VAL;
  start();
  for (Index k = 1; k <= most; ++k) {
    std::copy_n(y, rows, from);
    const double changed = sweep();
    ++report.iterations;
    if (changed < least) least = changed, std::copy_n(y, rows, best);
    if (changed <= tolerated && changed <= recheck * checked) {
      checked = changed;
      write(y), report.residual = x.residual() / speed;
      if (report.residual <= x.tolerance) return true;
    }
    if (k % patience == 0) {
      if (!(least < progress * least_before)) break;
      least_before = least;
    }
    if (k == most || w.time_is_up()) break;
    accelerate(changed > growth * last);
    last = changed;
  }
  write(best), report.residual = speed > 0 ? x.residual() / speed : 0;
  return report.residual <= x.tolerance;
}

void AcceleratedSweeps::frictionless(int most, double share) {
  std::fill_n(y, rows, 0.0);
  std::fill_n(w.by_segment, W * std::ptrdiff_t(e.size), 0.0);
  double first = 0;
  for (int n = 0; n < most; ++n) {
    double changed = 0;
    for_each([&](const ActiveConstraint&, SweepBlock& s, Index k) {
      if (s.cone) changed = std::max(changed, row<1>(s, k, 0, 0, HUGE_VAL));
      else
        with_row_count(s.rows, [&]<int n_>() {
          for (Index r = 0; r < n_; ++r) changed = std::max(changed, row<n_>(s, k, r, s.lower, s.upper));
        });
    });
    if (n == 0) first = changed;
    else if (changed <= share * first) break;
  }
  write(y);
}

}  // namespace dyn::simulation
