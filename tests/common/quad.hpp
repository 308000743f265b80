// Quadruple precision (binary128, 113 bits) as a scalar of the templates: references and differences free of double's rounding.
#pragma once

#include <cfloat>
#include <cmath>
#include <limits>

#if defined(__SIZEOF_FLOAT128__)
namespace dyn_test {
__extension__ typedef __float128 Binary128;
}
// glibc's libm has them; declared here for compilers that its headers hide them from
extern "C" {
dyn_test::Binary128 sqrtf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 sinf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 cosf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 tanf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 tanhf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 expf128(dyn_test::Binary128) noexcept;
dyn_test::Binary128 atan2f128(dyn_test::Binary128, dyn_test::Binary128) noexcept;
dyn_test::Binary128 remainderf128(dyn_test::Binary128, dyn_test::Binary128) noexcept;
}
#define DYN_TEST_QUAD(f) f##f128
#elif LDBL_MANT_DIG == DBL_MANT_DIG
#include "common/twice.hpp"
namespace dyn_test {
using Binary128 = Twice;  // 32-bit ARM has nothing wider than double
}
#define DYN_TEST_QUAD(f) twice_##f
#else
namespace dyn_test {
typedef long double Binary128;  // binary128 on 64-bit ARM
}
#define DYN_TEST_QUAD(f) f##l
#endif

namespace dyn_test {

struct Quad {
  Binary128 x;

  Quad() = default;
  constexpr Quad(double y) : x(y) {}
  constexpr Quad(int y) : x(y) {}
  constexpr Quad(Binary128 y) : x(y) {}
  explicit constexpr operator double() const { return double(x); }

#define DYN_TEST_OPERATOR(op)                                                             \
  friend constexpr Quad operator op(Quad a, Quad b) { return Quad(Binary128(a.x op b.x)); } \
  constexpr Quad& operator op##=(Quad b) {                                                \
    x = x op b.x;                                                                         \
    return *this;                                                                         \
  }
  DYN_TEST_OPERATOR(+)
  DYN_TEST_OPERATOR(-)
  DYN_TEST_OPERATOR(*)
  DYN_TEST_OPERATOR(/)
#undef DYN_TEST_OPERATOR
  constexpr Quad operator-() const { return Quad(Binary128(-x)); }
#define DYN_TEST_COMPARE(op) \
  friend constexpr bool operator op(Quad a, Quad b) { return a.x op b.x; }
  DYN_TEST_COMPARE(<)
  DYN_TEST_COMPARE(>)
  DYN_TEST_COMPARE(<=)
  DYN_TEST_COMPARE(>=)
  DYN_TEST_COMPARE(==)
  DYN_TEST_COMPARE(!=)
#undef DYN_TEST_COMPARE
};

inline Quad abs(Quad a) { return a.x < 0 ? -a : a; }
#define DYN_TEST_FUNCTION(f) \
  inline Quad f(Quad a) { return Quad(Binary128(DYN_TEST_QUAD(f)(a.x))); }
DYN_TEST_FUNCTION(sqrt)
DYN_TEST_FUNCTION(sin)
DYN_TEST_FUNCTION(cos)
DYN_TEST_FUNCTION(tan)
DYN_TEST_FUNCTION(tanh)
DYN_TEST_FUNCTION(exp)
#undef DYN_TEST_FUNCTION
inline Quad atan2(Quad y, Quad x) { return Quad(Binary128(DYN_TEST_QUAD(atan2)(y.x, x.x))); }
inline Quad remainder(Quad y, Quad x) { return Quad(Binary128(DYN_TEST_QUAD(remainder)(y.x, x.x))); }

}  // namespace dyn_test

template <>
class std::numeric_limits<dyn_test::Quad> {
 public:
  static constexpr bool is_specialized = true;
  static constexpr dyn_test::Quad epsilon() { return dyn_test::Quad(0x1p-112); }
};
