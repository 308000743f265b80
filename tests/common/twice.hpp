// Numbers of twice double's precision, each an unevaluated sum of two doubles (Dekker 1971): the references of tests where the
// compiler has nothing wider than double, as on 32-bit ARM. About 104 bits; the exponents are those of double. sin and cos take
// angles up to 1e6.
#pragma once

#include <cmath>

namespace dyn_test {

struct Twice {
  double high = 0, low = 0;

  Twice() = default;
  constexpr Twice(double x) : high(x) {}
  constexpr Twice(int x) : high(x) {}
  explicit constexpr operator double() const { return high; }

  // a + b without an error (Knuth), and where |a| >= |b| (Dekker)
  static constexpr Twice sum(double a, double b) {
    const double s = a + b, t = s - a;
    return pair(s, (a - (s - t)) + (b - t));
  }
  static constexpr Twice fast_sum(double a, double b) {
    const double s = a + b;
    return pair(s, b - (s - a));
  }
  // a b without an error: products of halves of 26 bits, where the compiler fuses nothing
  static constexpr Twice product(double a, double b) {
    const double p = a * b;
#ifdef __FP_FAST_FMA
    return pair(p, __builtin_fma(a, b, -p));
#else
    const Halves x(a), y(b);
    return pair(p, ((x.high * y.high - p) + x.high * y.low + x.low * y.high) + x.low * y.low);
#endif
  }

  constexpr Twice operator-() const { return pair(-high, -low); }
  friend constexpr Twice operator+(Twice a, Twice b) {
    const Twice s = sum(a.high, b.high), t = sum(a.low, b.low), u = fast_sum(s.high, s.low + t.high);
    return fast_sum(u.high, u.low + t.low);
  }
  friend constexpr Twice operator-(Twice a, Twice b) { return a + -b; }
  friend constexpr Twice operator*(Twice a, Twice b) {
    const Twice p = product(a.high, b.high);
    return fast_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
  }
  friend constexpr Twice operator/(Twice a, Twice b) {
    const double first = a.high / b.high;
    const Twice r = a - b * first;
    const double second = r.high / b.high;
    return fast_sum(first, second) + (r - b * second).high / b.high;
  }
  friend constexpr bool operator<(Twice a, Twice b) { return a.high < b.high || (a.high == b.high && a.low < b.low); }
  friend constexpr bool operator>(Twice a, Twice b) { return b < a; }
  friend constexpr bool operator<=(Twice a, Twice b) { return a < b || a == b; }
  friend constexpr bool operator>=(Twice a, Twice b) { return b <= a; }
  friend constexpr bool operator==(Twice a, Twice b) { return a.high == b.high && a.low == b.low; }
  friend constexpr bool operator!=(Twice a, Twice b) { return !(a == b); }

 private:
  struct Halves {
    double high, low;
    constexpr explicit Halves(double x) : high(x * 134217729.0 - (x * 134217729.0 - x)), low(x - high) {}
  };
  static constexpr Twice pair(double high, double low) {
    Twice x;
    x.high = high, x.low = low;
    return x;
  }
};

inline Twice twice_sqrt(Twice x) {  // one step of Newton from double's
  if (!(x.high > 0)) return std::sqrt(x.high);
  const double root = std::sqrt(x.high);
  return Twice::fast_sum(root, (x - Twice::product(root, root)).high / (2 * root));
}

// pi/2 and log 2, to three doubles: a multiple of the third is what a reduction by the first two loses
inline constexpr double half_pi[] = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110};
inline constexpr double log_2[] = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111};
inline Twice reduced(Twice x, double n, const double (&unit)[3]) {
  return ((x - Twice::product(n, unit[0])) - Twice::product(n, unit[1])) - Twice::product(n, unit[2]);
}

// sum of x^k / k! from k on, every step-th, with alternating signs or without
inline Twice series(Twice x, int first, int step, bool alternating) {
  Twice term = 1, sum = 0;
  for (int k = 1; k <= first; ++k) term = term * x / Twice(k);
  for (int k = first; k < 40; k += step) {
    sum = sum + term;
    for (int i = 1; i <= step; ++i) term = term * x / Twice(k + i);
    if (alternating) term = -term;
  }
  return sum;
}

inline Twice twice_exp(Twice x) {
  if (!(std::abs(x.high) < 745)) return std::exp(x.high);
  const double n = std::nearbyint(x.high / log_2[0]);
  Twice y = series(reduced(x, n, log_2), 0, 1, false);
  y.high = std::ldexp(y.high, int(n)), y.low = std::ldexp(y.low, int(n));
  return y;
}
struct Turned {
  Twice c, s;
};
inline Turned turned(Twice x) {
  const double n = std::nearbyint(x.high / half_pi[0]);
  const Twice r = reduced(x, n, half_pi), c = series(r, 0, 2, true), s = series(r, 1, 2, true);
  switch (int(std::remainder(n, 4.0)) & 3) {
    case 0: return {c, s};
    case 1: return {-s, c};
    case 2: return {-c, -s};
    default: return {s, -c};
  }
}
inline Twice twice_sin(Twice x) { return turned(x).s; }
inline Twice twice_cos(Twice x) { return turned(x).c; }
inline Twice twice_tan(Twice x) { return turned(x).s / turned(x).c; }
inline Twice twice_tanh(Twice x) {
  if (std::abs(x.high) < 0.3) {  // sinh by its series, where the difference of exponentials would cancel
    const Twice s = series(x, 1, 2, false);
    return s / twice_sqrt(Twice(1) + s * s);
  }
  const Twice e = twice_exp(x + x);
  return e.high > 1e60 ? Twice(1) : (e - Twice(1)) / (e + Twice(1));
}
inline Twice twice_atan2(Twice y, Twice x) {  // one step of Newton from double's, on the sine of what is left
  const double angle = std::atan2(y.high, x.high);
  if (!(std::abs(y.high) + std::abs(x.high) > 0)) return angle;
  const Turned t = turned(angle);
  return Twice(angle) + (y * t.c - x * t.s) / (x * t.c + y * t.s);
}
inline Twice twice_remainder(Twice x, Twice y) {
  const Twice left = x - y * Twice(std::nearbyint((x / y).high));
  const Twice half =
      y.high < 0 ? -y * Twice(0.5) : y * Twice(0.5);  // a quotient just beside a half may have been rounded to either side
  return left > half ? left - half - half : left < -half ? left + half + half : left;
}

}  // namespace dyn_test
