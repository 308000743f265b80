// Models from robot files, and their end.
#include "model/load.hpp"

#include <cmath>
#include <string>

#include "handles.hpp"
#include "host.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

LoadOptions read_options(const Given<dynLoadOptions>& o) {
  LoadOptions out;
  require_value(o->base, "dynLoadOptions", "base");
  if (o->package_dirs_count && !o->package_dirs)
    throw Error(DYN_ERROR_ARGUMENT, "dynLoadOptions: package_dirs is NULL but package_dirs_count is not 0");
  if (o->package_dirs_count > max_package_dirs)
    throw Error(DYN_ERROR_LIMIT, "dynLoadOptions: package_dirs_count is " + std::to_string(o->package_dirs_count) +
                                     ": give at most " + std::to_string(max_package_dirs));
  out.base = o->base;
  out.strict = o->strict != 0;
  out.cos_sin = o->cos_sin != 0;
  for (size_t k = 0; k < o->package_dirs_count; ++k) {
    if (!o->package_dirs[k]) throw Error(DYN_ERROR_ARGUMENT, "dynLoadOptions: package_dirs[" + std::to_string(k) + "] is NULL");
    out.package_dirs.push_back(o->package_dirs[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!std::isfinite(o->gravity[k]))
      throw Error(DYN_ERROR_NONFINITE, "dynLoadOptions: gravity[" + std::to_string(k) + "] is not finite");
    out.gravity[k] = o->gravity[k];
  }
  require_value(o->meshes, "dynLoadOptions", "meshes");
  out.meshes = o->meshes;
  if (o->constraint_slots < 0 || o->constraint_slots > 1000)
    throw Error(DYN_ERROR_ARGUMENT,
                "dynLoadOptions: constraint_slots is " + std::to_string(o->constraint_slots) + ": give 0 to 1000");
  out.constraint_slots = o->constraint_slots;
  if (o->contact_capacity < 0 || o->contact_capacity > max_contacts)
    throw Error(DYN_ERROR_ARGUMENT, "dynLoadOptions: contact_capacity is " + std::to_string(o->contact_capacity) +
                                        ": give 1 to " + std::to_string(max_contacts) + ", or 0 for what the shapes need");
  out.contact_capacity = o->contact_capacity;
  out.confined = o->confined != 0;
  const auto limit = [](const char* name, auto given, auto& to) {
    if (!(given >= 0))
      throw Error(DYN_ERROR_ARGUMENT,
                  "dynLoadOptions: " + std::string(name) + " is no limit: give a positive number, or 0 for the default");
    if (given > 0) to = given;
  };
  limit("max_bodies", o->max_bodies, out.limits.bodies), limit("max_shapes", o->max_shapes, out.limits.shapes);
  limit("max_constraint_rows", o->max_constraint_rows, out.limits.rows), limit("max_keys", o->max_keys, out.limits.keys);
  limit("max_bytes", o->max_bytes, out.limits.bytes), limit("max_seconds", o->max_seconds, out.limits.seconds);
  if (o->srdf) out.srdf = o->srdf;
  if (o->srdf && out.srdf.empty())
    throw Error(DYN_ERROR_ARGUMENT, "dynLoadOptions: srdf is empty: give a path, or NULL for none");
  return out;
}

template <class Load>
dynStatus load_model(const char* text, const dynLoadOptions* options, dynModel** model, const char* function, const char* what,
                     Load f) {
  if (!text || !model) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL", function, text ? "model" : what);
  const Given<dynLoadOptions> given(function, options);
  if (given.status != DYN_OK) return given.status;
  return guarded([&] { return make_handle(f(text, read_options(given)), model); });
}

}  // namespace

template <>
dynLoadOptions capi::defaults() {
  dynLoadOptions o{};
  o.gravity[2] = -9.81;
  o.constraint_slots = 8;
  o.meshes = DYN_MESH_USE_AUTO;
  return o;
}

extern "C" {

dynStatus dyn_model_load(const char* path, const dynLoadOptions* options, dynModel** model) {
  return load_model(path, options, model, "dyn_model_load", "path",
                    [](const char* p, const LoadOptions& o) { return load_file(p, o); });
}

dynStatus dyn_model_load_string(const char* text, const dynLoadOptions* options, dynModel** model) {
  return load_model(text, options, model, "dyn_model_load_string", "text",
                    [](const char* t, const LoadOptions& o) { return load_string(t, o); });
}

void dyn_model_free(dynModel* model) {
  if (!model || model->magic != live_model || model->in_place == 1) return;
  ModelDeleter{}(const_cast<Model*>(model->m.get()));
  free_handle(model);
}

}  // extern "C"
