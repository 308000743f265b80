// The iterations: derivatives of the steps, the backward pass, and a line search along its solution.
#include "algorithm/declarations.hpp"
#include "plan/planner.hpp"
#include "simulation/step_derivatives.hpp"
#include "simulation/workspace.hpp"

namespace dyn::plan {

namespace {

constexpr double first_regularisation = 1e-6, factor = 10;
constexpr double still_converges = 1e-5;  // regularisation, with which a small expected decrease says something
constexpr double sufficient = 1e-4;       // share of the expected decrease that a step must reach (Armijo)
constexpr int halvings = 10;
constexpr double long_step = 0.4, short_step = 0.01;  // the regularisation is lowered beyond, raised below
constexpr double share_of_gaps = 0.5;     // of the merit's expected decrease, at least, comes from closing gaps

bool is_finite(const double* x, std::ptrdiff_t n) {
  double sum = 0;
  for (std::ptrdiff_t k = 0; k < n; ++k) sum += 0 * x[k];
  return sum == 0;
}

// Steps as derivatives take them, whatever the data's options say; they come back at the end.
struct ExactSteps {
  simulation::Workspace& w;
  const dynStepOptions options;
  const dynStepReport report;
  const bool ledger;

  explicit ExactSteps(simulation::Workspace& workspace)
      : w(workspace), options(w.options), report(w.report), ledger(w.ledger.open) {
    simulation::solve_exactly(w);
  }
  ~ExactSteps() { w.options = options, w.report = report, w.ledger.open = ledger, w.ends_fast = true; }
};

struct Solver {
  const Model& m;
  Data<double>& d;
  Planner& p;
  const Problem& problem;
  const dynPlanOptions& o;
  Result result{};
  double cost = 0, penalty = 0;
  dynPlanReport& report = result.report;

  const double* input(Index k, const double* u) const { return u + std::ptrdiff_t(k) * p.inputs; }

  void set(const double* q, const double* v, const double* u) {
    std::copy_n(q, p.nq, d.q), std::copy_n(v, p.nv, d.v);
    const bool torques = p.input == DYN_PLAN_INPUT_TAU;
    std::copy_n(torques ? u : p.tau, p.nv, d.tau_applied), std::copy_n(torques ? p.ctrl : u, m.n.nu, d.ctrl);
    simulation::wake_all(m, d);
    std::fill_n(d.step->sleep.slow_time, d.step->sleep.count, 0.0);
    d.step->growth = 0, d.step->advancement_cache.square = 0;
  }
  // The steps from a knot to the next one, into d. Returns what integrator::step returns.
  Index advance(const double* q, const double* v, const double* u) {
    set(q, v, u);
    for (Index k = 0; k < o.steps; ++k) {
      d.step->growth = 0, d.step->advancement_cache.square = 0, ++report.steps;
      if (const Index failed = simulation::step_once(m, d)) return failed;
    }
    return 0;
  }

  dynPlanPoint point(Index k, const double* q, const double* v, const double* u, double* sum) const {
    dynPlanPoint at{};
    at.knot = k, at.inputs = k < p.knots ? p.inputs : 0, at.cost = sum;
    at.q = q + std::ptrdiff_t(k) * p.nq, at.v = v + std::ptrdiff_t(k) * p.nv, at.u = k < p.knots ? input(k, u) : nullptr;
    return at;
  }
  bool add(const dynPlanPoint& at) {
    if (add_cost(m, d, p, problem, at) == 0) return true;
    result.failure = Failure::Cancelled;
    return false;
  }

  // The motion by p.u, as the plan. Returns false where a step fails.
  bool simulate() {
    for (Index k = 0; k < p.knots; ++k) {
      double *const q = p.q + std::ptrdiff_t(k) * p.nq, *const v = p.v + std::ptrdiff_t(k) * p.nv;
      const Index failed = advance(q, v, input(k, p.u));
      if (failed) return fail_at(k);
      std::copy_n(d.q, p.nq, q + p.nq), std::copy_n(d.v, p.nv, v + p.nv);
    }
    std::fill_n(p.gaps, std::ptrdiff_t(p.knots) * p.n, 0.0);
    return true;
  }
  bool fail_at(Index k) {
    report.status = DYN_PLAN_STATUS_STEP_FAILED, report.knot = k;
    return false;
  }

