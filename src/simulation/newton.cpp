#include "simulation/newton.hpp"

#include "algorithm/constrained/delassus.hpp"

namespace dyn::simulation {

namespace {

constexpr double min_compliance = 1e-6;  // of the unit diagonal: steps are unique where contacts are redundant
constexpr double damping = 1e-2;           // the same, where a step without makes nothing better (Levenberg and Marquardt)
constexpr int refinements = 1;             // of a step, after which it is as if there were no such compliance
constexpr double min_step = 0.2;
constexpr double jammed = 100;             // impulses that exceed those of all free velocities so much are stress that friction locks in
constexpr double hardly_more = 1.1;    // than the guess: what is heavy presses through what is light
constexpr Index max_steps = 15;
constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

// Impulses of rows from unknowns. A slipping contact has the normal (friction follows it) and the directions across the slip.
void to_rows(const NewtonConstraint& s, const double* unknowns, double* rows) {
  if (s.mode != solver::ConeState::slip) {
    for (Index i = 0; i < s.rows; ++i) rows[i] = i < s.unknowns ? unknowns[i] : 0;
    return;
  }
  rows[0] = unknowns[0];
  for (Index l = 0; l < s.rows - 1; ++l) {
    rows[1 + l] = s.mu * unknowns[0] * s.direction[0][l];
    for (Index i = 1; i < s.rows - 1; ++i) rows[1 + l] += unknowns[i] * s.direction[i][l];
  }
}

// Equations of unknowns from those of rows.
void to_unknowns(const NewtonConstraint& s, const double* rows, double* unknowns) {
  if (s.mode != solver::ConeState::slip) {
    std::copy_n(rows, s.unknowns, unknowns);
    return;
  }
  unknowns[0] = rows[0];
  for (Index i = 1; i < s.rows - 1; ++i) {
    unknowns[i] = 0;
    for (Index l = 0; l < s.rows - 1; ++l) unknowns[i] += s.direction[i][l] * rows[1 + l];
  }
}

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

// Sets the scaling (unit diagonals, round cones) and the guess.
void Newton::scale() {
  Index boxes = 0, contacts = 0;
  for_each([&](const ActiveConstraint& a, State& s, Index k) {
    const ConstraintBlock& own = w.blocks[k];
    const Index rows = a.s->rows;
    s.order = as_they_are, s.rows = rows, s.cone = false;
    auto unit = [](double diagonal) { return diagonal > 0 ? 1 / std::sqrt(diagonal) : 1; };
    for (Index i = 0; i < rows; ++i) s.unit[i] = unit(own.diagonal[i] + x.compliance[a.s->first + i]);
    s.lower = -HUGE_VAL, s.upper = HUGE_VAL;
    if (a.kind == RowKind::Box) {
      s.lower = x.lower[boxes] / s.unit[0], s.upper = x.upper[boxes] / s.unit[0], ++boxes;
    } else if (a.kind == RowKind::Contact) {
      const double mu = x.friction[contacts++];
      if (rows == 1 || mu == 0) {
        s.lower = 0;
      } else {
        s.order = order_of[rows], s.cone = true;
        double across = 0;
        for (Index i = 1; i < rows; ++i) across = std::max(across, own.G[i + row_lanes * i]);
        const double n = unit(own.G[0]), t = unit(across);
        s.mu = mu * n / t;
        for (Index i = 0; i < rows; ++i) s.unit[i] = own.scale[i] * (i ? t : n);
        s.speed[0] = n, s.speed[1] = t;
      }
    }
    if (!s.cone) s.speed[0] = s.unit[0];
    for (Index i = 0; i < rows; ++i) {
      const double l = x.lambda[a.s->first + s.order[i]];
      y[a.s->first + i] = s.unit[i] > 0 ? l / s.unit[i] : 0;
      before[a.s->first + i] = y[a.s->first + i];
    }
  });
}

// Collects rows by segments, and pivots.
void Newton::build_segment_rows() {
  const double* Dinv = inverse_pivots(x.m, x.d);
  const Segments& segments = w.segments;
  std::fill_n(w.pivots, W * std::ptrdiff_t(e.size), 0.0);
  for (Index i = 0; i < e.size; ++i) {
    const Index s = e.segment[e.order[i]], first = segments.first[s];
    for (Index k = first; k < segments.first[s + 1]; ++k) w.pivots[W * i + k - first] = Dinv[k];
  }
  double* to = w.run_rows;
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    Index n = 0;
    const double* carried = a.Y;
    for (Index r = e.first_run[k]; r < e.first_run[k + 1]; ++r) {
      ConstraintRun& run = e.runs[r];
      const Index of = e.segment[run.segment], first = segments.first[of];
      run.rows = to;
      std::fill_n(to, W * s.rows, 0.0);
      for (; n < a.s->support && segments.of[a.support[n]] == of; ++n, carried += row_lanes)
        for (Index i = 0; i < s.rows; ++i) to[W * i + a.support[n] - first] = s.unit[i] * carried[s.order[i]];
      to += W * s.rows;
    }
  });
}

