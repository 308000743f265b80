// Data: creation, state, fields.
#include <cstdlib>
#include <cstring>
#include <new>

#include "model/block.hpp"
#include "model/effects.hpp"
#include "simulation/workspace.hpp"
#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr std::size_t handle_bytes = (sizeof(dynData) + 63) / 64 * 64;

dynStatus check_parts(const char* function, dynParts parts) {
  if (parts & ~dynParts(DYN_PART_ALL)) return fail(DYN_ERROR_ARGUMENT, "%s: parts 0x%x has unknown bits: use DYN_PART_... values", function, unsigned(parts));
  return DYN_OK;
}

void set_up(dynData* data, const Model& m, dynParts parts, void* arena) {
  data->model_id = m.id;
  data->counter = 1;
  data->busy.store(0);
  data_layout(m, parts, arena, data->d);
  data->magic = live_data;
}

struct FieldRow {
  dynFieldInfo info;
  Stage stage;
};

const FieldRow rows[] = {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  {{sizeof(dynFieldInfo), #name, #rows " x " #cols, unit, frame, producer, sentence, part, 0}, Stage::stage},
#include "model/data_fields.def"
};
constexpr int field_count = int(FieldId::count_);

}  // namespace

extern "C" {

dynStatus dyn_data_new(const dynModel* model, dynParts parts, dynData** data) {
  if (const dynStatus s = check(model)) return s;
  if (!data) return fail(DYN_ERROR_ARGUMENT, "dyn_data_new: data is NULL: pass the address of a dynData*");
  if (const dynStatus s = check_parts("dyn_data_new", parts)) return s;
  return guarded([&] {
    const std::size_t bytes = data_bytes<double>(*model->m, parts);
    void* arena = allocate_block(bytes);
    if (!arena)
      return fail(DYN_ERROR_MEMORY, "dyn_data_new: no memory for %zu bytes: ask for fewer parts (nv x nv matrices are MASS, FACTOR, MINV, CORIOLIS; nv x 10 njoints is REGRESSOR)", bytes);
    dynData* handle = new_data_slot();
    if (!handle) {
      std::free(arena);
      return fail(DYN_ERROR_MEMORY, "dyn_data_new: out of memory");
    }
    handle->arena = arena;
    handle->own_slot = true;
    set_up(handle, *model->m, parts, arena);
    *data = handle;
    return DYN_OK;
  });
}

size_t dyn_data_size(const dynModel* model, dynParts parts) {
  if (check(model) != DYN_OK || check_parts("dyn_data_size", parts) != DYN_OK) return 0;
  return 63 + handle_bytes + data_bytes<double>(*model->m, parts);
}

dynStatus dyn_data_init(const dynModel* model, dynParts parts, void* memory, size_t size, dynData** data) {
  if (const dynStatus s = check(model)) return s;
  if (!memory || !data) return fail(DYN_ERROR_ARGUMENT, "dyn_data_init: %s is NULL", memory ? "data" : "memory");
  if (const dynStatus s = check_parts("dyn_data_init", parts)) return s;
  if (size < dyn_data_size(model, parts))
    return fail(DYN_ERROR_SIZE, "dyn_data_init: memory has %zu bytes, needs %zu: ask dyn_data_size", size, dyn_data_size(model, parts));
  char* at = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(memory) + 63) / 64 * 64);
  dynData* handle = new (at) dynData{};
  handle->arena = nullptr;
  handle->own_slot = false;
  set_up(handle, *model->m, parts, at + handle_bytes);
  *data = handle;
  return DYN_OK;
}

void dyn_data_free(dynData* data) {
  if (!data || data->magic != live_data) return;
  if (!data->own_slot) {
    data->magic = freed;
    return;
  }
  std::free(data->arena);
  data->arena = nullptr;
  free_handle(data);
}

dynStatus dyn_data_set_state(const dynModel* model, dynData* data, const double* q, const double* v, const double* a, const double* tau) {
  Call call(model, data, 0, "dyn_data_set_state");
  if (call) call.inputs(q, v, a, tau);
  return call.status;
}

dynStatus dyn_data_set_effects(const dynModel* model, dynData* data, int joint, uint32_t effects) {
  Call call(model, data, 0, "dyn_data_set_effects");
  if (!call || !call.joint_or_all(joint)) return call.status;
  if (effects & ~uint32_t(DYN_EFFECT_ALL))
    return fail(DYN_ERROR_ARGUMENT, "dyn_data_set_effects: effects 0x%x has unknown bits: use DYN_EFFECT_... values", unsigned(effects));
  const Model& m = call.m();
  Data<double>& d = call.d();
  for (Index j = joint ? joint : 0, end = joint ? joint + 1 : m.n.joints; j < end; ++j) d.effects[j] = effects;
  apply_effects(m, d);
  simulation::invalidate_sleep(d);
  call.drop_results();
  return DYN_OK;
}

dynStatus dyn_data_effects(const dynModel* model, dynData* data, int joint, uint32_t* effects) {
  Call call(model, data, 0, "dyn_data_effects");
  if (!call || !call.joint_or_all(joint) || !call.required("effects", effects)) return call.status;
  *effects = joint ? call.d().effects[joint] : call.d().acting & std::uint32_t(DYN_EFFECT_ALL);
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
  if (!info) return fail(DYN_ERROR_ARGUMENT, "dyn_field_info: info is NULL");
  if (field < 0 || field >= field_count) return fail(DYN_ERROR_ARGUMENT, "dyn_field_info: field %d does not exist: there are %d", int(field), field_count);
  if (info->struct_size < sizeof(dynFieldInfo))
    return fail(DYN_ERROR_SIZE, "dyn_field_info: struct_size is %u, needs %zu: set it to sizeof(dynFieldInfo)", info->struct_size, sizeof(dynFieldInfo));
  const uint32_t size = info->struct_size;
  *info = rows[field].info;
  info->struct_size = size;
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
  if (!call || !call.required("out", out)) return call.status;
  if (out->struct_size < sizeof(dynArray))
    return fail(DYN_ERROR_SIZE, "dyn_data_array: struct_size is %u, needs %zu: set it to sizeof(dynArray)", out->struct_size, sizeof(dynArray));
  if (!call.fresh(rows[field].stage, rows[field].info.name, rows[field].info.producer)) return call.status;
  const std::ptrdiff_t nq = call.m().n.nq, nv = call.m().n.nv, nframes = call.m().n.frames, nparameters = parameter_count(call.m()),
                       npairs = call.m().n.pairs, nrows = call.m().n.constraint_rows, nu = call.m().n.nu, na = call.m().n.na, nactuators = call.m().n.actuators;
  (void)nq, (void)nv, (void)nframes, (void)nparameters, (void)npairs, (void)nrows, (void)nu, (void)na, (void)nactuators;
  auto view = [&](std::ptrdiff_t height, std::ptrdiff_t width, const double* numbers) {
    out->rows = int32_t(height), out->cols = int32_t(width), out->data = numbers ? numbers : call.d().time;  // NULL is for no one, not for no numbers
  };
  switch (FieldId(field)) {
#define FIELD(name, rows, cols, part, stage, unit, frame, producer, sentence) \
  case FieldId::name:                                                         \
    view(rows, cols, call.d().name);                                          \
    break;
#include "model/data_fields.def"
    case FieldId::count_: break;
  }
  out->stride[0] = 1;
  out->stride[1] = out->rows;
  return DYN_OK;
}

}  // extern "C"
