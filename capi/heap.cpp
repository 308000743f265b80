// Data, contact solvers and planners on the heap.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "handles.hpp"
#include "host.hpp"
#include "in_memory.hpp"
#include "model/block.hpp"
#include "simulation/data_layout.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

// The parts that take more than a gigabyte each: "; SIMULATION takes 7.1 GB; MINV takes 2.3 GB"
std::string large_parts(const Model& m, dynParts asked) {
  std::string text;
  for (dynParts part = 1; part & DYN_PART_ALL; part <<= 1) {
    const std::size_t bytes = complete_parts(m, asked) & part ? data_bytes<double>(m, part) : 0;
    if (bytes < 1000000000) continue;
    char one[80];
    std::snprintf(one, sizeof one, "; %s takes %.3g GB", name_of_part(part), 1e-9 * double(bytes));
    text += one;
  }
  return text;
}

template <class H>
void free_with_memory(H* handle) {
  free_aligned(handle->memory);
  free_handle(handle);
}
// A handle with memory of its own. init(memory, size, handle): makes one in that memory.
template <class H, class Init>
dynStatus new_with_memory(const char* function, std::size_t size, H** out, Init&& init) {
  size = (size + 63) / 64 * 64;
  void* const memory = allocate_aligned(64, size);
  H* const handle = memory ? new_handle<H>() : nullptr;
  if (!handle) return free_aligned(memory), fail(DYN_ERROR_MEMORY, "%s: out of memory", function);
  H* inner = nullptr;
  init(memory, size, &inner);
  *handle = *inner;
  handle->memory = memory;
  inner->magic = freed;
  *out = handle;
  return DYN_OK;
}

}  // namespace

void dyn::capi::free_heap(dynData* data) {
  free_zeros(data->body, data->body->bytes);
  free_handle(data);
}

void dyn::capi::free_heap(dynContactSolver* solver) { free_with_memory(solver); }
void dyn::capi::free_heap(dynPlanner* planner) { free_with_memory(planner); }

extern "C" {

dynStatus dyn_data_new(const dynModel* model, dynParts parts, dynData** data) {
  if (const dynStatus s = check(model)) return s;
  if (!data) return fail(DYN_ERROR_ARGUMENT, "dyn_data_new: data is NULL: pass the address of a dynData*");
  if (const dynStatus s = check_parts("dyn_data_new", *model->m, parts)) return s;
  return guarded([&] {
    const std::size_t bytes = body_bytes + data_bytes<double>(*model->m, parts);
    void* memory = allocate_zeros(bytes);
    if (!memory)
      return fail(DYN_ERROR_MEMORY, "dyn_data_new: no memory for %.3g GB: ask for fewer parts%s", 1e-9 * double(bytes),
                  large_parts(*model->m, parts).c_str());
    dynData* handle = new_handle<dynData>();
    if (!handle) {
      free_zeros(memory, bytes);
      return fail(DYN_ERROR_MEMORY, "dyn_data_new: out of memory");
    }
    set_up(handle, *model->m, parts, memory);
    handle->body->bytes = bytes;
    Data<double>& d = handle->body->d;
    if (bytes >= least_mapped)
      detail::for_each_buffer<DYN_PART_ALL>(*model->m, d.parts, d, []<class T>(T* p, std::size_t count) {
        if constexpr (std::is_same_v<T, double>) ask_for_large_pages(p, count * sizeof(double));  // of matrices
      });
    *data = handle;
    return DYN_OK;
  });
}

dynStatus dyn_contact_solver_new(int max_rows, dynContactSolver** solver) {
  constexpr const char* function = "dyn_contact_solver_new";
  if (const dynStatus s = check_max_rows(function, max_rows)) return s;
  if (!solver) return fail(DYN_ERROR_ARGUMENT, "%s: solver is NULL: pass the address of a dynContactSolver*", function);
  return new_with_memory(function, dyn_contact_solver_size(max_rows), solver, [&](void* memory, std::size_t size, auto** inner) {
    dyn_contact_solver_init(max_rows, memory, size, inner);
  });
}

dynStatus dyn_planner_new(const dynModel* model, int knots, dynPlanInput input, dynPlanner** planner) {
  constexpr const char* function = "dyn_planner_new";
  if (const dynStatus s = check_planner(function, model, knots, input)) return s;
  if (!planner) return fail(DYN_ERROR_ARGUMENT, "%s: planner is NULL: pass the address of a dynPlanner*", function);
  return new_with_memory(function, dyn_planner_size(model, knots, input), planner,
                         [&](void* memory, std::size_t size, auto** inner) {
                           dyn_planner_init(model, knots, input, memory, size, inner);
                         });
}

}  // extern "C"
