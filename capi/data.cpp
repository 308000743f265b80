// Data: creation, state, fields.
#include <cstring>
#include <new>

#include "model/effects.hpp"
#include "simulation/data_layout.hpp"
#include "simulation/workspace.hpp"
#include "in_memory.hpp"
#include "parts.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr std::size_t handle_bytes = 64;
static_assert(sizeof(dynData) <= handle_bytes);

struct FieldRow {
  dynFieldInfo info;
  Stage stage;
};

const FieldRow rows[] = {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  {{sizeof(dynFieldInfo), part, #name, #rows " x " #cols, unit, frame, producer, sentence}, Stage::stage},
#include "model/data_fields.def"
};
constexpr int field_count = int(FieldId::count_);

}  // namespace

dynStatus dyn::capi::check_parts(const char* function, [[maybe_unused]] const Model& m, dynParts parts) {
  if (parts & ~dynParts(DYN_PART_ALL))
    return fail(DYN_ERROR_ARGUMENT, "%s: parts 0x%x has unknown bits: use DYN_PART_... values", function, unsigned(parts));
  if constexpr (possible_parts != DYN_PART_ALL)
    if (const dynParts missing = complete_parts(m, parts) & ~possible_parts)
      return fail(DYN_ERROR_UNSUPPORTED, "%s: this library was built without DYN_PART_%s: name it in DYN_PARTS of the build",
                  function, name_of_part(missing));
  return DYN_OK;
}

void dyn::capi::set_up(dynData* data, const Model& m, dynParts parts, void* memory) {
  DataBody* body = new (memory) DataBody{};
  body->model_id = m.id;
  body->counter = 1;
  data_layout<possible_parts>(m, parts, static_cast<char*>(memory) + body_bytes, body->d);
  data->body = body;
  data->magic = live_data;
}

extern "C" {

size_t dyn_data_size(const dynModel* model, dynParts parts) {
  if (check(model) != DYN_OK || check_parts("dyn_data_size", *model->m, parts) != DYN_OK) return 0;
  return 63 + handle_bytes + body_bytes + data_bytes<double, possible_parts>(*model->m, parts);
}

dynStatus dyn_data_init(const dynModel* model, dynParts parts, void* memory, size_t size, dynData** data) {
  if (const dynStatus s = check(model)) return s;
  if (!memory || !data) return fail(DYN_ERROR_ARGUMENT, "dyn_data_init: %s is NULL", memory ? "data" : "memory");
  if (const dynStatus s = check_parts("dyn_data_init", *model->m, parts)) return s;
  if (size < dyn_data_size(model, parts))
    return fail(DYN_ERROR_SIZE, "dyn_data_init: memory has %zu bytes, needs %zu: ask dyn_data_size", size,
                dyn_data_size(model, parts));
  char* at = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(memory) + 63) / 64 * 64);
  std::memset(at, 0, dyn_data_size(model, parts) - 63);
  dynData* handle = new (at) dynData{};
  set_up(handle, *model->m, parts, at + handle_bytes);
  *data = handle;
  return DYN_OK;
}

void dyn_data_free(dynData* data) {
  if (!data || data->magic != live_data) return;
#if !DYN_NO_HOST
  if (data->body->bytes) return free_heap(data);
#endif
  data->magic = freed;
}

dynStatus dyn_data_set_state(const dynModel* model, dynData* data, const double* q, const double* v, const double* a,
                             const double* tau) {
  Call call(model, data, 0, "dyn_data_set_state");
  if (call) call.inputs(q, v, a, tau);
  if (call && (q || v) && call.d().step) call.d().step->growth = 0, call.d().step->ends_fast = true;
  return call.status;
}

dynStatus dyn_data_reset(const dynModel* model, dynData* data, const char* name) {
  Call call(model, data, 0, "dyn_data_reset");
  if (!call) return call.status;
  const Model& m = call.m();
  Index k = m.simulation()->initial;
  if (name && (k = find_configuration(m, name)) < 0) return DYN_ERROR_NAME;
  Data<double>& d = call.d();
  if (d.step) simulation::wake_all(m, d);
  set_to_configuration(m, d, k);
  place_mocaps<possible_parts>(m, d, k);
  for (Index i = 0; i < m.n.mocaps; ++i) simulation::mocap_moved(m, d, i);
  for (std::uint64_t& version : d.version) version = ++data->body->counter;
  if (!d.step) return DYN_OK;
  d.step->contact_count = 0, d.step->advancement_cache.square = d.step->growth = 0, d.step->ends_fast = true;
  std::fill_n(d.step->limit_forces, d.step->limits, 0.0);
  if (d.step->frame_forces) std::fill_n(d.step->frame_forces, 12 * std::ptrdiff_t(m.n.slots), 0.0);
  std::fill_n(d.step->sleep.slow_time, d.step->sleep.count, 0.0);
  return DYN_OK;
}

