// W numbers side by side: one vector instruction each where the machine has it.
#pragma once

#include <cstring>

#include "dyn/base/types.hpp"

namespace dyn {

template <class T, int W>
struct Pack {
  T x[W];
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
};

#if DYN_LANES == 4
template <int W>
struct Pack<double, W> {
  typedef double Lanes __attribute__((vector_size(8 * W)));
  Lanes x;
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
};
#endif

// b[k + ldb * c] = a[c + lda * k] for a 4 x 4 piece
template <class T>
DYN_INLINE void transpose4(const T* a, std::ptrdiff_t lda, T* b, std::ptrdiff_t ldb) {
  for (int c = 0; c < 4; ++c)
    for (int k = 0; k < 4; ++k) b[k + ldb * c] = a[c + lda * k];
}
#if DYN_LANES == 4
DYN_INLINE void transpose4(const double* a, std::ptrdiff_t lda, double* b, std::ptrdiff_t ldb) {
  using L = Pack<double, 4>::Lanes;
  const L p = Pack<double, 4>::load(a).x, q = Pack<double, 4>::load(a + lda).x;
  const L r = Pack<double, 4>::load(a + 2 * lda).x, s = Pack<double, 4>::load(a + 3 * lda).x;
  const L pq0 = __builtin_shufflevector(p, q, 0, 4, 2, 6), pq1 = __builtin_shufflevector(p, q, 1, 5, 3, 7);
  const L rs0 = __builtin_shufflevector(r, s, 0, 4, 2, 6), rs1 = __builtin_shufflevector(r, s, 1, 5, 3, 7);
  Pack<double, 4>{__builtin_shufflevector(pq0, rs0, 0, 1, 4, 5)}.store(b);
  Pack<double, 4>{__builtin_shufflevector(pq1, rs1, 0, 1, 4, 5)}.store(b + ldb);
  Pack<double, 4>{__builtin_shufflevector(pq0, rs0, 2, 3, 6, 7)}.store(b + 2 * ldb);
  Pack<double, 4>{__builtin_shufflevector(pq1, rs1, 2, 3, 6, 7)}.store(b + 3 * ldb);
}
#endif

}  // namespace dyn