  // The input moved inside its bounds by epsilon: where a range ends, central differences would give half the slope.
  const double* inner_input(Index k) const {
    const double* const u = input(k, p.u);
    for (Index a = 0; a < p.inputs; ++a)
      p.du[a] = p.upper[a] - p.lower[a] > 2 * o.epsilon ? std::clamp(u[a], p.lower[a] + o.epsilon, p.upper[a] - o.epsilon) : u[a];
    return p.du;
  }
  // A and B of the steps from knot k; and the gap, if it is not known.
  bool differentiate(Index k, bool gaps_known) {
    const double *const q = p.q + std::ptrdiff_t(k) * p.nq, *const v = p.v + std::ptrdiff_t(k) * p.nv;
    simulation::StepDerivatives& x = *d.derivatives;
    set(q, v, inner_input(k));
    for (Index s = 0; s < o.steps; ++s) {
      if (s > 0) std::copy_n(x.q_next, p.nq, d.q), std::copy_n(x.v_next, p.nv, d.v), d.step->growth = 0;
      dynDerivativeMethod used{};
      const simulation::Wanted wanted{true, p.input == DYN_PLAN_INPUT_TAU, p.input == DYN_PLAN_INPUT_CONTROL};
      const Index failed = simulation::differentiate_step(m, d, x, {o.method, o.epsilon, o.margin}, wanted, used);
      simulation::restore_state(m, d, x);
      if (failed) return fail_at(k);
      if (o.method == DYN_DERIVATIVE_METHOD_ANALYTIC && x.reason) {
        result.failure = Failure::Unsupported, result.reason = x.reason;
        return false;
      }
      ++(used == DYN_DERIVATIVE_METHOD_ANALYTIC ? report.analytic : report.differences);
      // the next step begins from these contact forces
      std::copy_n(x.modes.contacts, x.modes.count, d.step->contacts), d.step->contact_count = x.modes.count;
      chain(k, s, x.by);
    }
    if (!is_finite(p.A_of(k), std::ptrdiff_t(p.n) * p.ld) || !is_finite(p.B_of(k), std::ptrdiff_t(p.free_count) * p.ld))
      return fail_at(k);
    if (gaps_known) return true;
    double* const gap = p.gaps + std::ptrdiff_t(k) * p.n;
    difference(m, q + p.nq, static_cast<const double*>(x.q_next), gap);
    for (Index i = 0; i < p.nv; ++i) gap[p.nv + i] = x.v_next[i] - v[p.nv + i];
    return true;
  }
  // A = A_s A and B = A_s B + B_s, from the derivatives of step s.
  void chain(Index k, Index s, const double* by) const {
    const std::ptrdiff_t n = p.n, first = n + (p.input == DYN_PLAN_INPUT_TAU ? 0 : p.nv);
    const auto follow = [&](double* columns, Index count) {
      for (Index j = 0; j < count; ++j) {
        double* const column = columns + std::ptrdiff_t(p.ld) * j;
        std::fill_n(p.next_dx, n, 0.0);
        for (Index i = 0; i < n; ++i)
          if (column[i] != 0) solver::axpy(column[i], by + n * i, p.next_dx, p.n);
        std::copy_n(p.next_dx, n, column);
      }
    };
    double *const A = p.A_of(k), *const B = p.B_of(k);
    if (s > 0) follow(A, p.n), follow(B, p.free_count);
    for (Index j = 0; s == 0 && j < n; ++j) std::copy_n(by + n * j, n, A + std::ptrdiff_t(p.ld) * j);
    for (Index a = 0; a < p.free_count; ++a)
      for (Index i = 0; i < n; ++i) {
        double& b = B[i + std::ptrdiff_t(p.ld) * a];
        b = (s > 0 ? b : 0.0) + by[n * (first + p.free[a]) + i];
      }
  }

