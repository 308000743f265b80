// Batches: the table of what they compute, and the work of one call.
#pragma once

#include <memory>
#include <vector>

#include "guard.hpp"
#include "thread_pool.hpp"

namespace dyn::capi {

struct Sizes {
  int nq = 0, nv = 0, njoints = 0, nframes = 0, nparameters = 0;
  Sizes() = default;
  explicit Sizes(const Model& m)
      : nq(m.n.nq), nv(m.n.nv), njoints(m.n.joints), nframes(m.n.frames), nparameters(int(parameter_count(m))) {}
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
  BatchOutput outputs[4];
  // One state: the arrays are its rows.
  dynStatus (*call)(const dynModel*, dynData*, const dynBatchArrays&);

  int output_count() const;
  bool reads(const char* input) const;  // a word of inputs
};

constexpr int batch_algorithm_count = DYN_BATCH_STEP + 1;
extern const BatchAlgorithm batch_algorithms[batch_algorithm_count];

// A data for each thread.
class Batch {
 public:
  Batch(const dynModel* model, dynParts parts, int threads);
  dynStatus set_effects(int joint, std::uint32_t effects);
  dynStatus run(const BatchAlgorithm& algorithm, std::int64_t n, const dynBatchArrays& arrays);

 private:
  struct Worker;
  struct Job;
  struct Turn;
  struct Free {
    void operator()(dynData* d) const { dyn_data_free(d); }
  };

  const dynModel* const handle;
  const std::uint64_t model_id;
  const Sizes sizes;
  const int threads;
  std::vector<std::unique_ptr<dynData, Free>> datas;
  std::vector<double> zeros;
  std::unique_ptr<Worker[]> workers;
  std::atomic<bool> busy{false};
  ThreadPool pool;  // the last member: its threads end before the others go
};

}  // namespace dyn::capi
