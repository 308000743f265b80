// Planners: handles, what a caller's costs, bounds and options may be, and the solve.
#include "plan/planner.hpp"

#include <cmath>
#include <cstring>
#include <new>
#include <tuple>
#include <utility>

#include "algorithm/declarations.hpp"
#include "in_memory.hpp"
#include "reflection.hpp"
#include "rotation.hpp"
#include "simulation/workspace.hpp"

using namespace dyn;
using namespace dyn::capi;
using plan::Planner;

namespace {

constexpr int max_knots = 1 << 20;
constexpr std::size_t head = (sizeof(dynPlanner) + 63) / 64 * 64;

std::size_t bytes_of(const dynModel* model, int knots, dynPlanInput input) {
  return head + plan::planner_bytes(*model->m, knots, input, dyn_model_state_size(model));
}

// Checks of a problem: one cost after the other.
struct Reader {
  Call& call;
  const Planner& p;
  const StructArray<dynPlanCost>& costs;

  template <class... Args>
  bool refuse(dynStatus s, const char* format, Args... args) const {
    call.status = fail(s, format, call.function, args...);
    return false;
  }
  bool finite(Index cost, const char* name, const double* x, Index n) const {
    const Index k = x ? Index(finite_count(x, n)) : n;
    return k == n || refuse(DYN_ERROR_NONFINITE, "%s: %s[%d] of cost %d is %s: give a finite number", name, int(k), int(cost),
                            x[k] != x[k] ? "NaN" : "infinite");
  }
  bool weights(Index cost, const char* name, const double* x, Index n) const {
    if (!finite(cost, name, x, n)) return false;
    for (Index k = 0; x && k < n; ++k)
      if (x[k] < 0)
        return refuse(DYN_ERROR_ARGUMENT, "%s: %s[%d] of cost %d is %g: give zero or more", name, int(k), int(cost), x[k]);
    return true;
  }
  bool reference(Index cost, const dynPlanCost& c) const {
    if (!c.reference) return true;
    const Index size = plan::reference_size(call.m(), c.type, p.inputs), stride = c.reference_stride;
    if (stride != 0 && stride < size)
      return refuse(DYN_ERROR_ARGUMENT, "%s: reference_stride of cost %d is %d: give 0, or at least %d", int(cost), int(stride),
                    int(size));
    const Index count = stride == 0 ? 1 : p.knots + (c.type != DYN_PLAN_COST_TYPE_INPUT);
    const bool rotates = c.type == DYN_PLAN_COST_TYPE_FRAME_ORIENTATION || c.type == DYN_PLAN_COST_TYPE_FRAME_PLACEMENT;
    for (Index k = 0; k < count; ++k) {
      const double* const x = c.reference + std::ptrdiff_t(k) * stride;
      if (!finite(cost, "reference", x, size)) return false;
      if (c.type == DYN_PLAN_COST_TYPE_STATE && !call.nonzero(x)) return false;
      if (rotates && !is_rotation(load33(x)))
        return refuse(DYN_ERROR_ARGUMENT,
                      "%s: the reference of cost %d at knot %d is no rotation: its first nine numbers are the axes, "
                      "column by column",
                      int(cost), int(k));
    }
    return true;
  }
  bool good(Index k) const {
    if (costs.at(k)->struct_size != costs.first->struct_size)
      return refuse(DYN_ERROR_SIZE, "%s: struct_size of cost %d is %u, that of the first %u: call dyn_plan_cost_init for each",
                    int(k), costs.at(k)->struct_size, costs.first->struct_size);
    const Given<dynPlanCost> given(call.function, costs.at(k));
    if ((call.status = given.status)) return false;
    const dynPlanCost& c = *given;
    if ((call.status = check_value(c.type, call.function, "type of a cost"))) return false;
    if (plan::is_of_frame(c.type) && !call.frame(c.frame)) return false;
    return weights(k, "weight", &c.weight, 1) && weights(k, "terminal_weight", &c.terminal_weight, 1) &&
           weights(k, "knot_weights", c.knot_weights, p.knots + 1) &&
           weights(k, "weights", c.weights, plan::error_size(call.m(), c.type, p.inputs)) && reference(k, c);
  }
  bool all() const {
    if (costs.count < 0) return refuse(DYN_ERROR_ARGUMENT, "%s: cost_count is %d: it can't be negative", int(costs.count));
    if (costs.count == 0) return true;
    if (!call.required("costs", costs.first)) return false;
    if ((call.status = check_size(call.function, struct_name<dynPlanCost>(), costs.first->struct_size))) return false;
    for (Index k = 0; k < costs.count; ++k)
      if (!good(k)) return false;
    return true;
  }
  dynParts parts() const {
    dynParts needed = DYN_PART_STEP_DERIVATIVES;
    for (Index k = 0; k < costs.count; ++k)
      if (const dynPlanCostType type = costs[k].type; type == DYN_PLAN_COST_TYPE_COM || plan::is_of_frame(type))
        needed |= DYN_PART_COM;
    return needed;
  }
};

bool good_options(Call& call, const dynPlanOptions& o) {
  if ((call.status = check_value(o.method, call.function, "method"))) return false;
  for (const auto& [name, x] : {std::pair("max_iterations", o.max_iterations), std::pair("steps", o.steps)})
    if (x < 1) return call.status = fail(DYN_ERROR_ARGUMENT, "%s: %s is %d: give 1 or more", call.function, name, int(x)), false;
  for (const auto& [name, x] :
       {std::pair("tolerance", o.tolerance), std::pair("gap_tolerance", o.gap_tolerance),
        std::pair("regularisation", o.regularisation), std::pair("max_regularisation", o.max_regularisation),
        std::pair("epsilon", o.epsilon), std::pair("margin", o.margin)}) {
    if (!call.finite(name, &x, 1)) return false;
    if (x < 0)
      return call.status = fail(DYN_ERROR_ARGUMENT, "%s: %s is %g: it can't be negative", call.function, name, x), false;
  }
  if (!(o.epsilon > 0)) call.status = fail(DYN_ERROR_ARGUMENT, "%s: epsilon is 0: it must be positive", call.function);
  return call.status == DYN_OK;
}

bool good_bounds(Call& call, Planner& p, const dynPlanProblem& x) {
  for (Index k = 0; k < p.inputs; ++k) {
    const double lower = x.lower ? x.lower[k] : plan::default_bound(call.m(), p.input, k, false),
                 upper = x.upper ? x.upper[k] : plan::default_bound(call.m(), p.input, k, true);
    if (!(lower <= upper) || lower == HUGE_VAL || upper == -HUGE_VAL)
      return call.status = fail(DYN_ERROR_ARGUMENT, "%s: lower[%d] is %g and upper[%d] is %g: give lower <= upper", call.function,
                                int(k), lower, int(k), upper),
             false;
    p.lower[k] = lower, p.upper[k] = upper;
  }
  return true;
}

bool good_model(Call& call, const Planner& p) {
  if (call.m().id != p.model_id)
    call.status =
        fail(DYN_ERROR_MODEL, "%s: the planner belongs to another model: make one of the model you pass", call.function);
  else if (call.m().n.na > 0)
    call.status = fail(DYN_ERROR_UNSUPPORTED,
                       "%s: the model has actuators with activations, which are no part of a plan: build it without them",
                       call.function);
  return call.status == DYN_OK;
}

// The caller's cost, which may use the data.
struct Callback {
  Call& call;
  const dynPlanProblem& problem;
  const dynModel* model;
  dynData* data;
};
int call_back(void* context, const dynPlanPoint& point) {
  const Callback& x = *static_cast<const Callback*>(context);
  dynPlanPoint at = point;
  at.model = x.model, at.data = x.data;
  x.call.suspend();
  const int ends = x.problem.function(x.problem.context, &at);
  x.call.resume();
  return ends;
}

dynStatus explain(const char* function, const plan::Result& r) {
  switch (r.failure) {
    case plan::Failure::Cancelled: return fail(DYN_ERROR_CANCELLED, "%s: cancelled by the caller's function", function);
    case plan::Failure::Unsupported:
      return fail(DYN_ERROR_UNSUPPORTED, "%s: method ANALYTIC does not cover a step: %s; use AUTO or CENTRAL_DIFFERENCES",
                  function, r.reason);
    case plan::Failure::NotFinite:
      return fail(DYN_ERROR_NUMERIC, "%s: a cost or a derivative of it overflows or is not a number", function);
    default: return DYN_OK;
  }
}

void write(const Planner& p, const dynPlanOutput& out, const dynPlanReport& report) {
  const std::ptrdiff_t N = p.knots, n = p.n, r = p.inputs;
  copy_out(p.q, (N + 1) * p.nq, out.q), copy_out(p.v, (N + 1) * p.nv, out.v), copy_out(p.u, N * r, out.u);
  copy_out(p.K, N * r * n, out.K), copy_out(p.gaps, N * n, out.gaps);
  write_struct(report, out.report);
}

}  // namespace

