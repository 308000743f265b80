// A struct that begins with struct_size, made for one call: with<dynIkOutput>({0, q, nullptr, &result}).
#pragma once

namespace dyn_test {

template <class S>
const S* with(S&& s) {
  s.struct_size = sizeof(S);
  return &s;
}

}  // namespace dyn_test
