// Models where they lie: no copy, no heap.
#include <cstdint>

#include "guard.hpp"

using namespace dyn;
using namespace dyn::capi;

extern "C" dynStatus dyn_model_from_buffer(const void* buffer, size_t size, const dynModel** model) {
  if (!buffer || !model) return fail(DYN_ERROR_ARGUMENT, "dyn_model_from_buffer: %s is NULL", buffer ? "model" : "buffer");
  constexpr std::size_t boundary = alignof(Vec3<double>) > alignof(double) ? 64 : alignof(double);
  if (reinterpret_cast<std::uintptr_t>(buffer) % boundary)
    return fail(DYN_ERROR_ARGUMENT, "dyn_model_from_buffer: the buffer lies on no boundary of %zu bytes: align it", boundary);
#if DYN_NO_HOST && !DYN_CHECK_MODELS  // a model in flash is part of the program: checksum and layout show that it is whole
  const Damage d = check_header(buffer, size);
#else
  const Damage d = check_dynb(buffer, size);
#endif
  if (d) {
    const char* const action = "make it anew from the robot file";
    if (d.count >= 0)
      return fail(d.status, "dyn_model_from_buffer: %s is %lld of %lld: %s", d.what, static_cast<long long>(d.value),
                  static_cast<long long>(d.count), action);
    return fail(d.status, "dyn_model_from_buffer: %s: %s", d.what, action);
  }
  *model = &static_cast<const DynbHeader*>(buffer)->handle;
  return DYN_OK;
}
