// Batches: handles, checks, and the sharing of states among threads.
#include "batch.hpp"
#include "host.hpp"

#include "handles.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <system_error>

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr int max_threads = 256;

// An array of the caller's, row by row; nullptr stays nullptr.
template <class T>
void advance(T*& array, std::int64_t rows, std::ptrdiff_t row_size) {
  if (array) array += rows * row_size;
}

// The sentence of an error without the name of the function that is in front.
const char* sentence(const char* error) {
  const char* colon = std::strchr(error, ':');
  return std::strncmp(error, "dyn_", 4) == 0 && colon && !std::memchr(error, ' ', std::size_t(colon - error)) ? colon + 2 : error;
}

// Drops results of the state before. Reusing them would change the rounding of some algorithms.
void forget(dynData* data) { data->body->d.version[input_q] = ++data->body->counter; }

// Whether it is the numbers of one state that are at fault, rather than what all states share.
bool of_one_state(dynStatus status) {
  return status == DYN_ERROR_NONFINITE || status == DYN_ERROR_QUATERNION || status == DYN_ERROR_NUMERIC;
}

}  // namespace

dynStatus capi::place_mocaps_of(const dynModel* m, dynData* data, const double* placements) {
  for (int k = 0; k < int(m->m->n.mocaps); ++k)
    if (const dynStatus s = dyn_data_set_mocap(m, data, k, placements + 12 * k)) return s;
  return DYN_OK;
}

void Batch::Worker::failed(std::int64_t k, dynStatus s) {
  if (failures++) return;
  first = k, status = s;
  std::snprintf(message, sizeof message, "%s", sentence(dyn_last_error()));
  constexpr std::string_view maker = "dyn_data_new";  // at the end: of the error that asks for a part
  if (const std::string_view said = message; s == DYN_ERROR_PART && said.ends_with(maker))
    std::snprintf(message + said.size() - maker.size(), 14, "dyn_batch_new");
}

struct Batch::Job {
  const Batch& batch;
  const BatchAlgorithm& algorithm;
  const std::int64_t n, share;
  dynBatchArrays first;  // row 0
  BatchStrides stride;
  const dynAlgorithm number;
  bool in_lanes;
  dynBatchArrays read;  // in lanes: without inputs that the algorithm does not read
  alignas(64) std::atomic<std::int64_t> next{0};

  Job(const Batch& of, const BatchAlgorithm& x, std::int64_t count, const dynBatchArrays& arrays)
      : batch(of),
        algorithm(x),
        n(count),
        share(share_of(count, of.threads)),
        first(arrays),
        number(dynAlgorithm(&x - batch_algorithms)) {
    auto or_zeros = [&](const double*& p) {
      if (p) return std::ptrdiff_t(batch.sizes.nv);
      p = batch.zeros.data();
      return std::ptrdiff_t(0);
    };
    stride.v = or_zeros(first.v), stride.a = or_zeros(first.a), stride.tau = or_zeros(first.tau),
    stride.b = std::ptrdiff_t(batch.sizes.nv);
    for (int k = 0; k < 4; ++k) {
      stride.out[k] = algorithm.outputs[k].name ? algorithm.outputs[k].extent(batch.sizes).size() : 0;
    }
    read = first;
    for (const auto& [name, array] : {std::pair{"v", &read.v}, {"a", &read.a}, {"tau", &read.tau}, {"fext", &read.fext}})
      if (!algorithm.reads(name)) *array = nullptr;
    in_lanes = !first.exact && batch.lanes_apply && frame_is_valid() && !first.mocap &&
               Lanes::has(*batch.handle->m, number, batch.datas[0]->body->d.parts);
  }
  // So small that the last ones end together.
  static std::int64_t share_of(std::int64_t n, int threads) {
    const std::int64_t most = std::clamp<std::int64_t>(n / (32 * threads), 1, 64), width = Lanes::width();
    return (most + width - 1) / width * width;
  }
  // Lanes have them in their initial placements.
  const double* mocap(std::int64_t k) const {
    const Model& m = *batch.handle->m;
    const std::ptrdiff_t size = 12 * std::ptrdiff_t(m.n.mocaps);
    return first.mocap ? first.mocap + k * size : m.configuration_mocaps() + m.simulation()->initial * size;
  }
  // Errors that are no state's own are those of single calls.
  bool frame_is_valid() const {
    return number != DYN_ALGORITHM_FRAME_PLACEMENT || (first.frame >= 0 && first.frame < batch.sizes.nframes);
  }

  dynBatchArrays row(std::int64_t k) const {
    dynBatchArrays x = first;
    advance(x.q, k, batch.sizes.nq), advance(x.q1, k, batch.sizes.nq), advance(x.v, k, stride.v),
        advance(x.a, k, stride.a), advance(x.tau, k, stride.tau), advance(x.b, k, stride.b);
    advance(x.fext, k, 6 * std::ptrdiff_t(batch.sizes.njoints));
    for (int o = 0; o < 4; ++o) advance(x.out[o], k, stride.out[o]);
    return x;
  }

