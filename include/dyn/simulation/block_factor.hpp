// A = L U of a matrix of R x R blocks in the order of an elimination, without exchanges between blocks: of the Newton matrix of contacts,
// which is symmetric and positive definite but for what sliding adds. Columns of blocks lie in lanes.
#pragma once

#include "dyn/base/pack.hpp"
#include "dyn/simulation/island.hpp"

namespace dyn::simulation {

template <int R>
struct BlockFactor {
  static constexpr int W = R <= 4 ? 4 : 8;
  static constexpr int size = W * R;
  using P = Pack<double, W>;

  const Elimination& order;
  Index n;
  double *diagonal, *upper, *lower;  // of positions: the inverse; of entries: (earlier, later) and (later, earlier)
  Index* where;                      // of n

  // c -= a b
  static DYN_INLINE void subtract(double* c, const double* a, const double* b) {
    P columns[R];
#pragma GCC unroll 6
    for (int l = 0; l < R; ++l) columns[l] = P::load(a + W * l);
#pragma GCC unroll 6
    for (int j = 0; j < R; ++j) {
      P sum = P::load(c + W * j);
#pragma GCC unroll 6
      for (int l = 0; l < R; ++l) sum = sum - columns[l] * b[W * j + l];
      sum.store(c + W * j);
    }
  }
  // x -= a y
  static DYN_INLINE void subtract_times(double* x, const double* a, const double* y) {
    P sum = P::load(x);
#pragma GCC unroll 6
    for (int l = 0; l < R; ++l) sum = sum - P::load(a + W * l) * y[l];
    sum.store(x);
  }

  // By Gauss and Jordan with exchanges of rows. false: singular
  static bool invert(double* a) {
    double b[R][2 * R] = {};
    for (int i = 0; i < R; ++i) {
      for (int j = 0; j < R; ++j) b[i][j] = a[i + W * j];
      b[i][R + i] = 1;
    }
    for (int k = 0; k < R; ++k) {
      int p = k;
      for (int i = k + 1; i < R; ++i)
        if (std::abs(b[i][k]) > std::abs(b[p][k])) p = i;
      if (!(std::abs(b[p][k]) > 0)) return false;
      for (int j = k; p != k && j < 2 * R; ++j) std::swap(b[p][j], b[k][j]);
      const double scale = 1 / b[k][k];
      for (int j = k; j < 2 * R; ++j) b[k][j] *= scale;
      for (int i = 0; i < R; ++i) {
        if (i == k) continue;
        const double x = b[i][k];
        for (int j = k; j < 2 * R; ++j) b[i][j] -= x * b[k][j];
      }
    }
    for (int i = 0; i < R; ++i)
      for (int j = 0; j < R; ++j) a[i + W * j] = b[i][R + j];
    return true;
  }

  // fill(position): writes the blocks of A there, of its diagonal and of its entries, which are zero, with where[] of the later positions.
  // acts(position): has unknowns; the others are skipped
  template <class Acts, class Fill>
  bool operator()(Acts&& acts, Fill&& fill) const {
    for (Index i = 0; i < n; ++i) {
      const Index begin = order.first[i], end = order.first[i + 1];
      std::fill_n(upper + std::ptrdiff_t(size) * begin, size * (end - begin), 0.0);
      std::fill_n(lower + std::ptrdiff_t(size) * begin, size * (end - begin), 0.0);
      for (Index e = begin; e < end; ++e) where[order.later[e]] = e;
      double* const D = diagonal + size * i;
      if (!acts(i)) {
        std::fill_n(D, size, 0.0);
        continue;
      }
      fill(i, D);
      for (Index at = order.first_in[i]; at < order.first_in[i + 1]; ++at) {
        const Index e = order.in[at], last = order.first[order.earlier[e] + 1];
        if (!acts(order.earlier[e])) continue;
        const double *L = lower + std::ptrdiff_t(size) * e, *U = upper + std::ptrdiff_t(size) * e;
        subtract(D, L, U);
        for (Index f = e + 1; f < last; ++f) {
          if (!acts(order.later[f])) continue;
          const Index to = where[order.later[f]];
          subtract(upper + std::ptrdiff_t(size) * to, L, upper + std::ptrdiff_t(size) * f);
          subtract(lower + std::ptrdiff_t(size) * to, lower + std::ptrdiff_t(size) * f, U);
        }
      }
      if (!invert(D)) return false;
      for (Index e = begin; e < end; ++e) {
        double* L = lower + std::ptrdiff_t(size) * e;
        alignas(64) double minus[size] = {};
        subtract(minus, L, D);
        for (int k = 0; k < size; ++k) L[k] = -minus[k];
      }
    }
    return true;
  }
  // x: W numbers for each position
  void solve(double* x) const {
    for (Index i = 0; i < n; ++i)
      for (Index e = order.first[i]; e < order.first[i + 1]; ++e) subtract_times(x + W * order.later[e], lower + std::ptrdiff_t(size) * e, x + W * i);
    for (Index i = n - 1; i >= 0; --i) {
      alignas(64) double sum[W] = {};
      for (Index e = order.first[i]; e < order.first[i + 1]; ++e) subtract_times(x + W * i, upper + std::ptrdiff_t(size) * e, x + W * order.later[e]);
      subtract_times(sum, diagonal + size * i, x + W * i);
      for (int k = 0; k < W; ++k) x[W * i + k] = -sum[k];
    }
  }
};

}  // namespace dyn::simulation
