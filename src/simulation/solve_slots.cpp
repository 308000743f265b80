// The contact problems of a step, island by island, and the corrections of its configuration.
#include "dyn/constraint/constrained_dynamics.hpp"
#include "dyn/simulation/step.hpp"
#include "dyn/solver/list.hpp"

namespace dyn::simulation {

namespace {

constexpr double slop = 1e-9;         // m, rad: what no correction is made for
constexpr double correction = 0.5;    // of what is wrong, in a step
constexpr double fastest_correction = 1;  // m/s, rad/s
constexpr double rest = 0.05;             // m/s: what is faster is an impact however long the step

struct Island {
  const Model& m;
  Data<double>& d;
  Workspace& w;
  const Index* order;  // of its slots
  Index slots;
  double h;
  const double* v_before;
  Index rows = 0, equalities = 0, boxes = 0, contacts = 0;
  bool bounces = false;
  double worst = 0;  // what a correction is made for

  double* vector(int k) const { return w.vectors + k * row_room(step_rows(m)); }
  double *g = vector(0), *bias = vector(1), *lambda = vector(2), *c = vector(3), *compliance = vector(4), *v_minus = vector(5), *lower = vector(6),
         *upper = vector(7), *friction = vector(8), *torsion = vector(9), *rolling = vector(10), *restitution = vector(11);

  ActiveSlot& slot(Index k) const { return w.active[order[k]]; }
  std::ptrdiff_t stride() const { return row_room(rows); }

