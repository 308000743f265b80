// Memory of planners.
#include "plan/planner.hpp"

#include "algorithm/declarations.hpp"

namespace dyn::plan {

namespace {

// Calls f(array, numbers) for each.
template <class F>
void for_each_array(const Model& m, Planner& p, std::size_t state_bytes, F&& f) {
  const std::ptrdiff_t N = p.knots, n = p.n, r = p.inputs, ld = p.ld, rd = p.input_ld;
  f(p.q, (N + 1) * p.nq), f(p.v, (N + 1) * p.nv), f(p.u, N * r), f(p.gaps, N * n);
  f(p.trial_q, (N + 1) * p.nq), f(p.trial_v, (N + 1) * p.nv), f(p.trial_u, N * r);
  f(p.lower, r), f(p.upper, r), f(p.free, r);
  f(p.A, N * n * ld), f(p.B, N * r * ld);
  f(p.l_x, (N + 1) * n), f(p.l_u, N * r), f(p.l_xx, (N + 1) * n * n), f(p.l_ux, N * r * n), f(p.l_uu, N * r * r);
  f(p.k, N * r), f(p.K, N * r * n);
  f(p.V_x, ld), f(p.V_xx, n * ld), f(p.VA, n * ld), f(p.VB, r * ld), f(p.Q_x, n), f(p.Q_u, rd), f(p.Q_xx, n * n);
  f(p.Q_ux, n * rd), f(p.Q_uu, r * rd), f(p.gain, n * rd), f(p.product, std::max(n, r) * rd), f(p.step, rd);
  f(p.factor, r * r), f(p.box_lower, r), f(p.box_upper, r), f(p.dual, r), f(p.work, r), f(p.box_state, 2 * r);
  f(p.dx, ld), f(p.next_dx, ld), f(p.du, r);
  f(p.error, std::max(std::ptrdiff_t(6), std::max(n, r))), f(p.J, 6 * std::ptrdiff_t(p.nv));
  f(p.tau, p.nv), f(p.ctrl, m.n.nu), f(p.actuator_force, m.n.actuators), f(p.state, std::ptrdiff_t(state_bytes));
}

std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

Planner sizes(const Model& m, Index knots, dynPlanInput input) {
  Planner p{};
  p.model_id = m.id, p.knots = knots, p.nq = m.n.nq, p.nv = m.n.nv, p.n = 2 * m.n.nv, p.input = input;
  p.inputs = input == DYN_PLAN_INPUT_TAU ? m.n.nv : m.n.nu;
  p.ld = solver::padded(p.n), p.input_ld = solver::padded(p.inputs);
  return p;
}

}  // namespace

std::size_t planner_bytes(const Model& m, Index knots, dynPlanInput input, std::size_t state_bytes) {
  Planner p = sizes(m, knots, input);
  std::size_t bytes = rounded(sizeof p);
  for_each_array(m, p, state_bytes, [&](auto* array, std::ptrdiff_t n) { bytes += rounded(std::size_t(n) * sizeof *array); });
  return bytes;
}

Planner* place_planner(const Model& m, Index knots, dynPlanInput input, std::size_t state_bytes, void* memory) {
  Planner& p = *new (memory) Planner(sizes(m, knots, input));
  char* at = static_cast<char*>(memory) + rounded(sizeof p);
  for_each_array(m, p, state_bytes, [&](auto*& array, std::ptrdiff_t n) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(at);
    at += rounded(std::size_t(n) * sizeof *array);
  });
  return &p;
}

void shift(Planner& p, Index knots) {
  const auto move = [&](double* x, Index columns, Index size) {
    const Index by = std::min(knots, columns - 1);
    std::copy(x + std::ptrdiff_t(by) * size, x + std::ptrdiff_t(columns) * size, x);
    for (Index k = columns - by; k < columns; ++k)
      std::copy_n(x + std::ptrdiff_t(k - 1) * size, size, x + std::ptrdiff_t(k) * size);
  };
  move(p.q, p.knots + 1, p.nq), move(p.v, p.knots + 1, p.nv), move(p.u, p.knots, p.inputs);
}

double default_bound(const Model& m, dynPlanInput input, Index k, bool upper) {
  if (input == DYN_PLAN_INPUT_CONTROL) {
    for (Index a = 0; a < m.n.actuators; ++a) {
      const dynActuator& x = m.actuators()[a].spec;
      if (k < x.idx_u || k >= x.idx_u + x.controls) continue;
      return (k == x.idx_u ? x.control_range : k == x.idx_u + 1 ? x.velocity_range : x.feedforward_range)[upper];
    }
  }
  for (Index j = 1; j < m.n.joints; ++j) {
    const JointRecord& joint = m.joints()[j];
    if (joint.type == DYN_JOINT_TYPE_FREE_FLYER && k >= joint.idx_v && k < joint.idx_v + joint.nv) return 0;
  }
  return upper ? m.effort_limit()[k] : -m.effort_limit()[k];
}

}  // namespace dyn::plan
