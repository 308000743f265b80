// Parts of the C++ library that Emscripten 3.1.6 (libc++ 13) lacks. Compiled into every file for WebAssembly.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <type_traits>
#include <strings.h>

#if defined(__cplusplus) && _LIBCPP_VERSION < 14000
namespace std {

template <class To, class From>
  requires(sizeof(To) == sizeof(From) && is_trivially_copyable_v<To> && is_trivially_copyable_v<From>)
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

// The number's end as from_chars finds it: digits with at most one point and one exponent, inf or nan, and neither space nor plus in front.
inline const char* end_of_number(const char* p, const char* last) {
  const auto digits = [&] {
    const char* const first = p;
    while (p < last && *p >= '0' && *p <= '9') ++p;
    return p - first;
  };
  const char* const first = p;
  if (p < last && *p == '-') ++p;
  for (const char* word : {"infinity", "inf", "nan"})
    if (size_t(last - p) >= strlen(word) && strncasecmp(p, word, strlen(word)) == 0) return p + strlen(word);
  ptrdiff_t count = digits();
  if (p < last && *p == '.') ++p, count += digits();
  if (!count) return first;
  const char* const mantissa = p;
  if (p < last && (*p == 'e' || *p == 'E')) {
    ++p;
    if (p < last && (*p == '-' || *p == '+')) ++p;
    if (!digits()) return mantissa;
  }
  return p;
}

template <class T>
  requires is_floating_point_v<T>
from_chars_result from_chars(const char* first, const char* last, T& value) {
  const char* const end = end_of_number(first, last);
  if (end == first) return {first, errc::invalid_argument};
  const string text(first, end);
  errno = 0;
  const T x = is_same_v<T, float> ? T(strtof(text.c_str(), nullptr)) : T(strtod(text.c_str(), nullptr));
  if (errno == ERANGE) return {end, errc::result_out_of_range};
  value = x;
  return {end, errc()};
}

inline to_chars_result copy_chars(char* first, char* last, const char* text, int size) {
  if (size > last - first) return {last, errc::value_too_large};
  return {static_cast<char*>(memcpy(first, text, size_t(size))) + size, errc()};
}
// The fewest digits that are read as x.
template <class T>
  requires is_floating_point_v<T>
to_chars_result to_chars(char* first, char* last, T x) {
  char text[32];
  int size = 0;
  for (int digits = 1; digits <= 17; ++digits) {
    size = snprintf(text, sizeof text, "%.*g", digits, double(x));
    if ((is_same_v<T, float> ? T(strtof(text, nullptr)) : T(strtod(text, nullptr))) == x || x != x) break;
  }
  return copy_chars(first, last, text, size);
}
inline to_chars_result to_chars(char* first, char* last, double x, chars_format, int digits) {
  char text[400];
  return copy_chars(first, last, text, snprintf(text, sizeof text, "%.*g", digits, x));
}

}  // namespace std
#endif
