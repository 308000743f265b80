// Short messages of boards: the values of a message without its sentence, "dyn_rnea q 2 NaN". A message without values is kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace dyn::capi {

// printf's format of the values (format.hpp), separated by blanks.
template <class... Args>
constexpr auto values_format() {
  const auto item = []<class T>(std::type_identity<T>) -> const char* {
    if constexpr (std::is_floating_point_v<T>)
      return "%g";
    else if constexpr (!std::is_integral_v<T> && !std::is_enum_v<T>)
      return "%s";
    else if constexpr (sizeof(T) == 8)
      return std::is_signed_v<T> ? "%lld" : "%llu";
    else
      return std::is_signed_v<T> ? "%d" : "%u";
  };
  std::array<char, 5 * sizeof...(Args) + 1> text{};
  std::size_t at = 0;
  const auto append = [&](const char* s) {
    if (at) text[at++] = ' ';
    while (*s) text[at++] = *s++;
  };
  (append(item(std::type_identity<Args>())), ...);
  return text;
}
template <class... Args>
inline constexpr auto format_of_values = values_format<Args...>();

}  // namespace dyn::capi
