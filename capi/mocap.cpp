// Mocap bodies: links fixed to the world whose pose the caller sets.
#include "simulation/mocap.hpp"

#include <cstring>

#include "guard.hpp"
#include "rotation.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

bool exists(const char* function, const Model& m, int mocap) {
  if (mocap >= 0 && mocap < m.n.mocaps) return true;
  fail(DYN_ERROR_ARGUMENT, "%s: mocap body %d does not exist: the model has %d", function, mocap, int(m.n.mocaps));
  return false;
}

}  // namespace

extern "C" {

int dyn_model_nmocaps(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.mocaps) : -1; }

int dyn_model_mocap_frame(const dynModel* model, int mocap) {
  if (check(model) != DYN_OK || !exists("dyn_model_mocap_frame", *model->m, mocap)) return -1;
  return int(model->m->mocaps()[mocap]);
}

int dyn_model_mocap_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  const Model& m = *model->m;
  for (Index k = 0; name && k < m.n.mocaps; ++k)
    if (std::strcmp(m.string(m.frames()[m.mocaps()[k]].name), name) == 0) return int(k);
  fail(DYN_ERROR_NAME, "there is no mocap body '%.200s': the model has %d, see dyn_model_mocap_frame", name ? name : "(NULL)",
       int(m.n.mocaps));
  return -1;
}

dynStatus dyn_data_set_mocap(const dynModel* model, dynData* data, int mocap, const double placement[12]) {
  Call call(model, data, 0, "dyn_data_set_mocap");
  if (!call) return call.status;
  if (!exists(call.function, call.m(), mocap)) return DYN_ERROR_ARGUMENT;
  if (!call.required("placement", placement) || !call.finite("placement", placement, 12)) return call.status;
  if (!is_rotation(load33(placement)))
    return fail(DYN_ERROR_ARGUMENT, "%s: placement of mocap body '%s': its first nine numbers are no rotation", call.function,
                call.m().string(call.m().frames()[call.m().mocaps()[mocap]].name));
  Data<double>& d = call.d();
  if (std::equal(placement, placement + 12, d.mocap + 12 * mocap)) return DYN_OK;
  place_mocap(call.m(), d, mocap, placement);
  simulation::mocap_moved(call.m(), d, mocap);
  d.version[input_q] = ++data->body->counter;
  return DYN_OK;
}

dynStatus dyn_data_mocap(const dynModel* model, dynData* data, int mocap, double placement[12]) {
  Call call(model, data, 0, "dyn_data_mocap");
  if (!call || !call.required("placement", placement)) return call.status;
  if (!exists(call.function, call.m(), mocap)) return DYN_ERROR_ARGUMENT;
  copy_out(call.d().mocap + 12 * mocap, 12, placement);
  return DYN_OK;
}

}  // extern "C"
