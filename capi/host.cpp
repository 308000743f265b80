#include "host.hpp"

#include <cstring>
#include <filesystem>
#include <new>

#include "handles.hpp"

namespace dyn::capi {

dynStatus fail_of_exception() noexcept {
  try {
    throw;
  } catch (const Error& e) {
    return fail(e.status, "%s", e.what());
  } catch (const std::bad_alloc&) {
    return fail(DYN_ERROR_MEMORY, "out of memory");
  } catch (const std::length_error&) {
    return fail(DYN_ERROR_LIMIT, "an array or a name is longer than memory can be: check the sizes that are passed");
  } catch (const std::filesystem::filesystem_error& e) {
    return fail(DYN_ERROR_FILE, "file '%.300s': %s", e.path1().string().c_str(), std::strerror(e.code().value()));
  } catch (const std::exception& e) {
    return fail(DYN_ERROR_INTERNAL, "internal error: %s", e.what());
  } catch (...) {
    return fail(DYN_ERROR_INTERNAL, "internal error");
  }
}

dynStatus make_handle(ModelPtr model, dynModel** out) {
  dynModel* handle = new_handle<dynModel>();
  if (!handle) return fail(DYN_ERROR_MEMORY, "out of memory");
  handle->in_place = reinterpret_cast<std::uintptr_t>(model.get());
  handle->m = model.release();
  handle->magic = live_model;
  *out = handle;
  return DYN_OK;
}

}  // namespace dyn::capi
