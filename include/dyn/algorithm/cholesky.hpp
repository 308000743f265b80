// M = L^T D L with the tree's sparsity: L_ij is non-zero only for ancestors j of i (Featherstone 2008, 6.5, Table 6.3).
// Row i of L lies in L[i * nv .. i * nv + i]; dof_parent is the elimination tree (with mimic joints: of the filled pattern of
// M). Ancestors are consecutive but for branches, so that loops over them are loops over a few runs.
#pragma once

#include "dyn/model/data.hpp"

namespace dyn {

// f(first, last) for the runs of degree of freedom i and its ancestors, i first; nothing for i < 0.
template <class F>
DYN_INLINE void for_each_run(const Model& m, Index i, F&& f) {
  while (i >= 0) {
    const Index first = m.dof_run()[i];
    f(first, i + 1);
    i = m.dof_parent()[first];
  }
}

// From the current d.M. Returns 0, or 1 + the degree of freedom whose pivot is not positive.
template <class T>
Index factorize(const Model& m, Data<T>& d) {
  const Index n = m.n.nv;
  const Index* parent = m.dof_parent();
  auto row_of = [&](Index i) { return d.L + std::ptrdiff_t(i) * n; };
  for (Index i = 0; i < n; ++i)  // M is symmetric: its column i is its row i
    for_each_run(m, i, [&](Index first, Index last) {
      for (Index j = first; j < last; ++j) row_of(i)[j] = d.M[j + std::ptrdiff_t(i) * n];
    });
  for (Index k = n - 1; k >= 0; --k) {
    T* row = row_of(k);
    if (!(row[k] > T(0))) return k + 1;
    const T Dinv = T(1) / row[k];
    d.D[k] = Dinv;
    for (Index i = parent[k]; i >= 0; i = parent[i]) {
      const T a = row[i] * Dinv;
      T* target = row_of(i);
      for_each_run(m, i, [&](Index first, Index last) {
        for (Index j = first; j < last; ++j) target[j] -= a * row[j];
      });
      row[i] = a;
    }
  }
  d.done(Stage::Factor);
  return 0;
}

// x -= L_i^T x_i over the ancestors of i
template <class T>
DYN_INLINE void eliminate(const Model& m, const Data<T>& d, Index i, T* x) {
  const T* row = d.L + std::ptrdiff_t(i) * m.n.nv;
  const T xi = x[i];
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last) {
    for (Index j = first; j < last; ++j) x[j] -= row[j] * xi;
  });
}
// L_i x over the ancestors of i: four sums side by side
template <class T>
DYN_INLINE T row_times(const Model& m, const Data<T>& d, Index i, const T* x) {
  const T* row = d.L + std::ptrdiff_t(i) * m.n.nv;
  T sum[4] = {T(0), T(0), T(0), T(0)};
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last) {
    Index j = first;
    for (; j + 4 <= last; j += 4)
      for (int k = 0; k < 4; ++k) sum[k] += row[j + k] * x[j + k];
    for (; j < last; ++j) sum[0] += row[j] * x[j];
  });
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

// x = M^-1 x
template <class T>
void solve(const Model& m, const Data<T>& d, T* x) {
  const Index n = m.n.nv;
  for (Index i = n - 1; i >= 0; --i) eliminate(m, d, i, x);
  for (Index i = 0; i < n; ++i) x[i] = x[i] * d.D[i] - row_times(m, d, i, x);
}

// d.Minv from the factor. Column k of L^-T has entries at the ancestors of k only.
template <class T>
void invert(const Model& m, Data<T>& d) {
  const Index n = m.n.nv;
  const Index* parent = m.dof_parent();
  for (Index k = 0; k < n; ++k) {
    T* x = d.Minv + std::ptrdiff_t(k) * n;
    for (Index i = 0; i < n; ++i) x[i] = T(0);
    x[k] = T(1);
    for (Index i = k; i >= 0; i = parent[i]) eliminate(m, d, i, x);
    for (Index i = k; i >= 0; i = parent[i]) x[i] *= d.D[i];
    for (Index i = 0; i < n; ++i) x[i] -= row_times(m, d, i, x);
  }
  for (Index k = 0; k < n; ++k)  // symmetric to the last bit
    for (Index i = 0; i < k; ++i) d.Minv[k + std::ptrdiff_t(i) * n] = d.Minv[i + std::ptrdiff_t(k) * n];
  d.done(Stage::Minv);
}

}  // namespace dyn