// G y in scaled units, compliance included.
void Newton::times(const double* of, double* G_of) const {
  clear();
  for_each([&](const ActiveConstraint& a, const State& s, Index k) { scatter(k, s.rows, of + a.s->first); });
  for (std::ptrdiff_t i = 0; i < W * std::ptrdiff_t(e.size); ++i) w.by_segment[i] *= w.pivots[i];
  for_each([&](const ActiveConstraint& a, const State& s, Index k) {
    double* to = G_of + a.s->first;
    gather(k, s.rows, w.by_segment, to);
    for (Index i = 0; i < s.rows; ++i) to[i] += soft(a, s, i) * of[a.s->first + i];
  });
}

void Newton::velocities() const {
  times(y, c);
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    for (Index i = 0; i < s.rows; ++i) c[a.s->first + i] += s.unit[i] * (x.g[a.s->first + s.order[i]] + x.bias[a.s->first + s.order[i]]);
  });
}

// Residual of Alart and Curnier's function at y + t dy.
Newton::Error Newton::error(double t) const {
  Error out;
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    const Index first = a.s->first;
    double yk[6] = {}, ak[6] = {};
    for (Index i = 0; i < s.rows; ++i) yk[i] = y[first + i] + t * dy[first + i], ak[i] = yk[i] - (c[first + i] + t * dc[first + i]);
    auto take = [&](double e, Index i) {
      const double velocity = e / (s.cone ? s.speed[i > 0] : s.unit[i]);
      out.most = std::max(out.most, std::abs(velocity)), out.sum += velocity * velocity, out.own += e * e;
    };
    if (!s.cone) {
      for (Index i = 0; i < s.rows; ++i) take(yk[i] - std::clamp(ak[i], s.lower, s.upper), i);
      return;
    }
    const double r = std::max(0.0, ak[0]), length = solver::norm(ak + 1, s.rows - 1), within = length > s.mu * r ? s.mu * r / length : 1;
    take(yk[0] - r, 0);
    for (Index i = 1; i < s.rows; ++i) take(yk[i] - within * ak[i], i);
  });
  return out;
}

// Finds each constraint's state (open, stick, slip, bound) and the known part of dy. Returns its largest component.
double Newton::classify() {
  double known = 0;
  for_each([&](const ActiveConstraint& a, State& s, Index) {
    const double *yk = y + a.s->first, *ck = c + a.s->first;
    double* to = dy + a.s->first;
    std::fill_n(to, s.rows, 0.0);
    s.mode = solver::ConeState::stick, s.unknowns = s.rows;
    if (!s.cone) {
      if (s.lower == -HUGE_VAL && s.upper == HUGE_VAL) return;
      const double aim = yk[0] - ck[0], at = std::clamp(aim, s.lower, s.upper);
      if (at != aim) s.unknowns = 0, to[0] = at - yk[0];
    } else {
      double t[5];
      const Index size = s.rows - 1;
      for (Index i = 0; i < size; ++i) t[i] = yk[1 + i] - ck[1 + i];
      const double normal = yk[0] - ck[0], length = solver::norm(t, size);
      if (normal <= 0) {
        s.mode = solver::ConeState::open, s.unknowns = 0;
        for (Index i = 0; i < s.rows; ++i) to[i] = -yk[i];
      } else if (length > s.mu * normal) {
        s.mode = solver::ConeState::slip, s.unknowns = s.rows - 1;
        s.across = s.mu * normal / length;
        solver::basis(t, size, s.direction);
        double excess = s.mu * yk[0];
        for (Index i = 0; i < size; ++i) excess -= yk[1 + i] * s.direction[0][i];
        for (Index i = 0; i < size; ++i) to[1 + i] = excess * s.direction[0][i];
      }
    }
    for (Index i = 0; i < s.rows; ++i) known = std::max(known, std::abs(to[i]));
  });
  return known;
}