  void number();
  void matrix() const;
  void equality(const Slot<double>& s) const;
  void box(const Slot<double>& s, Index row) const;
  void contact(const ActiveSlot& x, Index number);
  dynContactProblem problem() const;
  void solve(const dynContactProblem& p, dynContactReport& best);
  void impulses(dynContactReport& report);
  void add(double* by_dof) const;
  bool correct(double* by_dof);
};

void Island::number() {
  for (Index k = 0; k < slots; ++k) {
    ActiveSlot& x = slot(k);
    x.s->first = rows, rows += x.s->rows;
    if (x.kind == RowKind::Equality) equalities += x.s->rows;
    else if (x.kind == RowKind::Box) ++boxes;
    else w.contact_rows[contacts++] = x.s->rows;
  }
}

// Slots come in the order of their rows: what whole lanes write beyond a slot is overwritten.
void Island::matrix() const {
  const std::ptrdiff_t ld = stride();
  const double* Dinv = inverse_pivots(m, d);
  double* G = w.matrix;
  auto apart = [](const ActiveSlot& a, const ActiveSlot& b) {
    auto in = [&](Index tree) { return tree >= 0 && (tree == b.tree1 || tree == b.tree2); };
    return !in(a.tree1) && !in(a.tree2);
  };
  for (Index i = 0; i < slots; ++i) {
    const ActiveSlot& a = slot(i);
    for (Index j = i; j < slots; ++j) {
      const ActiveSlot& b = slot(j);
      double* block = G + b.s->first + ld * a.s->first;
      if (apart(a, b)) {
        for (Index col = 0; col < a.s->rows; ++col) std::fill_n(block + ld * col, b.s->rows, 0.0);
        continue;
      }
      auto couple_slots = [&]<int columns>() { couple<columns>(a.support, a.s->support, a.carried, b.support, b.s->support, b.carried, Dinv, block, ld); };
      switch (a.s->rows) {
        case 1: couple_slots.template operator()<1>(); break;
        case 2: couple_slots.template operator()<2>(); break;
        case 3: couple_slots.template operator()<3>(); break;
        case 4: couple_slots.template operator()<4>(); break;
        case 5: couple_slots.template operator()<5>(); break;
        default: couple_slots.template operator()<6>(); break;
      }
    }
  }
  for (Index col = 0; col < rows; ++col)
    for (Index row = col + 1; row < rows; ++row) G[col + ld * row] = G[row + ld * col];
}

// With gains the acceleration is what these ask for; without, the velocity is zero and what is wrong goes by a correction.
void Island::equality(const Slot<double>& s) const {
  for (Index r = 0; r < s.rows; ++r) {
    const Index i = s.first + r;
    const bool gains = s.c.stiffness > 0 || s.c.damping > 0;
    g[i] = s.rate[r];
    bias[i] = gains ? h * s.c.stiffness * s.error[r] - std::max(0.0, 1 - h * s.c.damping) * s.rate[r] : 0;
    lambda[i] = compliance[i] = v_minus[i] = 0;
  }
}

void Island::box(const Slot<double>& s, Index k) const {
  const Index i = s.first;
  g[i] = s.rate[0], bias[i] = std::max(0.0, s.error[0]) / h;
  lower[k] = s.lower[0], upper[k] = s.upper[0];
  lambda[i] = compliance[i] = v_minus[i] = 0;
}

void Island::contact(const ActiveSlot& x, Index k) {
  const Slot<double>& s = *x.s;
  const dynContactForce& f = w.contacts[x.index];
  const ContactLaw& law = w.laws[x.index];
  const dynMaterial& material = law.material;
  const double gap = f.contact.distance;
  friction[k] = material.friction, torsion[k] = material.torsion, rolling[k] = material.rolling, restitution[k] = 0;
  for (Index r = 0; r < s.rows; ++r) {
    const Index i = s.first + r;
    const Vec3<double>& axis = law.axis(r);
    g[i] = s.rate[r] + (r < 2 && s.rows > 1 ? law.slip[r] : 0);
    lambda[i] = h * dot(axis, load3(r < 3 ? f.force_on_b : f.moment_on_b));
    bias[i] = compliance[i] = v_minus[i] = 0;
  }
  const Index n = s.first + (s.rows == 1 ? 0 : 2);
  bias[n] = std::max(0.0, gap) / h;
  if (material.stiffness > 0 || material.damping > 0) {
    const double total = h * material.stiffness + material.damping;
    compliance[n] = 1 / (h * total), bias[n] = material.stiffness * gap / total;
  } else if (material.restitution > 0 && gap + h * s.rate[n - s.first] <= 0) {
    auto speed = [&](Index body) {
      return body_motion(m, d, body, v_before, static_cast<const double*>(nullptr)).V;
    };
    using Six = SixEights<double>;
    const double before = (Six::load(s.F1).dot(speed(s.c.body1)) + Six::load(s.F2).dot(speed(s.c.body2)))[int(n - s.first)];
    const double gained = std::abs(s.rate[n - s.first] - before);
    if (before < -std::min(2 * gained, rest))  // less than what the step's own acceleration makes is rest, not an impact
      restitution[k] = material.restitution, v_minus[n] = before, bias[n] = 0, bounces = true;
  }
  w.report.penetration = std::max(w.report.penetration, -gap);
}

dynContactProblem Island::problem() const {
  dynContactProblem p{};
  p.struct_size = sizeof p;
  p.equalities = equalities, p.boxes = boxes, p.contacts = contacts;
  p.contact_rows = w.contact_rows, p.G = w.matrix, p.G_stride = std::int32_t(stride());
  p.g = g, p.bias = bias, p.lower = lower, p.upper = upper;
  return p;
}

// From the guess lambda to lambda; where that does not get far enough, from nothing, and by the other of the exact solvers.
void Island::solve(const dynContactProblem& p, dynContactReport& best) {
  const dynContactSolverType other = w.options.solver == DYN_CONTACT_ADMM ? DYN_CONTACT_NEWTON : DYN_CONTACT_ADMM;
  const struct {
    dynContactSolverType solver;
    bool warm;
  } tries[] = {{w.options.solver, true}, {w.options.solver, false}, {other, false}};
  best.residual = HUGE_VAL;
  std::int32_t iterations = 0, newton_steps = 0;
  for (const auto& t : tries) {
    solver::Budget b;
    b.tolerance = w.options.tolerance, b.max_iterations = w.options.max_iterations, b.warm = t.warm;
    dynContactReport report{};
    solver::solve(p, solver::solvers[t.solver], w.solver, b, lambda, report);
    iterations += report.iterations, newton_steps += report.newton_steps;
    if (report.residual < best.residual) best = report, solver::unscale(p, w.solver.problem, w.solver.y, lambda);
    if (best.residual <= w.options.tolerance || w.options.solver == DYN_CONTACT_PGS) break;
  }
  best.iterations = iterations, best.newton_steps = newton_steps;
}

void Island::impulses(dynContactReport& report) {
  for (Index k = 0, in_boxes = 0, in_contacts = 0; k < slots; ++k) {
    const ActiveSlot& x = slot(k);
    if (x.kind == RowKind::Equality) equality(*x.s);
    else if (x.kind == RowKind::Box) box(*x.s, in_boxes++);
    else contact(x, in_contacts++);
  }
  dynContactProblem p = problem();
  p.friction = friction, p.torsion = torsion, p.rolling = rolling, p.compliance = compliance;
  if (bounces) p.restitution = restitution, p.v_minus = v_minus;
  solve(p, report);
  p.bias = nullptr, p.compliance = nullptr;
  solver::velocity(p, lambda, c);
  for (Index k = 0; k < slots; ++k) {
    const ActiveSlot& x = slot(k);
    if (x.kind != RowKind::Contact) continue;
    dynContactForce& f = w.contacts[x.index];
    const ContactLaw& law = w.laws[x.index];
    Vec3<double> force = Vec3<double>::zero(), moment = force;
    for (Index r = 0; r < x.s->rows; ++r) {
      const double l = lambda[x.s->first + r] / h;
      (r < 3 ? force : moment) = (r < 3 ? force : moment) + law.axis(r) * l;
    }
    store3(force, f.force_on_b), store3(moment, f.moment_on_b);
  }
}

// by_dof += Y^T lambda
void Island::add(double* by_dof) const {
  for (Index k = 0; k < slots; ++k) {
    const ActiveSlot& x = slot(k);
    const double *y = x.carried, *l = lambda + x.s->first;
    for (Index n = 0; n < x.s->support; ++n, y += row_lanes)
      for (Index r = 0; r < x.s->rows; ++r) by_dof[x.support[n]] += y[r] * l[r];
  }
}

// What would be wrong at the end of the step, without friction: bias becomes that, g zero.
bool Island::correct(double* by_dof) {
  const double most = fastest_correction * h;
  auto part = [&](double wrong) { return std::clamp(correction * wrong, -most, most); };
  double largest = 0;
  for (Index k = 0, in_boxes = 0; k < slots; ++k) {
    const ActiveSlot& x = slot(k);
    const Slot<double>& s = *x.s;
    for (Index r = 0; r < s.rows; ++r) {
      const Index i = s.first + r;
      double wrong = 0;
      if (x.kind == RowKind::Equality && !(s.c.stiffness > 0 || s.c.damping > 0)) {
        wrong = s.error[r] + h * c[i];
        largest = std::max(largest, std::abs(wrong));
        wrong = part(wrong);
      } else if (x.kind == RowKind::Box && s.c.type == DYN_CONSTRAINT_LIMIT) {
        wrong = s.error[0] + h * c[i];
        largest = std::max(largest, -wrong);
        if (wrong < 0) wrong = part(wrong);
      } else if (x.kind == RowKind::Box) {
        lower[in_boxes] = upper[in_boxes] = 0;
      } else if (x.kind == RowKind::Contact && r == (s.rows == 1 ? 0 : 2)) {
        const dynMaterial& material = w.laws[x.index].material;
        wrong = w.contacts[x.index].contact.distance + h * c[i];
        if (material.stiffness > 0 || material.damping > 0) wrong = std::max(wrong, most);
        largest = std::max(largest, -wrong);
        if (wrong < 0) wrong = part(wrong);
      }
      g[i] = 0, bias[i] = wrong;
    }
    in_boxes += x.kind == RowKind::Box;
  }
  if (!(largest > slop)) return false;
  const dynContactProblem p = problem();
  solver::Budget b;
  b.tolerance = 1e-6, b.max_iterations = w.options.max_iterations;
  dynContactReport report{};
  solver::solve(p, solver::solvers[w.options.solver], w.solver, b, lambda, report);
  solver::unscale(p, w.solver.problem, w.solver.y, lambda);
  add(by_dof);
  return true;
}

}  // namespace

bool solve_slots(const Model& m, Data<double>& d, Index slots, const double* v_before, double h, double* v, double* dq) {
  Workspace& w = *d.step;
  v_before = d.expand(m, v_before, d.ax);
  double *impulse = d.constraint_step, *displacement = d.constraint_ddq;
  std::fill_n(impulse, m.n.nv, 0.0), std::fill_n(displacement, m.n.nv, 0.0);
  bool corrected = false;
  Index islands = 0, rows = 0;
  for (Index begin = 0, end; begin < slots; begin = end, ++islands) {
    end = begin + 1;
    while (end < slots && w.active[w.order[end]].island == w.active[w.order[begin]].island) ++end;
    Island island{m, d, w, w.order + begin, end - begin, h, v_before};
    island.number(), island.matrix();
    dynContactReport report{};
    island.impulses(report);
    island.add(impulse);
    corrected |= island.correct(displacement);
    rows += island.rows;
    w.report.iterations += report.iterations + report.newton_steps;
    w.report.residual = std::max(w.report.residual, report.residual);
  }
  w.report.islands = std::max(w.report.islands, islands), w.report.rows = std::max(w.report.rows, rows);
  w.report.contacts = std::max(w.report.contacts, w.contact_count);
  scatter(m, d, impulse);
  for (Index k = 0; k < m.n.nv; ++k) v[k] += impulse[k];
  if (!corrected) return false;
  scatter(m, d, displacement);
  std::copy_n(displacement, m.n.nv, dq);
  return true;
}

}  // namespace dyn::simulation
