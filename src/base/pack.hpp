// W numbers side by side: one vector instruction each where the machine has it.
#pragma once

#include <algorithm>
#include <cstring>

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

// The most that one instruction takes. (Sums depend on it.)
#if defined(__AVX512F__) && !DYN_REPRODUCIBLE
inline constexpr int widest_pack = 8;
#else
inline constexpr int widest_pack = 4;
#endif

template <class T, int W>
struct Pack {
  T x[W];
  static DYN_INLINE Pack zero() {
    Pack a;
    for (int k = 0; k < W; ++k) a.x[k] = T(0);
    return a;
  }
  static DYN_INLINE Pack load(const T* p) {
    Pack a;
    for (int k = 0; k < W; ++k) a.x[k] = p[k];
    return a;
  }
  DYN_INLINE void store(T* p) const {
    for (int k = 0; k < W; ++k) p[k] = x[k];
  }
#define DYN_PACK_OPERATOR(op)                                   \
  friend DYN_INLINE Pack operator op(const Pack& a, const Pack& b) { \
    Pack c;                                                     \
    for (int k = 0; k < W; ++k) c.x[k] = a.x[k] op b.x[k];        \
    return c;                                                   \
  }                                                             \
  friend DYN_INLINE Pack operator op(const Pack& a, T b) {        \
    Pack c;                                                     \
    for (int k = 0; k < W; ++k) c.x[k] = a.x[k] op b;             \
    return c;                                                   \
  }                                                             \
  friend DYN_INLINE Pack operator op(T a, const Pack& b) {        \
    Pack c;                                                     \
    for (int k = 0; k < W; ++k) c.x[k] = a op b.x[k];             \
    return c;                                                   \
  }
  DYN_PACK_OPERATOR(+)
  DYN_PACK_OPERATOR(-)
  DYN_PACK_OPERATOR(*)
#undef DYN_PACK_OPERATOR
  DYN_INLINE T operator[](int k) const { return x[k]; }

  static DYN_INLINE Pack from(const Index* p) {
    Pack a;
    for (int k = 0; k < W; ++k) a.x[k] = T(p[k]);
    return a;
  }
  // 0 but for the lanes in which a > b
  DYN_INLINE Pack where_above(const Pack& a, T b) const {
    Pack c;
    for (int k = 0; k < W; ++k) c.x[k] = a.x[k] > b ? x[k] : T(0);
    return c;
  }
  // one lane everywhere
  template <int lane>
  DYN_INLINE Pack all() const {
    Pack c;
    for (int k = 0; k < W; ++k) c.x[k] = x[lane];
    return c;
  }
  // lanes first and on from a
  template <int first>
  DYN_INLINE Pack with_tail(const Pack& a) const {
    Pack c;
    for (int k = 0; k < W; ++k) c.x[k] = k < first ? x[k] : a.x[k];
    return c;
  }
};

#if DYN_LANES == 4
typedef double FourNumbers __attribute__((vector_size(32)));
typedef long long FourIntegers __attribute__((vector_size(32)));
typedef Index FourIndices __attribute__((vector_size(16)));

template <int W>
struct Pack<double, W> {
  typedef double Lanes __attribute__((vector_size(8 * W)));
  Lanes x;
  static DYN_INLINE Pack zero() { return {Lanes{}}; }
  static DYN_INLINE Pack load(const double* p) {
    Pack a;
    std::memcpy(&a.x, p, sizeof a.x);
    return a;
  }
  DYN_INLINE void store(double* p) const { std::memcpy(p, &x, sizeof x); }
#define DYN_PACK_OPERATOR(op)                                                             \
  friend DYN_INLINE Pack operator op(const Pack& a, const Pack& b) { return {a.x op b.x}; } \
  friend DYN_INLINE Pack operator op(const Pack& a, double b) { return {a.x op b}; }        \
  friend DYN_INLINE Pack operator op(double a, const Pack& b) { return {a op b.x}; }
  DYN_PACK_OPERATOR(+)
  DYN_PACK_OPERATOR(-)
  DYN_PACK_OPERATOR(*)
#undef DYN_PACK_OPERATOR
  DYN_INLINE double operator[](int k) const {
    double numbers[W];
    store(numbers);
    return numbers[k];
  }

