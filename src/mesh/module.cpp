// The module's function table. The only place that turns exceptions into failures.
#include "module.hpp"

#include <libqhull_r/libqhull_r.h>

#include <cstdlib>
#include <string>

#include "parts.hpp"

namespace dyn::mesh {

namespace {

template <class F>
bool guarded(Failure* failure, F&& f) noexcept {
  const auto fail = [&](dynStatus status, const char* message) {
    failure->status = status;
    std::string_view text = message;
    text = text.substr(0, sizeof failure->message - 1);
    failure->message[text.copy(failure->message, text.size())] = '\0';
    return false;
  };
  try {
    f();
    return true;
  } catch (const Refusal& e) {
    return fail(e.status, e.what());
  } catch (const std::bad_alloc&) {
    return fail(DYN_ERROR_MEMORY, "out of memory");
  } catch (const std::exception& e) {
    return fail(DYN_ERROR_PARSE, e.what());
  } catch (...) {
    return fail(DYN_ERROR_INTERNAL, "internal error");
  }
}

template <class T>
T* handed_over(const std::vector<T>& from) {
  T* to = static_cast<T*>(std::malloc(std::max<std::size_t>(from.size(), 1) * sizeof(T)));
  if (!to) throw std::bad_alloc();
  std::copy(from.begin(), from.end(), to);
  return to;
}

bool hull(const double* points, std::int32_t count, HullFaces* out, Failure* failure) {
  *out = {};
  return guarded(failure, [&] {
    const Faces f = hull_qhull(points, count);
    out->corners = handed_over(f.corners), out->corner_count = std::int32_t(f.corners.size());
    out->face_start = handed_over(f.start), out->face_corners = handed_over(f.of_face);
    out->face_count = std::int32_t(f.start.size()) - 1;
  });
}

void free_hull(HullFaces* h) { std::free(h->corners), std::free(h->face_start), std::free(h->face_corners), *h = {}; }

}  // namespace

}  // namespace dyn::mesh

extern "C" __attribute__((visibility("default"))) const dyn::mesh::Module* dyn_mesh_module(std::uint32_t version) {
  using namespace dyn::mesh;
  static const std::string libraries = std::string("qhull ") + qh_version2;
  static const Module module = {module_version, sizeof(Module), hull, free_hull, libraries.c_str()};
  return version == module_version ? &module : nullptr;
}
