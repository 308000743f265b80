// Actuators, controls, and forces from outside.
#include <cstring>

#include "algorithm/actuators.hpp"
#include "simulation/workspace.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

Force<double> shifted(const Force<double>& f, const Vec3<double>& p) { return {f.linear, f.angular + cross(p, f.linear)}; }

}  // namespace

template <>
dynActuator capi::defaults() {
  return default_actuator(DYN_ACTUATOR_TYPE_MOTOR);
}

extern "C" {

void(dyn_actuator_init)(dynActuator* actuator, uint32_t size, dynActuatorType type) {
  initialize(actuator, size, default_actuator(type));
}

int dyn_model_nforce_limits(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.force_limits) : -1; }

dynStatus dyn_model_force_limit_info(const dynModel* model, int limit, dynForceLimit* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_force_limit_info", "out", out)) return s;
  const Model& m = *model->m;
  if (const dynStatus s = check_index("dyn_model_force_limit_info", "limit", limit, m.n.force_limits)) return s;
  const ForceLimitRecord& r = m.force_limits()[limit];
  write_struct(dynForceLimit{sizeof(dynForceLimit), std::int32_t(r.joint), std::int32_t(r.tendon), std::int32_t(r.with_weight),
                             {r.range[0], r.range[1]}},
               out);
  return DYN_OK;
}

int dyn_model_nactuators(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.actuators) : -1; }
int dyn_model_nu(const dynModel* model) { return check(model) == DYN_OK ? int(model->m->n.nu) : -1; }

const char* dyn_model_actuator_name(const dynModel* model, int actuator) {
  if (check(model) != DYN_OK || check_index("dyn_model_actuator_name", "actuator", actuator, model->m->n.actuators) != DYN_OK)
    return nullptr;
  return model->m->string(model->m->actuators()[actuator].name);
}

int dyn_model_actuator_id(const dynModel* model, const char* name) {
  if (check(model) != DYN_OK) return -1;
  const Model& m = *model->m;
  for (Index k = 0; name && k < m.n.actuators; ++k)
    if (std::strcmp(m.string(m.actuators()[k].name), name) == 0) return int(k);
  fail(DYN_ERROR_NAME, "there is no actuator '%.200s': the model has %d, see dyn_model_actuator_name", name ? name : "(NULL)",
       int(m.n.actuators));
  return -1;
}

dynStatus dyn_model_actuator_info(const dynModel* model, int actuator, dynActuator* out) {
  if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_struct("dyn_model_actuator_info", "out", out)) return s;
  if (const dynStatus s = check_index("dyn_model_actuator_info", "actuator", actuator, model->m->n.actuators)) return s;
  write_struct(model->m->actuators()[actuator].spec, out);
  return DYN_OK;
}

dynStatus dyn_data_set_control(const dynModel* model, dynData* data, const double* u) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_set_control");
  if (!call || !call.required("u", u, call.m().n.nu) || !call.finite("u", u, call.m().n.nu)) return call.status;
  copy_out(u, call.m().n.nu, call.d().ctrl);
  return DYN_OK;
}

dynStatus dyn_data_apply_wrench(const dynModel* model, dynData* data, int frame, const double* point, const double wrench[6],
                                dynReference reference) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_apply_wrench");
  if (!call || !call.frame(frame) || !call.reference(reference) || !call.required("wrench", wrench) ||
      !call.finite("wrench", wrench, 6) || !call.finite("point", point, 3))
    return call.status;
  const FrameRecord& f = call.m().frames()[frame];
  if (f.joint == 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: frame '%s' does not move: name one that a joint carries", call.function,
                call.m().string(f.name));
  if (reference == DYN_REFERENCE_WORLD && point)
    return fail(
        DYN_ERROR_ARGUMENT,
        "%s: a moment about the world's origin has no point on the body: pass NULL, or use DYN_REFERENCE_LOCAL_WORLD_ALIGNED",
        call.function);
  Data<double>& d = call.d();
  AppliedWrench<double>& held = d.wrenches[f.joint];
  const Force<double> w = load_force(wrench);
  const Vec3<double> at = point ? f.X.act(load3(point)) : f.X.p;
  if (reference == DYN_REFERENCE_LOCAL) {
    held.local = held.local + shifted({f.X.R * w.linear, f.X.R * w.angular}, at);
  } else if (reference == DYN_REFERENCE_LOCAL_WORLD_ALIGNED) {
    held.aligned = held.aligned + w;
    held.arm = held.arm + outer(at, w.linear);
  } else {
    held.world = held.world + w;
  }
  d.pushed |= acting_wrenches, d.acting |= acting_wrenches;
  simulation::invalidate_sleep(d);
  return DYN_OK;
}

dynStatus dyn_data_clear_wrenches(const dynModel* model, dynData* data) {
  Call call(model, data, DYN_PART_SIMULATION, "dyn_data_clear_wrenches");
  if (!call) return call.status;
  Data<double>& d = call.d();
  for (Index j = 0; j < call.m().n.joints; ++j) d.wrenches[j] = AppliedWrench<double>::none();
  d.acting &= ~acting_wrenches, d.pushed &= ~acting_wrenches;
  simulation::invalidate_sleep(d);
  return DYN_OK;
}

}  // extern "C"
