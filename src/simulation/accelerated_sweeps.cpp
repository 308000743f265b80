#include "simulation/accelerated_sweeps.hpp"

#include "algorithm/constrained/delassus.hpp"
#include "solver/pgs.hpp"
#include "solver/residuals.hpp"

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

// Solves A x = b, positive definite, by Cholesky. Rounding is added to the diagonal. Returns false if it is singular.
bool solve_gram(const double (*A)[depth], int n, double* b) {
  double L[depth][depth];
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i) {
      double sum = A[i][j] + (i == j ? solver::tuning::round_off * A[i][i] : 0);
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

template <class F>
DYN_INLINE void AcceleratedSweeps::by_rows(const RowBlock& s, F&& f) {
  if (s.rows == 3) f.template operator()<3>();  // most contacts
  else with_row_count(s.rows, f);
}

AcceleratedSweeps::AcceleratedSweeps(const Island& island) : x(island), w(x.w), e(w.elimination), room(padded_rows(x.rows)) {
  load();
}

void AcceleratedSweeps::load() {
  for_each([&](const ActiveConstraint& a, RowBlock& s, Index) {
    for (Index i = 0; i < s.rows; ++i) {
      const Index in = a.s->first + s.order[i];
      y[a.s->first + i] = s.unit[i] > 0 ? x.lambda[in] / s.unit[i] : 0;
      wanted[a.s->first + i] = s.unit[i] * (x.g[in] + x.bias[in]);
    }
  });
  kept = next = 0, has_last = false;
  start();
}

template <int rows>
DYN_INLINE void AcceleratedSweeps::gather(Index constraint, double* c) const {
  P sum[rows];
  for (int i = 0; i < rows; ++i) sum[i] = P::zero();
  for (Index r = e.first_run[constraint]; r < e.first_run[constraint + 1]; ++r) {
    const ConstraintRun& run = e.runs[r];
    const P z = P::load(w.by_segment + W * run.segment);
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) sum[i] = sum[i] + P::load(run.rows + W * i) * z;
  }
  for (int i = 0; i < rows; ++i) c[i] = sum_of(sum[i]);
}

template <int rows>
DYN_INLINE void AcceleratedSweeps::scatter(Index constraint, const double* by) const {
  for (Index r = e.first_run[constraint]; r < e.first_run[constraint + 1]; ++r) {
    const ConstraintRun& run = e.runs[r];
    double* const to = w.by_segment + W * run.segment;
    P z = P::load(to);
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) z = z + P::load(run.rows + W * i) * by[i];
    z.store(to);
  }
}

// z = Y'^T y
void AcceleratedSweeps::start() const {
  std::fill_n(w.by_segment, W * std::ptrdiff_t(e.size), 0.0);
  for_each([&](const ActiveConstraint& a, const RowBlock& s, Index k) {
    by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA { scatter<rows>(k, y + a.s->first); });
  });
}

// One row of a box or an equality; its own block is 1. Returns the change of its velocity.
template <int rows>
DYN_INLINE double AcceleratedSweeps::row(const RowBlock& s, Index k, double* l, const double* g, Index r) const {
  double c[rows], by[rows] = {};
  gather<rows>(k, c);
  const double to = std::clamp(l[r] - (g[r] + c[r] + s.soft[r] * l[r]), s.lower, s.upper);
  by[r] = to - l[r];
  if (by[r] == 0) return 0;
  l[r] = to;
  scatter<rows>(k, by);
  return std::abs(by[r]) / s.unit[r];
}

