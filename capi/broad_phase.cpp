// The broad phase: handle and thin wrappers.
#include "collision/broad/broad_phase.hpp"

#include <cmath>
#include <cstdlib>
#include <new>

#include "base/aligned.hpp"
#include "collision.hpp"
#include "handles.hpp"

using namespace dyn;
using namespace dyn::capi;
using collision::BroadPhase;
using shape::Bounds;

namespace {

constexpr int max_boxes = 1 << 24;
constexpr std::int64_t max_pairs = std::int64_t(1) << 30;

dynStatus read_box(const char* function, const double* lower, const double* upper, Bounds& out) {
  if (!lower || !upper) return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, lower ? "upper" : "lower");
  for (int i = 0; i < 3; ++i) {
    if (std::isnan(lower[i]) || std::isnan(upper[i]))
      return fail(DYN_ERROR_NONFINITE, "%s: %s[%d] is not a number", function, std::isnan(lower[i]) ? "lower" : "upper", i);
    if (!(lower[i] <= upper[i]))
      return fail(DYN_ERROR_INVALID, "%s: lower[%d] = %g is above upper[%d] = %g", function, i, lower[i], i, upper[i]);
  }
  out = {load3(lower), load3(upper)};
  return DYN_OK;
}

dynStatus check_id(const char* function, const BroadPhase& b, int id) {
  return b.has(id) ? DYN_OK : fail(DYN_ERROR_ARGUMENT, "%s: there is no box %d", function, id);
}

// Ids as they come, sorted in the end.
struct Ids {
  int* ids;
  int capacity, count = 0;
  void operator()(Index id) {
    if (count < capacity) ids[count] = int(id);
    ++count;
  }
  void finish(int* out) {
    std::sort(ids, ids + std::min(count, capacity));
    *out = count;
  }
};

dynStatus check_ids(const char* function, const int* ids, int capacity, const int* count) {
  if (const dynStatus s = check_capacity(function, capacity)) return s;
  if (!count || (!ids && capacity > 0))
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, count ? "ids" : "count");
  return DYN_OK;
}

}  // namespace

extern "C" {

dynStatus dyn_broad_phase_new(int capacity, int64_t pair_capacity, double margin, dynBroadPhase** broad_phase) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_new";
  if (!broad_phase) return fail(DYN_ERROR_ARGUMENT, "%s: broad_phase is NULL: pass the address of a dynBroadPhase*", function);
  if (capacity < 1 || capacity > max_boxes)
    return fail(DYN_ERROR_LIMIT, "%s: capacity is %d: give a number from 1 to %d", function, capacity, max_boxes);
  if (pair_capacity < 1 || pair_capacity > max_pairs)
    return fail(DYN_ERROR_LIMIT, "%s: pair_capacity is %lld: give a number from 1 to %lld", function,
                static_cast<long long>(pair_capacity), static_cast<long long>(max_pairs));
  if (const dynStatus s = check_margin(function, margin)) return s;
  constexpr std::size_t head = (sizeof(BroadPhase) + 63) / 64 * 64;
  void* memory = allocate_aligned(64, head + BroadPhase::bytes(capacity, std::ptrdiff_t(pair_capacity)));
  dynBroadPhase* h = memory ? new_handle<dynBroadPhase>() : nullptr;
  if (!h) return free_aligned(memory), fail(DYN_ERROR_MEMORY, "%s: out of memory", function);
  h->memory = memory;
  h->b = new (memory) BroadPhase(capacity, std::ptrdiff_t(pair_capacity), margin, static_cast<char*>(memory) + head);
  h->magic = live_broad_phase;
  *broad_phase = h;
  return DYN_OK;
}

void dyn_broad_phase_free(dynBroadPhase* broad_phase) {
  if (!broad_phase || broad_phase->magic != live_broad_phase) return;
  free_aligned(broad_phase->memory);
  free_handle(broad_phase);
}

