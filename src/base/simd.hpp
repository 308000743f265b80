// Simd<T, N>: N numbers side by side, called lanes. An operation acts on each lane by itself. It takes one instruction where the
// machine has it. Only simd*.hpp know how lanes are stored: as one vector of the compiler, as two halves, or as plain numbers.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/types.hpp"

namespace dyn {

// doubles in a register
#if defined(__AVX512F__)
inline constexpr int register_lanes = 8;
#elif defined(__AVX__)
inline constexpr int register_lanes = 4;
#else
inline constexpr int register_lanes = 2;
#endif

// Lanes of the widest blocks of algorithms. Sums depend on it, so reproducible builds use four everywhere.
#if defined(__AVX512F__) && !DYN_REPRODUCIBLE
inline constexpr int block_lanes = 8;
#else
inline constexpr int block_lanes = 4;
#endif

namespace detail {

// Types of which the compiler has vectors. Without SIMD (three lanes in types.hpp) all lanes are plain numbers.
template <class T>
inline constexpr bool has_vectors =
    DYN_LANES == 4 && (std::is_same_v<T, double> || std::is_same_v<T, float> || std::is_integral_v<T>);
// Whether N lanes fit a register. GCC keeps wider vectors in memory, so they lie in halves.
template <class T, int N>
inline constexpr bool is_vector = has_vectors<T> && N * int(sizeof(T)) <= 8 * register_lanes;
template <class T, int N>
inline constexpr bool is_halved = has_vectors<T> && !is_vector<T, N>;
// An integer of a mask: all bits of a lane are set, or none.
template <class T>
using LaneBits = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

}  // namespace detail

#define DYN_SIMD_OPERATORS(unary, binary, compare)                                                 \
  unary(-) unary(~) binary(+) binary(-) binary(*) binary(/) binary(&) binary(|) binary(^) binary(<<) \
  compare(<) compare(>) compare(<=) compare(>=) compare(==) compare(!=)                            \
  friend DYN_INLINE Simd& operator&=(Simd& a, const Simd& b) { return a = a & b; }                 \
  friend DYN_INLINE Simd& operator|=(Simd& a, const Simd& b) { return a = a | b; }

// As plain numbers.
template <class T, int N>
struct Simd {
  static constexpr int lanes = N;
  using Mask = Simd<detail::LaneBits<T>, N>;
  T x[N];

  Simd() = default;
  DYN_INLINE Simd(T a) {
    for (int k = 0; k < N; ++k) x[k] = a;
  }
  // one number each
  template <class... U>
    requires(N > 1 && sizeof...(U) == N)
  explicit DYN_INLINE constexpr Simd(U... a) : x{T(a)...} {}
  static DYN_INLINE Simd zero() { return Simd(T(0)); }
  // p needs no more alignment than a number has.
  static DYN_INLINE Simd load(const T* p) {
    Simd a;
    for (int k = 0; k < N; ++k) a.x[k] = p[k];
    return a;
  }
  DYN_INLINE void store(T* p) const {
    for (int k = 0; k < N; ++k) p[k] = x[k];
  }
  // N indices, as numbers
  static DYN_INLINE Simd convert(const Index* p) {
    Simd a;
    for (int k = 0; k < N; ++k) a.x[k] = T(p[k]);
    return a;
  }
  DYN_INLINE T operator[](int k) const { return x[k]; }
  DYN_INLINE void set(int k, T a) { x[k] = a; }

#define DYN_UNARY(op)                                 \
  friend DYN_INLINE Simd operator op(const Simd& a) { \
    Simd c;                                           \
    for (int k = 0; k < N; ++k) c.x[k] = op a.x[k];   \
    return c;                                         \
  }
#define DYN_BINARY(op)                                               \
  friend DYN_INLINE Simd operator op(const Simd& a, const Simd& b) { \
    Simd c;                                                          \
    for (int k = 0; k < N; ++k) c.x[k] = a.x[k] op b.x[k];           \
    return c;                                                        \
  }
#define DYN_COMPARE(op)                                              \
  friend DYN_INLINE Mask operator op(const Simd& a, const Simd& b) { \
    Mask m;                                                          \
    for (int k = 0; k < N; ++k) m.set(k, a.x[k] op b.x[k] ? -1 : 0); \
    return m;                                                        \
  }
  DYN_SIMD_OPERATORS(DYN_UNARY, DYN_BINARY, DYN_COMPARE)
#undef DYN_UNARY
#undef DYN_BINARY
#undef DYN_COMPARE
  // a in lanes where m is set, b elsewhere
  friend DYN_INLINE Simd select(const Mask& m, const Simd& a, const Simd& b) {
    Simd c;
    for (int k = 0; k < N; ++k) c.x[k] = m[k] ? a.x[k] : b.x[k];
    return c;
  }
  friend DYN_INLINE Simd min(const Simd& a, const Simd& b) { return select(a < b, a, b); }
  friend DYN_INLINE Simd max(const Simd& a, const Simd& b) { return select(a < b, b, a); }
  friend DYN_INLINE Simd abs(const Simd& a) {
    using std::abs;
    Simd c;
    for (int k = 0; k < N; ++k) c.x[k] = abs(a.x[k]);
    return c;
  }
  friend DYN_INLINE Simd sqrt(const Simd& a) {
    using std::sqrt;
    Simd c;
    for (int k = 0; k < N; ++k) c.x[k] = sqrt(a.x[k]);
    return c;
  }
};

// As one vector of the compiler.
template <class T, int N>
  requires detail::is_vector<T, N>
struct Simd<T, N> {
  static constexpr int lanes = N;
  using Mask = Simd<detail::LaneBits<T>, N>;
  typedef T Vector __attribute__((vector_size(sizeof(T) * N)));
  Vector x;