  // Shares until there are none left.
  void work(int thread) {
    Worker& worker = batch.workers[std::size_t(thread)];
    dynData* data = batch.datas[std::size_t(thread)].get();
    const auto compute = [&](std::int64_t k) {
      forget(data);
      dynStatus status = place_mocaps_of(batch.handle, data, mocap(k));
      if (status == DYN_OK) status = algorithm.call(batch.handle, data, row(k));
      if (first.status) first.status[k] = status;
      if (status != DYN_OK) worker.failed(k, status);
    };
    for (std::int64_t begin; (begin = next.fetch_add(share, std::memory_order_relaxed)) < n;) {
      const std::int64_t end = std::min(begin + share, n);
      for (std::int64_t k = begin; !in_lanes && k < end; ++k) compute(k);
      for (std::int64_t k = begin; in_lanes && k < end; k += Lanes::width()) {
        const int count = int(std::min<std::int64_t>(Lanes::width(), end - k));
        const unsigned done = batch.lanes[std::size_t(thread)].run(number, read, k, count, stride);
        for (int l = 0; l < count; ++l) {
          if (!(done >> l & 1u)) compute(k + l);  // with its error
          else if (first.status) first.status[k + l] = DYN_OK;
        }
      }
    }
  }
};

dynStatus Batch::Turn::take(const char* function) {
  if (const dynStatus s = check(batch.handle)) return s;
  if (batch.handle->m->id != batch.model_id)
    return fail(DYN_ERROR_MODEL, "%s: the batch's model was freed: it must live as long as the batch", function);
  if (batch.busy.exchange(true, std::memory_order_acquire))
    return fail(DYN_ERROR_BUSY, "%s: another thread is using this batch: give each thread its own", function);
  return DYN_OK;
}

Batch::Batch(const dynModel* model, dynParts parts, int count)
    : handle(model),
      model_id(model->m->id),
      sizes(*model->m),
      threads(count),
      zeros(std::size_t(sizes.nv)),
      accelerations(new double[std::size_t(count) * std::size_t(sizes.nv)]),
      workers(new Worker[std::size_t(count)]),
      pool(count) {
  for (int k = 0; k < count; ++k) {
    dynData* data = nullptr;
    if (const dynStatus s = dyn_data_new(model, parts, &data)) throw Error(s, dyn_last_error());
    datas.emplace_back(data);
  }
  const bool any = std::any_of(batch_algorithms, batch_algorithms + batch_algorithm_count, [&](const BatchAlgorithm& a) {
    return Lanes::has(*model->m, dynAlgorithm(&a - batch_algorithms), datas[0]->body->d.parts);
  });
  for (int k = 0; any && k < count; ++k) lanes.emplace_back(*model->m, datas[0]->body->d.parts);
  set_effects_of_lanes();
  if (parts == 0 || (parts & DYN_PART_SIMULATION)) {
    fresh.resize(dyn_model_state_size(model));
    if (const dynStatus s = dyn_data_save_state(model, datas[0].get(), fresh.data(), fresh.size()))
      throw Error(s, dyn_last_error());
  }
}

void Batch::set_effects_of_lanes() {
  for (Lanes& l : lanes) lanes_apply = l.set_effects(datas[0]->body->d);
}

dynStatus Batch::set_effects(int joint, std::uint32_t effects) {
  const Turn turn(*this, "dyn_batch_set_effects");
  if (turn.status != DYN_OK) return turn.status;
  for (const auto& data : datas)
    if (const dynStatus s = dyn_data_set_effects(handle, data.get(), joint, effects)) return s;  // the first one, if any
  set_effects_of_lanes();
  return DYN_OK;
}

dynStatus Batch::run(const BatchAlgorithm& algorithm, std::int64_t n, const dynBatchArrays& arrays) {
  const Turn turn(*this, "dyn_batch_run");
  if (turn.status != DYN_OK) return turn.status;
  Job job(*this, algorithm, n, arrays);
  char where[80];
  std::snprintf(where, sizeof where, "dyn_batch_run: %s: ", algorithm.name);
  return work(job, n, where, "state");
}

dynStatus Batch::first_failure(std::int64_t n, const char* where, const char* what) const {
  const Worker* bad = nullptr;
  std::int64_t failures = 0;
  for (int t = 0; t < threads; ++t) {
    const Worker& w = workers[std::size_t(t)];
    failures += w.failures;
    if (w.failures && (!bad || w.first < bad->first)) bad = &w;
  }
  if (!bad) return DYN_OK;
  if (!of_one_state(bad->status)) return fail(bad->status, "%s%s", where, bad->message);
  return fail(bad->status, "%s%s %lld: %s (%lld of %lld %ss failed)", where, what, static_cast<long long>(bad->first),
              bad->message, static_cast<long long>(failures), static_cast<long long>(n), what);
}

template <>
dynBatchArrays capi::defaults() {
  return {};
}

