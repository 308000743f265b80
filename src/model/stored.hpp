// Shapes whose numbers lie in arrays elsewhere (Hull, TriangleTree, Grid), as a model keeps them: a header without pointers, and
// where its arrays begin in two pools. T::each_array(f) names the arrays in order, each with its size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "base/types.hpp"

namespace dyn {

template <class T>
struct Stored {
  T header;
  std::uint64_t numbers, indices;
};

// Arrays of numbers begin at whole cache lines.
inline constexpr std::size_t pool_capacity(std::size_t n) { return (n + 7) & ~std::size_t(7); }

// The header with its pointers.
template <class T>
inline T view(T header, const double* numbers, const Index* indices) {
  header.each_array([&]<class X>(const X*& array, std::size_t n) {
    if constexpr (std::is_same_v<X, double>)
      array = numbers, numbers += pool_capacity(n);
    else
      array = indices, indices += n;
  });
  return header;
}

}  // namespace dyn
