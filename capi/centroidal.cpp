// Centroidal quantities: thin wrappers.
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// A_g, I_g, h_g are computed: finite, or the inputs of this call are taken back.
bool finite_map(Call& call) {
  const Data<double>& d = call.d();
  return call.numeric(d.Ag, 6 * call.m().n.nv, "Ag", Stage::CentroidalMap) &&
         call.numeric(d.Ig, 36, "Ig", Stage::CentroidalMap) && call.numeric(d.hg, 6, "hg", Stage::CentroidalMomentum);
}

}  // namespace

template <>
dynCentroidalDerivatives capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_centroidal_map(const dynModel* model, dynData* data, const double* q, const double* v, double* Ag, double Ig[36],
                             double hg[6]) {
  Call call(model, data, DYN_PART_CENTROIDAL, "dyn_centroidal_map");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  centroidal_map<false>(call.m(), call.d());
  if (!finite_map(call)) return call.status;
  copy_out(call.d().Ag, 6 * std::ptrdiff_t(call.m().n.nv), Ag), copy_out(call.d().Ig, 36, Ig), copy_out(call.d().hg, 6, hg);
  return DYN_OK;
}

dynStatus dyn_centroidal_map_time_variation(const dynModel* model, dynData* data, const double* q, const double* v, double* dAg) {
  Call call(model, data, DYN_PART_CENTROIDAL, "dyn_centroidal_map_time_variation");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  centroidal_map<true>(call.m(), call.d());
  if (!finite_map(call) || !call.numeric(call.d().dAg, 6 * call.m().n.nv, "dAg", Stage::CentroidalMapRate)) return call.status;
  copy_out(call.d().dAg, 6 * std::ptrdiff_t(call.m().n.nv), dAg);
  return DYN_OK;
}

dynStatus dyn_centroidal_momentum(const dynModel* model, dynData* data, const double* q, const double* v, double hg[6]) {
  Call call(model, data, DYN_PART_CENTROIDAL, "dyn_centroidal_momentum");
  if (!call || !call.inputs(q, v, nullptr, nullptr)) return call.status;
  centroidal_momentum<false>(call.m(), call.d());
  if (call.numeric(call.d().hg, 6, "hg", Stage::CentroidalMomentum)) copy_out(call.d().hg, 6, hg);
  return call.status;
}

dynStatus dyn_centroidal_momentum_time_variation(const dynModel* model, dynData* data, const double* q, const double* v,
                                                 const double* a, double dhg[6]) {
  Call call(model, data, DYN_PART_CENTROIDAL, "dyn_centroidal_momentum_time_variation");
  if (!call || !call.inputs(q, v, a, nullptr)) return call.status;
  centroidal_momentum<true>(call.m(), call.d());
  if (!call.numeric(call.d().hg, 6, "hg", Stage::CentroidalMomentum) ||
      !call.numeric(call.d().dhg, 6, "dhg", Stage::CentroidalMomentumRate))
    return call.status;
  copy_out(call.d().dhg, 6, dhg);
  return DYN_OK;
}

dynStatus dyn_centroidal_derivatives(const dynModel* model, dynData* data, const double* q, const double* v, const double* a,
                                     const dynCentroidalDerivatives* out) {
  Call call(model, data, DYN_PART_CENTROIDAL, "dyn_centroidal_derivatives");
  const Given<dynCentroidalDerivatives> wanted(call.function, out);
  if (!call || (call.status = wanted.status) || !call.inputs(q, v, a, nullptr)) return call.status;
  Data<double>& d = call.d();
  const Index n = 6 * call.m().n.nv;
  centroidal_derivatives(call.m(), d);
  if (!finite_map(call) || !call.numeric(d.dhg, 6, "dhg", Stage::CentroidalMomentumRate)) return call.status;
  if (!call.numeric(d.dh_dq, n, "dh_dq", Stage::CentroidalDerivatives) ||
      !call.numeric(d.dhdot_dv, n, "dhdot_dv", Stage::CentroidalDerivatives) ||
      !call.numeric(d.dhdot_dq, n, "dhdot_dq", Stage::CentroidalRateDerivative))
    return call.status;
  copy_out(d.dh_dq, n, wanted->dh_dq), copy_out(d.dhdot_dq, n, wanted->dhdot_dq);
  copy_out(d.dhdot_dv, n, wanted->dhdot_dv), copy_out(d.Ag, n, wanted->dhdot_da);
  return DYN_OK;
}

}  // extern "C"