  Simd() = default;
  DYN_INLINE Simd(T a) : x(a - Vector{}) {}
  static DYN_INLINE Simd of(Vector x) {
    Simd a;
    a.x = x;
    return a;
  }
  template <class... U>
    requires(N > 1 && sizeof...(U) == N)
  explicit DYN_INLINE constexpr Simd(U... a) : x{T(a)...} {}
  static DYN_INLINE Simd zero() { return of(Vector{}); }
  static DYN_INLINE Simd load(const T* p) {
    Simd a;
    std::memcpy(&a.x, p, sizeof a.x);
    return a;
  }
  DYN_INLINE void store(T* p) const { std::memcpy(p, &x, sizeof x); }
  static DYN_INLINE Simd convert(const Index* p) { return of(__builtin_convertvector((Simd<Index, N>::load(p).x), Vector)); }
  DYN_INLINE T operator[](int k) const { return x[k]; }
  DYN_INLINE void set(int k, T a) { x[k] = a; }

#define DYN_UNARY(op) \
  friend DYN_INLINE Simd operator op(const Simd& a) { return of(op a.x); }
#define DYN_BINARY(op) \
  friend DYN_INLINE Simd operator op(const Simd& a, const Simd& b) { return of(a.x op b.x); }
#define DYN_COMPARE(op) \
  friend DYN_INLINE Mask operator op(const Simd& a, const Simd& b) { return Mask::of((typename Mask::Vector)(a.x op b.x)); }
  DYN_SIMD_OPERATORS(DYN_UNARY, DYN_BINARY, DYN_COMPARE)
#undef DYN_UNARY
#undef DYN_BINARY
#undef DYN_COMPARE
  friend DYN_INLINE Simd select(const Mask& m, const Simd& a, const Simd& b) { return of(m.x ? a.x : b.x); }
  friend DYN_INLINE Simd min(const Simd& a, const Simd& b) { return of(a.x < b.x ? a.x : b.x); }
  friend DYN_INLINE Simd max(const Simd& a, const Simd& b) { return of(a.x < b.x ? b.x : a.x); }
  friend DYN_INLINE Simd abs(const Simd& a) {
    using Bits = detail::LaneBits<T>;
    return of((Vector)((typename Mask::Vector)a.x & ~(Bits(1) << (8 * sizeof(T) - 1))));
  }
  friend DYN_INLINE Simd sqrt(const Simd& a) {
    Simd b;
    for (int k = 0; k < N; ++k) b.x[k] = std::sqrt(a.x[k]);
    return b;
  }
};
// As two halves, of which each is one vector or halves in turn. An array of vectors would stay in memory through GCC's early
// passes, and compiling would take eight times as long. Four doubles are aligned as with AVX: records are alike everywhere.
template <class T, int N>
  requires detail::is_halved<T, N>
struct alignas(sizeof(T) * N >= 32 && register_lanes < 4 ? 32 : 8 * register_lanes) Simd<T, N> {
  static constexpr int lanes = N, half = N / 2;
  using Half = Simd<T, half>;
  using Mask = Simd<detail::LaneBits<T>, N>;
  Half low, high;

