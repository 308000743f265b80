// After fdlibm (Sun Microsystems: e_exp.c, e_log.c, s_atan.c, e_atan2.c: coefficients) and, for tanh, Cephes (Moshier).
#include "base/portable.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/sincos.hpp"

// what is added to be subtracted again must not be fused with a product before it
#ifdef __clang__
#pragma clang fp contract(off)
#else
#pragma GCC optimize("fp-contract=off")
#endif

namespace dyn {

namespace {

// 2/pi, binary, most significant first
constexpr std::uint32_t two_over_pi[] = {
    0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab, 0xdebbc561, 0xb7246e3a, 0x424dd2e0,
    0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484, 0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4,
    0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f, 0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d,
    0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab, 0xf0cfbc20, 0x9af4361d,
};

// 2^k within the normal numbers. (std::ldexp of a C library for boards brings the state of errno along: a kilobyte of RAM.)
double power_of_two(int k) { return std::bit_cast<double>(std::uint64_t(1023 + k) << 52); }

// x = (4 n + quadrant) pi/2 + r + y for any finite x: the product of its 53 bits with those 256 of 2/pi that are not multiples of
// 4 (Payne and Hanek 1983), as integers.
int reduce_far(double x, double& r, double& y) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(std::fabs(x));  // of a number that is large
  const std::uint64_t mantissa = (bits & 0xfffffffffffffu) | std::uint64_t(1) << 52;
  const int exponent = int(bits >> 52) - 1022;
  const int first = exponent - 53 - 2;  // |x| = mantissa 2^(exponent - 53); bits of 2/pi with a weight of 2^-(first + 1) and less
  constexpr int words = 8;
  std::uint32_t product[words] = {};  // least significant first; its two highest bits count quadrants
  std::uint32_t window[words];
  for (int k = 0; k < words; ++k) {
    const int bit = first + 32 * (words - 1 - k);
    const auto word = [&](int i) { return i >= 0 ? two_over_pi[i] : 0u; };
    const int whole = bit >= 0 ? bit / 32 : -((31 - bit) / 32), rest = bit - 32 * whole;
    window[k] = rest ? word(whole) << rest | word(whole + 1) >> (32 - rest) : word(whole);
  }
  for (int half = 0; half < 2; ++half) {
    const std::uint64_t factor = half ? mantissa >> 32 : mantissa & 0xffffffffu;
    std::uint64_t carry = 0;
    for (int k = 0; k + half < words; ++k) {
      carry += window[k] * factor + product[k + half];
      product[k + half] = std::uint32_t(carry), carry >>= 32;
    }
  }
  int quadrant = int(product[words - 1] >> 30);
  // the fraction, to the nearest quadrant
  const bool up = product[words - 1] >> 29 & 1u;
  quadrant += up;
  product[words - 1] &= 0x3fffffffu;
  if (up) {
    std::uint64_t borrow = 0;
    for (int k = 0; k < words; ++k) {
      const std::uint64_t from = k == words - 1 ? 0x40000000u : 0u, take = product[k] + borrow;
      borrow = from < take;
      product[k] = std::uint32_t(from - take);
    }
  }
  int top = words - 1;
  while (top > 4 && product[top] == 0) --top;
  double high = 0, low = 0;
  for (int k = top; k >= top - 4; --k) {
    const double word = double(product[k]) * power_of_two(32 * k - 254), sum = high + word;
    low += word - (sum - high), high = sum;
  }
  // times pi/2
  constexpr double pi_high = 0x1.921fb54442d18p+0, pi_low = 0x1.1a62633145c07p-54, split = 134217729;
  const double a = high * split, ah = a - (a - high), al = high - ah, b = pi_high * split, bh = b - (b - pi_high),
               bl = pi_high - bh, p = high * pi_high;
  const double error = ((ah * bh - p) + ah * bl + al * bh) + al * bl + (high * pi_low + low * pi_high);
  const bool negative = up != (x < 0);
  r = p + error, y = error - (r - p);
  if (negative) r = -r, y = -y;
  return x < 0 ? -quadrant : quadrant;
}

}  // namespace

