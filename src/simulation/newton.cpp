#include "simulation/newton.hpp"

#include <utility>

#include "algorithm/constrained/delassus.hpp"
#include "solver/residuals.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::newton;
using solver::by_rows, solver::Progress;

// C += a law b^T. a, b: rows of constraints in lanes.
template <int rows>
DYN_INLINE void add_product(const NewtonConstraint& s, const double* a, const double* b, double* C) {
  using P = BlockFactor::P;
  constexpr int W = BlockFactor::W;
  alignas(64) double lawb[rows * W];
  P A[rows], B[rows];
#pragma GCC unroll 6
  for (int i = 0; i < rows; ++i) A[i] = P::load(a + W * i), B[i] = P::load(b + W * i);
#pragma GCC unroll 6
  for (int i = 0; i < rows; ++i) {
    P sum = P::zero();
#pragma GCC unroll 6
    for (int j = 0; j < rows; ++j) sum = sum + B[j] * s.law[i][j];
    sum.store(lawb + W * i);
  }
  for (int q = 0; q < BlockFactor::R; ++q) {
    P sum = P::load(C + W * q);
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i) sum = sum + A[i] * lawb[W * i + q];
    sum.store(C + W * q);
  }
}

}  // namespace

// 1 plus Y law Y^T of each constraint.
void Newton::fill(Index p, double* D) const {
  std::fill_n(D, BlockFactor::size, 0.0);
  for (Index i = 0; i < BlockFactor::R; ++i) D[i + W * i] = 1;
  e.for_each_of(p, [&](const ConstraintRun& a) {
    const State& s = w.newton[a.constraint];
    if (!s.acts) return;
    by_rows(G.block(a.constraint), [&]<int rows>() {
      e.for_each_run(a.constraint, [&](const ConstraintRun& b) {
        const Index q = b.segment;
        if (q == p) add_product<rows>(s, a.rows, a.rows, D);
        if (q <= p) return;
        const Index entry = w.where[q];
        w.newton_filled[entry] = true;
        add_product<rows>(s, a.rows, b.rows, factor.upper + BlockFactor::size * std::ptrdiff_t(entry));
        if (!factor.symmetric) add_product<rows>(s, b.rows, a.rows, factor.lower + BlockFactor::size * std::ptrdiff_t(entry));
      });
    });
  });
}

bool Newton::factorize_laws(bool symmetric) {
  factor.symmetric = symmetric;
  return factor([this](Index p, double* D) { fill(p, D); });
}

bool Newton::factorize(double compliance) {
  std::fill_n(w.newton_acts, e.size, false);
  bool symmetric = true;
  for_each([&](const Block& b, State& s, Index k) {
    if (s.acts) s.set_law(b, compliance, s.law), activate(k), symmetric &= s.mode != State::slip;
  });
  return factorize_laws(symmetric);
}

void Newton::solve_laws(double* r, double* a, double* G_a, double removed) const {
  std::fill_n(a, x.rows, 0.0), std::fill_n(G_a, x.rows, 0.0);
  for (int k = 0, last = rough && removed == 0 ? 0 : refinements; k <= last; ++k) {
    G.clear();
    for_each([&](const Block& b, const State& s, Index constraint) {
      if (!s.acts) return;
      by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double by[rows];
        apply<rows>(s, r + b.first, by), G.scatter<rows>(constraint, by);
      });
    });
    factor.solve(w.by_segment);
    for_each([&](const Block& b, const State& s, Index constraint) {
      if (!s.acts) return;
      by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double v[rows], by[rows];
        double *left = r + b.first, *to = a + b.first;
        G.gather<rows>(constraint, v);
        for (int i = 0; i < rows; ++i) left[i] -= v[i];
        apply<rows>(s, left, by);
        for (int i = 0; i < rows; ++i)
          to[i] += by[i], left[i] = v[i] + (removed + b.soft[i]) * by[i] + G_a[b.first + i];
      });
    });
    times(a, G_a);
    for (Index i = 0; i < x.rows; ++i) r[i] -= G_a[i];
  }
}

// Projects y onto the feasible impulses.
void Newton::candidate(double* into) const {
  for_each([&](const Block& b, const State&, Index) { b.project(y + b.first, into + b.first); });
}

// Of impulses in their cones (solver/residuals.hpp), over the speed. Changes dc.
double Newton::residual(const double* impulses) const {
  velocities(impulses, dc);
  solver::BlockError worst;
  for_each([&](const Block& b, const State&, Index) { worst.take(b, impulses + b.first, dc + b.first); });
  return worst.error(x.fastest) / x.fastest;
}

Newton::Newton(const Island& island)
    : x(island),
      w(x.w),
      e(w.elimination),
      G(island),
      factor{e,       w.diagonal,    w.blocks_above, w.blocks_above + BlockFactor::size * std::ptrdiff_t(e.entries()),
             w.where, w.newton_acts, w.newton_filled},
      room(padded_rows(x.rows)) {
  G.g = g;
  G.load(before, g);
  for (Index i = 0; i < x.rows; ++i) bound += jammed * std::abs(g[i]);
  for (Index i = 0; i < x.rows; ++i) bound = std::max(bound, above_guess * std::abs(before[i]));
  std::copy_n(before, x.rows, y), velocities(y, c);
}

// G y in scaled units, compliance included.
void Newton::times(const double* of, double* G_of) const {
  G.start(of);
  G.for_each([&](const Block& b, Index k) {
    double* to = G_of + b.first;
    by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      G.gather<rows>(k, to);
      for (int i = 0; i < rows; ++i) to[i] += b.soft[i] * of[b.first + i];
    });
  });
}

