// Numbers of a page: typed arrays one behind another, little-endian, in base64. What refers to one is {"at": byte, "n": count,
// "as": type}.
#pragma once

#include <cstdint>

#include "../cli.hpp"

namespace cli::page {

class Pack {
 public:
  json f32(const Vector& x);
  // Rows of so many columns, in 16 bits between the least and the largest number of each column: {.., "as": "q16", "lower",
  // "step"}. Columns of step 0 never change and are left out; n counts them all the same.
  json q16(const Vector& x, std::size_t columns);
  // Indices: 16 bits where they fit.
  json indices(const std::vector<std::uint32_t>& x);
  std::string base64() const;
  std::size_t size() const { return bytes_.size(); }

 private:
  template <class T>
  json append(const std::vector<T>& x, const char* as);
  std::vector<unsigned char> bytes_;
};

}  // namespace cli::page