// A sticking row has only the regularising compliance; across the slip direction the width of the cone adds to it.
void Newton::set_law(const ActiveConstraint& a, State& s) const {
  for (Index i = 0; i < s.unknowns; ++i) {
    const double across = s.mode == solver::ConeState::slip && i > 0 ? 1 / s.across - 1 : 0;
    s.stiffness[i] = 1 / (compliant + across + soft(a, s, i));
  }
  for (Index j = 0; j < s.rows; ++j) {
    double unit[max_rows] = {}, by[max_rows] = {}, column[max_rows] = {};
    unit[j] = 1;
    to_unknowns(s, unit, by);
    for (Index i = 0; i < s.unknowns; ++i) by[i] *= s.stiffness[i];
    to_rows(s, by, column);
    for (Index i = 0; i < s.rows; ++i) s.law[i][j] = column[i];
  }
}

// D of the pivots plus Y law Y^T of each constraint.
void Newton::fill(Index p, double* D) const {
  std::fill_n(D, BlockFactor::size, 0.0);
  for (Index i = 0; i < BlockFactor::R; ++i) D[i + W * i] = w.pivots[W * p + i] > 0 ? 1 / w.pivots[W * p + i] : 1;
  e.for_each_of(e.order[p], [&](const ConstraintRun& a) {
    const State& s = w.newton[a.constraint];
    if (s.unknowns == 0) return;
    visit_rows(s.rows, [&]<int rows>() {
      e.for_each_run(a.constraint, [&](const ConstraintRun& b) {
        const Index q = e.position[b.segment];
        if (q == p) add_product<rows>(s, a.rows, a.rows, D);
        if (q <= p) return;
        const Index entry = w.where[q];
        w.newton_filled[entry] = true;
        add_product<rows>(s, a.rows, b.rows, factor.upper + BlockFactor::size * std::ptrdiff_t(entry));
        add_product<rows>(s, b.rows, a.rows, factor.lower + BlockFactor::size * std::ptrdiff_t(entry));
      });
    });
  });
}

bool Newton::factorize() const {
  return factor([this](Index p, double* D) { fill(p, D); });
}

// Newton direction dy and dc = G dy. Returns false if singular.
bool Newton::direction() {
  if (classify() > 0) times(dy, dc);
  else std::fill_n(dc, x.rows, 0.0);
  std::fill_n(w.newton_acts, e.size, false);
  for_each([&](const ActiveConstraint& a, State& s, Index k) {
    if (s.unknowns > 0) set_law(a, s), activate(k);
  });
  if (!factorize()) return false;
  // by unknowns: wanted change, remainder, found change; by rows: step and G step
  double *wanted = before + room, *left = wanted + room, *found = left + room, *step = found + room, *G_step = step + room;
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    const Index first = a.s->first;
    double minus[max_rows] = {};
    for (Index i = 0; i < s.rows; ++i) minus[i] = -dc[first + i] - (s.mode == solver::ConeState::slip && i > 0 ? c[first + i] / s.across : c[first + i]);
    to_unknowns(s, minus, wanted + first);
    std::copy_n(wanted + first, s.unknowns, left + first);
    std::fill_n(found + first, s.rows, 0.0);
  });
  for (int k = 0;; ++k) {
    clear();
    for_each([&](const ActiveConstraint& a, const State& s, Index constraint) {
      if (s.unknowns == 0) return;
      double by[max_rows] = {}, rows[max_rows] = {};
      for (Index i = 0; i < s.unknowns; ++i) by[i] = s.stiffness[i] * left[a.s->first + i];
      to_rows(s, by, rows), scatter(constraint, s.rows, rows);
    });
    factor.solve(w.by_segment);
    for_each([&](const ActiveConstraint& a, const State& s, Index constraint) {
      const Index first = a.s->first;
      double rows[max_rows] = {}, by[max_rows] = {};
      if (s.unknowns) gather(constraint, s.rows, w.by_segment, rows), to_unknowns(s, rows, by);
      for (Index i = 0; i < s.unknowns; ++i) found[first + i] += s.stiffness[i] * (left[first + i] - by[i]);
      to_rows(s, found + first, step + first);
    });
    times(step, G_step);
    if (k == refinements || compliant != min_compliance) break;
    for_each([&](const ActiveConstraint& a, const State& s, Index) {  // residual with the true compliance
      const Index first = a.s->first;
      double by[max_rows];
      to_unknowns(s, G_step + first, by);
      for (Index i = 0; i < s.unknowns; ++i) left[first + i] = wanted[first + i] - by[i] - (1 / s.stiffness[i] - compliant - soft(a, s, i)) * found[first + i];
    });
  }
  for (Index i = 0; i < x.rows; ++i) dy[i] += step[i], dc[i] += G_step[i];
  return true;
}