  static DYN_INLINE Pack from(const Index* p) {
    static_assert(W == 4);
    FourIndices i;
    std::memcpy(&i, p, sizeof i);
    return {__builtin_convertvector(i, FourNumbers)};
  }
  DYN_INLINE Pack where_above(const Pack& a, double b) const { return {a.x > b ? x : Lanes{}}; }
  template <int lane>
  DYN_INLINE Pack all() const {
    static_assert(W == 4);
    return {__builtin_shufflevector(x, x, lane, lane, lane, lane)};
  }
  template <int first>
  DYN_INLINE Pack with_tail(const Pack& a) const {
    static_assert(W == 4);
    return {__builtin_shufflevector(x, a.x, 0, first > 1 ? 1 : 5, first > 2 ? 2 : 6, first > 3 ? 3 : 7)};
  }
};

// In several registers: GCC would keep a vector that is wider than one in memory.
template <int W>
  requires(W > 4 && W > register_lanes)
struct Pack<double, W> {
  typedef double Register __attribute__((vector_size(8 * register_lanes)));
  static constexpr int registers = W / register_lanes;
  Register x[registers];
  static DYN_INLINE Pack zero() { return {}; }
  static DYN_INLINE Pack load(const double* p) {
    Pack a;
    for (int k = 0; k < registers; ++k) std::memcpy(&a.x[k], p + register_lanes * k, sizeof(Register));
    return a;
  }
  DYN_INLINE void store(double* p) const {
    for (int k = 0; k < registers; ++k) std::memcpy(p + register_lanes * k, &x[k], sizeof(Register));
  }
#define DYN_PACK_OPERATOR(op)                                           \
  friend DYN_INLINE Pack operator op(const Pack& a, const Pack& b) {    \
    Pack c;                                                             \
    for (int k = 0; k < registers; ++k) c.x[k] = a.x[k] op b.x[k];      \
    return c;                                                           \
  }                                                                     \
  friend DYN_INLINE Pack operator op(const Pack& a, double b) {         \
    Pack c;                                                             \
    for (int k = 0; k < registers; ++k) c.x[k] = a.x[k] op b;           \
    return c;                                                           \
  }
  DYN_PACK_OPERATOR(+)
  DYN_PACK_OPERATOR(-)
  DYN_PACK_OPERATOR(*)
#undef DYN_PACK_OPERATOR
  DYN_INLINE double operator[](int k) const { return x[k / register_lanes][k % register_lanes]; }
};
#endif

// The first count lanes alone; loaded, the others are zero.
template <class T>
DYN_INLINE void store_some(const Pack<T, 4>& a, T* p, int count) {
  for (int k = 0; k < count; ++k) p[k] = a[k];
}
template <class T>
DYN_INLINE Pack<T, 4> load_some(const T* p, int count) {
  Pack<T, 4> a;
  for (int k = 0; k < 4; ++k) a.x[k] = k < count ? p[k] : T(0);
  return a;
}
#ifdef __AVX__
DYN_INLINE Pack<double, 4> load_some(const double* p, int count) {
  return {__builtin_ia32_maskloadpd256(reinterpret_cast<const FourNumbers*>(p), FourIntegers{0, 1, 2, 3} < (long long)count)};
}
DYN_INLINE void store_some(const Pack<double, 4>& a, double* p, int count) {
  __builtin_ia32_maskstorepd256(reinterpret_cast<FourNumbers*>(p), FourIntegers{0, 1, 2, 3} < (long long)count, a.x);
}
#endif

// The same of a count known beforehand, in pieces that are read back as fast as they are written.
template <int count, class T>
DYN_INLINE void store_first(const Pack<T, 4>& a, T* p) {
  for (int k = 0; k < count; ++k) p[k] = a[k];
}
template <int count, class T>
DYN_INLINE Pack<T, 4> load_first(const T* p) {
  return load_some(p, count);
}
#if DYN_LANES == 4
typedef double TwoNumbers __attribute__((vector_size(16)));
template <int count>
DYN_INLINE void store_first(const Pack<double, 4>& a, double* p) {
  if constexpr (count == 4) return a.store(p);
  const TwoNumbers low = __builtin_shufflevector(a.x, a.x, 0, 1), high = __builtin_shufflevector(a.x, a.x, 2, 3);
  if constexpr (count > 1) std::memcpy(p, &low, 16);
  if constexpr (count != 2) p[count - 1] = count == 1 ? low[0] : high[0];
}
template <int count>
DYN_INLINE Pack<double, 4> load_first(const double* p) {
  if constexpr (count == 4) return Pack<double, 4>::load(p);
  TwoNumbers low{}, high{};
  if constexpr (count > 1) std::memcpy(&low, p, 16);
  if constexpr (count == 1) low[0] = p[0];
  if constexpr (count == 3) high[0] = p[2];
  return {__builtin_shufflevector(low, high, 0, 1, 2, 3)};
}
#endif

