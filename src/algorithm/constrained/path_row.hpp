// The Delassus matrix's columns of a row on a path's length (algorithm/paths.hpp), which may act on many branches of a tree and on
// several trees: each degree of freedom passes what is left of the wrench to the place of its parent.
#pragma once

#include "algorithm/constrained/delassus.hpp"

namespace dyn {

// f(place, degree of freedom, entry of J, place of the parent or -1), the degrees of freedom descending.
template <class T, class F>
void for_each_path_dof(const Model& m, const Data<T>& d, const ConstraintInstance<T>& s, F&& f) {
  const PathRecord& p = m.paths()[s.c.path - 1];
  for (Index k = 0; k < p.dofs; ++k) {
    const Index at = p.first_dof + k;
    f(k, m.path_dofs()[at], s.g1 * d.path_moment[at], m.path_parents()[at]);
  }
}

// Rate of the row. v: expanded.
template <class T>
T path_rate(const Model& m, const Data<T>& d, const ConstraintInstance<T>& s, const T* v) {
  T sum = T(0);
  for_each_path_dof(m, d, s, [&](Index, Index dof, T entry, Index) { sum += entry * v[m.has_mimic ? m.own_v()[dof] : dof]; });
  return sum;
}

template <class T>
void propagate_path(const Model& m, Data<T>& d, ConstraintInstance<T>& s, Index* support, T* y) {
  const Index count = s.support_count = m.paths()[s.c.path - 1].dofs;
  if (m.has_mimic) {
    T* const J = d.constraint_columns;
    for_each_path_dof(m, d, s, [&](Index, Index dof, T entry, Index) {
      std::fill_n(J + row_lanes * dof, row_lanes, T(0)), J[row_lanes * dof] = entry;
    });
    for_each_path_dof(m, d, s, [&](Index k, Index dof, T, Index) {
      eliminate_row(m, d, dof, J, y + row_lanes * k), support[k] = dof;
    });
    return;
  }
  Force<T>* const passed = d.path_wrenches;
  std::fill_n(passed, count, Force<T>{Vec3<T>::zero(), Vec3<T>::zero()});
  for_each_path_dof(m, d, s, [&](Index k, Index dof, T entry, Index parent) {
    const T x = entry + dot(d.S[dof], passed[k]);
    std::fill_n(y + row_lanes * k, row_lanes, T(0));
    y[row_lanes * k] = x, support[k] = dof;
    if (parent >= 0) passed[parent] = passed[parent] + passed[k] + d.U_root[dof] * (-d.Dinv[dof] * x);
  });
}

}  // namespace dyn