extern "C" {

dynStatus dyn_batch_new(const dynModel* model, dynParts parts, int threads, dynBatch** batch) {
  if (const dynStatus s = check(model)) return s;
  if (!batch) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_new: batch is NULL: pass the address of a dynBatch*");
  if (threads < 1) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_new: threads is %d: at least one is needed, the caller's", threads);
  if (threads > max_threads) return fail(DYN_ERROR_LIMIT, "dyn_batch_new: threads is %d: the limit is %d", threads, max_threads);
  return guarded([&] {
    try {
      auto made = std::make_unique<Batch>(model, parts, threads);
      dynBatch* h = new_handle<dynBatch>();
      if (!h) return fail(DYN_ERROR_MEMORY, "dyn_batch_new: out of memory");
      h->b = made.release();
      h->magic = live_batch;
      *batch = h;
      return DYN_OK;
    } catch (const std::system_error&) {
      return fail(DYN_ERROR_LIMIT, "dyn_batch_new: the system does not start %d threads: ask for fewer", threads - 1);
    }
  });
}

void dyn_batch_free(dynBatch* batch) {
  if (!batch || batch->magic != live_batch) return;
  delete batch->b;
  batch->b = nullptr;
  free_handle(batch);
}

dynStatus dyn_batch_set_effects(dynBatch* batch, int joint, uint32_t effects) {
  if (const dynStatus s = check(batch)) return s;
  return batch->b->set_effects(joint, effects);
}

dynStatus dyn_batch_run(dynBatch* batch, dynAlgorithm algorithm, int64_t n, const dynBatchArrays* given) {
  const DefaultFloatingPoint settings;
  if (const dynStatus s = check(batch)) return s;
  if (const dynStatus s = check_value(algorithm, "dyn_batch_run", "algorithm")) return s;
  const BatchAlgorithm& row = batch_algorithms[raw(algorithm)];
  if (!given) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: arrays is NULL: it is required");
  const Given<dynBatchArrays> arrays("dyn_batch_run", given);
  if (arrays.status != DYN_OK) return arrays.status;
  if (n < 0 || n > max_records)
    return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: n is %lld: give a number of states from 0 to %lld", static_cast<long long>(n),
                static_cast<long long>(max_records));
  if (n == 0) return DYN_OK;
  if (!arrays->q) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: %s: q is NULL: it is required", row.name);
  if (!arrays->b && row.reads("b")) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: %s: b is NULL: it is required", row.name);
  if (!arrays->q1 && row.reads("q1")) return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: %s: q1 is NULL: it is required", row.name);
  bool wanted = false;
  for (int k = 0; k < row.output_count(); ++k) wanted |= arrays->out[k] != nullptr;
  if (!wanted)
    return fail(DYN_ERROR_ARGUMENT, "dyn_batch_run: %s: out[0] to out[%d] are NULL: one at least is required", row.name,
                row.output_count() - 1);
  return batch->b->run(row, n, *arrays);
}

dynStatus dyn_algorithm_run(const dynModel* model, dynData* data, dynAlgorithm algorithm, const dynBatchArrays* arrays) {
  if (const dynStatus s = check_value(algorithm, "dyn_algorithm_run", "algorithm")) return s;
  if (!arrays) return fail(DYN_ERROR_ARGUMENT, "dyn_algorithm_run: arrays is NULL: it is required");
  if (arrays->struct_size < sizeof(dynBatchArrays))
    return fail(DYN_ERROR_SIZE, "dyn_algorithm_run: struct_size is %u, needs %zu: call dyn_batch_arrays_init",
                arrays->struct_size, sizeof(dynBatchArrays));
  if (arrays->mocap) {
    if (const dynStatus s = check(model)) return s;
    if (const dynStatus s = place_mocaps_of(model, data, arrays->mocap)) return s;
  }
  return batch_algorithms[raw(algorithm)].call(model, data, *arrays);
}

dynStatus dyn_algorithm_info(const dynModel* model, dynAlgorithm algorithm, dynAlgorithmInfo* info) {
  if (model)
    if (const dynStatus s = check(model)) return s;
  if (const dynStatus s = check_value(algorithm, "dyn_algorithm_info", "algorithm")) return s;
  if (const dynStatus s = check_struct("dyn_algorithm_info", "info", info)) return s;
  const BatchAlgorithm& row = batch_algorithms[raw(algorithm)];
  dynAlgorithmInfo out{};
  out.name = row.name, out.inputs = row.inputs, out.outputs = row.output_count(), out.part = row.part,
  out.precondition = row.precondition;
  for (int k = 0; k < out.outputs; ++k) {
    const Extent extent = row.outputs[k].extent(model ? Sizes(*model->m) : Sizes());
    out.output[k] = row.outputs[k].name, out.rows[k] = extent.rows, out.cols[k] = extent.cols, out.pages[k] = extent.pages;
  }
  write_struct(out, info);
  return DYN_OK;
}

}  // extern "C"