  Simd() = default;
  DYN_INLINE Simd(T a) : low(a), high(a) {}
  static DYN_INLINE constexpr Simd of(Half low, Half high) {
    Simd a;
    a.low = low, a.high = high;
    return a;
  }
  template <class... U>
    requires(N > 1 && sizeof...(U) == N)
  explicit DYN_INLINE constexpr Simd(U... a) : Simd(std::make_index_sequence<half>{}, std::array<T, N>{T(a)...}) {}
  static DYN_INLINE Simd zero() { return of(Half::zero(), Half::zero()); }
  static DYN_INLINE Simd load(const T* p) { return of(Half::load(p), Half::load(p + half)); }
  DYN_INLINE void store(T* p) const { low.store(p), high.store(p + half); }
  static DYN_INLINE Simd convert(const Index* p) { return of(Half::convert(p), Half::convert(p + half)); }
  DYN_INLINE T operator[](int k) const { return k < half ? low[k] : high[k - half]; }
  DYN_INLINE void set(int k, T a) { k < half ? low.set(k, a) : high.set(k - half, a); }

#define DYN_UNARY(op) \
  friend DYN_INLINE Simd operator op(const Simd& a) { return of(op a.low, op a.high); }
#define DYN_BINARY(op) \
  friend DYN_INLINE Simd operator op(const Simd& a, const Simd& b) { return of(a.low op b.low, a.high op b.high); }
#define DYN_COMPARE(op) \
  friend DYN_INLINE Mask operator op(const Simd& a, const Simd& b) { return Mask::of(a.low op b.low, a.high op b.high); }
  DYN_SIMD_OPERATORS(DYN_UNARY, DYN_BINARY, DYN_COMPARE)
#undef DYN_UNARY
#undef DYN_BINARY
#undef DYN_COMPARE
  friend DYN_INLINE Simd select(const Mask& m, const Simd& a, const Simd& b) {
    return of(select(m.low, a.low, b.low), select(m.high, a.high, b.high));
  }
  friend DYN_INLINE Simd min(const Simd& a, const Simd& b) { return of(min(a.low, b.low), min(a.high, b.high)); }
  friend DYN_INLINE Simd max(const Simd& a, const Simd& b) { return of(max(a.low, b.low), max(a.high, b.high)); }
  friend DYN_INLINE Simd abs(const Simd& a) { return of(abs(a.low), abs(a.high)); }
  friend DYN_INLINE Simd sqrt(const Simd& a) { return of(sqrt(a.low), sqrt(a.high)); }

 private:
  template <std::size_t... k>
  DYN_INLINE constexpr Simd(std::index_sequence<k...>, const std::array<T, N>& a) : low(a[k]...), high(a[half + k]...) {}
};
#undef DYN_SIMD_OPERATORS

using Double4 = Simd<double, 4>;

// The same bits as lanes of another type of this size.
template <class To, class T, int N>
DYN_INLINE Simd<To, N> reinterpret(const Simd<T, N>& a) {
  static_assert(sizeof(To) == sizeof(T));
  Simd<To, N> b;
  if constexpr (detail::is_vector<T, N>)
    b.x = (typename Simd<To, N>::Vector)a.x;
  else if constexpr (detail::is_halved<T, N>)
    b = Simd<To, N>::of(reinterpret<To>(a.low), reinterpret<To>(a.high));
  else
    std::memcpy(&b, &a, sizeof b);
  return b;
}
// 0 + a[0] + a[1] + ..., added in this order
template <class T, int N>
DYN_INLINE T sum(const Simd<T, N>& a) {
  T s = T(0);
  for (int k = 0; k < N; ++k) s = s + a[k];
  return s;
}

// One bit for each lane of a mask, the lowest for the first lane.
template <class T, int N>
DYN_INLINE unsigned bits_of(const Simd<T, N>& m) {
#if defined(__AVX512DQ__)
  typedef long long Eight __attribute__((vector_size(64)));
  if constexpr (std::is_same_v<T, std::int64_t> && N == 8) return unsigned(__builtin_ia32_cvtq2mask512(Eight(m.x)));
#endif
#if defined(__AVX__)
  if constexpr (std::is_same_v<T, std::int64_t> && N == 4) return unsigned(__builtin_ia32_movmskpd256(reinterpret<double>(m).x));
  if constexpr (std::is_same_v<T, std::int32_t> && N == 8) return unsigned(__builtin_ia32_movmskps256(reinterpret<float>(m).x));
#elif defined(__SSE2__)
  if constexpr (std::is_same_v<T, std::int64_t> && N == 2) return unsigned(__builtin_ia32_movmskpd(reinterpret<double>(m).x));
  if constexpr (std::is_same_v<T, std::int32_t> && N == 4) return unsigned(__builtin_ia32_movmskps(reinterpret<float>(m).x));
#endif
  if constexpr (detail::is_halved<T, N>) return bits_of(m.low) | bits_of(m.high) << m.half;
  unsigned bits = 0;
  for (int k = 0; k < N; ++k) bits |= unsigned(m[k] & 1) << k;
  return bits;
}
template <class T, int N>
DYN_INLINE bool any(const Simd<T, N>& m) {
  return bits_of(m) != 0;
}
template <class T, int N>
DYN_INLINE bool all(const Simd<T, N>& m) {
  return bits_of(m) == (1u << N) - 1;
}
// f(lane) for each bit, from the lowest
template <class Bits, class F>
DYN_INLINE void for_each_bit(Bits bits, F&& f) {
  for (; bits; bits &= bits - 1) f(std::countr_zero(bits));
}

}  // namespace dyn
