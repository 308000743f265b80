// Tests of the printf of boards against the C library's.
#include "base/format.hpp"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <cstdio>
#include <string>

#include "short_message.hpp"

namespace {

std::string formatted(std::size_t size, const char* format, ...) {
  char text[256];
  va_list args;
  va_start(args, format);
  dyn::Format(text, size).write(format, args);
  va_end(args);
  return text;
}
template <class... Args>
void expect_as_printf(const char* format, Args... args) {
  char text[256];
  std::snprintf(text, sizeof text, format, args...);
  EXPECT_EQ(text, formatted(256, format, args...));
}

TEST(Format, IntegersAndTextsAreAsByPrintf) {
  for (const int n : {0, 7, -7, 10, 65535, 65536, INT_MAX, INT_MIN})
    expect_as_printf("%d of %d", n, 3), expect_as_printf("%x %u", unsigned(n), unsigned(n));
  for (const long long n : {0LL, -1LL, 4294967296LL, 1000000000000LL, LLONG_MAX, LLONG_MIN})
    expect_as_printf("%lld|%llx|%llu", n, static_cast<unsigned long long>(n), static_cast<unsigned long long>(n));
  expect_as_printf("%zu %td", std::size_t(1) << 40, std::ptrdiff_t(-5));
  expect_as_printf("%s: joint '%.5s' is %s%%", "dyn_rnea", "shoulder", "");
}

TEST(Format, NumbersAreAsByPrintf) {
  // of two numbers of six digits that are as near, printf takes the even one
  for (const double x : {0.0, 1.0, -1.0, 0.5, 1e-3, 1e-4, 1.5e-5, 123456.0, 1234567.0, 999999.6, 9.9999996, 1e100, -2.5e-300,
                         1.7976931348623157e308, 5e-324, 0.1, 100.0, 3.14159265358979})
    expect_as_printf("%g|%.3g|%.9g", x, x, x);
  expect_as_printf("%g %g %g", NAN, HUGE_VAL, -HUGE_VAL);
}

TEST(Format, ATextWithoutRoomIsCut) {
  EXPECT_EQ("dyn", formatted(4, "%s", "dyn_rnea"));
  EXPECT_EQ("", formatted(1, "%d", 5));
  EXPECT_EQ("12 ", formatted(4, "%d %g", 12, 3.0));
}

TEST(Format, AFormatThatEndsEarlyIsSafe) {
  EXPECT_EQ("a", formatted(256, "a%"));
  EXPECT_EQ("a", formatted(256, "a%."));
}

template <class... Args>
std::string short_message(Args... args) {
  return formatted(256, dyn::capi::format_of_values<Args...>.data(), args...);
}

TEST(Format, AShortMessageIsTheValuesOfAMessage) {
  const char* const function = "dyn_rnea";
  EXPECT_EQ("dyn_rnea q 2 NaN", short_message(function, "q", 2, "NaN"));
  EXPECT_EQ("-1 7 4294967296 -4294967296 1 0.25", short_message(-1, 7u, std::uint64_t(1) << 32, -4294967296LL, true, 0.25));
  enum Colour : std::uint16_t { red = 3 };
  EXPECT_EQ("3", short_message(red));
}

}  // namespace
