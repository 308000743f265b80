// Derivatives of the dynamics: thin wrappers.
#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

template <>
dynAbaDerivatives capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_rnea_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* a,
                               const double* fext, double* dtau_dq, double* dtau_dv) {
  Call call(model, data, DYN_PART_INVERSE_DERIVATIVES, "dyn_rnea_derivatives");
  if (!call || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr)) return call.status;
  const std::ptrdiff_t nv = call.m().n.nv;
  Data<double>& d = call.d();
  d.invalidate(Stage::Tau), d.invalidate(Stage::InverseDerivatives);  // being written
  rnea_derivatives(call.m(), d, d.v, d.a, fext);
  const bool small = small_columns(call);
  if (!finite_mass(call) || !call.numeric(d.tau, Index(nv), "tau", Stage::Tau) ||
      !numeric_pairs(call, d.dtau_dq, "dtau_dq", Stage::InverseDerivatives, small) ||
      !numeric_pairs(call, d.dtau_dv, "dtau_dv", Stage::InverseDerivatives, small))
    return call.status;
  d.mark_fresh(Stage::Tau), d.mark_fresh(Stage::InverseDerivatives);
  copy_out(d.dtau_dq, nv * nv, dtau_dq), copy_out(d.dtau_dv, nv * nv, dtau_dv);
  return DYN_OK;
}

dynStatus dyn_aba_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* tau,
                              const double* fext, const dynAbaDerivatives* out) {
  Call call(model, data, DYN_PART_FORWARD_DERIVATIVES, "dyn_aba_derivatives");
  const Given<dynAbaDerivatives> wanted(call.function, out);
  if (!call || (call.status = wanted.status) || !check_fext(call, fext) || !call.inputs(q, v, nullptr, tau)) return call.status;
  const std::ptrdiff_t nv = call.m().n.nv;
  Data<double>& d = call.d();
  d.invalidate(Stage::Ddq), d.invalidate(Stage::ForwardDerivatives), d.invalidate(Stage::Minv);    // being written
  d.invalidate(Stage::Tau), d.invalidate(Stage::InverseDerivatives);  // at another a than the held one
  const Index failed = aba_derivatives(call.m(), d, d.v, d.tau_applied, fext);
  if (failed) return singular(call, failed, Stage::ForwardDerivatives);
  if (!finite_mass(call) || !call.numeric(d.ddq, Index(nv), "ddq", Stage::Ddq) ||
      !call.numeric(d.Minv, nv * nv, "Minv", Stage::Minv) ||
      !call.numeric(d.ddq_dq, nv * nv, "ddq_dq", Stage::ForwardDerivatives) ||
      !call.numeric(d.ddq_dv, nv * nv, "ddq_dv", Stage::ForwardDerivatives))
    return call.status;
  d.mark_fresh(Stage::Ddq), d.mark_fresh(Stage::ForwardDerivatives);
  copy_out(d.ddq_dq, nv * nv, wanted->ddq_dq), copy_out(d.ddq_dv, nv * nv, wanted->ddq_dv),
      copy_out(d.Minv, nv * nv, wanted->ddq_dtau);
  return DYN_OK;
}

static dynStatus at_rest(const dynModel* model, dynData* data, const double* q, const double* fext, double* Data<double>::* field,
                         const char* name, Stage stage, const char* function, double* out) {
  Call call(model, data, DYN_PART_INVERSE_DERIVATIVES, function);
  if (!call || !check_fext(call, fext) || !call.inputs(q, nullptr, nullptr, nullptr)) return call.status;
  const std::ptrdiff_t nv = call.m().n.nv;
  Data<double>& d = call.d();
  if (stage == Stage::StaticDerivatives) static_torque_derivatives(call.m(), d, fext, d.*field);
  else gravity_derivatives(call.m(), d, fext, d.*field);
  d.mark_fresh(stage);
  if (!no_overflow(call, 0) || !numeric_pairs(call, d.*field, name, stage, small_columns(call))) return call.status;
  copy_out(d.*field, nv * nv, out);
  return DYN_OK;
}

dynStatus dyn_gravity_torque_derivatives(const dynModel* model, dynData* data, const double* q, double* dg_dq) {
  return at_rest(model, data, q, nullptr, &Data<double>::dg_dq, "dg_dq", Stage::GravityDerivatives,
                 "dyn_gravity_torque_derivatives", dg_dq);
}

dynStatus dyn_static_torque_derivatives(const dynModel* model, dynData* data, const double* q, const double* fext,
                                        double* dstatic_torque_dq) {
  return at_rest(model, data, q, fext, &Data<double>::dstatic_torque_dq, "dstatic_torque_dq", Stage::StaticDerivatives,
                 "dyn_static_torque_derivatives", dstatic_torque_dq);
}

dynStatus dyn_vcom_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, double* dvcom_dq,
                               double* dvcom_dv) {
  Call call(model, data, DYN_PART_COM, "dyn_vcom_derivatives");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  Data<double>& d = call.d();
  const Index n = 3 * call.m().n.nv;
  center_of_mass_velocity_derivatives(call.m(), d);
  if (!no_overflow(call, 1) || !call.numeric(d.com, 3, "com", Stage::Com) || !call.numeric(d.vcom, 3, "vcom", Stage::Vcom) ||
      !call.numeric(d.Jcom, n, "Jcom", Stage::Jcom) || !call.numeric(d.dvcom_dq, n, "dvcom_dq", Stage::ComDerivatives))
    return call.status;
  copy_out(d.dvcom_dq, n, dvcom_dq), copy_out(d.Jcom, n, dvcom_dv);
  return DYN_OK;
}

}  // extern "C"
