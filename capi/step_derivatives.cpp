// Derivatives of a step: checks, the method, and the outputs.
#include "simulation/step_derivatives.hpp"

#include "collision.hpp"
#include "reflection.hpp"
#include "steps.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

bool good_options(Call& call, const dynStepDerivativeOptions& options) {
  if ((call.status = check_value(options.method, call.function, "method"))) return false;
  if (!call.finite("epsilon", &options.epsilon, 1) || !call.finite("margin", &options.margin, 1)) return false;
  if (!(options.epsilon > 0))
    call.status = fail(DYN_ERROR_ARGUMENT, "%s: epsilon is %g: it must be positive", call.function, options.epsilon);
  else if (!(options.margin >= 0))
    call.status = fail(DYN_ERROR_ARGUMENT, "%s: margin is %g: it can't be negative", call.function, options.margin);
  return call.status == DYN_OK;
}

// Parameters: types and indices in range. numbers: of all of them.
bool good_parameters(Call& call, const dynStepDerivatives& out, Index& numbers) {
  const Model& m = call.m();
  numbers = 0;
  if (out.parameter_count < 0)
    call.status =
        fail(DYN_ERROR_ARGUMENT, "%s: parameter_count is %d: it can't be negative", call.function, int(out.parameter_count));
  if (!call.required("parameters", out.parameters, out.parameter_count)) return false;
  for (Index k = 0; k < out.parameter_count; ++k) {
    const dynStepParameterType type = out.parameters[k];
    if ((call.status = check_value(type, call.function, "parameters"))) return false;
    const Index index = out.parameter_index ? out.parameter_index[k] : 0;
    const auto within = [&](const char* what, Index first, Index end) {
      if (index < first || index >= end)
        call.status = fail(DYN_ERROR_ARGUMENT, "%s: parameter_index[%d] is %d: %s from %d to %d", call.function, int(k),
                           int(index), what, int(first), int(end) - 1);
      return call.status == DYN_OK;
    };
    switch (type) {
      case DYN_STEP_PARAMETER_TYPE_INERTIA: within("joints are", 1, m.n.joints); break;
      case DYN_STEP_PARAMETER_TYPE_ARMATURE:
      case DYN_STEP_PARAMETER_TYPE_DAMPING:
      case DYN_STEP_PARAMETER_TYPE_FRICTION: within("degrees of freedom are", 0, m.n.nv); break;
      case DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION:
      case DYN_STEP_PARAMETER_TYPE_RESTITUTION: geom_of_shape(call, index, 0); break;
      default: within("it is", 0, 1);
    }
    if (!call) return false;
    numbers += simulation::parameter_size(type);
  }
  return true;
}

// Vectors of a product, of n numbers, and a place for their results.
struct Vectors {
  const char *count_name, *name, *result_name;
  std::int32_t count;
  const double *from, *result;
};
bool good_vectors(Call& call, const Vectors& x, std::ptrdiff_t n) {
  if (x.count < 0)
    call.status = fail(DYN_ERROR_ARGUMENT, "%s: %s is %d: it can't be negative", call.function, x.count_name, int(x.count));
  return x.count == 0 || (call.required(x.name, x.from, n * x.count) && call.required(x.result_name, x.result, n * x.count) &&
                          call.finite(x.name, x.from, Index(n * x.count)));
}

bool good_output(Call& call, const dynStepDerivatives& out, Index& numbers) {
  if ((call.status = check_capacity(call.function, out.capacity))) return false;
  if (out.report && (call.status = check_struct(call.function, "report", out.report))) return false;
  if (!good_parameters(call, out, numbers)) return false;
  const std::ptrdiff_t nv = call.m().n.nv, inputs = simulation::derivative_count(call.m()) + numbers;
  return good_vectors(call, {"tangent_count", "tangents", "jvp", out.tangent_count, out.tangents, out.jvp}, inputs) &&
         good_vectors(call, {"cotangent_count", "cotangents", "vjp", out.cotangent_count, out.cotangents, out.vjp}, 2 * nv);
}