DYN_INLINE double AcceleratedSweeps::point(RowBlock& s, Index k, double* l, const double* g) const {
  double c[3], b[3], to[3];
  const double* G = s.point.G;
  gather<3>(k, c);
  b[0] = g[0] + c[0] + s.soft[0] * l[0] - (G[0] * l[0] + G[1] * l[1] + G[2] * l[2]);
  b[1] = g[1] + c[1] + s.soft[1] * l[1] - (G[1] * l[0] + G[3] * l[1] + G[4] * l[2]);
  b[2] = g[2] + c[2] + s.soft[2] * l[2] - (G[2] * l[0] + G[4] * l[1] + G[5] * l[2]);
  s.point.solve(s.mu, b, to);
  const double by[3] = {to[0] - l[0], to[1] - l[1], to[2] - l[2]};
  std::copy_n(to, 3, l);
  const double most = std::max(std::abs(by[0]) / s.speed[0], std::max(std::abs(by[1]), std::abs(by[2])) / s.speed[1]);
  if (most > 0) scatter<3>(k, by);
  return most;
}

// In the units of ConstraintBlock, which its eigenvectors belong to.
template <int rows>
DYN_INLINE double AcceleratedSweeps::cone(const RowBlock& s, Index k, double* l, const double* g) const {
  ConstraintBlock& own = w.blocks[k];
  double c[rows], b[rows], now[rows], to[rows], by[rows], most = 0;
  gather<rows>(k, c);
  const auto unit = [&](int i) { return s.speed[i > 0]; };
  for (int i = 0; i < rows; ++i) now[i] = l[i] * unit(i);
  for (int i = 0; i < rows; ++i) {
    b[i] = (g[i] + c[i] + s.soft[i] * l[i]) / unit(i);
    for (int j = 0; j < rows; ++j) b[i] -= own.G[i + row_lanes * j] * now[j];
  }
  solver::solve_cone({0, rows, s.mu * s.speed[1] / s.speed[0]}, own.local, own.G[0], b, to);
  for (int i = 0; i < rows; ++i) {
    by[i] = (to[i] - now[i]) / unit(i), l[i] = to[i] / unit(i);
    most = std::max(most, std::abs(by[i]) / unit(i));
  }
  if (most > 0) scatter<rows>(k, by);
  return most;
}

// One sweep. Returns the largest change of a row's velocity by its own impulse.
double AcceleratedSweeps::sweep() const {
  double most = 0;
  for_each([&](const ActiveConstraint& a, RowBlock& s, Index k) {
    double* const l = y + a.s->first;
    const double* const g = wanted + a.s->first;
    if (s.kind == RowBlock::Kind::point) {
      most = std::max(most, point(s, k, l, g));
    } else if (s.kind == RowBlock::Kind::cone) {
      if (s.rows == 3) most = std::max(most, cone<3>(s, k, l, g));
      else if (s.rows == 4) most = std::max(most, cone<4>(s, k, l, g));
      else most = std::max(most, cone<6>(s, k, l, g));
    } else {
      with_row_count(s.rows, [&]<int rows>() {
        for (Index r = 0; r < rows; ++r) most = std::max(most, row<rows>(s, k, l, g, r));
      });
    }
  });
  return most;
}

// Onto the cones and the bounds; z follows.
void AcceleratedSweeps::project() const {
  for_each([&](const ActiveConstraint& a, const RowBlock& s, Index k) {
    double *const l = y + a.s->first, before[max_rows], by[max_rows];
    std::copy_n(l, s.rows, before);
    if (s.is_cone()) solver::project_cone(s.mu, s.rows, l, l);
    else
      for (Index i = 0; i < s.rows; ++i) l[i] = std::clamp(l[i], s.lower, s.upper);
    bool moved = false;
    for (Index i = 0; i < s.rows; ++i) by[i] = l[i] - before[i], moved |= by[i] != 0;
    if (moved) by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA { scatter<rows>(k, by); });
  });
}

// y after a sweep becomes the combination of the last results whose changes are least (least squares).
void AcceleratedSweeps::accelerate(bool grew) {
  const Index rows = x.rows;
  for (Index i = 0; i < rows; ++i) from[i] = y[i] - from[i];  // the change
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
  start(), project();
}

