// An array of the caller's structs that begin with struct_size, which may be shorter or longer than this library's.
#pragma once

#include <cstddef>

#include "base/types.hpp"

namespace dyn {

template <class S>
struct StructArray {
  const S* first;
  Index count;
  S (*defaults)();
  const S* at(Index k) const {
    return reinterpret_cast<const S*>(reinterpret_cast<const char*>(first) + std::ptrdiff_t(k) * first->struct_size);
  }
  S operator[](Index k) const {
    if (first->struct_size == sizeof(S)) [[likely]] return first[k];
    S s = defaults();
    __builtin_memcpy(static_cast<void*>(&s), at(k), first->struct_size < sizeof s ? first->struct_size : sizeof s);
    return s;
  }
};

}  // namespace dyn