  // The linear-quadratic problem at the plan.
  bool linearise(bool gaps_known) {
    const std::ptrdiff_t N = p.knots, n = p.n, r = p.inputs;
    std::fill_n(p.l_x, (N + 1) * n, 0.0), std::fill_n(p.l_u, N * r, 0.0), std::fill_n(p.l_xx, (N + 1) * n * n, 0.0);
    std::fill_n(p.l_ux, N * r * n, 0.0), std::fill_n(p.l_uu, N * r * r, 0.0);
    cost = 0;
    for (Index k = 0; k <= p.knots; ++k) {
      if (k < p.knots && !differentiate(k, gaps_known)) return false;
      dynPlanPoint at = point(k, p.q, p.v, p.u, &cost);
      at.l_x = p.l_x + k * n, at.l_xx = p.l_xx + k * n * n;
      if (k < p.knots) at.l_u = p.l_u + k * r, at.l_ux = p.l_ux + k * r * n, at.l_uu = p.l_uu + k * r * r;
      if (!add(at)) return false;
    }
    if (std::isfinite(cost) && is_finite(p.l_x, (N + 1) * n) && is_finite(p.l_u, N * r) && is_finite(p.l_xx, (N + 1) * n * n) &&
        is_finite(p.l_ux, N * r * n) && is_finite(p.l_uu, N * r * r))
      return true;
    result.failure = Failure::NotFinite;
    return false;
  }

  // A motion along the solution, with gaps of 1 - length of theirs. Returns false where a step fails or the cost is no number.
  bool try_step(double length, double& sum) {
    sum = 0;
    std::copy_n(p.q, p.nq, p.trial_q), std::copy_n(p.v, p.nv, p.trial_v);
    for (Index k = 0; k < p.knots; ++k) {
      double *const q = p.trial_q + std::ptrdiff_t(k) * p.nq, *const v = p.trial_v + std::ptrdiff_t(k) * p.nv,
                    *const u = p.trial_u + std::ptrdiff_t(k) * p.inputs;
      follow_plan(k, length, q, v, u);
      if (!add(point(k, p.trial_q, p.trial_v, p.trial_u, &sum)) || !std::isfinite(sum)) return false;
      if (advance(q, v, u)) return false;
      const double *const gap = p.gaps + std::ptrdiff_t(k) * p.n, rest = 1 - length;
      for (Index i = 0; i < p.n; ++i) p.dx[i] = -rest * gap[i];
      integrate(m, static_cast<const double*>(d.q), static_cast<const double*>(p.dx), q + p.nq);
      for (Index i = 0; i < p.nv; ++i) v[p.nv + i] = d.v[i] + p.dx[p.nv + i];
    }
    return add(point(p.knots, p.trial_q, p.trial_v, p.trial_u, &sum)) && std::isfinite(sum);
  }
  // u = the plan's + length k + K (x (-) the plan's), within the bounds.
  void follow_plan(Index k, double length, const double* q, const double* v, double* u) const {
    difference(m, static_cast<const double*>(p.q + std::ptrdiff_t(k) * p.nq), q, p.dx);
    for (Index i = 0; i < p.nv; ++i) p.dx[p.nv + i] = v[i] - p.v[std::ptrdiff_t(k) * p.nv + i];
    const double *const step = p.k + std::ptrdiff_t(k) * p.inputs, *const K = p.K_of(k);
    for (Index a = 0; a < p.inputs; ++a) {
      double sum = p.u[std::ptrdiff_t(k) * p.inputs + a] + length * step[a];
      for (Index i = 0; i < p.n; ++i) sum += K[a + std::ptrdiff_t(p.inputs) * i] * p.dx[i];
      u[a] = std::clamp(sum, p.lower[a], p.upper[a]);
    }
  }
  void accept(double length, double sum) {
    std::swap(p.q, p.trial_q), std::swap(p.v, p.trial_v), std::swap(p.u, p.trial_u);
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(p.knots) * p.n; ++i) p.gaps[i] *= 1 - length;
    cost = sum, report.step_length = length;
  }

