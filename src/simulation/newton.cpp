// Newton's method of Alart and Curnier (solver/alart_curnier.hpp) on an island as it lies: rows are carried by degrees of freedom, and its
// matrix is factorised in blocks, of which there are as many as slots that share a tree.
#include "dyn/constraint/delassus.hpp"
#include "dyn/simulation/block_factor.hpp"
#include "dyn/solver/residuals.hpp"

namespace dyn::simulation {

namespace {

constexpr double proximal = 1e-11;  // of the unit diagonal: steps are unique where contacts are redundant
constexpr double damping = 1e-2;    // the same, where a step without makes nothing better (Levenberg and Marquardt)
constexpr double least_step = 0.2;
constexpr double jammed = 100;      // impulses that exceed those of all free velocities so much are stress that friction locks in
constexpr Index most_steps = 30;
constexpr Index as_they_are[6] = {0, 1, 2, 3, 4, 5};

template <int R>
class Newton {
 public:
  Newton(const Island& x_, double most)
      : x(x_), w(x.w), Dinv(inverse_pivots(x.m, x.d)), room(row_room(x.rows)), speed(most), factor{w.elimination, x.slots, w.diagonal, w.blocks_above,
        w.blocks_above + Factor::size * std::ptrdiff_t(w.elimination.entries(x.slots)), w.where} {}

  void scale();
  bool run(double tolerance, Index most_iterations, dynContactReport& report);

 private:
  using Factor = BlockFactor<R>;
  using State = NewtonSlot;
  const Island& x;
  Workspace& w;
  const double* Dinv;
  std::ptrdiff_t room;
  double speed, damped = proximal;
  Factor factor;
  // of rows, in the slots' own order and units
  double *y = w.newton_vectors, *c = y + room, *dy = c + room, *dc = dy + room, *before = dc + room, *best = before + room;

