// Sums of products of small matrices, row by row, many entries of which are zero.
#pragma once

#include <algorithm>

#include "base/simd.hpp"

namespace dyn::solver {

// A matrix whose entries lie `across` apart in a row, and `down` from row to row.
struct Factors {
  const double* at;
  std::ptrdiff_t down, across;
};

// R rows of factors, without the columns that are zero in all of them.
template <int R>
struct FactorRows {
  static constexpr Index capacity = 64;
  Index count = 0;
  std::ptrdiff_t column[capacity];
  double by[capacity][R];

  FactorRows(const Factors& f, Index first, Index end) {
    for (Index l = first; l < end; ++l) {
      bool any = false;
      for (int r = 0; r < R; ++r) by[count][r] = f.at[f.down * r + f.across * l], any |= by[count][r] != 0;
      column[count] = l, count += any;
    }
  }

  // Adds to some columns, `packs` times P's lanes: sums stay in registers if loops are unrolled.
  template <class P, int packs>
  DYN_INLINE void add_to(double* to, std::ptrdiff_t to_stride, const double* from, std::ptrdiff_t from_stride) const {
    P sum[R * packs];
    const auto at = [&](int k) { return to + to_stride * (k / packs) + P::lanes * (k % packs); };
#pragma GCC unroll 8
    for (int k = 0; k < R * packs; ++k) sum[k] = P::load(at(k));
    for (Index l = 0; l < count; ++l) {
      const double* const row = from + from_stride * column[l];
#pragma GCC unroll 8
      for (int k = 0; k < R * packs; ++k) sum[k] = sum[k] + P::load(row + P::lanes * (k % packs)) * P(by[l][k / packs]);
    }
#pragma GCC unroll 8
    for (int k = 0; k < R * packs; ++k) sum[k].store(at(k));
  }
};

// to += factors times from, of rows x count and count x n; rows of `to` and `from` lie that far apart.
inline void add_product(double* to, std::ptrdiff_t to_stride, std::ptrdiff_t rows, const Factors& factors, const double* from,
                        std::ptrdiff_t from_stride, Index count, std::ptrdiff_t n) {
  const auto add_rows = [&]<int R>(std::ptrdiff_t r, std::integral_constant<int, R>) {
    for (Index first = 0; first < count; first += FactorRows<R>::capacity) {
      const Factors own{factors.at + factors.down * r, factors.down, factors.across};
      const FactorRows<R> f(own, first, std::min(count, first + FactorRows<R>::capacity));
      std::ptrdiff_t c = 0;
      const auto add = [&]<class P, int packs>(P, std::integral_constant<int, packs>) {
        for (; c + packs * P::lanes <= n; c += packs * P::lanes)
          f.template add_to<P, packs>(to + to_stride * r + c, to_stride, from + c, from_stride);
      };
      add(Simd<double, block_lanes>{}, std::integral_constant<int, 2>{});
      add(Simd<double, 4>{}, std::integral_constant<int, 1>{}), add(Simd<double, 1>{}, std::integral_constant<int, 1>{});
    }
  };
  std::ptrdiff_t r = 0;
  for (; r + 4 <= rows; r += 4) add_rows(r, std::integral_constant<int, 4>{});
  for (; r < rows; ++r) add_rows(r, std::integral_constant<int, 1>{});
}

}  // namespace dyn::solver
