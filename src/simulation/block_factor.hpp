// A = L U of a matrix of 6 x 6 blocks in elimination order, without pivoting between blocks.
// Used for the Newton matrix of contacts: symmetric positive definite, except for what slip adds. Columns of blocks lie in lanes.
#pragma once

#include "base/simd.hpp"
#include "simulation/island.hpp"

namespace dyn::simulation {

struct BlockFactor {
  static constexpr int R = segment_size, W = segment_lanes, size = W * R;
  using P = Simd<double, W>;

  const Elimination& order;
  // diagonal: inverse blocks by position. upper, lower: blocks (earlier, later) and (later, earlier) by entry
  double *diagonal, *upper, *lower;
  Index* where;                      // by position
  // acts: by position, has unknowns. filled: by entry, block is not zero
  bool *acts, *filled;
  bool symmetric = false;  // then blocks of `lower` follow from those of `upper`, and need not be filled

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

  static DYN_INLINE void transpose(const double* a, double* to) {
    for (int j = 0; j < R; ++j)
      for (int i = 0; i < W; ++i) to[i + W * j] = i < R ? a[j + W * i] : 0;
  }

  // In-place Gauss-Jordan inverse, columns in lanes. Returns false if singular.
  template <int k>
  static DYN_INLINE bool pivot(P* c) {
    const P column = c[k];
    const double own = column[k];
    if (!(std::abs(own) > 0)) return false;
    const double inverse = 1 / own;
    double unit[W] = {}, others[W];
    for (int i = 0; i < W; ++i) unit[i] = i == k, others[i] = i != k;
    const P lane = P::load(unit), rest = P::load(others);
#pragma GCC unroll 6
    for (int j = 0; j < R; ++j) {
      if (j == k) continue;
      const double f = c[j][k] * inverse;
      c[j] = (c[j] - column * f) * rest + lane * f;
    }
    c[k] = column * rest * -inverse + lane * inverse;
    return true;
  }
  static bool invert(double* a) {
    P c[R];
    for (int j = 0; j < R; ++j) c[j] = P::load(a + W * j);
    if (!(pivot<0>(c) && pivot<1>(c) && pivot<2>(c) && pivot<3>(c) && pivot<4>(c) && pivot<5>(c))) return false;
    for (int j = 0; j < R; ++j) c[j].store(a + W * j);
    return true;
  }

  // fill(position): adds the blocks of A at the position, diagonal and entries. They are zero before; where[] gives entries by
  // later position.
  template <class Fill>
  bool operator()(Fill&& fill) const {
    for (Index i = 0; i < order.size; ++i) {
      const Index begin = order.first[i], end = order.first[i + 1];
      std::fill_n(filled + begin, end - begin, false);
      if (!acts[i]) continue;
      std::fill_n(upper + std::ptrdiff_t(size) * begin, size * (end - begin), 0.0);
      if (!symmetric) std::fill_n(lower + std::ptrdiff_t(size) * begin, size * (end - begin), 0.0);
      for (Index e = begin; e < end; ++e) where[order.later[e]] = e;
      double* const D = diagonal + size * i;
      fill(i, D);
      for (Index at = order.first_in[i]; at < order.first_in[i + 1]; ++at) {
        const Index e = order.in[at], last = order.first[order.earlier[e] + 1];
        if (!filled[e]) continue;
        const double *L = lower + std::ptrdiff_t(size) * e, *U = upper + std::ptrdiff_t(size) * e;
        subtract(D, L, U);
        for (Index f = e + 1; f < last; ++f) {
          if (!filled[f]) continue;
          const Index to = where[order.later[f]];
          filled[to] = true;
          subtract(upper + std::ptrdiff_t(size) * to, L, upper + std::ptrdiff_t(size) * f);
          if (!symmetric) subtract(lower + std::ptrdiff_t(size) * to, lower + std::ptrdiff_t(size) * f, U);
        }
      }
      if (!invert(D)) return false;
      for (Index e = begin; e < end; ++e) {
        if (!filled[e]) continue;
        double* L = lower + std::ptrdiff_t(size) * e;
        if (symmetric) transpose(upper + std::ptrdiff_t(size) * e, L);
        alignas(64) double minus[size] = {};
        subtract(minus, L, D);
        for (int k = 0; k < size; ++k) L[k] = -minus[k];
      }
    }
    return true;
  }
  // x: W numbers for each position
  void solve(double* x) const {
    for (Index i = 0; i < order.size; ++i)
      for (Index e = order.first[i]; e < order.first[i + 1]; ++e)
        if (filled[e]) subtract_times(x + W * order.later[e], lower + std::ptrdiff_t(size) * e, x + W * i);
    for (Index i = order.size - 1; i >= 0; --i) {
      if (!acts[i]) continue;
      alignas(64) double sum[W] = {};
      for (Index e = order.first[i]; e < order.first[i + 1]; ++e)
        if (filled[e]) subtract_times(x + W * i, upper + std::ptrdiff_t(size) * e, x + W * order.later[e]);
      subtract_times(sum, diagonal + size * i, x + W * i);
      for (int k = 0; k < W; ++k) x[W * i + k] = -sum[k];
    }
  }
};

}  // namespace dyn::simulation
