// Pages of memory that a first call would wait for.
#include "simulation/data_layout.hpp"
#include "guard.hpp"

#ifdef __linux__
#include <link.h>
#endif

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr std::size_t page = 4096;  // or part of a larger one

// Reads one byte of each page, gaps between variables included.
__attribute__((no_sanitize_address)) void read(const volatile char* from, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; k += page) (void)from[k];
  if (bytes) (void)from[bytes - 1];
}
void write(volatile char* to, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; k += page) to[k] = to[k];
  if (bytes) to[bytes - 1] = to[bytes - 1];
}

__attribute__((noinline)) void touch_stack() {
  char room[128 << 10];
  write(room, sizeof room);
}

// Reads the readable segments of this library or program.
void touch_library() {
#ifdef __linux__
  dl_iterate_phdr([](dl_phdr_info* info, std::size_t, void*) {
    const auto here = reinterpret_cast<std::uintptr_t>(&touch_library);
    const auto begin = [&](const auto& segment) { return std::uintptr_t(info->dlpi_addr) + segment.p_vaddr; };
    bool ours = false;
    for (int k = 0; k < info->dlpi_phnum; ++k) {
      const auto& s = info->dlpi_phdr[k];
      ours |= s.p_type == PT_LOAD && here - begin(s) < s.p_memsz;
    }
    for (int k = 0; ours && k < info->dlpi_phnum; ++k)
      if (const auto& s = info->dlpi_phdr[k]; s.p_type == PT_LOAD && (s.p_flags & PF_R))
        read(reinterpret_cast<const char*>(begin(s)), s.p_memsz);
    return int(ours);
  }, nullptr);
#endif
}

}  // namespace

extern "C" dynStatus dyn_data_warm_up(const dynModel* model, dynData* data) {
  Call call(model, data, 0, "dyn_data_warm_up");
  if (!call) return call.status;
  read(reinterpret_cast<const char*>(&call.m()), std::size_t(call.m().bytes));
  detail::for_each_buffer<DYN_PART_ALL>(call.m(), call.d().parts, call.d(),
                                        [](auto* p, std::size_t count) { write(reinterpret_cast<char*>(p), count * sizeof *p); });
  write(reinterpret_cast<char*>(data), sizeof *data), write(reinterpret_cast<char*>(data->body), sizeof *data->body);
  touch_stack(), touch_library();
  touch_last_error();
  return DYN_OK;
}
