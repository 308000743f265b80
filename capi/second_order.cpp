// Second derivatives of inverse dynamics: thin wrappers.
#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

template <>
dynSecondOrderDerivatives capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_rnea_second_order_product(const dynModel* model, dynData* data, const double* q, const double* v, const double* a,
                                        const double* fext, const double* lambda, const dynSecondOrderDerivatives* out) {
  Call call(model, data, DYN_PART_SECOND_ORDER, "dyn_rnea_second_order_product");
  const Given<dynSecondOrderDerivatives> wanted(call.function, out);
  if (!call || (call.status = wanted.status) || !call.required("lambda", lambda, call.m().n.nv) ||
      !call.finite("lambda", lambda, call.m().n.nv) || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr))
    return call.status;
  const std::ptrdiff_t squares = std::ptrdiff_t(call.m().n.nv) * call.m().n.nv;
  Data<double>& d = call.d();
  second_order_columns(call.m(), d, d.v, d.a, fext);
  second_order_product(call.m(), d, lambda, {d.lambda_d2tau_dqdq, d.lambda_d2tau_dvdv, d.lambda_d2tau_dqdv, d.lambda_d2tau_dadq});
  d.mark_fresh(Stage::SecondOrder);
  if (!no_overflow(call, 0)) return call.status;
  const struct {
    const double* from;
    double* to;
    const char* name;
  } fields[] = {{d.lambda_d2tau_dqdq, wanted->dqdq, "lambda_d2tau_dqdq"},
                {d.lambda_d2tau_dvdv, wanted->dvdv, "lambda_d2tau_dvdv"},
                {d.lambda_d2tau_dqdv, wanted->dqdv, "lambda_d2tau_dqdv"},
                {d.lambda_d2tau_dadq, wanted->dadq, "lambda_d2tau_dadq"}};
  for (const auto& f : fields)
    if (!call.numeric(f.from, squares, f.name, Stage::SecondOrder)) return call.status;
  for (const auto& f : fields) copy_out(f.from, squares, f.to);
  return DYN_OK;
}

dynStatus dyn_rnea_second_order_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                            const double* a, const double* fext, const dynSecondOrderDerivatives* out) {
  Call call(model, data, DYN_PART_SECOND_ORDER, "dyn_rnea_second_order_derivatives");
  const Given<dynSecondOrderDerivatives> wanted(call.function, out);
  if (!call || (call.status = wanted.status) || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr)) return call.status;
  Data<double>& d = call.d();
  second_order_columns(call.m(), d, d.v, d.a, fext);
  if (!no_overflow(call, 0)) return call.status;
  if (!(second_order_size(call.m(), d) < 1e70)) {
    call.drop_results();
    call.rollback();
    return fail(DYN_ERROR_NUMERIC, "%s: second derivatives overflow: the inputs are too large for double precision",
                call.function);
  }
  second_order_derivatives(call.m(), d, {wanted->dqdq, wanted->dvdv, wanted->dqdv, wanted->dadq});
  return DYN_OK;
}

}  // extern "C"
