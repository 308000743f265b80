// Derivatives of constrained dynamics and of impulses: thin wrappers.
#include <span>

#include "constraint.hpp"
#include "algorithm/constrained/kkt_inverse.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Copies the results to the requested outputs, if all are finite.
dynStatus write(Call& call, const dynConstraintDerivatives& out, Index rows, bool by_tau) {
  const Model& m = call.m();
  Data<double>& d = call.d();
  const std::ptrdiff_t nv = m.n.nv;
  const KktSystem<double> K = kkt_system(m, d, rows);
  const struct { const double* x; double *ddq, *lambda; } results[] = {
      {K.by_q, out.ddq_dq, out.lambda_dq}, {K.by_v, out.ddq_dv, out.lambda_dv}, {K.inverse, out.ddq_dtau, out.lambda_dtau}};
  const auto wanted = std::span(results).first(by_tau ? 3 : 2);
  bool good = finite_count(d.constraint_ddq, Index(nv)) == nv && finite_count(d.lambda, rows) == rows;
  for (const auto& r : wanted)
    for (Index k = 0; k < nv; ++k) good = good && finite_count(r.x + K.ld * k, Index(nv) + rows) == nv + rows;
  if (!good) {
    call.drop_results();
    call.rollback();
    return fail(DYN_ERROR_NUMERIC, "%s: a derivative overflows: the inputs are too large for double precision", call.function);
  }
  for (const auto& r : wanted)
    for (Index k = 0; k < nv; ++k) {
      if (r.ddq) copy_out(r.x + K.ld * k, Index(nv), r.ddq + nv * k);
      if (r.lambda) copy_out(r.x + K.ld * k + nv, rows, r.lambda + std::ptrdiff_t(rows) * k);
    }
  return DYN_OK;
}

void drop_written(Data<double>& d) {
  for (Stage s : {Stage::ConstrainedDdq, Stage::Ddq, Stage::ForwardDerivatives, Stage::Tau, Stage::InverseDerivatives,
                  Stage::Minv, Stage::Mass, Stage::Factor})
    d.invalidate(s);
}

}  // namespace

template <>
dynConstraintDerivatives capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_constrained_dynamics_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                               const double* tau, const double* fext, const dynConstraintOptions* options,
                                               const dynConstraintDerivatives* output) {
  Call call(model, data, DYN_PART_CONSTRAINT_DERIVATIVES, "dyn_constrained_dynamics_derivatives");
  const Given<dynConstraintDerivatives> out(call.function, output);
  ProximalOptions given;
  if (!call || !call.required("out", output) || !good_output(call, out) || !read_options(call, options, given) ||
      !check_fext(call, fext) || !call.inputs(q, v, nullptr, tau))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  drop_written(d);
  dynConstraintResult found{};
  const Index failed = constrained_dynamics_derivatives(m, d, d.v, d.tau_applied, fext, given, found);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (const dynStatus s = write(call, *out, found.rows, true)) return s;
  d.invalidate(Stage::Mass), d.invalidate(Stage::Factor), d.invalidate(Stage::Minv);  // not checked
  write_struct(found, out->result);
  return DYN_OK;
}

dynStatus dyn_constraint_impulse_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                             const dynConstraintOptions* options, const dynConstraintDerivatives* output) {
  Call call(model, data, DYN_PART_CONSTRAINT_DERIVATIVES, "dyn_constraint_impulse_derivatives");
  const Given<dynConstraintDerivatives> out(call.function, output);
  ProximalOptions given;
  if (!call || !call.required("out", output) || !good_output(call, out) || !read_options(call, options, given) ||
      !call.inputs(q, v, nullptr, nullptr))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  drop_written(d);
  dynConstraintResult found{};
  if (const Index failed = constraint_impulse_derivatives(m, d, d.v, given, found))
    return singular(call, failed, Stage::ConstrainedDdq);
  if (const dynStatus s = write(call, *out, found.rows, false)) return s;
  d.invalidate(Stage::Mass), d.invalidate(Stage::Factor), d.invalidate(Stage::Minv);
  write_struct(found, out->result);
  return DYN_OK;
}

}  // extern "C"
