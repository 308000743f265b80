// The boundary: handles and argument checks, once for all functions of dyn.h. host.hpp has what boards do without.
#pragma once

#include <atomic>
#include <cstdint>

#include "dyn.h"
#include "algorithm/declarations.hpp"
#include "base/floating_point.hpp"
#include "base/simd_memory.hpp"
#include "model/dynb.hpp"
#include "structs.hpp"
#include "table/enums.hpp"

namespace dyn::capi {

// Makes the thread's place for it.
void touch_last_error();

inline constexpr std::uint64_t live_data = 0x617461646d6e7964u, live_builder = 0x726c6475626e7964u,
                               live_batch = 0x68637461626e7964u, live_mesh = 0x6873656d6e7964u,
                               live_broad_phase = 0x64616f72626e7964u, live_contact_solver = 0x746e6f63626e7964u,
                               live_planner = 0x6e616c706e7964u;
inline constexpr std::uint64_t freed = 0x6465657266u;

// Sums of 0 times each of x[0 .. n-1]: zero where all are finite.
inline Double4 zero_times(const double* x, std::ptrdiff_t n) {
  using P = Simd<double, block_lanes>;
  constexpr Index w = block_lanes;
  Double4 sum =
      n >= 4 ? Double4::load(x + n - 4) * 0.0 : load_partial(x, int(n)) * 0.0;  // 0 times what is not finite is not a number
  std::ptrdiff_t i = 0;
  if (n >= 4 * w) {
    P a = P::zero(), b = a, c = a, d = a;
    for (; i + 4 * w <= n; i += 4 * w)
      a = a + P::load(x + i) * 0.0, b = b + P::load(x + i + w) * 0.0, c = c + P::load(x + i + 2 * w) * 0.0,
      d = d + P::load(x + i + 3 * w) * 0.0;
    a = (a + b) + (c + d);
    sum = sum + slice4<0>(a) + slice4<w - 4>(a);
  }
  for (; i + 4 < n; i += 4) sum = sum + Double4::load(x + i) * 0.0;
  return sum;
}
inline bool all_zero(const Double4& sum) { return (sum[0] + sum[1]) + (sum[2] + sum[3]) == 0; }

// The number of x[0 .. n-1] up to the first one that is not finite: n when all are.
inline std::ptrdiff_t finite_count(const double* x, std::ptrdiff_t n) {
#if DYN_SIMD  // elsewhere many at once are no faster, and much code
  if (all_zero(zero_times(x, n))) return n;
#endif
  for (std::ptrdiff_t i = 0; i < n; ++i)
    if (!(x[i] * 0.0 == 0)) return i;
  return n;
}

// Whether one of x[0 .. n-1] is 2^exponent or more in size, or not finite.
inline bool any_beyond(const double* x, std::ptrdiff_t n, int exponent) {
  const std::int64_t limit = std::int64_t(1023 + exponent) << 52;
  std::int64_t found = 0;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    std::int64_t bits;
    __builtin_memcpy(&bits, x + i, 8);
    found |= std::int64_t((bits & 0x7fffffffffffffff) >= limit);
  }
  return found;
}

}  // namespace dyn::capi

// The handles; a model's is in model/dynb.hpp. Freed ones are recognised: handles.hpp. They are small, for freed ones stay.
namespace dyn::capi {
// Lies in front of the data's buffers.
struct DataBody {
  std::uint64_t model_id;
  std::uint64_t counter;  // of versions
  std::size_t bytes;      // to be given back; 0: in the caller's memory
  std::atomic<int> busy;
  bool stepping;          // d has the effects of steps (switch_effects)
  Data<double> d;
};
}  // namespace dyn::capi
struct dynData {
  std::uint64_t magic;
  dyn::capi::DataBody* body;
};

namespace dyn {
class Builder;
}
struct dynBuilder {
  std::uint64_t magic;
  dyn::Builder* b;
};

namespace dyn::capi {
class Batch;
}
struct dynBatch {
  std::uint64_t magic;
  dyn::capi::Batch* b;
};

namespace dyn::meshes {
struct Mesh;
}
struct dynMesh {
  std::uint64_t magic;
  const dyn::meshes::Mesh* m;
};

namespace dyn::collision {
class BroadPhase;
}
struct dynBroadPhase {
  std::uint64_t magic;
  dyn::collision::BroadPhase* b;
  void* memory;  // of b and its arrays
};

namespace dyn::solver {
struct Workspace;
}
struct dynContactSolver {
  std::uint64_t magic;
  dyn::solver::Workspace* w;
  void* memory;  // of w and its arrays, from the heap; nullptr: w and this handle are in the caller's memory
};

