// A number with its derivatives in up to sixteen directions, which are one vector: and not inline: formulas on duals are long.
#pragma once

#include <cmath>

#include "base/types.hpp"

namespace dyn_test {

#define DYN_CALL __attribute__((noinline))

template <class T>
struct Dual {
  static constexpr int directions = 16;
  typedef T Lanes __attribute__((vector_size(directions * sizeof(T))));
  T x;
  Lanes d;

  Dual() = default;
  explicit Dual(T value) : x(value), d{} {}
  Dual(T value, const Lanes& derivatives) : x(value), d(derivatives) {}
  // the variable of direction k
  static Dual variable(T value, int k) {
    Dual a(value);
    a.d[k] = T(1);
    return a;
  }

  friend DYN_CALL Dual operator+(const Dual& a, const Dual& b) { return {a.x + b.x, a.d + b.d}; }
  friend DYN_CALL Dual operator-(const Dual& a, const Dual& b) { return {a.x - b.x, a.d - b.d}; }
  friend DYN_CALL Dual operator-(const Dual& a) { return {-a.x, -a.d}; }
  friend DYN_CALL Dual operator*(const Dual& a, const Dual& b) { return {a.x * b.x, a.d * b.x + a.x * b.d}; }
  friend DYN_CALL Dual operator/(const Dual& a, const Dual& b) {
    const T i = T(1) / b.x, q = a.x * i;
    return {q, (a.d - q * b.d) * i};
  }
  friend inline bool operator>(const Dual& a, const Dual& b) { return a.x > b.x; }
  friend inline bool operator<=(const Dual& a, const Dual& b) { return a.x <= b.x; }
  friend inline bool operator>=(const Dual& a, const Dual& b) { return a.x >= b.x; }
  friend inline bool operator!=(const Dual& a, const Dual& b) { return a.x != b.x; }
  friend inline Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T s = sqrt(a.x);
    return {s, a.d * (T(1) / (T(2) * s))};
  }
  friend inline Dual atan2(const Dual& y, const Dual& x) {
    using std::atan2;
    return {atan2(y.x, x.x), (x.x * y.d - y.x * x.d) * (T(1) / (x.x * x.x + y.x * y.x))};
  }
  // the divisor is a constant
  friend inline Dual remainder(const Dual& a, const Dual& b) {
    using std::remainder;
    return {remainder(a.x, b.x), a.d};
  }
};

#undef DYN_CALL

}  // namespace dyn_test
