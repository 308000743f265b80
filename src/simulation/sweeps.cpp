// Without a matrix: projected Gauss-Seidel by what the rows leave at the degrees of freedom, z = Y^T lambda:
//   c = g + Y D^-1 z        after a change of lambda: z += Y^T change
// A slot costs what its bodies have of degrees of freedom, however many rows the island has.
#include "dyn/constraint/delassus.hpp"
#include "dyn/simulation/island.hpp"
#include "dyn/solver/pgs.hpp"
#include "dyn/solver/residuals.hpp"

namespace dyn::simulation {

namespace {

constexpr int few_sweeps = 4;  // of a guess that is nearly good: cheaper than a matrix

struct Sweeper {
  const Island& x;
  const double* Dinv;
  double* z;

  Pack<double, row_lanes> moved(const ActiveSlot& a) const { return x.moved(a, Dinv, z); }  // G lambda, in lanes
  void change(const ActiveSlot& a, const double* by) const { x.pass(a, by, z); }
  double wanted(Index i) const { return x.g[i] + x.bias[i]; }
  double soft(Index i) const { return x.compliance[i]; }

  // A row of an equality or a box. Answers by how much its velocity changes.
  double row(const ActiveSlot& a, const SlotBlock& s, Index r, double lower, double upper) const {
    const Index i = a.s->first + r;
    const double G = s.diagonal[r] + soft(i);
    if (!(G > 0)) return 0;
    const double c = wanted(i) + moved(a)[int(r)] + soft(i) * x.lambda[i], to = std::clamp(x.lambda[i] - c / G, lower, upper);
    double by[most_rows] = {};
    by[r] = to - x.lambda[i];
    if (by[r] == 0) return 0;
    x.lambda[i] = to;
    change(a, by);
    return std::abs(G * by[r]);
  }
  void contact(const ActiveSlot& a, SlotBlock& s, double mu) const {
    const Index first = a.s->first, rows = a.s->rows, normal = normal_row(rows);
    if (rows == 1 || mu == 0) return void(row(a, s, normal, 0, HUGE_VAL));
    const Index* order = order_of[rows];
    const auto Gl = moved(a);
    double b[most_rows] = {}, now[most_rows] = {}, to[most_rows] = {}, by[most_rows] = {};
    for (Index i = 0; i < rows; ++i) now[i] = x.lambda[first + order[i]] / s.scale[i];
    for (Index i = 0; i < rows; ++i) {
      const Index at = first + order[i];
      b[i] = s.scale[i] * (wanted(at) + Gl[int(order[i])] + soft(at) * x.lambda[at]);
      for (Index j = 0; j < rows; ++j) b[i] -= s.G[i + row_lanes * j] * now[j];
    }
    solver::solve_cone({0, rows, mu}, s.local, s.G[0], b, to);
    bool changes = false;
    for (Index i = 0; i < rows; ++i) {
      by[order[i]] = (to[i] - now[i]) * s.scale[i], changes |= to[i] != now[i];
      x.lambda[first + order[i]] = to[i] * s.scale[i];
    }
    if (changes) change(a, by);
  }
  void operator()() const {
    for (Index k = 0, boxes = 0, contacts = 0; k < x.slots; ++k) {
      const ActiveSlot& a = x.slot(k);
      SlotBlock& s = x.w.blocks[k];
      if (a.kind == RowKind::Equality)
        for (Index r = 0; r < a.s->rows; ++r) row(a, s, r, -HUGE_VAL, HUGE_VAL);
      else if (a.kind == RowKind::Box)
        row(a, s, 0, x.lower[boxes], x.upper[boxes]), ++boxes;
      else
        contact(a, s, x.friction[contacts]), ++contacts;
    }
  }
  // Without friction. Answers the largest change of a velocity.
  double apart() const {
    double most = 0;
    for (Index k = 0, boxes = 0; k < x.slots; ++k) {
      const ActiveSlot& a = x.slot(k);
      const SlotBlock& s = x.w.blocks[k];
      if (a.kind == RowKind::Equality)
        for (Index r = 0; r < a.s->rows; ++r) most = std::max(most, row(a, s, r, -HUGE_VAL, HUGE_VAL));
      else if (a.kind == RowKind::Box)
        most = std::max(most, row(a, s, 0, x.lower[boxes], x.upper[boxes])), ++boxes;
      else
        most = std::max(most, row(a, s, normal_row(a.s->rows), 0, HUGE_VAL));
    }
    return most;
  }
  // Largest |y - P_K(y - u)| as a velocity: the residual of residuals.hpp, slot by slot.
  double residual() const {
    double worst = 0;
    for (Index k = 0, boxes = 0, contacts = 0; k < x.slots; ++k) {
      const ActiveSlot& a = x.slot(k);
      const SlotBlock& s = x.w.blocks[k];
      const auto Gl = moved(a);
      const Index first = a.s->first, rows = a.s->rows;
      auto velocity = [&](Index r) { return wanted(first + r) + Gl[int(r)] + soft(first + r) * x.lambda[first + r]; };
      auto of_row = [&](Index r, double lower, double upper) {
        const double G = s.diagonal[r] + soft(first + r), l = x.lambda[first + r];
        if (G > 0) worst = std::max(worst, G * std::abs(l - std::clamp(l - velocity(r) / G, lower, upper)));
      };
      if (a.kind == RowKind::Equality) {
        for (Index r = 0; r < rows; ++r) of_row(r, -HUGE_VAL, HUGE_VAL);
      } else if (a.kind == RowKind::Box) {
        of_row(0, x.lower[boxes], x.upper[boxes]), ++boxes;
      } else if (const double mu = x.friction[contacts++]; rows == 1 || mu == 0) {
        of_row(normal_row(rows), 0, HUGE_VAL);
      } else {
        const Index* order = order_of[rows];
        double across = 0, y[most_rows] = {}, c[most_rows] = {}, e[most_rows] = {};
        for (Index i = 1; i < rows; ++i) across = std::max(across, s.G[i + row_lanes * i]);
        const double dn = 1 / std::sqrt(s.G[0]), dt = across > 0 ? 1 / std::sqrt(across) : dn;
        for (Index i = 0; i < rows; ++i) {
          const double di = i ? dt : dn;
          y[i] = x.lambda[first + order[i]] / s.scale[i] / di, c[i] = di * s.scale[i] * velocity(order[i]);
        }
        solver::natural_map({0, rows, mu * dn / dt}, y, c, e);
        for (Index i = 0; i < rows; ++i) worst = std::max(worst, std::abs(e[i]) / (i ? dt : dn));
      }
    }
    return worst;
  }
  void start() const {
    x.clear(z);
    x.add(z);
  }
};

}  // namespace

void Island::prepare_blocks() {
  using P = Pack<double, row_lanes>;
  const double* Dinv = inverse_pivots(m, d);
  for (Index k = 0, at = 0; k < slots; ++k) {
    const ActiveSlot& a = slot(k);
    SlotBlock& s = w.blocks[k];
    const Index rows_ = a.s->rows;
    P G[most_rows];
    for (P& column : G) column = P::zero();
    const double* y = a.carried;
    for (Index n = 0; n < a.s->support; ++n, y += row_lanes) {
      const P e = P::load(y) * Dinv[a.support[n]];
      for (Index r = 0; r < rows_; ++r) G[r] = G[r] + e * y[r];
    }
    double block[most_rows * row_lanes];
    for (Index r = 0; r < rows_; ++r) G[r].store(block + row_lanes * r);
    for (Index r = 0; r < rows_; ++r) s.diagonal[r] = block[r + row_lanes * r];
    if (a.kind != RowKind::Contact) continue;
    const Index contact = at++;
    const double mu = friction[contact];
    if (rows_ == 1 || mu == 0) continue;
    const Index* order = order_of[rows_];
    for (Index i = 0; i < rows_; ++i) s.scale[i] = i < 3 ? 1 : (i == rows_ - 1 ? torsion[contact] : rolling[contact]) / mu;
    for (Index j = 0; j < rows_; ++j)
      for (Index i = 0; i < rows_; ++i)
        s.G[i + row_lanes * j] = s.scale[i] * s.scale[j] * (block[order[i] + row_lanes * order[j]] + (i == j ? compliance[a.s->first + order[i]] : 0));
  }
}

// What sweeps need more.
void Island::prepare_cones() {
  if (has_cones) return;
  has_cones = true;
  for (Index k = 0, contact = 0; k < slots; ++k) {
    if (slot(k).kind != RowKind::Contact) continue;
    const double mu = friction[contact++];
    const Index rows_ = slot(k).s->rows;
    if (rows_ == 1 || mu == 0) continue;
    SlotBlock& s = w.blocks[k];
    solver::Problem p;
    p.G = {s.G, row_lanes};
    s.local = solver::local_cone(p, {0, rows_, mu});
  }
}

// Of torsion and rolling by their lengths, and where a coefficient is zero not at all.
double Island::speed() const {
  double most = 0;
  for (Index k = 0, contact = 0; k < slots; ++k) {
    const ActiveSlot& a = slot(k);
    const bool touches = a.kind == RowKind::Contact;
    for (Index r = 0; r < a.s->rows; ++r) {
      const double length = r < 3 || !touches ? 1 : friction[contact] > 0 ? (r == a.s->rows - 1 ? torsion[contact] : rolling[contact]) / friction[contact] : 0;
      most = std::max(most, length * std::abs(g[a.s->first + r] + bias[a.s->first + r]));
    }
    contact += touches;
  }
  return most;
}

// c = G lambda + g
void Island::velocities() const {
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  for (Index k = 0; k < slots; ++k) {
    const ActiveSlot& a = slot(k);
    const auto Gl = sweep.moved(a);
    for (Index r = 0; r < a.s->rows; ++r) c[a.s->first + r] = g[a.s->first + r] + Gl[int(r)];
  }
}

double Island::residual() const {
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  sweep.start();
  return sweep.residual();
}

bool Island::stays(dynContactReport& report) {
  if (bounces) return false;
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  const double most = speed();
  sweep.start();
  report.residual = most > 0 ? sweep.residual() / most : 0;
  const auto another = [&](int done) {  // one at least where much is tolerated: cones have turned since the guess
    return (report.residual > w.options.tolerance && report.residual < 1e-5) || (done == 0 && sweeps_alone() && report.residual <= w.options.tolerance);
  };
  for (int k = 0; k < few_sweeps && another(k); ++k) {
    prepare_cones();
    sweep(), ++report.iterations;
    report.residual = sweep.residual() / most;
  }
  if (!(report.residual <= w.options.tolerance)) return false;
  velocities();
  return true;
}

void Island::sweep_to_rest(dynContactReport& report) {
  for (Index k = 0, contact = 0; k < slots; ++k) {
    const ActiveSlot& a = slot(k);
    if (a.kind != RowKind::Contact) continue;
    const Index n = a.s->first + normal_row(a.s->rows);
    if (restitution[contact] > 0) bias[n] = restitution[contact] * v_minus[n];
    ++contact;
  }
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  const double most = speed();
  sweep.start();
  report.residual = most > 0 ? sweep.residual() / most : 0;
  prepare_cones();
  // ever more of them before Newton's method has another try, and then from inside
  Index tries = 0;
  for (Index some = 5; (large() || sweeps_alone() || some <= 10) && report.residual > w.options.tolerance && may_go_on(report); some *= sweeps_alone() ? 1 : 2) {
    for (Index k = 0; k < some && may_go_on(report); ++k) sweep(), ++report.iterations;
    report.residual = sweep.residual() / most;
    if (report.residual <= w.options.tolerance || (!sweeps_alone() && newton(report, ++tries >= 2))) break;
    sweep.start();
  }
  velocities();
}

void Island::sweep_on(dynContactReport& report) {
  double* const best = w.newton_vectors;
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  const double most = speed();
  prepare_cones();
  std::copy_n(lambda, rows, best);
  for (int worse = 0, k = 0; worse < 3 && k < 50 && report.residual > w.options.tolerance; ++k) {
    sweep.start();
    for (int i = 0; i < 20; ++i) sweep();
    report.iterations += 20;
    const double now = sweep.residual() / most;
    worse = now < 0.9 * report.residual ? 0 : worse + 1;
    if (now < report.residual) report.residual = now, std::copy_n(lambda, rows, best);
  }
  std::copy_n(best, rows, lambda);
  sweep.start(), velocities();
}

// Enough for corrections, of which the next steps make more.
void Island::sweep_apart() {
  constexpr int most_sweeps = 20;
  constexpr double least = 0.02;  // of the first sweep's largest change
  std::fill_n(lambda, rows, 0.0);
  const Sweeper sweep{*this, inverse_pivots(m, d), w.by_dof};
  sweep.start();
  const double first = sweep.apart();
  for (int k = 1; k < most_sweeps && sweep.apart() > least * first; ++k) {}
}

}  // namespace dyn::simulation
