// Mocap bodies: links fixed to the world whose pose the caller sets.
#include "simulation/mocap.hpp"

#include <cstring>

#include "guard.hpp"
#include "rotation.hpp"

using namespace dyn;
using namespace dyn::capi;

extern "C" {

int dyn_model_nmocaps(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.mocaps) : -1; }

int dyn_model_mocap_frame(const dynModel* model, int mocap) {
  if (check(model) != DYN_OK || check_index("dyn_model_mocap_frame", "mocap body", mocap, model->m->n.mocaps) != DYN_OK)
    return -1;
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
  if (const dynStatus s = check_index(call.function, "mocap body", mocap, call.m().n.mocaps)) return s;
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
  if (const dynStatus s = check_index(call.function, "mocap body", mocap, call.m().n.mocaps)) return s;
  copy_out(call.d().mocap + 12 * mocap, 12, placement);
  return DYN_OK;
}

}  // extern "C"
