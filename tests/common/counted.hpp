// A scalar of the templates that counts what is computed with it: the cost of an algorithm without a clock.
#pragma once

#include <cmath>
#include <limits>

namespace dyn_test {

struct Counted {
  double x;
  static inline long operations = 0;

  Counted() = default;
  constexpr Counted(double y) : x(y) {}
  constexpr Counted(int y) : x(y) {}
  explicit constexpr operator double() const { return x; }

#define DYN_TEST_OPERATOR(op)                        \
  friend Counted operator op(Counted a, Counted b) { \
    ++operations;                                    \
    return Counted(a.x op b.x);                      \
  }                                                  \
  Counted& operator op##=(Counted b) {               \
    ++operations;                                    \
    x = x op b.x;                                    \
    return *this;                                    \
  }
  DYN_TEST_OPERATOR(+)
  DYN_TEST_OPERATOR(-)
  DYN_TEST_OPERATOR(*)
  DYN_TEST_OPERATOR(/)
#undef DYN_TEST_OPERATOR
  constexpr Counted operator-() const { return Counted(-x); }
#define DYN_TEST_COMPARE(op) \
  friend constexpr bool operator op(Counted a, Counted b) { return a.x op b.x; }
  DYN_TEST_COMPARE(<)
  DYN_TEST_COMPARE(>)
  DYN_TEST_COMPARE(<=)
  DYN_TEST_COMPARE(>=)
  DYN_TEST_COMPARE(==)
  DYN_TEST_COMPARE(!=)
#undef DYN_TEST_COMPARE
};

inline Counted abs(Counted a) { return std::abs(a.x); }
#define DYN_TEST_FUNCTION(f)      \
  inline Counted f(Counted a) {   \
    ++Counted::operations;        \
    return Counted(std::f(a.x));  \
  }
DYN_TEST_FUNCTION(sqrt)
DYN_TEST_FUNCTION(sin)
DYN_TEST_FUNCTION(cos)
DYN_TEST_FUNCTION(tan)
DYN_TEST_FUNCTION(exp)
DYN_TEST_FUNCTION(tanh)
#undef DYN_TEST_FUNCTION
inline Counted atan2(Counted y, Counted x) { return ++Counted::operations, Counted(std::atan2(y.x, x.x)); }
inline Counted remainder(Counted y, Counted x) { return ++Counted::operations, Counted(std::remainder(y.x, x.x)); }

}  // namespace dyn_test

template <>
class std::numeric_limits<dyn_test::Counted> {
 public:
  static constexpr bool is_specialized = true;
  static constexpr dyn_test::Counted epsilon() { return dyn_test::Counted(0x1p-52); }
};
