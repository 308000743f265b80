// Text to double, independent of the locale.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dyn::load {

// The whole token must be one finite decimal number. Returns "" or the error.
std::string parse_number(std::string_view token, double& value);
// Splits at spaces, tabs and line ends.
std::vector<std::string_view> split(std::string_view text);

}  // namespace dyn::load