  double largest_gap() const {
    double most = 0;
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(p.knots) * p.n; ++i) most = std::max(most, std::abs(p.gaps[i]));
    return most;
  }
  // Cost and penalty on gaps: whether some step along the solution lowers their sum enough.
  bool search_line(const Expected& e) {
    double gaps = 0;
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(p.knots) * p.n; ++i) gaps += std::abs(p.gaps[i]);
    if (largest_gap() > o.gap_tolerance)
      penalty = std::max(penalty, (e.linear + 0.5 * std::max(e.quadratic, 0.0)) / ((1 - share_of_gaps) * gaps));
    const double slope = e.linear - penalty * gaps, merit = cost + penalty * gaps;
    double length = 1;
    for (int k = 0; k <= halvings; ++k, length *= 0.5) {
      double sum = 0;
      const bool made = try_step(length, sum);
      if (result.failure != Failure::None) return false;
      if (!made || !(sum + penalty * (1 - length) * gaps <= merit + sufficient * length * slope)) continue;
      accept(length, sum);
      return true;
    }
    return false;
  }

  // Returns false at the limit.
  bool raise() {
    report.regularisation = std::max(first_regularisation, report.regularisation * factor);
    if (report.regularisation <= o.max_regularisation) return true;
    report.regularisation = o.max_regularisation, report.status = DYN_PLAN_STATUS_REGULARISATION;
    return false;
  }
  void lower() {
    report.regularisation /= factor;
    if (report.regularisation < first_regularisation) report.regularisation = 0;
  }

  void iterate(bool gaps_known) {
    report.status = DYN_PLAN_STATUS_MAX_ITERATIONS;
    bool linear = false;
    while (report.iterations < o.max_iterations) {
      if (!linear && !linearise(gaps_known)) return;
      linear = gaps_known = true, ++report.iterations;
      if (!solve_backward(p, report.regularisation)) {
        if (!raise()) return;
        continue;
      }
      const Expected e = expected_change(p);
      report.expected_decrease = -(e.linear + 0.5 * e.quadratic);
      if (largest_gap() <= o.gap_tolerance && report.expected_decrease <= o.tolerance * (1 + std::abs(cost))) {
        if (report.regularisation <= still_converges) return void(report.status = DYN_PLAN_STATUS_CONVERGED);
        lower();
        continue;
      }
      if (!search_line(e)) {
        if (result.failure != Failure::None || !raise()) return;
        continue;
      }
      linear = false;
      if (report.step_length > long_step) lower();
      else if (report.step_length < short_step && !raise()) return;
    }
  }

  void begin() {
    p.free_count = 0;
    for (Index a = 0; a < p.inputs; ++a)
      if (p.lower[a] < p.upper[a]) p.free[p.free_count++] = a;
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(p.knots) * p.inputs; ++i)
      p.u[i] = std::clamp(p.u[i], p.lower[i % p.inputs], p.upper[i % p.inputs]);
    std::copy_n(d.q, p.nq, p.q), std::copy_n(d.v, p.nv, p.v);
    std::copy_n(d.tau_applied, p.nv, p.tau), std::copy_n(d.ctrl, m.n.nu, p.ctrl);
    std::copy_n(d.actuator_force, m.n.actuators, p.actuator_force);
    report.knot = -1, report.regularisation = o.regularisation;
  }
  void run() {
    const ExactSteps exact(*d.step);
    begin();
    if (p.has_states || simulate()) iterate(!p.has_states), p.has_states = true;
    std::copy_n(p.actuator_force, m.n.actuators, d.actuator_force);
    report.cost = cost, report.gap = largest_gap();
    for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(p.knots) * p.inputs; ++i)
      report.bound_violation = std::max({report.bound_violation, p.lower[i % p.inputs] - p.u[i], p.u[i] - p.upper[i % p.inputs]});
  }
};

}  // namespace

Result solve(const Model& m, Data<double>& d, Planner& p, const Problem& problem, const dynPlanOptions& options) {
  Solver solver{m, d, p, problem, options};
  solver.run();
  return solver.result;
}

}  // namespace dyn::plan
