// Ascending order of a few numbers, equal ones as they come. Without branches: the order of features cannot be predicted.
#pragma once

#include "base/types.hpp"

namespace dyn::collision {

// Writes the place of each key.
template <class Key>
DYN_INLINE void ascending(const Key* key, int count, int* place) {
  for (int k = 0; k < count; ++k) {
    place[k] = 0;
    for (int i = 0; i < k; ++i) {
      const bool after = key[i] <= key[k];
      place[k] += after, place[i] += !after;
    }
  }
}

}  // namespace dyn::collision
