// Lane: the numbers of several states side by side, one in each lane, as one scalar of the templates. An algorithm on lanes does
// for each state what it does for any other, so that a state's results depend on nothing but the state.
// A comparison holds where it holds for all lanes. Templates for lanes therefore branch only on what is alike for all ordinary
// states, and choose by min and max elsewhere.
#pragma once

#include "base/scalar.hpp"
#include "base/sincos.hpp"

namespace dyn {

struct Lane {
  static constexpr int count = register_lanes;
  using Numbers = Simd<double, count>;
  Numbers x;

  Lane() = default;
  DYN_INLINE Lane(double a) : x(a) {}
  DYN_INLINE Lane(int a) : x(double(a)) {}
  DYN_INLINE Lane(Numbers a) : x(a) {}
  explicit DYN_INLINE operator double() const { return x[0]; }

#define DYN_LANE_OPERATOR(op)                                                         \
  friend DYN_INLINE Lane operator op(const Lane& a, const Lane& b) { return a.x op b.x; } \
  DYN_INLINE Lane& operator op##=(const Lane& b) { return *this = *this op b; }
  DYN_LANE_OPERATOR(+)
  DYN_LANE_OPERATOR(-)
  DYN_LANE_OPERATOR(*)
  DYN_LANE_OPERATOR(/)
#undef DYN_LANE_OPERATOR
  DYN_INLINE Lane operator-() const { return -x; }
#define DYN_LANE_COMPARE(op) \
  friend DYN_INLINE bool operator op(const Lane& a, const Lane& b) { return all(a.x op b.x); }
  DYN_LANE_COMPARE(<)
  DYN_LANE_COMPARE(>)
  DYN_LANE_COMPARE(<=)
  DYN_LANE_COMPARE(>=)
  DYN_LANE_COMPARE(==)
  DYN_LANE_COMPARE(!=)
#undef DYN_LANE_COMPARE
  friend DYN_INLINE Lane min(const Lane& a, const Lane& b) { return min(a.x, b.x); }
  friend DYN_INLINE Lane max(const Lane& a, const Lane& b) { return max(a.x, b.x); }
  friend DYN_INLINE Lane abs(const Lane& a) { return abs(a.x); }
  friend DYN_INLINE Lane sqrt(const Lane& a) { return sqrt(a.x); }

  // What algorithms call rarely: lane by lane.
#define DYN_LANE_FUNCTION(f)                                               \
  friend inline Lane f(const Lane& a) {                                    \
    Lane b;                                                                \
    for (int k = 0; k < count; ++k) b.x.set(k, math::f(a.x[k]));           \
    return b;                                                              \
  }
  DYN_LANE_FUNCTION(sin)
  DYN_LANE_FUNCTION(cos)
  DYN_LANE_FUNCTION(exp)
  DYN_LANE_FUNCTION(tanh)
#undef DYN_LANE_FUNCTION
  friend inline Lane atan2(const Lane& y, const Lane& x) {
    Lane b;
    for (int k = 0; k < count; ++k) b.x.set(k, math::atan2(y.x[k], x.x[k]));
    return b;
  }
};

template <>
inline constexpr bool branches_by_state<Lane> = false;

template <>
inline void sincos_sweep(const Lane* x, Index n, Lane* c, Lane* s) {
  sincos_sweep(reinterpret_cast<const double*>(x), n * Lane::count, reinterpret_cast<double*>(c), reinterpret_cast<double*>(s));
}

}  // namespace dyn
