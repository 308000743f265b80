#include "simulation/newton.hpp"


#include "algorithm/constrained/delassus.hpp"
#include "solver/residuals.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::newton;

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

// Alart and Curnier's function at y + t dy.
Newton::Error Newton::error(double t) const {
  Error out;
  for_each([&](const Block& b, const State&, Index) {
    const Index first = b.first;
    G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      double yk[rows], ck[rows], wrong[rows] = {};
      for (int i = 0; i < rows; ++i) yk[i] = y[first + i] + t * dy[first + i], ck[i] = c[first + i] + t * dc[first + i];
      b.alart_curnier(yk, ck, wrong);
      for (int i = 0; i < rows; ++i) {
        const double velocity = wrong[i] * b.per_speed[i];
        out.most = std::max(out.most, std::abs(velocity)), out.sum += velocity * velocity, out.own += wrong[i] * wrong[i];
      }
    });
  });
  return out;
}

// Finds the states and the known part of dy. Returns its largest component.
double Newton::classify() {
  double known = 0;
  for_each([&](const Block& b, State& s, Index) {
    s.find(b, y + b.first, c + b.first, dy + b.first);
    for (Index i = 0; i < b.rows; ++i) known = std::max(known, std::abs(dy[b.first + i]));
  });
  return known;
}

// A sticking row has only the regularising compliance. Where a contact slips, friction follows the normal along the slip, and the
// width of the cone adds to the compliance across it.
void Newton::set_law(const Block& b, State& s) const {
  const bool slips = s.mode == State::slip;
  for (Index i = 0; i < b.rows; ++i) {
    for (Index j = 0; j < b.rows; ++j) s.law[i][j] = 0;
    if (!slips || i == 0) s.law[i][i] = 1 / (compliant + b.soft[i]);
  }
  if (!slips) return;
  const double K = 1 / (compliant + 1 / s.across - 1 + b.soft[1]);
  for (Index i = 1; i < b.rows; ++i) {
    s.law[i][0] = b.mu * s.law[0][0] * s.direction[i - 1];
    for (Index j = 1; j < b.rows; ++j) s.law[i][j] = K * ((i == j) - s.direction[i - 1] * s.direction[j - 1]);
  }
}

// 1 plus Y law Y^T of each constraint.
void Newton::fill(Index p, double* D) const {
  std::fill_n(D, BlockFactor::size, 0.0);
  for (Index i = 0; i < BlockFactor::R; ++i) D[i + W * i] = 1;
  e.for_each_of(p, [&](const ConstraintRun& a) {
    const State& s = w.newton[a.constraint];
    if (!s.acts) return;
    G.by_rows(G.block(a.constraint), [&]<int rows>() {
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

bool Newton::factorize(bool symmetric) {
  factor.symmetric = symmetric;
  return factor([this](Index p, double* D) { fill(p, D); });
}

// Newton direction dy and dc = G dy. Returns false if singular.
bool Newton::direction() {
  if (classify() > 0) times(dy, dc);
  else std::fill_n(dc, x.rows, 0.0);
  std::fill_n(w.newton_acts, e.size, false);
  bool symmetric = true;
  for_each([&](const Block& b, State& s, Index k) {
    if (s.acts) set_law(b, s), activate(k), symmetric &= s.mode != State::slip;
  });
  return solve_laws(symmetric);
}

// Adds to dy and dc the step by the constraints' laws. Returns false if singular.
bool Newton::solve_laws(bool symmetric) {
  if (!factorize(symmetric)) return false;
  // wanted change of velocity less what the step gives; step; G step
  double *const left = before + room, *const step = left + room;
  for_each([&](const Block& b, const State& s, Index) {
    const Index first = b.first;
    const double across = s.mode == State::slip ? 1 / s.across : 1;
    for (Index i = 0; i < b.rows; ++i) left[first + i] = -dc[first + i] - (i > 0 ? across : 1) * c[first + i];
  });
  std::fill_n(step, x.rows, 0.0);
  for (int k = 0;; ++k) {
    G.clear();
    for_each([&](const Block& b, const State& s, Index constraint) {
      if (!s.acts) return;
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double by[rows];
        apply<rows>(s, left + b.first, by), G.scatter<rows>(constraint, by);
      });
    });
    factor.solve(w.by_segment);
    for_each([&](const Block& b, const State& s, Index constraint) {
      if (!s.acts) return;
      G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
        double velocity[rows], by[rows];
        G.gather<rows>(constraint, velocity);
        for (int i = 0; i < rows; ++i) velocity[i] = left[b.first + i] - velocity[i];
        apply<rows>(s, velocity, by);
        for (int i = 0; i < rows; ++i) step[b.first + i] += by[i];
      });
    });
    times(step, G_step);
    if (k == refinements || compliant != min_compliance) break;
    for_each([&](const Block& b, const State& s, Index) {  // with the true compliance
      const Index first = b.first;
      const bool slips = s.mode == State::slip;
      double along = 0;
      for (Index i = 1; slips && i < b.rows; ++i) along += step[first + i] * s.direction[i - 1];
      for (Index i = 0; i < b.rows; ++i) {
        const double across = slips && i > 0 ? (1 / s.across - 1) * (step[first + i] - along * s.direction[i - 1]) : 0;
        left[first + i] = -dc[first + i] - (slips && i > 0 ? c[first + i] / s.across : c[first + i]) - G_step[first + i] - across;
      }
    });
  }
  for (Index i = 0; i < x.rows; ++i) dy[i] += step[i], dc[i] += G_step[i];
  return true;
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
      room(padded_rows(x.rows)),
      compliant(min_compliance) {
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
    G.by_rows(b, [&]<int rows>() DYN_INLINE_LAMBDA {
      G.gather<rows>(k, to);
      for (int i = 0; i < rows; ++i) to[i] += b.soft[i] * of[b.first + i];
    });
  });
}

