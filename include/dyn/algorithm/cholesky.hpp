// M = L^T D L with the tree's sparsity: L_ij is non-zero only for ancestors j of i (Featherstone 2008, 6.5, Table 6.3).
// Row i of L is the run L[i * nv .. i * nv + i]; dof_parent is the elimination tree (with mimic joints: of the filled
// pattern of M).
#pragma once

#include "dyn/model/data.hpp"

namespace dyn {

// From the current d.M. Returns 0, or 1 + the degree of freedom whose pivot is not positive.
template <class T>
Index factorize(const Model& m, Data<T>& d) {
  const Index n = m.n.nv;
  const Index* parent = m.dof_parent();
  T* L = d.L;
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j >= 0; j = parent[j]) L[std::ptrdiff_t(i) * n + j] = d.M[i + std::ptrdiff_t(j) * n];
  for (Index k = n - 1; k >= 0; --k) {
    T* row = L + std::ptrdiff_t(k) * n;
    if (!(row[k] > T(0))) return k + 1;
    const T Dinv = T(1) / row[k];
    d.D[k] = Dinv;
    for (Index i = parent[k]; i >= 0; i = parent[i]) {
      const T a = row[i] * Dinv;
      T* target = L + std::ptrdiff_t(i) * n;
      for (Index j = i; j >= 0; j = parent[j]) target[j] -= a * row[j];
    }
    for (Index i = parent[k]; i >= 0; i = parent[i]) row[i] *= Dinv;
  }
  d.done(Stage::Factor);
  return 0;
}

// x = M^-1 x
template <class T>
void solve(const Model& m, const Data<T>& d, T* x) {
  const Index n = m.n.nv;
  const Index* parent = m.dof_parent();
  for (Index i = n - 1; i >= 0; --i)
    for (Index j = parent[i]; j >= 0; j = parent[j]) x[j] -= d.L[std::ptrdiff_t(i) * n + j] * x[i];
  for (Index i = 0; i < n; ++i) x[i] *= d.D[i];
  for (Index i = 0; i < n; ++i)
    for (Index j = parent[i]; j >= 0; j = parent[j]) x[i] -= d.L[std::ptrdiff_t(i) * n + j] * x[j];
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
    for (Index i = k; i >= 0; i = parent[i])
      for (Index j = parent[i]; j >= 0; j = parent[j]) x[j] -= d.L[std::ptrdiff_t(i) * n + j] * x[i];
    for (Index i = k; i >= 0; i = parent[i]) x[i] *= d.D[i];
    for (Index i = 0; i < n; ++i)
      for (Index j = parent[i]; j >= 0; j = parent[j]) x[i] -= d.L[std::ptrdiff_t(i) * n + j] * x[j];
  }
  for (Index k = 0; k < n; ++k)  // symmetric to the last bit
    for (Index i = 0; i < k; ++i) d.Minv[k + std::ptrdiff_t(i) * n] = d.Minv[i + std::ptrdiff_t(k) * n];
  d.done(Stage::Minv);
}

}  // namespace dyn
