// The values of an enumeration, as the library describes them.
#pragma once

#include <gtest/gtest.h>

#include "dyn.h"

namespace dyn_test {

// f(value) for each of an enumeration
template <class F>
void each_value(const char* type, F&& f) {
  dynEnumInfo info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(dyn_enum_info(dyn_enum_id(type), &info), DYN_OK);
  for (int k = 0; k < info.count; ++k) {
    dynEnumValueInfo value = {};
    value.struct_size = sizeof value;
    ASSERT_EQ(dyn_enum_value_info(dyn_enum_id(type), k, &value), DYN_OK);
    SCOPED_TRACE(value.identifier);
    f(value);
  }
}

}  // namespace dyn_test
