// JSON as values, for glTF. Checked as it is read: depth, number of values, numbers that are finite.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "report.hpp"

namespace dyn::load {

struct Json {
  enum class Kind { Null, Bool, Number, String, Array, Object };
  Kind kind = Kind::Null;
  double number = 0;  // of a Bool: 0 or 1
  std::string text;
  std::vector<Json> items;        // of an Object: its values
  std::vector<std::string> keys;  // of an Object

  // The value of a key, or null. The first of equals.
  const Json* find(std::string_view key) const;
};

// Throws DYN_ERROR_PARSE with the line, or DYN_ERROR_LIMIT.
Json parse_json(std::string_view text, const Report& report);

}  // namespace dyn::load
