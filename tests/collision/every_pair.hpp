// Pairs of convex shapes but two half-spaces, for tests that run once a pair.
#pragma once

#include "collision/scene.hpp"

namespace dyn_test {

inline std::vector<std::pair<Type, Type>> pairs() {
  std::vector<std::pair<Type, Type>> p;
  for (int a = 0; a < shape::type_count; ++a)
    for (int b = std::max(a, 1); b < shape::type_count; ++b) p.push_back({Type(a), Type(b)});
  return p;
}
inline std::string pair_name(const testing::TestParamInfo<std::pair<Type, Type>>& info) {
  return std::string(name_of(info.param.first)) + "_" + name_of(info.param.second);
}

}  // namespace dyn_test