dynStatus dyn_broad_phase_insert(dynBroadPhase* broad_phase, const double* lower, const double* upper, int* id) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_insert";
  if (const dynStatus s = check(broad_phase)) return s;
  Bounds box;
  if (const dynStatus s = read_box(function, lower, upper, box)) return s;
  if (!id) return fail(DYN_ERROR_ARGUMENT, "%s: id is NULL: it is required", function);
  const Index given = broad_phase->b->insert(box);
  if (given < 0)
    return fail(DYN_ERROR_LIMIT, "%s: all %d boxes are in use: make the broad phase with a larger capacity", function,
                int(broad_phase->b->count()));
  *id = int(given);
  return DYN_OK;
}

dynStatus dyn_broad_phase_update(dynBroadPhase* broad_phase, int id, const double* lower, const double* upper) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_update";
  if (const dynStatus s = check(broad_phase)) return s;
  Bounds box;
  if (const dynStatus s = check_id(function, *broad_phase->b, id)) return s;
  if (const dynStatus s = read_box(function, lower, upper, box)) return s;
  broad_phase->b->update(id, box);
  return DYN_OK;
}

dynStatus dyn_broad_phase_remove(dynBroadPhase* broad_phase, int id) {
  if (const dynStatus s = check(broad_phase)) return s;
  if (const dynStatus s = check_id("dyn_broad_phase_remove", *broad_phase->b, id)) return s;
  broad_phase->b->remove(id);
  return DYN_OK;
}

dynStatus dyn_broad_phase_pairs(dynBroadPhase* broad_phase, int* pairs, int64_t capacity, int64_t* count) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_pairs";
  if (const dynStatus s = check(broad_phase)) return s;
  if (capacity < 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: capacity is %lld: it can't be negative", function, static_cast<long long>(capacity));
  if (!count || (!pairs && capacity > 0))
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, count ? "pairs" : "count");
  std::int64_t found = 0;
  const bool all = broad_phase->b->pairs([&](Index a, Index b) {
    if (found < capacity) pairs[2 * found] = int(a), pairs[2 * found + 1] = int(b);
    ++found;
  });
  if (!all)
    return fail(DYN_ERROR_LIMIT, "%s: %lld overlaps, room for %lld: make the broad phase with a larger pair_capacity", function,
                static_cast<long long>(broad_phase->b->candidates()), static_cast<long long>(broad_phase->b->pair_capacity()));
  *count = found;
  return DYN_OK;
}

dynStatus dyn_broad_phase_query(dynBroadPhase* broad_phase, const double* lower, const double* upper, int* ids, int capacity,
                                int* count) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_query";
  if (const dynStatus s = check(broad_phase)) return s;
  Bounds box;
  if (const dynStatus s = read_box(function, lower, upper, box)) return s;
  if (const dynStatus s = check_ids(function, ids, capacity, count)) return s;
  Ids found{ids, capacity};
  broad_phase->b->query(box, [&](Index id) { found(id); });
  found.finish(count);
  return DYN_OK;
}

dynStatus dyn_broad_phase_ray(dynBroadPhase* broad_phase, const double* origin, const double* direction, double max_t, int* ids,
                              int capacity, int* count) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_broad_phase_ray";
  if (const dynStatus s = check(broad_phase)) return s;
  if (!origin || !direction)
    return fail(DYN_ERROR_ARGUMENT, "%s: %s is NULL: it is required", function, origin ? "direction" : "origin");
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(origin[i]) || !std::isfinite(direction[i]))
      return fail(DYN_ERROR_NONFINITE, "%s: origin or direction has no finite component %d", function, i);
  if (!(max_t >= 0))
    return fail(std::isnan(max_t) ? DYN_ERROR_NONFINITE : DYN_ERROR_ARGUMENT, "%s: max_t is %g: give a number from 0", function,
                max_t);
  if (const dynStatus s = check_ids(function, ids, capacity, count)) return s;
  Ids found{ids, capacity};
  broad_phase->b->ray(load3(origin), load3(direction), max_t, [&](Index id) { found(id); });
  found.finish(count);
  return DYN_OK;
}

}  // extern "C"