// Calls f(constraint, block, Y' z in its rows).
template <class F>
double AcceleratedSweeps::residual(F&& f) const {
  BlockError worst;
  for_each([&](const ActiveConstraint& a, const RowBlock& s, Index k) {
    const double *const l = y + a.s->first, *const g = wanted + a.s->first;
    double c[max_rows], u[max_rows];
    by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA {
      gather<rows>(k, c);
      for (int i = 0; i < rows; ++i) u[i] = g[i] + c[i] + s.soft[i] * l[i];
    });
    f(a, s, c);
    worst.take(s, l, u);
  });
  return worst.error(x.fastest);
}

double AcceleratedSweeps::residual() const {
  return residual([](const ActiveConstraint&, const RowBlock&, const double*) {});
}

void AcceleratedSweeps::run(Index most, dynContactReport& report) {
  const double tolerated = x.tolerance * x.fastest;
  double least = HUGE_VAL, least_before = HUGE_VAL, last = HUGE_VAL;
  w.limit.expect(solver::TimeLimit::Unit::Sweep, x.rows);
  for (Index k = 1; k <= most; ++k) {
    std::copy_n(y, x.rows, from);
    const double changed = sweep();
    ++report.iterations;
    if (changed < least) least = changed, std::copy_n(y, x.rows, best);
    if (changed <= tolerated && residual() <= tolerated) return;
    if (k % solver::tuning::sweeps_a_check == 0) {
      if (!(least < tuning::progress * least_before)) break;
      least_before = least;
    }
    if (k == most || w.time_is_up()) break;
    accelerate(changed > growth * last);
    last = changed;
  }
  std::copy_n(best, x.rows, y), start();
}

void AcceleratedSweeps::frictionless(int most, double share) {
  std::fill_n(y, x.rows, 0.0);
  std::fill_n(w.by_segment, W * std::ptrdiff_t(e.size), 0.0);
  double first = 0;
  for (int n = 0; n < most; ++n) {
    double changed = 0;
    for_each([&](const ActiveConstraint& a, const RowBlock& s, Index k) {
      const auto row = [&]<int rows>(Index r, double lower, double upper) DYN_INLINE_LAMBDA {
        double c[rows], by[rows] = {}, &l = y[a.s->first + r];
        const double own = 1 - s.soft[r];
        if (!(own > 0)) return;
        gather<rows>(k, c);
        const double to = std::clamp(l - (wanted[a.s->first + r] + c[r]) / own, lower, upper);
        by[r] = to - l;
        if (by[r] == 0) return;
        l = to;
        scatter<rows>(k, by);
        changed = std::max(changed, std::abs(by[r]) / s.unit[r]);
      };
      if (s.is_cone()) row.template operator()<1>(0, 0, HUGE_VAL);
      else
        with_row_count(s.rows, [&]<int rows>() {
          for (Index r = 0; r < rows; ++r) row.template operator()<rows>(r, s.lower, s.upper);
        });
    });
    if (n == 0) first = changed;
    else if (changed <= share * first) break;
  }
  write();
}

void AcceleratedSweeps::write() const {
  for_each([&](const ActiveConstraint& a, const RowBlock& s, Index) {
    for (Index i = 0; i < s.rows; ++i) x.lambda[a.s->first + s.order[i]] = s.unit[i] * y[a.s->first + i];
  });
}

double AcceleratedSweeps::finish() {
  project(), write();
  const double wrong = residual([&](const ActiveConstraint& a, const RowBlock& s, const double* c) {
    for (Index i = 0; i < s.rows; ++i) {
      const Index in = a.s->first + s.order[i];
      x.c[in] = x.g[in] + (s.unit[i] > 0 ? c[i] / s.unit[i] : 0);
    }
  });
  const double* Dinv = inverse_pivots(x.m, x.d);
  for (Index k = 0; k < e.size; ++k) {
    const Index begin = w.segments.first[e.segment[k]], end = w.segments.first[e.segment[k] + 1];
    for (Index dof = begin; dof < end; ++dof)
      if (Dinv[dof] > 0) x.by_dof[dof] = w.by_segment[W * k + dof - begin] / std::sqrt(Dinv[dof]);
  }
  return wrong;
}

}  // namespace dyn::simulation