dynStatus dyn::capi::check_planner(const char* function, const dynModel* model, int knots, dynPlanInput input) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_value(input, function, "input")) return s;
  if (knots < 1 || knots > max_knots)
    return fail(DYN_ERROR_LIMIT, "%s: knots is %d: give a number from 1 to %d", function, knots, max_knots);
  return DYN_OK;
}

template <>
dynPlanCost capi::defaults() {
  dynPlanCost c{};
  c.weight = c.terminal_weight = 1;
  return c;
}
template <>
dynPlanProblem capi::defaults() {
  return {};
}
template <>
dynPlanOptions capi::defaults() {
  dynPlanOptions o{};
  o.max_iterations = 100, o.steps = 1;
  o.tolerance = 1e-9, o.gap_tolerance = 1e-8, o.max_regularisation = 1e9;
  o.epsilon = o.margin = 1e-6;
  return o;
}
template <>
dynPlanOutput capi::defaults() {
  return {};
}

extern "C" {

size_t dyn_planner_size(const dynModel* model, int knots, dynPlanInput input) {
  return check_planner("dyn_planner_size", model, knots, input) == DYN_OK ? bytes_of(model, knots, input) : 0;
}

dynStatus dyn_planner_init(const dynModel* model, int knots, dynPlanInput input, void* memory, size_t size,
                           dynPlanner** planner) {
  constexpr const char* function = "dyn_planner_init";
  if (const dynStatus s = check_planner(function, model, knots, input)) return s;
  if (!memory || !planner)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, memory ? "planner" : "memory");
  if (reinterpret_cast<std::uintptr_t>(memory) % 64 != 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: memory is not aligned to 64 bytes", function);
  const std::size_t needed = bytes_of(model, knots, input);
  if (size < needed)
    return fail(DYN_ERROR_SIZE, "%s: memory has %zu bytes, needs %zu (dyn_planner_size)", function, size, needed);
  std::memset(memory, 0, needed);
  Planner* const p =
      plan::place_planner(*model->m, knots, input, dyn_model_state_size(model), static_cast<char*>(memory) + head);
  *planner = new (memory) dynPlanner{live_planner, p, nullptr};
  return DYN_OK;
}

void dyn_planner_free(dynPlanner* planner) {
  if (!planner || planner->magic != live_planner) return;
#if !DYN_NO_HOST
  if (planner->memory) return free_heap(planner);
#endif
  planner->magic = freed;
}

dynStatus dyn_planner_set_guess(dynPlanner* planner, const dynModel* model, const double* q, const double* v, const double* u) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_planner_set_guess";
  if (const dynStatus s = check(planner)) return s;
  if (const dynStatus s = check(model)) return s;
  Planner& p = *planner->p;
  const Model& m = *model->m;
  if (m.id != p.model_id)
    return fail(DYN_ERROR_MODEL, "%s: the planner belongs to another model: pass the model that it was made of", function);
  const std::ptrdiff_t nq = (p.knots + 1) * std::ptrdiff_t(p.nq), nv = (p.knots + 1) * std::ptrdiff_t(p.nv),
                       nu = p.knots * std::ptrdiff_t(p.inputs);
  if (!q != !v && nv > 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: give both q and v, or neither", function, q ? "v" : "q");
  for (const auto& [name, x, n] : {std::tuple("q", q, nq), std::tuple("v", v, nv), std::tuple("u", u, nu)})
    if (const std::ptrdiff_t k = x ? finite_count(x, n) : n; k < n)
      return fail(DYN_ERROR_NONFINITE, "%s: %s[%td] is %s: give a finite number", function, name, k,
                  x[k] != x[k] ? "NaN" : "infinite");
  for (Index k = 0; q && k <= p.knots; ++k)
    if (const Index j = zero_norm_joint(m, q + std::ptrdiff_t(k) * p.nq))
      return fail(DYN_ERROR_QUATERNION, "%s: the quaternion of joint '%s' in q of knot %d is zero: give one of norm 1", function,
                  m.string(m.joints()[j].name), int(k));
  if (q) copy_out(q, nq, p.q), copy_out(v, nv, p.v);
  if (u) copy_out(u, nu, p.u);
  else std::fill_n(p.u, nu, 0.0);
  p.has_states = q != nullptr;
  return DYN_OK;
}

dynStatus dyn_planner_shift(dynPlanner* planner, int knots) {
  if (const dynStatus s = check(planner)) return s;
  if (knots < 0) return fail(DYN_ERROR_ARGUMENT, "dyn_planner_shift: knots is %d: it can't be negative", knots);
  plan::shift(*planner->p, Index(knots));
  return DYN_OK;
}

dynStatus dyn_planner_solve(dynPlanner* planner, const dynModel* model, dynData* data, const dynPlanProblem* given_problem,
                            const dynPlanOptions* given_options, const dynPlanOutput* given_out) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_planner_solve";
  if (const dynStatus s = check(planner)) return s;
  Planner& p = *planner->p;
  const Given<dynPlanProblem> problem(function, given_problem);
  const Given<dynPlanOptions> options(function, given_options);
  const Given<dynPlanOutput> out(function, given_out);
  const StructArray<dynPlanCost> costs{problem->costs, problem->cost_count, capi::defaults<dynPlanCost>};
  dynParts parts = 0;
  {
    Call call(model, data, DYN_PART_STEP_DERIVATIVES, function);
    if (!call || !call.required("problem", given_problem)) return call.status;
    for (const dynStatus s : {problem.status, options.status, out.status})
      if (s) return s;
    if (out->report)
      if (const dynStatus s = check_struct(function, "report", out->report)) return s;
    const Reader reader{call, p, costs};
    if (!good_model(call, p) || !good_options(call, *options) || !reader.all() || !good_bounds(call, p, *problem))
      return call.status;
    parts = reader.parts();
  }
  const std::size_t state_size = dyn_model_state_size(model);
  if (const dynStatus s = dyn_data_save_state(model, data, p.state, state_size)) return s;
  plan::Result result;
  {
    Call call(model, data, parts, function);
    if (!call) return call.status;
    Callback callback{call, *problem, model, data};
    call.have_effects_of(true), call.begin_step();
    result = plan::solve(call.m(), call.d(), p, {costs, problem->function ? call_back : nullptr, &callback}, *options);
    call.drop_results(), call.end_step();
  }
  if (const dynStatus s = dyn_data_restore_state(model, data, p.state, state_size)) return s;
  if (const dynStatus s = explain(function, result)) return s;
  write(p, *out, result.report);
  return DYN_OK;
}

}  // extern "C"