  struct Error {
    double most = 0, sum = 0;
  };
  template <class F>
  void each(F&& f) const {
    for (Index k = 0; k < x.slots; ++k) f(x.slot(k), w.newton[k], k);
  }
  void to_impulses(const double* from, double* lambda) const {
    each([&](const ActiveSlot& a, const State& s, Index) {
      for (Index i = 0; i < a.s->rows; ++i) lambda[a.s->first + s.order[i]] = s.unit[i] * from[a.s->first + i];
    });
  }
  void times(const double* of, double* G_of) const;
  Error error(double t) const;
  double states();
  void fill(Index position, double* D) const;
  void block(const State& a, const State& b, const double* G, double* U, double* L) const;
  bool direction();
  void candidate(double* into);
};

// Units in which diagonals are 1 and cones round; and the guess.
template <int R>
void Newton<R>::scale() {
  Index boxes = 0, contacts = 0;
  each([&](const ActiveSlot& a, State& s, Index k) {
    const SlotBlock& own = w.blocks[k];
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

// G y in these units, with what is soft.
template <int R>
void Newton<R>::times(const double* of, double* G_of) const {
  double* const z = w.by_dof;
  x.clear(z);
  each([&](const ActiveSlot& a, const State& s, Index) {
    double by[most_rows] = {};
    for (Index i = 0; i < s.rows; ++i) by[s.order[i]] = s.unit[i] * of[a.s->first + i];
    x.pass(a, by, z);
  });
  each([&](const ActiveSlot& a, const State& s, Index) {
    const auto moved = x.moved(a, Dinv, z);
    for (Index i = 0; i < s.rows; ++i) {
      const Index row = a.s->first + s.order[i];
      G_of[a.s->first + i] = s.unit[i] * (moved[int(s.order[i])] + x.compliance[row] * s.unit[i] * of[a.s->first + i]);
    }
  });
}

// Of the function whose zero is looked for, at y + t dy: largest and squares, as velocities.
template <int R>
typename Newton<R>::Error Newton<R>::error(double t) const {
  Error out;
  each([&](const ActiveSlot& a, const State& s, Index) {
    const Index first = a.s->first;
    double yk[6] = {}, ak[6] = {};
    for (Index i = 0; i < s.rows; ++i) yk[i] = y[first + i] + t * dy[first + i], ak[i] = yk[i] - (c[first + i] + t * dc[first + i]);
    auto take = [&](double e, Index i) {
      const double velocity = e / (s.cone ? s.speed[i > 0] : s.unit[i]);
      out.most = std::max(out.most, std::abs(velocity)), out.sum += velocity * velocity;
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

// What each slot does in the step, and the known part of dy. Answers its largest number.
template <int R>
double Newton<R>::states() {
  double known = 0;
  each([&](const ActiveSlot& a, State& s, Index) {
    const double *yk = y + a.s->first, *ck = c + a.s->first;
    double* step = dy + a.s->first;
    std::fill_n(step, s.rows, 0.0);
    s.is = solver::ConeState::stuck, s.unknowns = s.rows;
    if (!s.cone) {
      if (s.lower == -HUGE_VAL && s.upper == HUGE_VAL) return;
      const double to = yk[0] - ck[0], at = std::clamp(to, s.lower, s.upper);
      if (at != to) s.unknowns = 0, step[0] = at - yk[0];
    } else {
      double t[5];
      const Index size = s.rows - 1;
      for (Index i = 0; i < size; ++i) t[i] = yk[1 + i] - ck[1 + i];
      const double normal = yk[0] - ck[0], length = solver::norm(t, size);
      if (normal <= 0) {
        s.is = solver::ConeState::apart, s.unknowns = 0;
        for (Index i = 0; i < s.rows; ++i) step[i] = -yk[i];
      } else if (length > s.mu * normal) {
        s.is = solver::ConeState::slides, s.unknowns = s.rows - 1;
        s.across = s.mu * normal / length;
        solver::basis(t, size, s.direction);
        double excess = s.mu * yk[0];
        for (Index i = 0; i < size; ++i) excess -= yk[1 + i] * s.direction[0][i];
        for (Index i = 0; i < size; ++i) step[1 + i] = excess * s.direction[0][i];
      }
    }
    for (Index i = 0; i < s.rows; ++i) known = std::max(known, std::abs(step[i]));
  });
  return known;
}

// U = rows of a, columns of b of the matrix, L the other way round; G: rows of b in lanes, by rows of a.
template <int R>
void Newton<R>::block(const State& a, const State& b, const double* G, double* U, double* L) const {
  double g[6][6];  // rows of a, rows of b
  for (Index i = 0; i < a.rows; ++i)
    for (Index j = 0; j < b.rows; ++j) g[i][j] = a.unit[i] * b.unit[j] * G[b.order[j] + row_lanes * a.order[i]];
  // equations: the normal and the directions across the sliding; unknowns: the normal with the friction along it, and the same directions
  auto reduce = [&](const State& s, auto&& at, Index others, bool equations) {
    if (s.is != solver::ConeState::slides) return;
    const Index size = s.rows - 1;
    for (Index o = 0; o < others; ++o) {
      double turned[5] = {};
      for (Index k = 0; k < size; ++k) {
        turned[k] = 0;
        for (Index l = 0; l < size; ++l) turned[k] += s.direction[k][l] * at(1 + l, o);
      }
      if (!equations) at(0, o) += s.mu * turned[0];
      for (Index k = 1; k < size; ++k) at(k, o) = turned[k];
    }
  };
  double h[6][6];
  auto by_a = [](double(*m)[6]) { return [m](Index i, Index o) -> double& { return m[i][o]; }; };
  auto by_b = [](double(*m)[6]) { return [m](Index i, Index o) -> double& { return m[o][i]; }; };
  if (L) {
    std::copy_n(&g[0][0], 36, &h[0][0]);
    reduce(b, by_b(h), a.rows, true), reduce(a, by_a(h), b.unknowns, false);
    for (Index i = 0; i < a.unknowns; ++i)
      for (Index j = 0; j < b.unknowns; ++j) L[j + Factor::W * i] = h[i][j];
  }
  reduce(a, by_a(g), b.rows, true), reduce(b, by_b(g), a.unknowns, false);
  for (Index i = 0; i < a.unknowns; ++i)
    for (Index j = 0; j < b.unknowns; ++j) U[i + Factor::W * j] = g[i][j];
}

template <int R>
void Newton<R>::fill(Index p, double* D) const {
  const Elimination& e = w.elimination;
  const Index k = e.order[p];
  const ActiveSlot& a = x.slot(k);
  const State& s = w.newton[k];
  alignas(64) double G[row_lanes * most_rows];
  auto coupled = [&](const ActiveSlot& b) {
    visit_rows(a.s->rows, [&]<int columns>() { couple<columns>(a.support, a.s->support, a.carried, b.support, b.s->support, b.carried, Dinv, G, row_lanes); });
  };
  std::fill_n(D, Factor::size, 0.0);
  for (Index i = s.unknowns; i < R; ++i) D[i + Factor::W * i] = 1;
  coupled(a);
  block(s, s, G, D, nullptr);
  for (Index i = 0; i < s.unknowns; ++i) {
    const Index row = a.s->first + s.order[i];
    D[i + Factor::W * i] += damped + x.compliance[row] * s.unit[i] * s.unit[i];
    if (s.is == solver::ConeState::slides && i > 0) D[i + Factor::W * i] += 1 / s.across - 1;
  }
  auto with = [&](Index tree, Index not_of) {
    if (tree < 0) return;
    e.for_each_of(tree, [&](Index j) {
      if (e.position[j] <= p || w.newton[j].unknowns == 0) return;
      const ActiveSlot& b = x.slot(j);
      if (not_of >= 0 && (tree_a(b) == not_of || tree_b(b) == not_of)) return;
      const std::ptrdiff_t to = Factor::size * std::ptrdiff_t(w.where[e.position[j]]);
      coupled(b);
      block(s, w.newton[j], G, factor.upper + to, factor.lower + to);
    });
  };
  with(tree_a(a), -1), with(tree_b(a), tree_a(a));
}

// dy and dc = G dy. false: singular.
template <int R>
bool Newton<R>::direction() {
  const Elimination& e = w.elimination;
  if (states() > 0) times(dy, dc);
  else std::fill_n(dc, x.rows, 0.0);
  bool* const acts = w.newton_acts;
  each([&](const ActiveSlot&, const State& s, Index k) { acts[e.position[k]] = s.unknowns > 0; });
  if (!factor([=](Index p) { return acts[p]; }, [&](Index p, double* D) { fill(p, D); })) return false;
  double* const rhs = w.newton_rhs;
  std::fill_n(rhs, Factor::W * std::ptrdiff_t(x.slots), 0.0);
  each([&](const ActiveSlot& a, const State& s, Index k) {
    if (s.unknowns == 0) return;
    double* r = rhs + Factor::W * e.position[k];
    const double *ck = c + a.s->first, *known = dc + a.s->first;
    if (s.is == solver::ConeState::stuck) {
      for (Index i = 0; i < s.rows; ++i) r[i] = -(ck[i] + known[i]);
      return;
    }
    r[0] = -(ck[0] + known[0]);
    for (Index i = 1; i < s.rows - 1; ++i)
      for (Index l = 0; l < s.rows - 1; ++l) r[i] -= s.direction[i][l] * (ck[1 + l] / s.across + known[1 + l]);
  });
  factor.solve(rhs);
  each([&](const ActiveSlot& a, const State& s, Index k) {
    if (s.unknowns == 0) return;
    const double* r = rhs + Factor::W * e.position[k];
    double* step = dy + a.s->first;
    if (s.is == solver::ConeState::stuck) {
      std::copy_n(r, s.rows, step);
      return;
    }
    step[0] = r[0];
    for (Index l = 0; l < s.rows - 1; ++l) {
      step[1 + l] += s.mu * r[0] * s.direction[0][l];
      for (Index i = 1; i < s.rows - 1; ++i) step[1 + l] += r[i] * s.direction[i][l];
    }
  });
  times(dy, dc);
  return true;
}

// The nearest impulses that are allowed.
template <int R>
void Newton<R>::candidate(double* into) {
  each([&](const ActiveSlot& a, const State& s, Index) {
    const Index first = a.s->first;
    if (s.cone) solver::project_cone(s.mu, s.rows, y + first, into + first);
    else
      for (Index i = 0; i < s.rows; ++i) into[first + i] = std::clamp(y[first + i], s.lower, s.upper);
  });
}

template <int R>
bool Newton<R>::run(double tolerance, Index most_iterations, dynContactReport& report) {
  scale();
  auto velocities = [&] {
    times(y, c);
    each([&](const ActiveSlot& a, const State& s, Index) {
      for (Index i = 0; i < s.rows; ++i) {
        const Index row = a.s->first + s.order[i];
        c[a.s->first + i] += s.unit[i] * (x.g[row] + x.bias[row]);
      }
    });
  };
  std::fill_n(y, x.rows, 0.0), velocities();
  double bound = 0;
  for (Index i = 0; i < x.rows; ++i) bound += jammed * std::abs(c[i]);
  std::copy_n(before, x.rows, y), velocities();
  std::fill_n(dy, x.rows, 0.0), std::fill_n(dc, x.rows, 0.0);
  Error now = error(0);
  const double first = now.sum, residual = report.residual;
  auto better = [&] {  // the candidate's residual becomes that of the report
    candidate(best);
    to_impulses(best, x.lambda);
    report.residual = x.residual() / speed;
    return report.residual <= tolerance;
  };
  for (Index k = 0; k < most_steps && report.iterations + report.newton_steps < most_iterations; ++k) {
    ++report.newton_steps;
    if (!direction()) break;
    double t = 1;
    Error next = error(t);
    while (!(next.sum < now.sum) && t > least_step) next = error(t /= 2);
    if (!(next.sum < now.sum)) {
      if (damped == damping) break;
      damped = damping;
      continue;
    }
    damped = proximal;
    double largest = 0;
    for (Index i = 0; i < x.rows; ++i) y[i] += t * dy[i], c[i] += t * dc[i], largest = std::max(largest, std::abs(y[i]));
    now = next;
    if (!(largest <= bound)) {
      now.sum = first;
      break;
    }
    if (now.most < 1e-2 * speed && better()) return true;
  }
  // a better start of what comes next, or the same
  if (now.sum < first && (better(), report.residual < residual)) return false;
  to_impulses(before, x.lambda);
  report.residual = residual;
  return false;
}

}  // namespace

bool Island::sparse() {
  if (!eliminated) eliminated = w.elimination(*this) ? 1 : -1;
  return eliminated > 0 && (large() || 4 * std::ptrdiff_t(w.elimination.entries(slots)) < std::ptrdiff_t(slots) * (slots - 1));
}

bool Island::newton(dynContactReport& report) {
  if (!sparse()) return false;
  Index most = 0;
  for (Index k = 0; k < slots; ++k) most = std::max(most, slot(k).s->rows);
  const std::ptrdiff_t entries = w.elimination.entries(slots);
  auto run = [&]<int R>() {
    if (2 * BlockFactor<R>::size * entries > w.block_room) return false;
    return Newton<R>(*this, speed()).run(w.options.tolerance, w.options.max_iterations, report);
  };
  return most <= 3 ? run.template operator()<3>() : run.template operator()<6>();
}

}  // namespace dyn::simulation
