// Inverse of the KKT matrix and its products. Z = M^-1 J^T, W = Z G^-1. H and D are changes of M ddq - J^T lambda and of J ddq at
// fixed ddq and lambda. The changes of ddq and lambda are
//   [dddq; dlambda] = -[M^-1 - Z W^T, W; -W^T, G^-1] [H; D]
// For dependent rows and rows at a bound, G^-1 is the pseudoinverse on the free rows, which gives the smallest dlambda.
#pragma once

#include "algorithm/cholesky.hpp"
#include "algorithm/constrained/row_inverse.hpp"

namespace dyn {

template <class T>
struct KktSystem {
  Index rows;
  std::ptrdiff_t ld;  // of inverse, by_q, by_v
  T *inverse, *by_q, *by_v, *Z;
  T *Dq, *Dv;  // rows x nv
};
template <class T>
KktSystem<T> kkt_system(const Model& m, const Data<T>& d, Index rows) {
  const std::ptrdiff_t nv = m.n.nv, most = m.n.constraint_rows, ld = padded_kkt(nv + most);
  T* Dv = d.row_by_state + padded_kkt(most * nv) + row_lanes;
  return {rows, padded_kkt(nv + rows), d.kkt_inverse, d.kkt_by_state, d.kkt_by_state + ld * nv, d.inverse_rows, d.row_by_state,
          Dv};
}

// Several packs of a column.
template <int packs, class T>
struct PackColumn {
  using P = Simd<T, row_lanes>;
  P sum[packs];
  DYN_INLINE void load(const T* from) {
    for (int p = 0; p < packs; ++p) sum[p] = P::load(from + row_lanes * p);
  }
  DYN_INLINE void subtract(const T* column, T x) {
    for (int p = 0; p < packs; ++p) sum[p] = sum[p] - P::load(column + row_lanes * p) * x;
  }
  DYN_INLINE void store(T* to) const {
    for (int p = 0; p < packs; ++p) sum[p].store(to + row_lanes * p);
  }
};

// Calls f.template operator()<packs>(first row) over n rows.
template <class F>
DYN_INLINE void for_each_packs(std::ptrdiff_t n, F&& f) {
  std::ptrdiff_t i = 0;
  for (; i + row_lanes < n; i += 2 * row_lanes) f.template operator()<2>(i);
  if (i < n) f.template operator()<1>(i);
}

// Z, nv x rows with the system's leading dimension, from d.Minv and J.
template <class T>
void inverse_times_rows(const Model& m, Data<T>& d, std::ptrdiff_t ld, T* Z) {
  using P = Simd<T, row_lanes>;
  const std::ptrdiff_t n = m.n.nv;
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index slot) {
    const Index* dofs = supporting_dofs_of(m, d, slot);
    const T* J = propagated_jacobian_of(m, d, slot);
    auto columns = [&]<int count>() {
      for (std::ptrdiff_t i = 0; i < n; i += row_lanes) {
        P sum[count];
#pragma GCC unroll 6
        for (int r = 0; r < count; ++r) sum[r] = P::zero();
        for (Index c = 0; c < s.support_count; ++c) {
          const P column = P::load(d.Minv + n * dofs[c] + i);
#pragma GCC unroll 6
          for (int r = 0; r < count; ++r) sum[r] = sum[r] + column * J[row_lanes * c + r];
        }
#pragma GCC unroll 6
        for (int r = 0; r < count; ++r) sum[r].store(Z + ld * (s.first + r) + i);
      }
    };
    with_row_count(s.rows, columns);
  });
}

// Inverse of the system from d.Minv, J and G^-1.
template <class T>
void invert_kkt(const Model& m, Data<T>& d, bool bounded, bool factored, const KktSystem<T>& K) {
  const std::ptrdiff_t n = m.n.nv, ld = K.ld, rows = K.rows, ldg = padded_rows(rows);
  T *Z = K.Z, *W = K.inverse + ld * n;
  if (rows) {
    const T* Ginv = row_inverse(m, d, bounded, factored, K.rows);
    inverse_times_rows(m, d, ld, Z);
    for (std::ptrdiff_t r = 0; r < rows; ++r) {
      for_each_packs(n, [&]<int packs>(std::ptrdiff_t i) {
        PackColumn<packs, T> x{};
        for (std::ptrdiff_t l = 0; l < rows; ++l) x.subtract(Z + ld * l + i, -Ginv[ldg * r + l]);
        x.store(W + ld * r + i);
      });
      std::copy_n(Ginv + ldg * r, rows, W + ld * r + n);
    }
  }
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    T* column = K.inverse + ld * k;
    for_each_packs(n, [&]<int packs>(std::ptrdiff_t i) {
      PackColumn<packs, T> x;
      x.load(d.Minv + n * k + i);
      for (std::ptrdiff_t r = 0; r < rows; ++r) x.subtract(Z + ld * r + i, W[ld * r + k]);
      x.store(column + i);
    });
    for (std::ptrdiff_t r = 0; r < rows; ++r) column[n + r] = -W[ld * r + k];
  }
}

// out = -inverse [H; D] for the columns j .. j + width - 1. related: only rows of related degrees of freedom. H: nv x nv, or null
// for 0.
template <int width, class T>
DYN_INLINE void minus_kkt_columns(const Model& m, const KktSystem<T>& K, bool related, const T* H, const T* D, T* out,
                                  std::ptrdiff_t j) {
  const std::ptrdiff_t n = m.n.nv;
  Index end = 0;
  for (int l = 0; l < width; ++l) end = std::max(end, m.dof_descendants_end()[j + l]);
  for_each_packs(K.ld, [&]<int packs>(std::ptrdiff_t i) DYN_INLINE_LAMBDA {
    PackColumn<packs, T> x[width];
#pragma GCC unroll 4
    for (int l = 0; l < width; ++l) x[l] = {};
    auto add = [&](std::ptrdiff_t first, std::ptrdiff_t last, const T* from, std::ptrdiff_t stride) DYN_INLINE_LAMBDA {
      const T* column = K.inverse + K.ld * first + i;
      for (std::ptrdiff_t k = first; k < last; ++k, column += K.ld, ++from) {
#pragma GCC unroll 4
        for (int l = 0; l < width; ++l) x[l].subtract(column, from[stride * l]);
      }
    };
    auto add_H = [&](std::ptrdiff_t first, std::ptrdiff_t last) DYN_INLINE_LAMBDA { add(first, last, H + n * j + first, n); };
    if (H && related) {
      for_each_run(m, m.dof_parent()[j], [&](Index first, Index last, Index) DYN_INLINE_LAMBDA { add_H(first, last); });
      add_H(j, end);
    } else if (H) {
      add_H(0, n);
    }
    add(n, n + K.rows, D + K.rows * j, K.rows);
#pragma GCC unroll 4
    for (int l = 0; l < width; ++l) x[l].store(out + K.ld * (j + l) + i);
  });
}
template <class T>
void minus_kkt_product(const Model& m, const KktSystem<T>& K, bool related, const T* H, const T* D, T* out) {
  const std::ptrdiff_t n = m.n.nv;
  if (n < 4)
    for (std::ptrdiff_t j = 0; j < n; ++j) minus_kkt_columns<1>(m, K, related, H, D, out, j);
  else
    for (std::ptrdiff_t j = 0; j < n; j += 4)
      minus_kkt_columns<4>(m, K, related, H, D, out, std::min(j, n - 4));  // the last block overlaps
}

}  // namespace dyn
