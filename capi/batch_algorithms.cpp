// Algorithms of batches: one row for each value of dynAlgorithm, made of its comment and its function's prototype
// (src/table/algorithms.py).
#include <cstring>

#include "batch.hpp"

namespace dyn::capi {

namespace {

// What one state calls: what dyn.h describes, but for those below.
using OneState = dynStatus (*)(const dynModel*, dynData*, const dynBatchArrays&);
template <dynAlgorithm>
constexpr OneState one_state(OneState described) { return described; }

// The velocity and the acceleration are read for what they move alone.
template <>
constexpr OneState one_state<DYN_ALGORITHM_COM>(OneState) {
  return [](const dynModel* m, dynData* d, const dynBatchArrays& x) {
    const bool moving = x.out[1] || x.out[2];
    return dyn_com(m, d, x.q, moving ? x.v : nullptr, moving ? x.a : nullptr, x.out[0], x.out[1], x.out[2]);
  };
}

dynStatus step_one(const dynModel* m, dynData* d, const dynBatchArrays& x) {
  dynStatus status = dyn_data_set_state(m, d, x.q, x.v, nullptr, x.tau);
  dynStepOptions options;
  dyn_step_options_init(&options);
  options.integrator = x.integrator, options.dt = x.dt;
  if (status == DYN_OK) status = dyn_data_set_step_options(m, d, &options);
  if (status == DYN_OK) status = dyn_step(m, d);
  if (status == DYN_OK) copy_out(d->body->d.q, m->m->n.nq, x.out[0]), copy_out(d->body->d.v, m->m->n.nv, x.out[1]);
  return status;
}
template <>
constexpr OneState one_state<DYN_ALGORITHM_STEP>(OneState) { return step_one; }

}  // namespace

const BatchAlgorithm batch_algorithms[batch_algorithm_count] = {
#include "table/algorithms.inc"
};

int BatchAlgorithm::output_count() const {
  int count = 0;
  while (count < 4 && outputs[count].name) ++count;
  return count;
}

bool BatchAlgorithm::reads(const char* input) const {
  const std::size_t length = std::strlen(input);
  for (const char* word = inputs; *word;) {
    const std::size_t n = std::strcspn(word, " ");
    if (n == length && std::strncmp(word, input, n) == 0) return true;
    word += n + (word[n] == ' ');
  }
  return false;
}

}  // namespace dyn::capi