namespace dyn::plan {
struct Planner;
}
struct dynPlanner {
  std::uint64_t magic;
  dyn::plan::Planner* p;
  void* memory;  // of p and its arrays, from the heap; nullptr: p and this handle are in the caller's memory
};

namespace dyn::capi {

// An error unless index is one of count. what it is of: "sensor".
dynStatus check_index(const char* function, const char* what, int index, Index count);

dynStatus no_model(const dynModel* model);
inline dynStatus check(const dynModel* model) { return model && model->magic == live_model ? DYN_OK : no_model(model); }
dynStatus check(const dynBuilder* builder);
dynStatus check(const dynBatch* batch);
dynStatus check(const dynMesh* mesh);
dynStatus check(const dynBroadPhase* broad_phase);
dynStatus check(const dynContactSolver* solver);
dynStatus check(const dynPlanner* planner);

// The number of a named configuration, or -1 with the error set.
Index find_configuration(const Model& m, const char* name);
// Name of the highest of some parts, without DYN_PART_.
const char* name_of_part(dynParts part);
// One call on a model and its data: checks the handles and the part; in checked builds that no other thread is in.
class Call {
  DefaultFloatingPoint settings;

 public:
  Call(const dynModel* model, dynData* data, dynParts part, const char* function_) : function(function_) {
#if !DYN_CHECKED
    if (model && data && model->magic == live_model && data->magic == live_data && data->body->model_id == model->m->id &&
        (data->body->d.parts & part) == part) [[likely]] {
      model_ = model->m.get(), body = data->body;
      if (body->stepping && (part & ~dynParts(DYN_PART_SIMULATION))) [[unlikely]] have_effects_of(false);
      return;
    }
#endif
    enter(model, data, part);
  }
  ~Call() {
#if DYN_CHECKED
    if (entered) body->busy.store(0, std::memory_order_release);
#endif
  }
  Call(const Call&) = delete;

  dynStatus status = DYN_OK;
  const char* const function;
  explicit operator bool() const { return status == DYN_OK; }

  const Model& m() const { return *model_; }
  Data<double>& d() const { return body->d; }

  // Checks the given inputs, then sets them: all or none. nullptr: the held value stays.
  bool inputs(const double* q, const double* v, const double* a, const double* tau);
  // An argument that is not held.
  bool finite(const char* name, const double* x, Index n, Index first = 0) {
    if (status != DYN_OK || !x) return status == DYN_OK;
    const Index k = first + Index(finite_count(x + first, n - first));
    return k >= n || not_finite(name, x, k);
  }
  bool nonzero(const double* q);
  bool required(const char* name, const void* p, std::ptrdiff_t n = 1) {  // an array of no numbers may be NULL
    return status == DYN_OK && (p || n <= 0 || missing(name));
  }
  bool frame(int id);
  bool joint(int id);
  bool joint_or_all(int id);  // 0: all; not a follower
  bool reference(dynReference r);
  // DYN_ERROR_STALE unless the stage is fresh.
  bool fresh(Stage stage, const char* what, const char* producer) {
    return status == DYN_OK && (d().fresh(stage) || stale(what, producer));
  }
  // A result of n numbers that must be finite: otherwise the inputs of this call are taken back.
  bool numeric(const double* x, std::ptrdiff_t n, const char* what, Stage stage);
  // After an overflow nothing that belongs to these inputs is a result. (Frame queries look for themselves.)
  void drop_results();
  // Nothing to do when no input was replaced: what was computed then belongs to the state that stays.
  void rollback();
  // Effects of steps, or of algorithms called alone. No result is of the other kind: a step leaves none, and algorithms come
  // before its state.
  void have_effects_of(bool steps);
  // The call is about to replace q and v by itself; nothing computed on the way belongs to the state it leaves.
  void begin_step();
  void end_step();
  // Around a function of the caller's that uses the data; q and v were set without their versions.
  void suspend();
  void resume();
  // The call has replaced q by its solution, where the placements are.
  void end_search();

 private:
  void remember_stamps();
  // what went wrong, if anything did
  void enter(const dynModel* model, dynData* data, dynParts part);
  bool not_finite(const char* name, const double* x, Index k);
  bool missing(const char* name);
  bool stale(const char* what, const char* producer);

  const Model* model_ = nullptr;
  DataBody* body = nullptr;
  bool entered = false;
  unsigned changed = 0;            // inputs that this call replaced
  std::uint64_t before[input_count];  // their versions
  bool stepping = false;
  std::uint64_t kinematic_stamps[3];  // what the placements, velocities and accelerations were computed for, before the call
};

inline void copy_out(const double* from, std::ptrdiff_t n, double* to) {
  if (to && n) __builtin_memcpy(to, from, std::size_t(n) * sizeof(double));  // an empty array may be nullptr
}

}  // namespace dyn::capi
