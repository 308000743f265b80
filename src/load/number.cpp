#include "number.hpp"

#include <charconv>
#include <cmath>

namespace dyn::load {

namespace {

constexpr std::string_view spaces = " \t\r\n";

// Returns whether an out-of-range number is too small (read as zero) rather than too large.
bool underflows(std::string_view token) {
  const size_t e = token.find_first_of("eE");
  if (e != std::string_view::npos) return token.substr(e + 1).starts_with('-');
  return token.substr(0, token.find('.')).find_first_of("123456789") == std::string_view::npos;
}

std::string why(std::string_view token) {
  if (token.find("${") != token.npos || token.find("$(") != token.npos) return "is a xacro expression: run xacro first";
  if (token.find(',') != token.npos) return "is not a number: write a point as decimal sign, and spaces between numbers";
  return "is not a number";
}

}  // namespace

std::string parse_number(std::string_view token, double& value) {
  std::string_view digits = token;
  if (digits.starts_with('+')) {
    digits.remove_prefix(1);
    if (digits.starts_with('-')) return why(token);
  }
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) return why(token);
  if (error == std::errc::result_out_of_range) {
    if (!underflows(digits)) return "is too large for a double";
    value = 0;
  }
  if (!std::isfinite(value))
    return std::isnan(value) || digits.find_first_of("0123456789") == digits.npos ? "is not finite" : "is too large for a double";
  return "";
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (size_t at = text.find_first_not_of(spaces); at != text.npos;) {
    const size_t end = std::min(text.find_first_of(spaces, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(spaces, end);
  }
  return parts;
}

}  // namespace dyn::load
