// The values of an enumeration, as the library lists them: every<dynIntegrator>("dynIntegrator").
#pragma once

#include <cstdlib>
#include <vector>

#include "dyn.h"

namespace dyn_test {

template <class E>
std::vector<E> every(const char* type) {
  dynEnumInfo info = {};
  info.struct_size = sizeof info;
  const int index = dyn_enum_id(type);
  if (dyn_enum_info(index, &info) != DYN_OK) std::abort();
  std::vector<E> out;
  for (int k = 0; k < info.count; ++k) {
    dynEnumValueInfo value = {};
    value.struct_size = sizeof value;
    if (dyn_enum_value_info(index, k, &value) != DYN_OK) std::abort();
    out.push_back(E(value.value));
  }
  return out;
}

}  // namespace dyn_test
