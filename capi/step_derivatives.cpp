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

bool good_output(Call& call, const dynStepDerivatives& out) {
  if ((call.status = check_capacity(call.function, out.capacity))) return false;
  if (out.report) call.status = check_struct(call.function, "report", out.report);
  return call.status == DYN_OK;
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
  if (!good_options(call, *options) || !good_output(call, *out)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  simulation::StepDerivatives& x = *d.derivatives;
  dynStepDerivativeReport report{};
  call.have_effects_of(true), call.begin_step();
  const Index failed =
      simulation::differentiate_step(m, d, x, {options->method, options->epsilon, options->margin},
                                     {out->A != nullptr, out->B != nullptr, out->B_control != nullptr}, report.method);
  const bool refused = options->method == DYN_DERIVATIVE_METHOD_ANALYTIC && x.reason;
  dynStatus status = failed ? explain_step(m, d, failed, call.function, d.time[0]) : DYN_OK;
  if (!failed && refused)
    status = fail(DYN_ERROR_UNSUPPORTED, "%s: method ANALYTIC does not cover this step: %s; use AUTO or CENTRAL_DIFFERENCES",
                  call.function, x.reason);
  const std::ptrdiff_t rows = 2 * std::ptrdiff_t(m.n.nv);
  if (!status && (finite_count(x.by, out->A ? rows * rows : 0) < (out->A ? rows * rows : 0)))
    status = fail(DYN_ERROR_NUMERIC, "%s: a derivative overflows: the inputs are too large for double precision", call.function);
  simulation::restore_state(m, d, x);
  call.end_step(), simulation::invalidate_sleep(d);
  if (status) return status;
  write(m, x, *out, report);
  return DYN_OK;
}

}  // extern "C"
