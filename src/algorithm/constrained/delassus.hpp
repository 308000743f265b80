// The Delassus matrix G = J M^-1 J^T from the factor of M^-1 of forward dynamics, with the columns S, U, 1/D of articulated
// bodies: M^-1 = (1 - ..)^T D^-1 (1 - ..). The wrench P of a row is propagated from its body to the root. At each degree of
// freedom
//   y = P . S        P -= U y / D
// so G = sum over degrees of freedom of y y^T / D. A contact touches its own ancestors only (Sathya, Carpentier 2024,
// "Constrained articulated body dynamics algorithms"). Forces are propagated at the tree's root, which needs no change of frame.
// With mimic joints M does not follow the tree; then y are the rows of L^-T J^T with M = L^T D L.
#pragma once

#include "algorithm/articulated_solve.hpp"
#include "algorithm/cholesky.hpp"
#include "algorithm/constrained/rows.hpp"
#include "base/row_count.hpp"

namespace dyn {

// Degrees of freedom of a constraint, descending, and its y, row by row.
template <class T>
DYN_INLINE Index* supporting_dofs_of(const Model& m, const Data<T>& d, Index slot) {
  return d.supporting_dofs + std::ptrdiff_t(slot) * m.n.nvx;
}
template <class T>
DYN_INLINE T* propagated_jacobian_of(const Model& m, const Data<T>& d, Index slot) {
  return d.propagated_jacobian + row_lanes * std::ptrdiff_t(slot) * m.n.nvx;
}
// 1 / D of the factor.
template <class T>
DYN_INLINE const T* inverse_pivots(const Model& m, const Data<T>& d) {
  return m.has_mimic ? d.D : d.Dinv;
}

// The last degree of freedom of a body, or -1.
inline Index last_dof(const Model& m, Index body) { return body ? first_dof(m, body + 1) - 1 : -1; }

// Propagates one constraint, without mimic joints.
template <class T>
DYN_INLINE void propagate(const Model& m, const Data<T>& d, ConstraintInstance<T>& s, Index* support, T* y) {
  using Six = SixEights<T>;
  using P = typename Six::P;
  const bool joints = between_joints(s.c.type);
  const Index* parent = m.dof_parent();
  const bool ball = of_ball(s.c);
  Index a = ball ? s.c.v1 + 2 : joints ? s.c.v1 : last_dof(m, s.c.body1);
  Index b = joints ? (s.c.body2 ? s.c.v2 : -1) : last_dof(m, s.c.body2), count = 0;
  Six F = Six::zero(), H = F;
  if (!joints && s.c.body1) F = Six::load(s.F1);
  if (!joints && s.c.body2) H = Six::load(s.F2);
  auto pass = [&](Six& f, Index k, T own) DYN_INLINE_LAMBDA {
    P x = f.dot(d.S[k]);
    if (joints) {
      alignas(64) T lanes[row_lanes] = {own};
      x = x + P::load(lanes);
    }
    x.store(y);
    f.add(d.U_root[k], x * -d.Dinv[k]);
    support[count++] = k, y += row_lanes;
  };
  auto entry = [&](Index k) {
    if (ball) return k >= s.c.v1 && k < s.c.v1 + 3 ? T(s.c.axis[int(k - s.c.v1)]) : T(0);
    return joints ? (k == s.c.v1 ? s.g1 : T(0)) + (s.c.body2 && k == s.c.v2 ? s.g2 : T(0)) : T(0);
  };
  while (a != b) {
    if (a > b) pass(F, a, entry(a)), a = parent[a];
    else pass(H, b, entry(b)), b = parent[b];
  }
  F = F + H;
  for (; a >= 0; a = parent[a]) pass(F, a, entry(a));
  s.support_count = count;
}

// J with rows in lanes by the user's degrees of freedom. Adds the rows of a constraint.
template <class T>
void add_constraint_jacobian(const Model& m, const Data<T>& d, const ConstraintInstance<T>& s, T* J) {
  using Six = SixEights<T>;
  auto user = [&](Index k) { return m.has_mimic ? m.expand_v()[k] : k; };
  auto ratio = [&](Index k) { return m.has_mimic ? T(m.ratio_v()[k]) : T(1); };
  if (of_ball(s.c)) {
    for (int i = 0; i < 3; ++i) J[row_lanes * user(s.c.v1 + i)] = T(s.c.axis[i]);
    return;
  }
  if (between_joints(s.c.type)) {  // of joints that follow no other
    J[row_lanes * user(s.c.v1)] += s.g1;
    if (s.c.body2) J[row_lanes * user(s.c.v2)] += s.g2;
    return;
  }
  auto add = [&](Index i, const T* lanes) {
    const Six F = Six::load(lanes);
    for (; i != 0; i = m.bodies()[i].parent)
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) {
        T* row = J + row_lanes * user(k);
        (Six::P::load(row) + F.dot(d.S[k]) * ratio(k)).store(row);
      }
  };
  if (s.c.body1) add(s.c.body1, s.F1);
  if (s.c.body2) add(s.c.body2, s.F2);
}
// J of a constraint, nv rows of lanes.
template <class T>
void constraint_jacobian(const Model& m, const Data<T>& d, const ConstraintInstance<T>& s, T* J) {
  std::fill_n(J, row_lanes * std::ptrdiff_t(m.n.nv), T(0));
  add_constraint_jacobian(m, d, s, J);
}