void write(const Model& m, const simulation::StepDerivatives& x, const dynStepDerivatives& out, dynStepDerivativeReport& report) {
  const std::ptrdiff_t nq = m.n.nq, nv = m.n.nv, nu = m.n.nu;
  copy_out(x.by, 4 * nv * nv, out.A), copy_out(x.by + 4 * nv * nv, 2 * nv * nv, out.B);
  copy_out(x.by + 6 * nv * nv, 2 * nv * nu, out.B_control);
  copy_out(x.q_next, nq, out.q), copy_out(x.v_next, nv, out.v);
  report.contacts = std::int32_t(x.modes.count), report.degenerate = std::int32_t(x.degenerate),
  report.steps = std::int32_t(x.steps);
  report.reason = x.reason ? x.reason : "";
  for (Index k = 0; k < x.modes.count; ++k) {
    report.active += x.modes.modes[k] != DYN_CONTACT_MODE_OPEN, report.degenerate += x.modes.degenerate[k];
    if (k >= out.capacity) continue;
    if (out.contacts) out.contacts[k] = x.modes.contacts[k];
    if (out.modes) out.modes[k] = x.modes.modes[k];
    if (out.degenerate) out.degenerate[k] = x.modes.degenerate[k];
  }
  write_struct(report, out.report);
}

}  // namespace

template <>
dynStepDerivativeOptions capi::defaults() {
  dynStepDerivativeOptions o{};
  o.method = DYN_DERIVATIVE_METHOD_AUTO, o.epsilon = o.margin = 1e-6;
  return o;
}
template <>
dynStepDerivatives capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_step_derivatives(const dynModel* model, dynData* data, const dynStepDerivativeOptions* given,
                               const dynStepDerivatives* output) {
  Call call(model, data, DYN_PART_STEP_DERIVATIVES, "dyn_step_derivatives");
  if (!call || !call.required("out", output)) return call.status;
  const Given<dynStepDerivativeOptions> options(call.function, given);
  if (options.status) return options.status;
  const Given<dynStepDerivatives> out(call.function, output);
  if (out.status) return out.status;
  Index numbers;
  if (!good_options(call, *options) || !good_output(call, *out, numbers)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  simulation::StepDerivatives& x = *d.derivatives;
  dynStepDerivativeReport report{};
  const simulation::StepProducts products{out->parameters, out->parameter_index, out->parameter_count, numbers, out->P,
                                          out->tangents, out->jvp, out->tangent_count, out->cotangents, out->vjp,
                                          out->cotangent_count};
  call.have_effects_of(true), call.begin_step();
  const Index failed =
      simulation::differentiate_step(m, d, x, {options->method, options->epsilon, options->margin},
                                     {out->A != nullptr, out->B != nullptr, out->B_control != nullptr, products}, report.method);
  const bool refused = options->method == DYN_DERIVATIVE_METHOD_ANALYTIC && x.reason;
  dynStatus status = failed ? explain_step(m, d, failed, call.function, d.time[0]) : DYN_OK;
  if (!failed && refused)
    status = fail(DYN_ERROR_UNSUPPORTED, "%s: method ANALYTIC does not cover this step: %s; use AUTO or CENTRAL_DIFFERENCES",
                  call.function, x.reason);
  else if (!failed && x.refused)
    status = fail(DYN_ERROR_UNSUPPORTED,
                  "%s: a parameter of this type, or whose effect the model lacks, has no central differences%s%s", call.function,
                  x.reason ? ", and ANALYTIC does not cover this step: " : "", x.reason ? x.reason : "");
  const std::ptrdiff_t rows = 2 * std::ptrdiff_t(m.n.nv), inputs = simulation::derivative_count(m) + numbers;
  const auto overflows = [](const double* from, std::ptrdiff_t n) { return finite_count(from, n) < n; };
  if (!status && (overflows(x.by, out->A ? rows * rows : 0) || overflows(out->P, out->P ? rows * numbers : 0) ||
                  overflows(out->jvp, rows * out->tangent_count) ||
                  overflows(out->vjp, inputs * out->cotangent_count)))
    status = fail(DYN_ERROR_NUMERIC, "%s: a derivative overflows: the inputs are too large for double precision", call.function);
  simulation::restore_state(m, d, x);
  call.end_step(), simulation::invalidate_sleep(d);
  if (status) return status;
  write(m, x, *out, report);
  return DYN_OK;
}

}  // extern "C"
