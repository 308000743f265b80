// Text by a format. On boards by the part of printf that messages use: without a heap, without a locale, a kilobyte of code.
// %s %d %u %x %g and %%, with z, t and ll before an integer, and a precision: letters of a text, or digits of a number
// (9 at most).
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#if !DYN_NO_HOST
#include <cstdio>
#endif

namespace dyn {

class Format {
 public:
  // A text that has no room is cut. size is 1 or more.
  Format(char* to, std::size_t size) : at(to), end(to + size - 1) { *at = 0; }

  void write(const char* format, va_list given) {
    va_copy(args, given);  // where it is an array, a parameter of its type is none
    for (; *format; ++format) {
      if (*format != '%') letter(*format);
      else if (*++format == '%') letter('%');
      else format = item(format);
    }
    va_end(args);
    *at = 0;
  }

 private:
  const char* item(const char* format) {
    int precision = -1;
    if (*format == '.')
      for (precision = 0; *++format >= '0' && *format <= '9';) precision = 10 * precision + (*format - '0');
    char size = 0;
    for (; *format == 'l' || *format == 'z' || *format == 't'; ++format) size = *format;
    switch (*format) {
      case 's': text(va_arg(args, const char*), precision); break;
      case 'd': {
        const std::int64_t n = size == 'l' ? va_arg(args, long long) : size ? va_arg(args, std::ptrdiff_t) : va_arg(args, int);
        if (n < 0) letter('-');
        natural(n < 0 ? 0 - std::uint64_t(n) : std::uint64_t(n), 10);
        break;
      }
      case 'u':
      case 'x':
        natural(size == 'l' ? va_arg(args, unsigned long long) : size ? va_arg(args, std::size_t) : va_arg(args, unsigned),
                *format == 'x' ? 16 : 10);
        break;
      case 'g': number(va_arg(args, double), precision < 0 ? 6 : precision < 9 ? precision : 9); break;
      default: return format - 1;  // ends at the end of the format
    }
    return format;
  }
  void letter(char c) {
    if (at < end) *at++ = c;
  }
  void text(const char* s, int most) {
    for (; *s && most != 0; ++s, --most) letter(*s);
  }
  void natural(std::uint64_t n, unsigned base) {
    char digits[20];
    int count = 0;
    do {
      std::uint32_t rest = 0;  // by halves of a word: boards need no division of 64 bits for this
      for (int k = 48; k >= 0; k -= 16) {
        const std::uint32_t part = rest << 16 | (std::uint32_t(n >> k) & 0xffff);
        n = (n & ~(std::uint64_t(0xffff) << k)) | std::uint64_t(part / base) << k, rest = part % base;
      }
      digits[count++] = "0123456789abcdef"[rest];
    } while (n);
    while (count) letter(digits[--count]);
  }
  void number(double x, int most) {
    if (x != x) return text("nan", -1);
    if (x < 0) letter('-'), x = -x;
    if (x > 1.7976931348623157e308) return text("inf", -1);
    if (x == 0) return letter('0');
    int exponent = 0;
    for (; x >= 10; x /= 10) ++exponent;
    for (; x < 1; x *= 10) --exponent;
    std::uint32_t unit = 1;
    for (int k = 1; k < most; ++k) unit *= 10;
    std::uint32_t n = std::uint32_t(x * unit + 0.5);  // digits, the first one at unit
    if (n >= 10 * unit) n /= 10, ++exponent;
    const bool scientific = exponent < -4 || exponent >= most;
    int before = scientific ? 1 : exponent + 1;  // digits in front of the point
    if (before <= 0) {
      text("0.", -1);
      for (int k = before; k < 0; ++k) letter('0');
    }
    for (; n || before > 0; unit /= 10) {
      letter(char('0' + n / unit)), n %= unit;
      if (--before == 0 && n) letter('.');
    }
    if (!scientific) return;
    letter('e'), letter(exponent < 0 ? '-' : '+');
    const unsigned size = unsigned(exponent < 0 ? -exponent : exponent);
    if (size < 10) letter('0');
    natural(size, 10);
  }

  char *at, *const end;
  va_list args;
};

inline void vwrite_text(char* to, std::size_t size, const char* format, va_list given) {
#if DYN_NO_HOST
  Format(to, size).write(format, given);
#else
  std::vsnprintf(to, size, format, given);
#endif
}
__attribute__((format(printf, 3, 4))) inline void write_text(char* to, std::size_t size, const char* format, ...) {
  va_list given;
  va_start(given, format);
  vwrite_text(to, size, format, given);
  va_end(given);
}

}  // namespace dyn