// Projects y onto the feasible impulses.
void Newton::candidate(double* into) const {
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    const Index first = a.s->first;
    if (s.cone) solver::project_cone(s.mu, s.rows, y + first, into + first);
    else
      for (Index i = 0; i < s.rows; ++i) into[first + i] = std::clamp(y[first + i], s.lower, s.upper);
  });
}

double Newton::residual() const {
  candidate(best), to_impulses(best);
  return x.residual() / speed;
}

void Newton::to_impulses(const double* from) const {
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    for (Index i = 0; i < a.s->rows; ++i) x.lambda[a.s->first + s.order[i]] = s.unit[i] * from[a.s->first + i];
  });
}

Newton::Newton(const Island& island)
    : x(island), w(x.w), e(w.elimination),
      factor{e, w.diagonal, w.blocks_above, w.blocks_above + BlockFactor::size * std::ptrdiff_t(e.entries()), w.where, w.newton_acts, w.newton_filled},
      room(padded_rows(x.rows)), speed(x.speed()), bound(0), compliant(min_compliance) {
  scale(), build_segment_rows();
  std::fill_n(y, x.rows, 0.0), velocities();
  for (Index i = 0; i < x.rows; ++i) bound += jammed * std::abs(c[i]);
  for (Index i = 0; i < x.rows; ++i) bound = std::max(bound, hardly_more * std::abs(before[i]));
  std::copy_n(before, x.rows, y), velocities();
}

bool Newton::run(Index most, double share, dynContactReport& report) {
  Error now = error();
  for (Index k = 0; k < most && x.within_budget(report); ++k) {
    ++report.newton_steps;
    if (!direction()) break;
    double t = 1, largest = 0;
    Error next = error(t);
    while (!(next.sum < now.sum) && t > min_step) next = error(t /= 2);
    if (!(next.sum < now.sum)) {
      if (compliant == damping) break;
      compliant = damping;
      continue;
    }
    compliant = min_compliance;
    for (Index i = 0; i < x.rows; ++i) y[i] += t * dy[i], c[i] += t * dc[i], largest = std::max(largest, std::abs(y[i]));
    if (!(largest <= bound)) {
      std::copy_n(before, x.rows, y), velocities();
      break;
    }
    if (next.most < 1e-2 * speed && (report.residual = residual()) <= x.w.options.tolerance) return true;
    if (!(next.sum < share * now.sum)) break;
    now = next;
  }
  compliant = min_compliance;
  return false;
}

bool Newton::run(dynContactReport& report) { return run(max_steps, 1, report); }

void Newton::write_best(dynContactReport& report) {
  const double found = residual();
  to_impulses(before);
  report.residual = x.residual() / speed;
  if (found < report.residual) to_impulses(best), report.residual = found;
}

// Compares the price of a factorization: dense rows^3 against blocks of segments, in the same unit (measured).
// With no more rows than lanes contacts are seldom redundant, and the damped dense Newton succeeds more often.
bool Island::sparse() {
  if (eliminated == Eliminated::Not) eliminated = w.elimination.find_runs(*this) ? Eliminated::Runs : Eliminated::DoesNotFit;
  const double whole = double(rows) * rows * rows, block = rows > segment_lanes * w.elimination.size ? 4000 : 16000;
  if (!large() && whole <= block * w.elimination.size) return false;
  return ordered() && (large() || whole > block * (w.elimination.size + w.elimination.entries()));
}

bool Island::ordered() {
  if (eliminated == Eliminated::Runs) eliminated = w.elimination.find_order(*this) ? Eliminated::Fits : Eliminated::DoesNotFit;
  return eliminated == Eliminated::Fits;
}

// A residual slightly above the tolerance: contacts contradict one another by as little, and a solution of all is hard to find.
void Island::solve_fixed_correction(dynContactReport& report) {
  constexpr Index fair = 30;  // iterations; below it they were the reason
  constexpr double rounding = 1e-11;
  if (w.options.max_iterations < fair || report.residual < rounding || (!sparse() && !ordered())) return;
  allowance = report.iterations + report.newton_steps + (report.residual > 10 * w.options.tolerance ? 9 : 2) * w.options.max_iterations;
  interior_fixed_correction(*this, report);
}

bool Island::newton(dynContactReport& report, bool from_inside) {
  if (!sparse()) return false;
  if (from_inside) return interior(*this, report);
  Newton method(*this);
  if (method.run(report)) return true;
  method.write_best(report);
  return false;
}

}  // namespace dyn::simulation