// The last of the user's degrees of freedom that move a body, or -1. The others are its ancestors in the elimination tree,
// because all are coupled.
inline Index last_user_dof(const Model& m, Index body) {
  Index last = -1;
  for (Index i = body; i != 0; i = m.bodies()[i].parent)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) last = std::max(last, m.expand_v()[k]);
  return last;
}

// One step of the elimination: takes row i out of J.
template <class T>
DYN_INLINE void eliminate_row(const Model& m, const Data<T>& d, Index i, T* J, T* y) {
  using P = Simd<T, row_lanes>;
  const T* row = factor_row(m, d, i);
  const P x = P::load(J + row_lanes * i), xD = x * d.D[i];
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last, Index at) {
    for (Index j = first; j < last; ++j) {
      T* to = J + row_lanes * j;
      (P::load(to) - xD * row[at + j - first]).store(to);
    }
  });
  x.store(y);
}

// L^-T J^T of one constraint, with mimic joints.
template <class T>
void eliminate_constraint(const Model& m, const Data<T>& d, ConstraintInstance<T>& s, Index* support, T* y) {
  using P = Simd<T, row_lanes>;
  const Index *parent = m.dof_parent(), *user = m.expand_v();
  const bool joints = between_joints(s.c.type);
  Index a = joints ? user[s.c.v1 + (of_ball(s.c) ? 2 : 0)] : last_user_dof(m, s.c.body1);
  Index b = !joints ? last_user_dof(m, s.c.body2) : s.c.body2 ? user[s.c.v2] : -1;
  T* const J = d.constraint_columns;
  for (const Index last : {a, b})
    for (Index i = last; i >= 0; i = parent[i]) P::zero().store(J + row_lanes * i);
  add_constraint_jacobian(m, d, s, J);
  s.support_count = 0;
  while (a >= 0 || b >= 0) {
    const Index i = std::max(a, b);
    eliminate_row(m, d, i, J, y), y += row_lanes;
    support[s.support_count++] = i;
    if (a == i) a = parent[a];
    if (b == i) b = parent[b];
  }
}

// Clears the dropped rows of a constraint in its propagated columns.
template <class T>
void clear_dropped(const ConstraintInstance<T>& s, T* y) {
  for (Index r = 0; r < s.rows; ++r)
    if (s.dropped >> r & 1)
      for (Index n = 0; n < s.support_count; ++n) y[row_lanes * n + r] = T(0);
}

template <class T>
void propagate_rows(const Model& m, Data<T>& d) {
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index k) {
    T* y = propagated_jacobian_of(m, d, k);
    if (m.has_mimic) eliminate_constraint(m, d, s, supporting_dofs_of(m, d, k), y);
    else propagate(m, d, s, supporting_dofs_of(m, d, k), y);
    if (s.dropped) clear_dropped(s, y);
  });
}

// Sum of y_s y_t^T / D over common degrees of freedom. Columns are the rows of s; the rows of t are in lanes.
template <int columns, class T>
DYN_INLINE void couple(const Index* ks, Index ns, const T* ys, const Index* kt, Index nt, const T* yt, const T* Dinv, T* G,
                       std::ptrdiff_t ld) {
  using P = Simd<T, row_lanes>;
  P sum[columns];
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c) sum[c] = P::zero();
  for (Index i = 0, j = 0; i < ns && j < nt;) {
    if (ks[i] > kt[j]) {
      ++i;
    } else if (ks[i] < kt[j]) {
      ++j;
    } else {
      const P y = P::load(yt + row_lanes * j) * Dinv[ks[i]];
      const T* x = ys + row_lanes * i;
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) sum[c] = sum[c] + y * x[c];
      ++i, ++j;
    }
  }
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c) sum[c].store(G + ld * c);
}

