// Derivatives of constrained dynamics and of impulses: thin wrappers.
#include "constraint.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Which of the outputs are wanted, where they are in the data, and whether they are by rows.
dynStatus write(Call& call, const dynConstraintDerivatives& out, Index rows, bool by_tau) {
  const Model& m = call.m();
  Data<double>& d = call.d();
  const std::ptrdiff_t nv = m.n.nv, ld = (nv + 7) / 8 * 8, size = ld * m.n.constraint_rows;
  const double *lambda_dq = d.row_by_dof + size, *lambda_dv = lambda_dq + size, *lambda_dtau = lambda_dv + size;
  bool good = finite_count(d.constraint_ddq, Index(nv)) == nv && finite_count(d.lambda, rows) == rows;
  for (const double* x : {static_cast<const double*>(d.ddq_dq), static_cast<const double*>(d.ddq_dv), static_cast<const double*>(by_tau ? d.constrained_Minv : d.ddq_dv)})
    good = good && finite_count(x, Index(nv * nv)) == nv * nv;
  for (const double* x : {lambda_dq, lambda_dv, by_tau ? lambda_dtau : lambda_dv})
    for (Index r = 0; r < rows; ++r) good = good && finite_count(x + ld * r, Index(nv)) == nv;
  if (!good) {
    call.drop_results();
    call.take_back();
    return fail(DYN_ERROR_NUMERIC, "%s: a derivative overflows: the inputs are too large for double precision", call.function);
  }
  copy_out(d.ddq_dq, nv * nv, out.ddq_dq), copy_out(d.ddq_dv, nv * nv, out.ddq_dv);
  if (by_tau) copy_out(d.constrained_Minv, nv * nv, out.ddq_dtau);
  auto transposed = [&](const double* x, double* to) {
    if (to) transpose(x, ld, nv, rows, 1.0, to, rows);
  };
  transposed(lambda_dq, out.lambda_dq), transposed(lambda_dv, out.lambda_dv);
  if (by_tau) transposed(lambda_dtau, out.lambda_dtau);
  return DYN_OK;
}

bool good_outputs(Call& call, const dynConstraintDerivatives* out) {
  if (!call.required("out", out)) return false;
  call.status = sized(call.function, "dynConstraintDerivatives", "a setting of struct_size to sizeof(dynConstraintDerivatives)", out);
  return bool(call);
}

void drop_written(Data<double>& d) {
  for (Stage s : {Stage::ConstrainedDdq, Stage::Ddq, Stage::ForwardDerivatives, Stage::Tau, Stage::InverseDerivatives, Stage::Minv, Stage::Mass, Stage::Factor}) d.drop(s);
}

}  // namespace

extern "C" {

dynStatus dyn_constrained_dynamics_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* tau, const double* fext,
                                               const dynConstraintOptions* options, const dynConstraintDerivatives* out, dynConstraintResult* result) {
  Call call(model, data, DYN_PART_CONSTRAINT_DERIVATIVES, "dyn_constrained_dynamics_derivatives");
  ProximalOptions given;
  if (!call || !good_outputs(call, out) || !good_result(call, result) || !read_options(call, options, given) || !check_fext(call, fext) ||
      !call.inputs(q, v, nullptr, tau))
    return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  drop_written(d);
  dynConstraintResult found{};
  const Index failed = constrained_dynamics_derivatives(m, d, d.v, d.tau_applied, fext, given, found);
  if (failed) return singular(call, failed, Stage::ConstrainedDdq);
  if (const dynStatus s = write(call, *out, found.rows, true)) return s;
  d.drop(Stage::Mass), d.drop(Stage::Factor), d.drop(Stage::Minv);  // not checked
  copy_result(found, result);
  return DYN_OK;
}

dynStatus dyn_constraint_impulse_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const dynConstraintOptions* options,
                                             const dynConstraintDerivatives* out, dynConstraintResult* result) {
  Call call(model, data, DYN_PART_CONSTRAINT_DERIVATIVES, "dyn_constraint_impulse_derivatives");
  ProximalOptions given;
  if (!call || !good_outputs(call, out) || !good_result(call, result) || !read_options(call, options, given) || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  const Model& m = call.m();
  Data<double>& d = call.d();
  drop_written(d);
  dynConstraintResult found{};
  if (const Index failed = constraint_impulse_derivatives(m, d, d.v, given, found)) return singular(call, failed, Stage::ConstrainedDdq);
  if (const dynStatus s = write(call, *out, found.rows, false)) return s;
  d.drop(Stage::Mass), d.drop(Stage::Factor), d.drop(Stage::Minv);
  copy_result(found, result);
  return DYN_OK;
}

}  // extern "C"
