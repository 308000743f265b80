// Smoothed projections onto bounds and onto second-order cones that are their own duals, |t| <= n, and their derivatives:
//   P(z) = sum g(z_i) e_i,  g(z) = (z + sqrt(z^2 + 4 eps^2)) / 2
// over the spectral decomposition of z (Chen and Harker 1993; Kanzow 1996; Fukushima, Luo and Tseng 2002).
// S: double, or several cones in lanes.
#pragma once

#include "base/simd.hpp"
#include "solver/block.hpp"

namespace dyn::solver {

struct Smoothed {
  double eps;

  template <class S>
  struct Value {
    S value, slope, root;
  };
  // (normal, along t / |t|); d normal / d n = d along / d |t|: own; d normal / d |t|: mixed; along / |t|: across
  template <class S, int rows>
  struct Projected {
    S direction[rows - 1];
    S normal, along, own, mixed, across;
  };

  template <class S>
  DYN_INLINE Value<S> plus(S z) const {
    using std::sqrt;
    const S root = sqrt(z * z + S(4 * eps * eps));
    return {(z + root) * S(0.5), (S(1.0) + z / root) * S(0.5), root};
  }
  Value<double> bounded(double z, double lower, double upper) const {
    Value<double> out{z, 1, 0};
    if (!std::isinf(lower)) out = plus(z - lower), out.value += lower;
    if (!std::isinf(upper)) {
      const Value<double> above = plus(z - upper);
      out.value -= above.value, out.slope -= above.slope;
    }
    return out;
  }
  template <int rows, class S>
  DYN_INLINE Projected<S, rows> cone(const S* z) const {
    using std::sqrt;
    Projected<S, rows> out;
    S square = z[1] * z[1];
    for (int i = 2; i < rows; ++i) square = square + z[i] * z[i];
    const S length = sqrt(square);
    const Value<S> low = plus(z[0] - length), high = plus(z[0] + length);
    for (int i = 1; i < rows; ++i) out.direction[i - 1] = choose(length > S(0.0), z[i] / length, S(double(i == 1)));
    out.across = (S(1.0) + S(2.0) * z[0] / (low.root + high.root)) * S(0.5);  // (g(high) - g(low)) / (high - low)
    out.normal = (low.value + high.value) * S(0.5), out.along = out.across * length;
    out.own = (high.slope + low.slope) * S(0.5), out.mixed = (high.slope - low.slope) * S(0.5);
    return out;
  }

 private:
  static DYN_INLINE double choose(bool first, double a, double b) { return first ? a : b; }
  template <class T, int N>
  static DYN_INLINE Simd<T, N> choose(const typename Simd<T, N>::Mask& first, const Simd<T, N>& a, const Simd<T, N>& b) {
    return select(first, a, b);
  }
};

}  // namespace dyn::solver
