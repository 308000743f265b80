// Dual numbers x + e d, e^2 = 0: a value and its derivative along one direction.
#pragma once

#include <cmath>
#include <compare>

#include "base/portable.hpp"
#include "spatial/mat3.hpp"

namespace dyn {

template <class T>
struct Dual {
  T x, d;
  Dual() = default;
  constexpr Dual(T value, T derivative = T(0)) : x(value), d(derivative) {}

  friend Dual operator+(Dual a, Dual b) { return {a.x + b.x, a.d + b.d}; }
  friend Dual operator-(Dual a, Dual b) { return {a.x - b.x, a.d - b.d}; }
  friend Dual operator*(Dual a, Dual b) { return {a.x * b.x, a.x * b.d + a.d * b.x}; }
  friend Dual operator/(Dual a, Dual b) { return {a.x / b.x, (a.d - a.x / b.x * b.d) / b.x}; }
  friend Dual operator-(Dual a) { return {-a.x, -a.d}; }
  friend Dual& operator+=(Dual& a, Dual b) { return a = a + b; }
  friend auto operator<=>(Dual a, Dual b) { return a.x <=> b.x; }
  friend bool operator==(Dual a, Dual b) { return a.x == b.x; }

  friend Dual abs(Dual a) { return a.x < T(0) ? -a : a; }
  friend Dual sqrt(Dual a) {
    const T root = std::sqrt(a.x);
    return {root, root > T(0) ? a.d / (T(2) * root) : T(0)};
  }
  friend Dual sin(Dual a) { return {math::sin(a.x), math::cos(a.x) * a.d}; }
  friend Dual cos(Dual a) { return {math::cos(a.x), -math::sin(a.x) * a.d}; }
  friend Dual atan2(Dual y, Dual x) {
    const T square = x.x * x.x + y.x * y.x;
    return {math::atan2(y.x, x.x), square > T(0) ? (x.x * y.d - y.x * x.d) / square : T(0)};
  }
};

template <class T>
Vec3<Dual<T>> dual(const Vec3<T>& x, const Vec3<T>& d) {
  return Vec3<Dual<T>>::make({x[0], d[0]}, {x[1], d[1]}, {x[2], d[2]});
}

}  // namespace dyn