namespace portable {

namespace {

// cos and sin, also of what the sweep cannot reduce
struct Turn {
  double c, s;
};
Turn turn(double x) {
  using namespace detail;
  Angles C, S;
  if (std::fabs(x) <= sweep_reach) {
    sincos_lanes(x, C, S);
  } else if (std::isfinite(x)) {
    double r, y;
    const int quadrant = reduce_far(x, r, y);
    sincos_reduced(r, y, quadrant, C, S);
  } else {
    return {x - x, x - x};
  }
  return {C[0], S[0]};
}

double atan(double x) {  // x >= 0
  constexpr double high[] = {4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01,
                             1.57079632679489655800e+00};
  constexpr double low[] = {2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17,
                            6.12323399573676603587e-17};
  constexpr double a[] = {3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
                          -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
                          6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
                          -3.65315727442169155270e-02, 1.62858201153657823623e-02};
  int k = -1;
  if (x >= 2.4375) k = 3, x = -1 / x;
  else if (x >= 1.1875) k = 2, x = (x - 1.5) / (1 + 1.5 * x);
  else if (x >= 0.6875) k = 1, x = (x - 1) / (x + 1);
  else if (x >= 0.4375) k = 0, x = (2 * x - 1) / (2 + x);
  const double z = x * x;
  double p = a[10];
  for (int i = 9; i >= 0; --i) p = a[i] + z * p;
  return k < 0 ? x - x * (z * p) : high[k] - ((x * (z * p) - low[k]) - x);
}

}  // namespace

double sin(double x) { return x == 0 ? x : turn(x).s; }
double cos(double x) { return turn(x).c; }
double tan(double x) {
  const Turn t = turn(x);
  return x == 0 ? x : t.s / t.c;
}

double atan2(double y, double x) {
  if (x != x || y != y) return x + y;
  constexpr double pi = 3.1415926535897931160e+00, pi_low = 1.2246467991473531772e-16;
  const double a = std::fabs(y), b = std::fabs(x);
  if (std::isinf(a) ? !std::isinf(b) : b == 0 && a > 0) return std::copysign(pi / 2, y);
  const double angle = std::isinf(a) ? pi / 4 : a == 0 ? 0.0 : atan(a / b);
  return std::copysign(std::signbit(x) ? pi - (angle - pi_low) : angle, y);
}

double exp(double x) {
  if (!(x < 709.782712893384)) return x > 0 ? std::numeric_limits<double>::infinity() : x;
  if (x < -745.2) return 0;
  const double k = std::floor(x * 1.44269504088896338700e+00 + 0.5);
  const double high = x - k * 6.93147180369123816490e-01, low = k * 1.90821492927058770002e-10, r = high - low, t = r * r;
  const double c = r - t * (1.66666666666666019037e-01 + t * (-2.77777777770155933842e-03 + t * (6.61375632143793436117e-05 +
                        t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
  const int half = int(k) / 2;  // in two steps: 2^k may be beyond the normal numbers, and the second step alone rounds
  return (1 - ((low - r * c / (2 - c)) - high)) * power_of_two(half) * power_of_two(int(k) - half);
}

double log(double x) {
  if (!(x > 0)) return x == 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  if (std::isinf(x)) return x;
  int k = 0;
  if (x < 0x1p-1022) x *= 0x1p54, k = -54;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  k += int(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0xfffffffffffffu) | std::uint64_t(1023) << 52);  // x = m 2^k, 1 <= m < 2
  if (m > 1.4142135623730951) m /= 2, ++k;
  const double f = m - 1, s = f / (2 + f), z = s * s, h = 0.5 * f * f;
  const double R =
      z * (6.666666666666735130e-01 +
           z * (3.999999999940941908e-01 +
                z * (2.857142874366239149e-01 +
                     z * (2.222219843214978396e-01 +
                          z * (1.818357216161805012e-01 + z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01))))));
  return k * 6.93147180369123816490e-01 - ((h - (s * (h + R) + k * 1.90821492927058770002e-10)) - f);
}

double pow(double x, double y) { return y == 0 ? 1 : exp(y * log(x)); }

double tanh(double x) {
  const double a = std::fabs(x), z = x * x;
  if (a < 0.625)
    return x + x * z * ((-9.64399179425052238628e-1 * z - 9.92877231001918586564e1) * z - 1.61468768441708447952e3) /
                   (((z + 1.12811678491632931402e2) * z + 2.23548839060100448583e3) * z + 4.84406305325125486048e3);
  return std::copysign(1 - 2 / (exp(2 * a) + 1), x);
}

double hypot(double x, double y, double z) {
  const double most = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (!(most > 0) || std::isinf(most))
    return std::isinf(x) || std::isinf(y) || std::isinf(z) ? std::numeric_limits<double>::infinity() : x + y + z;
  const double unit = std::ldexp(1.0, std::ilogb(most) < -1000 ? 1000 : -std::ilogb(most));  // a power of two: nothing is rounded
  x *= unit, y *= unit, z *= unit;
  return std::sqrt(x * x + y * y + z * z) / unit;
}
double hypot(double x, double y) { return hypot(x, y, 0.0); }

}  // namespace portable

}  // namespace dyn