void Newton::velocities(const double* of, double* into) const {
  times(of, into);
  for (Index i = 0; i < x.rows; ++i) into[i] += g[i];
}

bool Newton::run(Index most, double enough, dynContactReport& report) {
  Error now = error();
  double last = HUGE_VAL;
  w.limit.expect(solver::TimeLimit::Unit::Segments, x.rows);
  for (Index k = 0; k < most && x.within_budget(report); ++k) {
    ++report.newton_steps;
    if (!direction()) break;
    double t = 1, largest = 0;
    Error next = error(t);
    while (!(next.sum < now.sum) && t > solver::tuning::shortest_part) next = error(t /= 2);
    if (!(next.sum < now.sum)) {
      if (compliant == damping) break;
      compliant = damping;
      continue;
    }
    const bool damped = compliant > min_compliance;
    compliant = min_compliance;
    for (Index i = 0; i < x.rows; ++i) y[i] += t * dy[i], c[i] += t * dc[i], largest = std::max(largest, std::abs(y[i]));
    if (!(largest <= bound)) {
      std::copy_n(before, x.rows, y), velocities(y, c);
      break;
    }
    candidate(best), report.residual = residual(best);
    const bool stalls = !(damped && x.is_exact()) && !(report.residual < progress * last);  // a damped step is slow in any case
    if (report.residual <= x.tolerance || (report.residual <= enough && stalls)) {
      G.write(best);
      return true;
    }
    last = report.residual;
    now = next;
  }
  compliant = min_compliance;
  return false;
}

bool Newton::least_norm(double tolerance) {
  const auto may_pull = [&](Index k) { return x.constraint(k).kind != RowKind::Contact; };
  for_each([&](const Block& b, State& s, Index k) {
    s.mode = State::stick, s.acts = may_pull(k) || before[b.first] > 0;
  });
  for (int k = 0; k < relaxations; ++k) {
    std::fill_n(y, x.rows, 0.0), velocities(y, c);
    std::fill_n(dy, x.rows, 0.0), std::fill_n(dc, x.rows, 0.0), std::fill_n(w.newton_acts, e.size, false);
    for_each([&](const Block& b, State& s, Index constraint) {
      if (s.acts) set_law(b, s), activate(constraint);
    });
    if (!solve_laws(true)) return false;
    std::copy_n(dy, x.rows, y), candidate(best);
    if (residual(best) <= tolerance) return G.write(best), true;
    for_each([&](const Block& b, State& s, Index constraint) { s.acts &= may_pull(constraint) || y[b.first] > 0; });
  }
  return false;
}

bool Newton::run(dynContactReport& report) { return run(max_steps, x.enough, report); }

void Newton::write_best(dynContactReport& report) {
  candidate(best);
  const double found = residual(best);
  std::copy_n(before, x.rows, y), candidate(before);  // the guess need not lie in its cones
  report.residual = residual(before);
  if (found < report.residual) G.write(best), report.residual = found;
  else G.write(before);
}

}  // namespace dyn::simulation
