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
  rnea_derivatives(call.m(), d, d.v, d.a, fext);
  if (!finite_mass(call) || !call.numeric(d.tau, Index(nv), "tau", Stage::Tau) ||
      !call.numeric(d.dtau_dq, Index(nv * nv), "dtau_dq", Stage::InverseDerivatives) ||
      !call.numeric(d.dtau_dv, Index(nv * nv), "dtau_dv", Stage::InverseDerivatives))
    return call.status;
  d.done(Stage::Tau), d.done(Stage::InverseDerivatives);
  copy_out(d.dtau_dq, nv * nv, dtau_dq), copy_out(d.dtau_dv, nv * nv, dtau_dv);
  return DYN_OK;
}

}  // extern "C"
