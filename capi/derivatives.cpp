// Derivatives of the dynamics: thin wrappers.
#include "checks.hpp"

using namespace dyn;
using namespace dyn::capi;

extern "C" {

dynStatus dyn_rnea_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* a, const double* fext,
                               double* dtau_dq, double* dtau_dv) {
  Call call(model, data, DYN_PART_INVERSE_DERIVATIVES, "dyn_rnea_derivatives");
  if (!call || !check_fext(call, fext) || !call.inputs(q, v, a, nullptr)) return call.status;
  const std::ptrdiff_t nv = call.m().n.nv;
  Data<double>& d = call.d();
  d.drop(Stage::Tau), d.drop(Stage::InverseDerivatives);  // being written
  rnea_derivatives(call.m(), d, d.v, d.a, fext);
  if (!finite_mass(call) || !call.numeric(d.tau, Index(nv), "tau", Stage::Tau) ||
      !call.numeric(d.dtau_dq, Index(nv * nv), "dtau_dq", Stage::InverseDerivatives) ||
      !call.numeric(d.dtau_dv, Index(nv * nv), "dtau_dv", Stage::InverseDerivatives))
    return call.status;
  d.done(Stage::Tau), d.done(Stage::InverseDerivatives);
  copy_out(d.dtau_dq, nv * nv, dtau_dq), copy_out(d.dtau_dv, nv * nv, dtau_dv);
  return DYN_OK;
}

dynStatus dyn_aba_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* tau, const double* fext,
                              double* ddq_dq, double* ddq_dv, double* ddq_dtau) {
  Call call(model, data, DYN_PART_FORWARD_DERIVATIVES, "dyn_aba_derivatives");
  if (!call || !check_fext(call, fext) || !call.inputs(q, v, nullptr, tau)) return call.status;
  const std::ptrdiff_t nv = call.m().n.nv;
  Data<double>& d = call.d();
  d.drop(Stage::Ddq), d.drop(Stage::ForwardDerivatives), d.drop(Stage::Minv);    // being written
  d.drop(Stage::Tau), d.drop(Stage::InverseDerivatives);  // at another a than the held one
  const Index failed = aba_derivatives(call.m(), d, d.v, d.tau_applied, fext);
  if (failed) return singular(call, failed, Stage::ForwardDerivatives);
  if (!finite_mass(call) || !call.numeric(d.ddq, Index(nv), "ddq", Stage::Ddq) || !call.numeric(d.Minv, Index(nv * nv), "Minv", Stage::Minv) ||
      !call.numeric(d.ddq_dq, Index(nv * nv), "ddq_dq", Stage::ForwardDerivatives) ||
      !call.numeric(d.ddq_dv, Index(nv * nv), "ddq_dv", Stage::ForwardDerivatives))
    return call.status;
  d.done(Stage::Ddq), d.done(Stage::ForwardDerivatives);
  copy_out(d.ddq_dq, nv * nv, ddq_dq), copy_out(d.ddq_dv, nv * nv, ddq_dv), copy_out(d.Minv, nv * nv, ddq_dtau);
  return DYN_OK;
}

}  // extern "C"
