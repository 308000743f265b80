// Batches in lanes: several states side by side, one in each lane (base/lane.hpp).
#pragma once

#include <cstdint>
#include <memory>

#include "guard.hpp"

namespace dyn::capi {

// Sizes of the rows of dynBatchArrays; 0: all states read the same zeros.
struct BatchStrides {
  std::ptrdiff_t v, a, tau, b, out[4];
};

// The data of one thread. A state's results depend on nothing but the state: each lane does the same whatever is in the others.
class Lanes {
 public:
  // Which algorithms it has depends on the size: in large models lanes no longer fit the cache.
  static bool has(const Model& m, dynAlgorithm algorithm, dynParts parts);

  Lanes(const Model& m, dynParts parts);
  Lanes(Lanes&&) noexcept;
  ~Lanes();
  // As of the data that computes single states. Returns false where effects branch by the state, so that lanes do not have them.
  bool set_effects(const Data<double>& single);
  // States first .. first + count - 1 of the arrays, whose rows have the sizes `stride`; count is at most `width()`. Inputs that
  // are NULL are zeros. Returns bits of the states that were computed. The others have no finite result, or inputs for which an
  // algorithm branches.
  unsigned run(dynAlgorithm algorithm, const dynBatchArrays& x, std::int64_t first, int count, const BatchStrides& stride);
  static int width();

  struct State;

 private:
  std::unique_ptr<State> s;
};

}  // namespace dyn::capi
