// Batches: the table of what they compute, and the work of one call.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "batch_lanes.hpp"
#include "guard.hpp"
#include "thread_pool.hpp"

namespace dyn::capi {

// Largest number of states or records: the address of the last one must exist. 64-bit: 4 GiB each. 32-bit: one number each.
constexpr std::int64_t max_records = std::min<std::int64_t>(
    std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::ptrdiff_t>::max() / std::int64_t(sizeof(double)));

struct Sizes {
  int nq = 0, nv = 0, njoints = 0, nframes = 0, nparameters = 0, ntendons = 0, nsensordata = 0;
  Sizes() = default;
  explicit Sizes(const Model& m)
      : nq(m.n.nq),
        nv(m.n.nv),
        njoints(m.n.joints),
        nframes(m.n.frames),
        nparameters(int(parameter_count(m))),
        ntendons(m.n.tendons),
        nsensordata(int(m.n.sensor_values)) {}
};

struct Extent {
  int rows, cols, pages = 1;
  std::ptrdiff_t size() const { return std::ptrdiff_t(rows) * cols * pages; }
};

struct BatchOutput {
  const char* name;
  Extent (*extent)(const Sizes&);
};

struct BatchAlgorithm {
  const char* name;
  const char* inputs;  // their names
  dynParts part;
  const char* precondition;  // calls that are made first
  BatchOutput outputs[4];
  // One state: the arrays are its rows.
  dynStatus (*call)(const dynModel*, dynData*, const dynBatchArrays&);

  int output_count() const;
  bool reads(const char* input) const;  // a word of inputs
};

constexpr int batch_algorithm_count = Members<dynAlgorithm>::count;
extern const BatchAlgorithm batch_algorithms[batch_algorithm_count];

// Places all mocap bodies, 12 numbers each.
dynStatus place_mocaps_of(const dynModel* m, dynData* data, const double* placements);

// A data for each thread.
class Batch {
 public:
  Batch(const dynModel* model, dynParts parts, int threads);
  dynStatus set_effects(int joint, std::uint32_t effects);
  dynStatus run(const BatchAlgorithm& algorithm, std::int64_t n, const dynBatchArrays& arrays);
  dynStatus rollout(std::int64_t n, const dynRollout& rollout);

 private:
  // The first failure of one thread in a call.
  struct alignas(64) Worker {
    std::int64_t failures, first;
    dynStatus status;
    char message[1024];

    void failed(std::int64_t k, dynStatus s);
  };
  struct Job;
  struct Rollout;
  struct Turn;
  // With several threads where n rows are worth waking them; then the first failure. Rows are called `what`, the message begins
  // with `where`.
  template <class J>
  dynStatus work(J& job, std::int64_t n, const char* where, const char* what);
  void set_effects_of_lanes();
  dynStatus first_failure(std::int64_t n, const char* where, const char* what) const;
  struct Free {
    void operator()(dynData* d) const { dyn_data_free(d); }
  };

  const dynModel* const handle;
  const std::uint64_t model_id;
  const Sizes sizes;
  const int threads;
  std::vector<std::unique_ptr<dynData, Free>> datas;
  mutable std::vector<Lanes> lanes;  // one for each thread; empty in large models
  bool lanes_apply = false;          // under the effects that are chosen
  std::vector<double> zeros;
  std::vector<char> fresh;  // the state of new data, where it can step
  std::unique_ptr<double[]> accelerations;  // nv for each thread: what rollouts' sensors read
  std::unique_ptr<Worker[]> workers;
  std::atomic<bool> busy{false};
  ThreadPool pool;  // the last member: its threads end before the others go
};

// One thread at a time uses the batch, and while its model lives.
struct Batch::Turn {
  Batch& batch;
  const dynStatus status;
  Turn(Batch& b, const char* function) : batch(b), status(take(function)) {}
  ~Turn() {
    if (status == DYN_OK) batch.busy.store(false, std::memory_order_release);
  }
  Turn(const Turn&) = delete;

 private:
  dynStatus take(const char* function);
};

template <class J>
dynStatus Batch::work(J& job, std::int64_t n, const char* where, const char* what) {
  for (int t = 0; t < threads; ++t) workers[std::size_t(t)].failures = 0;
  auto of_thread = [](void* j, int thread) { static_cast<J*>(j)->work(thread); };
  if (threads == 1 || n <= job.share) of_thread(&job, 0);
  else pool.run(of_thread, &job);
  return first_failure(n, where, what);
}

}  // namespace dyn::capi