// G, rows x rows with leading dimension ld = padded_rows(rows), both triangles. Constraints t >= s write whole lanes at and below
// the diagonal. Lanes beyond their rows are overwritten by the next constraint, so the order matters.
template <class T>
void delassus(const Model& m, Data<T>& d, Index rows, T* G) {
  const std::ptrdiff_t ld = padded_rows(rows);
  const T* Dinv = inverse_pivots(m, d);
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index i) {
    for (Index j = i; j < m.n.slots; ++j) {
      const ConstraintInstance<T>& t = d.slots[j];
      if (!t.rows) continue;
      auto block = [&]<int columns>() {
        couple<columns>(supporting_dofs_of(m, d, i), s.support_count, propagated_jacobian_of(m, d, i),
                        supporting_dofs_of(m, d, j), t.support_count, propagated_jacobian_of(m, d, j), Dinv,
                        G + t.first + ld * s.first, ld);
      };
      with_row_count(s.rows, block);
    }
  });
  mirror(G, ld, rows);
}

// x = Y^T lambda by degrees of freedom.
template <class T>
void gather(const Model& m, Data<T>& d, const T* lambda, T* x) {
  std::fill_n(x, m.n.nv, T(0));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index i) {
    const Index* k = supporting_dofs_of(m, d, i);
    const T* y = propagated_jacobian_of(m, d, i);
    T l[max_rows] = {};
    for (Index r = 0; r < s.rows; ++r) l[r] = lambda[s.first + r];
    for (Index n = 0; n < s.support_count; ++n, y += row_lanes) {
      T sum = T(0);
      for (int r = 0; r < max_rows; ++r) sum += r < s.rows ? y[r] * l[r] : T(0);
      x[k[n]] += sum;
    }
  });
}

// Sum of D L_i x over the ancestors of i.
template <class T>
T row_times(const Model& m, const Data<T>& d, Index i, const T* x) {
  const T* row = factor_row(m, d, i);
  T sum = T(0);
  for_each_run(m, m.dof_parent()[i], [&](Index first, Index last, Index at) {
    for (Index j = first; j < last; ++j) sum += row[at + j - first] * x[j];
  });
  return sum;
}

// x = M^-1 J^T lambda from x = Y^T lambda, several trees side by side.
template <class T>
void scatter(const Model& m, Data<T>& d, T* x, Index begin, Index end) {
  if (m.has_mimic) {
    for (Index i = 0; i < m.n.nv; ++i) x[i] = (x[i] - row_times(m, d, i, x)) * d.D[i];
    return;
  }
  const Index *parent = m.dof_parent(), *forks = m.dof_forks();
  Motion<T> a = Motion<T>::zero();
  for (Index k = begin; k < end; ++k) {
    const Index p = parent[k];
    if (p != k - 1) a = p >= 0 ? d.moved[p] : Motion<T>::zero();
    x[k] = (x[k] - dot(a, d.U_root[k])) * d.Dinv[k];
    a = a + d.S[k] * x[k];
    if (forks[k]) d.moved[k] = a;
  }
}
template <class T>
void scatter(const Model& m, Data<T>& d, T* x) {
  scatter(m, d, x, 0, m.n.nv);
}

// out = G x for a vector, by the factors.
template <class T>
void delassus_times(const Model& m, Data<T>& d, const T* x, T* by_dof, T* out) {
  gather(m, d, x, by_dof);
  const T* Dinv = inverse_pivots(m, d);
  for (Index k = 0; k < m.n.nv; ++k) by_dof[k] *= Dinv[k];
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index i) {
    using P = Simd<T, row_lanes>;
    P sum = P::zero();
    const Index* k = supporting_dofs_of(m, d, i);
    const T* y = propagated_jacobian_of(m, d, i);
    for (Index n = 0; n < s.support_count; ++n) sum = sum + P::load(y + row_lanes * n) * by_dof[k[n]];
    for (Index r = 0; r < s.rows; ++r) out[s.first + r] = sum[int(r)];
  });
}

}  // namespace dyn
