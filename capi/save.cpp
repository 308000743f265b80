// Models to files and to memory.
#include "model/save.hpp"

#include <cstring>

#include "host.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// Reports all lines, also when strict refuses the model.
template <class Save>
dynStatus save(const char* function, const dynSaveOptions* options, Save&& f) {
  const Given<dynSaveOptions> o(function, options);
  if (o.status != DYN_OK) return o.status;
  return guarded([&] {
    SaveReport lines;
    const auto tell = [&] {
      for (const SaveEntry& e : lines)
        if (o->report) o->report(o->context, e.level, e.message.c_str());
    };
    try {
      f(lines, o->strict != 0);
    } catch (const Error&) {
      tell();
      throw;
    }
    tell();
    return DYN_OK;
  });
}

// Copies what there is into the caller's buffer, if there is one.
void hand_out(const char* function, const std::string& out, void* buffer, size_t capacity, size_t* size) {
  *size = out.size();
  if (!buffer) return;
  if (out.size() > capacity)
    throw Error(DYN_ERROR_SIZE, std::string(function) + ": capacity is " + std::to_string(capacity) + ", and there are " +
                                    std::to_string(out.size()) + " bytes");
  std::memcpy(buffer, out.data(), out.size());
}

}  // namespace

template <>
dynSaveOptions capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_model_save(const dynModel* model, const char* path, const dynSaveOptions* options) {
  if (const dynStatus s = check(model)) return s;
  if (!path) return fail(DYN_ERROR_ARGUMENT, "dyn_model_save: path is NULL");
  return save("dyn_model_save", options, [&](SaveReport& lines, bool strict) { save_file(*model->m, path, strict, lines); });
}

dynStatus dyn_model_save_memory(const dynModel* model, dynFormat format, const dynSaveOptions* options, void* buffer,
                                size_t capacity, size_t* size) {
  if (const dynStatus s = check(model)) return s;
  if (!size) return fail(DYN_ERROR_ARGUMENT, "dyn_model_save_memory: size is NULL");
  if (!buffer && capacity) return fail(DYN_ERROR_ARGUMENT, "dyn_model_save_memory: buffer is NULL but capacity is not 0");
  return save("dyn_model_save_memory", options, [&](SaveReport& lines, bool strict) {
    hand_out("dyn_model_save_memory", save_string(*model->m, dynFormat(raw(format)), strict, lines), buffer, capacity, size);
  });
}

dynStatus dyn_model_image(const dynModel* model, uint32_t flags, void* buffer, size_t capacity, size_t* size) {
  if (const dynStatus s = check(model)) return s;
  if (!size) return fail(DYN_ERROR_ARGUMENT, "dyn_model_image: size is NULL");
  if (!buffer && capacity) return fail(DYN_ERROR_ARGUMENT, "dyn_model_image: buffer is NULL but capacity is not 0");
  if (flags & ~uint32_t(DYN_IMAGE_NARROW | DYN_IMAGE_NAMELESS))
    return fail(DYN_ERROR_ARGUMENT, "dyn_model_image: flags are 0x%x: use DYN_IMAGE_NARROW and DYN_IMAGE_NAMELESS",
                unsigned(flags));
  return guarded([&] {
    hand_out("dyn_model_image", save_dynb(*model->m, (flags & DYN_IMAGE_NARROW) != 0, (flags & DYN_IMAGE_NAMELESS) == 0), buffer,
             capacity, size);
    return DYN_OK;
  });
}

}  // extern "C"