// The four lanes from first on.
template <int first, class T, int W>
DYN_INLINE Pack<T, 4> four_of(const Pack<T, W>& a) {
  Pack<T, 4> b;
  for (int k = 0; k < 4; ++k) b.x[k] = a.x[first + k];
  return b;
}
#if DYN_LANES == 4
template <int first, int W>
DYN_INLINE Pack<double, 4> four_of(const Pack<double, W>& a) {
  static_assert(first % 4 == 0);
  if constexpr (W == 4 || register_lanes == 8)
    return {__builtin_shufflevector(a.x, a.x, first, first + 1, first + 2, first + 3)};
  else if constexpr (register_lanes == 4)
    return {a.x[first / 4]};
  else
    return {__builtin_shufflevector(a.x[first / 2], a.x[first / 2 + 1], 0, 1, 2, 3)};
}
#endif

// Rows of a 4 x 4 matrix from its columns.
template <class P>
DYN_INLINE void transpose4(const P& a, const P& b, const P& c, const P& d, P& x, P& y, P& z, P& w) {
  for (int k = 0; k < 4; ++k) {
    const P& s = k == 0 ? a : k == 1 ? b : k == 2 ? c : d;
    x.x[k] = s.x[0], y.x[k] = s.x[1], z.x[k] = s.x[2], w.x[k] = s.x[3];
  }
}
#if DYN_LANES == 4
DYN_INLINE void transpose4(const Pack<double, 4>& a, const Pack<double, 4>& b, const Pack<double, 4>& c, const Pack<double, 4>& d,
                           Pack<double, 4>& x, Pack<double, 4>& y, Pack<double, 4>& z, Pack<double, 4>& w) {
  using L = Pack<double, 4>::Lanes;
  const L ab0 = __builtin_shufflevector(a.x, b.x, 0, 4, 2, 6), ab1 = __builtin_shufflevector(a.x, b.x, 1, 5, 3, 7);
  const L cd0 = __builtin_shufflevector(c.x, d.x, 0, 4, 2, 6), cd1 = __builtin_shufflevector(c.x, d.x, 1, 5, 3, 7);
  x = {__builtin_shufflevector(ab0, cd0, 0, 1, 4, 5)};
  y = {__builtin_shufflevector(ab1, cd1, 0, 1, 4, 5)};
  z = {__builtin_shufflevector(ab0, cd0, 2, 3, 6, 7)};
  w = {__builtin_shufflevector(ab1, cd1, 2, 3, 6, 7)};
}
#endif

// b = factor a^T, a rows x columns: b[k + ldb * c] = factor a[c + lda * k]
template <class T>
inline void transpose(const T* a, std::ptrdiff_t lda, std::ptrdiff_t rows, std::ptrdiff_t columns, T factor, T* b, std::ptrdiff_t ldb) {
  using P = Pack<T, 4>;
  auto one_by_one = [&](std::ptrdiff_t c0, std::ptrdiff_t c1, std::ptrdiff_t k0, std::ptrdiff_t k1) {
    for (std::ptrdiff_t c = c0; c < c1; ++c)
      for (std::ptrdiff_t k = k0; k < k1; ++k) b[k + ldb * c] = factor * a[c + lda * k];
  };
  std::ptrdiff_t k = 0;
  for (; k + 4 <= columns; k += 4) {
    std::ptrdiff_t c = 0;
    for (; c + 4 <= rows; c += 4) {
      const T* from = a + c + lda * k;
      T* to = b + k + ldb * c;
      P x, y, z, w;
      transpose4(P::load(from) * factor, P::load(from + lda) * factor, P::load(from + 2 * lda) * factor, P::load(from + 3 * lda) * factor, x, y, z, w);
      x.store(to), y.store(to + ldb), z.store(to + 2 * ldb), w.store(to + 3 * ldb);
    }
    one_by_one(c, rows, k, k + 4);
  }
  one_by_one(0, rows, k, columns);
}
// The lower triangle of an n x n matrix from its upper one.
template <class T>
inline void mirror_upper(T* M, std::ptrdiff_t n) {
  for (std::ptrdiff_t j0 = 0; j0 < n; j0 += 16) {
    const std::ptrdiff_t width = std::min<std::ptrdiff_t>(16, n - j0);
    transpose(M + n * j0, n, j0, width, T(1), M + j0, n);
    for (std::ptrdiff_t j = j0; j < j0 + width; ++j)
      for (std::ptrdiff_t i = j0; i < j; ++i) M[j + n * i] = M[i + n * j];
  }
}

}  // namespace dyn
