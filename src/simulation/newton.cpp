#include "simulation/newton.hpp"

#include "algorithm/constrained/delassus.hpp"

namespace dyn::simulation {

namespace {

using namespace tuning::newton;


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

// Residual of Alart and Curnier's function at y + t dy.
Newton::Error Newton::error(double t) const {
  Error out;
  for_each([&](const ActiveConstraint& a, const State& s, Index) {
    const Index first = a.s->first;
    double yk[6] = {}, ak[6] = {};
    for (Index i = 0; i < s.rows; ++i)
      yk[i] = y[first + i] + t * dy[first + i], ak[i] = yk[i] - (c[first + i] + t * dc[first + i]);
    auto take = [&](double e, Index i) {
      const double velocity = e / (s.cone ? s.speed[i > 0] : s.unit[i]);
      out.most = std::max(out.most, std::abs(velocity)), out.sum += velocity * velocity, out.own += e * e;
    };
    if (!s.cone) {
      for (Index i = 0; i < s.rows; ++i) take(yk[i] - std::clamp(ak[i], s.lower, s.upper), i);
      return;
    }
    const double r = std::max(0.0, ak[0]), length = solver::norm(ak + 1, s.rows - 1),
                 within = length > s.mu * r ? s.mu * r / length : 1;
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

// 1 plus Y law Y^T of each constraint.
void Newton::fill(Index p, double* D) const {
  std::fill_n(D, BlockFactor::size, 0.0);
  for (Index i = 0; i < BlockFactor::R; ++i) D[i + W * i] = 1;
  e.for_each_of(e.order[p], [&](const ConstraintRun& a) {
    const State& s = w.newton[a.constraint];
    if (s.unknowns == 0) return;
    with_row_count(s.rows, [&]<int rows>() {
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
    for (Index i = 0; i < s.rows; ++i)
      minus[i] = -dc[first + i] - (s.mode == solver::ConeState::slip && i > 0 ? c[first + i] / s.across : c[first + i]);
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
      for (Index i = 0; i < s.unknowns; ++i)
        left[first + i] = wanted[first + i] - by[i] - (1 / s.stiffness[i] - compliant - soft(a, s, i)) * found[first + i];
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
    : x(island),
      w(x.w),
      e(w.elimination),
      factor{e,       w.diagonal,    w.blocks_above, w.blocks_above + BlockFactor::size * std::ptrdiff_t(e.entries()),
             w.where, w.newton_acts, w.newton_filled},
      room(padded_rows(x.rows)),
      speed(x.speed()),
      bound(0),
      compliant(min_compliance) {
  load();
  std::fill_n(y, x.rows, 0.0), velocities();
  for (Index i = 0; i < x.rows; ++i) bound += jammed * std::abs(c[i]);
  for (Index i = 0; i < x.rows; ++i) bound = std::max(bound, above_guess * std::abs(before[i]));
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
    if (next.most < near * speed && (report.residual = residual()) <= x.tolerance) return true;
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

}  // namespace dyn::simulation