void Newton::velocities(const double* of, double* into) const {
  times(of, into);
  for (Index i = 0; i < x.rows; ++i) into[i] += g[i];
}

// Residual of the impulses nearest to y, which are kept if they are the best so far.
double Newton::take(dynContactReport& report) {
  double* const now = method.a;
  candidate(now);
  const double found = residual(now);
  if (found < least) std::copy_n(now, x.rows, best), least = found;
  report.residual = least;
  return found;
}

bool Newton::slides() const {
  Index slip = 0, stick = 0;
  for_each([&](const Block& b, State& s, Index) {
    s.find(b, y + b.first, c + b.first, dy + b.first);
    slip += s.mode == State::slip, stick += s.acts && s.mode == State::stick;
  });
  return slip > sliding * stick;
}

bool Newton::run(Index most, double enough, dynContactReport& report) {
  double last = HUGE_VAL;
  w.limit.expect(solver::TimeLimit::Unit::Segments, x.rows);
  const auto may_step = [&] { return x.within_budget(report) && ++report.newton_steps; };
  const auto accept = [&](const Error&, bool damped) {
    double largest = 0;
    for (Index i = 0; i < x.rows; ++i) largest = std::max(largest, std::abs(y[i]));
    if (!(largest <= bound)) {
      std::copy_n(before, x.rows, y), velocities(y, c);
      return Progress::stuck;
    }
    const double found = take(report);
    // a damped step is slow in any case
    const bool stalls = !(damped && x.is_exact()) && !(found < solver::tuning::newton_method::progress * last);
    last = found;
    return found <= x.tolerance || (found <= enough && stalls) ? Progress::solved : Progress::going;
  };
  rough = x.tolerance < enough;
  const bool between = enough < report.residual && report.residual < tuning::default_solve::near_guess;
  method.damping = rough && between && slides() ? damping : 0;
  const bool solved = method.run(most, may_step, accept);
  if (solved) G.write(best);
  return solved;
}

bool Newton::least_norm(double tolerance) {
  const auto may_pull = [&](Index k) { return x.constraint(k).kind != RowKind::Contact; };
  for_each([&](const Block& b, State& s, Index k) {
    s.mode = State::stick, s.acts = may_pull(k) || before[b.first] > 0;
  });
  for (int k = 0; k < relaxations; ++k) {
    if (!factorize(min_compliance)) return false;
    for (Index i = 0; i < x.rows; ++i) method.rhs[i] = -g[i];
    solve_laws(method.rhs, y, dc, min_compliance);
    candidate(best);
    if (residual(best) <= tolerance) return G.write(best), true;
    for_each([&](const Block& b, State& s, Index constraint) { s.acts &= may_pull(constraint) || y[b.first] > 0; });
  }
  return false;
}

// Of rows in their bounds, and of contacts' normals, by their active sets (Hintermueller, Ito and Kunisch 2002).
bool Newton::frictionless(double tolerance) {
  const auto bounds = [](const Block& b) { return b.is_cone() ? std::pair(0.0, HUGE_VAL) : std::pair(b.lower, b.upper); };
  const auto pressing = [](const Block& b) { return b.is_cone() ? 1 : b.rows; };  // rows, the first
  const auto error = [&](const double* impulses, const double* velocities) {
    double worst = 0;
    for_each([&](const Block& b, const State&, Index) {
      const auto [low, high] = bounds(b);
      for (Index r = 0, i = b.first; r < pressing(b); ++r, ++i)
        worst = std::max(worst, std::abs(impulses[i] - std::clamp(impulses[i] - velocities[i], low, high)) * b.per_speed[r]);
    });
    return worst;
  };
  bool rigid = true;
  for_each([&](const Block& b, State& s, Index) {
    std::fill_n(&s.law[0][0], Block::max_rows * Block::max_rows, 0.0);
    for (Index i = 0; i < b.rows; ++i) rigid &= b.soft[i] == 0;
    for (Index i = 0; i < pressing(b); ++i) s.law[i][i] = 1 / min_compliance;
  });
  if (!rigid) return false;
  std::fill_n(dy, x.rows, 0.0);
  const double first = error(dy, g);  // of no impulses
  if (error(y, c) <= tolerance * first) return true;
  double last = first;
  for (Index k = 0; k < max_steps; ++k) {
    std::fill_n(w.newton_acts, e.size, false);
    for_each([&](const Block& b, State& s, Index constraint) {
      const auto [low, high] = bounds(b);
      const double aim = y[b.first] - c[b.first];
      s.acts = aim > low && aim < high;
      if (s.acts) activate(constraint);
    });
    if (!factorize_laws(true)) return false;
    for (Index i = 0; i < x.rows; ++i) method.rhs[i] = -g[i];
    solve_laws(method.rhs, y, c, min_compliance);
    for (Index i = 0; i < x.rows; ++i) c[i] += g[i];
    const double now = error(y, c);
    if (std::min(now, last) > first) return false;
    last = now;
    if (now > tolerance * first) continue;
    for_each([&](const Block& b, const State&, Index) {
      const auto [low, high] = bounds(b);
      for (Index i = b.first; i < b.first + b.rows; ++i) y[i] = std::clamp(y[i], low, high);
    });
    return G.write(y), true;
  }
  return false;
}

bool Newton::run(dynContactReport& report) { return run(max_steps, x.enough, report); }

void Newton::write_best(dynContactReport& report) {
  take(report);
  std::copy_n(before, x.rows, y), candidate(before);  // the guess need not lie in its cones
  report.residual = residual(before);
  if (least < report.residual) G.write(best), report.residual = least;
  else G.write(before);
}

}  // namespace dyn::simulation
