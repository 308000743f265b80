#include "simulation/sweeps.hpp"

#include "solver/dense.hpp"
#include "solver/residuals.hpp"
#include "solver/sweep.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::sweeps;
using solver::dot;

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

template <class Operator>
Sweeps<Operator>::Sweeps(Island& island) : x(island), w(x.w), G(island), room(padded_rows(x.rows)) {
  G.g = wanted;
  load();
}

template <class Operator>
void Sweeps<Operator>::load() {
  G.load(y, wanted);
  kept = next = 0, has_last = false;
  G.start(y);
}

template <class Operator>
double Sweeps<Operator>::sweep() const {
  x.prepare_sweeps();
  return solver::sweep(G, 1, y);
}

// Onto the cones and the bounds; z follows.
template <class Operator>
void Sweeps<Operator>::project() const {
  G.for_each([&](const Block& s, Index k) {
    double *const l = y + s.first, before[max_rows], by[max_rows];
    std::copy_n(l, s.rows, before);
    s.project(l, l);
    bool moved = false;
    for (Index i = 0; i < s.rows; ++i) by[i] = l[i] - before[i], moved |= by[i] != 0;
    if (moved) solver::by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA { G.template change<rows>(k, by); });
  });
}

// y after a sweep becomes the combination of the last results whose changes are least (least squares).
template <class Operator>
void Sweeps<Operator>::accelerate(bool grew) {
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
  G.start(y), project();
}

// Calls f(block, Y^T z in its rows, their number).
template <class Operator>
template <class F>
double Sweeps<Operator>::residual(F&& f) const {
  solver::BlockError worst;
  G.for_each([&](const Block& s, Index k) {
    double c[max_rows];
    solver::by_rows(s, [&]<int rows>() DYN_INLINE_LAMBDA {
      G.template gather<rows>(k, c);
      f(s, c, Index(rows));
      G.template add_own<rows>(s, y + s.first, c);
    });
    worst.take(s, y + s.first, c);
  });
  return x.fastest > 0 ? worst.error(x.fastest) / x.fastest : 0;
}

template <class Operator>
double Sweeps<Operator>::residual() const {
  return residual([](const Block&, const double*, Index) {});
}

template <class Operator>
void Sweeps<Operator>::run(Index most, dynContactReport& report) {
  double least = HUGE_VAL, least_before = HUGE_VAL, last = HUGE_VAL;
  w.limit.expect(solver::TimeLimit::Unit::Sweep, x.rows);
  for (Index k = 1; k <= most; ++k) {
    std::copy_n(y, x.rows, from);
    const double changed = sweep();
    ++report.iterations;
    if (changed < least) least = changed, std::copy_n(y, x.rows, best);
    if (changed <= x.tolerance * x.fastest && residual() <= x.tolerance) return;
    if (k % solver::tuning::sweeps_a_check == 0) {
      if (!(least < progress * least_before)) break;
      least_before = least;
    }
    if (k == most || w.time_is_up()) break;
    accelerate(changed > growth * last);
    last = changed;
  }
  std::copy_n(best, x.rows, y), G.start(y);
}

template <class Operator>
bool Sweeps<Operator>::frictionless(int most, double share, double softness) {
  std::fill_n(y, x.rows, 0.0), G.clear();
  double first = 0, last = 0;
  bool agree = true;
  for (int n = 0; n < most; ++n) {
    double changed = 0;
    G.for_each([&](const Block& s, Index k) {
      const double give = softness > 0 ? softness * x.free_share(k) : 0;
      const auto row = [&]<int rows>(Index r, double lower, double upper) DYN_INLINE_LAMBDA {
        double c[rows], by[rows] = {}, &l = y[s.first + r];
        const double own = 1 - s.soft[r];
        if (!(own > 0)) return;
        G.template gather<rows>(k, c);
        const double to = std::clamp((l - (wanted[s.first + r] + c[r]) / own) / (1 + give), lower, upper);
        by[r] = to - l;
        if (by[r] == 0) return;
        l = to;
        G.template change<rows>(k, by);
        changed = std::max(changed, std::abs(by[r]) * s.per_speed[r]);
      };
      if (s.is_cone()) row.template operator()<1>(0, 0, HUGE_VAL);
      else
        with_row_count(s.rows, [&]<int rows>() {
          for (Index r = 0; r < rows; ++r) row.template operator()<rows>(r, s.lower, s.upper);
        });
    });
    if (n == 0) first = changed;
    else if (changed <= share * first) break;
    else if (softness == 0 && n == most - 1) agree = changed < contradictory_progress * std::max(first, last);
    last = changed;
  }
  write();
  return agree;
}

template <class Operator>
void Sweeps<Operator>::write() const {
  G.write(y);
}

template <class Operator>
double Sweeps<Operator>::settle() const {
  G.to_dofs();
  return residual([&](const Block& s, const double* c, Index rows) {
    for (Index i = 0; i < rows; ++i) {
      const Index in = s.first + s.order[i];
      x.c[in] = x.g[in] + (s.unit[i] > 0 ? c[i] / s.unit[i] : 0);
    }
  });
}

template <class Operator>
double Sweeps<Operator>::finish() {
  project(), write();
  return settle();
}

template class Sweeps<ByDofs>;
template class Sweeps<BySegments>;

}  // namespace dyn::simulation
