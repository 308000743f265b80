// Code for each number of rows that a constraint can have.
#pragma once

#include "base/types.hpp"

namespace dyn {

// Calls f.template operator()<rows>().
template <class F>
DYN_INLINE void with_row_count(Index rows, F&& f) {
  switch (rows) {
    case 1: return f.template operator()<1>();
    case 2: return f.template operator()<2>();
    case 3: return f.template operator()<3>();
    case 4: return f.template operator()<4>();
    case 5: return f.template operator()<5>();
    default: return f.template operator()<6>();
  }
}

}  // namespace dyn