dynStatus dyn_data_set_effects(const dynModel* model, dynData* data, int joint, uint32_t effects) {
  Call call(model, data, 0, "dyn_data_set_effects");
  if (!call || !call.joint_or_all(joint)) return call.status;
  if (effects & ~uint32_t(DYN_EFFECT_ALL | DYN_EFFECT_AS_STATED))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_effects: effects 0x%x has unknown bits: use DYN_EFFECT_... values",
                unsigned(effects));
  const Model& m = call.m();
  Data<double>& d = call.d();
  for (Index j = joint ? joint : 0, end = joint ? joint + 1 : m.n.joints; j < end; ++j) d.chosen_effects[j] = effects;
  switch_effects(m, d, data->body->stepping);
  simulation::invalidate_sleep(d);
  call.drop_results();
  return DYN_OK;
}

dynStatus dyn_data_effects(const dynModel* model, dynData* data, int joint, uint32_t* effects) {
  Call call(model, data, 0, "dyn_data_effects");
  if (!call || !call.joint_or_all(joint) || !call.required("effects", effects)) return call.status;
  if (joint == 0) call.have_effects_of(true);
  *effects = joint ? call.d().chosen_effects[joint] : call.d().acting & std::uint32_t(DYN_EFFECT_ALL);
  return DYN_OK;
}

dynStatus dyn_data_set_gravity(const dynModel* model, dynData* data, const double gravity[3]) {
  Call call(model, data, 0, "dyn_data_set_gravity");
  if (!call || !call.required("gravity", gravity) || !call.finite("gravity", gravity, 3)) return call.status;
  copy_out(gravity, 3, call.d().world_gravity);
  simulation::invalidate_sleep(call.d());
  call.drop_results();
  return DYN_OK;
}

int dyn_field_count(void) { return field_count; }

dynStatus dyn_field_info(dynField field, dynFieldInfo* info) {
  if (const dynStatus s = check_struct("dyn_field_info", "info", info)) return s;
  if (field < 0 || field >= field_count)
    return fail(DYN_ERROR_ARGUMENT, "dyn_field_info: field %d does not exist: there are %d", int(field), field_count);
  write_struct(rows[field].info, info);
  return DYN_OK;
}

dynField dyn_field_id(const char* name) {
  if (name)
    for (int k = 0; k < field_count; ++k)
      if (std::strcmp(rows[k].info.name, name) == 0) return k;
  fail(DYN_ERROR_NAME, "there is no field '%.64s': dyn_field_info lists them", name ? name : "(NULL)");
  return -1;
}

dynStatus dyn_data_array(const dynModel* model, dynData* data, dynField field, dynArray* out) {
  if (field < 0 || field >= field_count) {
    if (const dynStatus s = check(model)) return s;
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_array: field %d does not exist: there are %d", int(field), field_count);
  }
  Call call(model, data, rows[field].info.part, "dyn_data_array");
  if (!call) return call.status;
  if (const dynStatus s = check_struct(call.function, "out", out)) return s;
  if (!call.fresh(rows[field].stage, rows[field].info.name, rows[field].info.producer)) return call.status;
  const std::ptrdiff_t nq = call.m().n.nq, nv = call.m().n.nv, nframes = call.m().n.frames,
                       nparameters = parameter_count(call.m()), npairs = call.m().n.pairs, nrows = call.m().n.constraint_rows,
                       nu = call.m().n.nu, na = call.m().n.na, nactuators = call.m().n.actuators, ntendons = call.m().n.tendons,
                       nmocaps = call.m().n.mocaps,
                       nsensordata = call.m().n.sensor_values;
  (void)nq, (void)nv, (void)nframes, (void)nparameters, (void)npairs, (void)nrows, (void)nu, (void)na, (void)nactuators,
      (void)ntendons, (void)nmocaps, (void)nsensordata;
  dynArray array{};
  auto view = [&](std::ptrdiff_t height, std::ptrdiff_t width, const double* numbers) {
    array.rows = int32_t(height), array.cols = int32_t(width),
    array.data = numbers ? numbers : call.d().time;  // NULL is for no one, not for no numbers
  };
  switch (FieldId(field)) {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  case FieldId::name:                                                         \
    view(rows, cols, call.d().name);                                          \
    break;
#include "model/data_fields.def"
    case FieldId::count_: break;
  }
  array.stride[0] = 1;
  array.stride[1] = array.rows;
  write_struct(array, out);
  return DYN_OK;
}

}  // extern "C"
