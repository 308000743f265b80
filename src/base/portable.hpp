// Elementary functions made of additions, multiplications, divisions and roots alone, which IEEE 754 rounds in one way: the same
// bits on every machine and compiler, where those of the C library differ between its versions, and between processors under one
// version. Builds with DYN_REPRODUCIBLE take these, and boards without an operating system do (DYN_PORTABLE: they are smaller);
// others those of the C library: by the names of dyn::math.
#pragma once

#include <cmath>
#include <concepts>

namespace dyn::portable {

// All within one unit in the last place or two, of any argument; pow (x > 0) loses what is in |y log x|.
double sin(double x);
double cos(double x);
double tan(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double pow(double x, double y);
double tanh(double x);
double hypot(double x, double y);
double hypot(double x, double y, double z);

}  // namespace dyn::portable

namespace dyn::math {

#if DYN_REPRODUCIBLE || DYN_PORTABLE
#define DYN_FROM(function)                                                       \
  using portable::function;                                                      \
  template <std::floating_point T, std::same_as<T>... U>                         \
    requires(!std::same_as<T, double>)                                           \
  T function(T x, U... others) {                                                 \
    return std::function(x, others...);                                          \
  }
#else
#define DYN_FROM(function) using std::function;
#endif
DYN_FROM(sin) DYN_FROM(cos) DYN_FROM(tan) DYN_FROM(atan2) DYN_FROM(exp) DYN_FROM(log) DYN_FROM(pow) DYN_FROM(tanh) DYN_FROM(hypot)
#undef DYN_FROM

}  // namespace dyn::math
