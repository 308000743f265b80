// Derivatives of constrained dynamics and of impulses on the tangent space. From M ddq + nle - tau - J^T lambda = 0 and c = 0,
// with H, D the derivatives of the two at fixed ddq and lambda, G = J M^-1 J^T and Z = M^-1 J^T:
//   G dlambda = Z^T H - D        dddq = Z dlambda - M^-1 H
// H is that of inverse dynamics with the constraint forces as external ones, which move with their bodies, less what the forces do beside
// (Carpentier, Budhiraja, Mansard 2021, section IV, for every constraint). Rows at a bound keep their force.
#pragma once

#include "dyn/algorithm/aba_derivatives.hpp"
#include "dyn/algorithm/gravity_derivatives.hpp"
#include "dyn/constraint/row_derivatives.hpp"

namespace dyn {

// Matrices rows x nv, a row's entries side by side.
template <class T>
struct RowMatrices {
  T *Z, *Dq, *Dv, *Dt;
  std::ptrdiff_t ld;
};
inline std::ptrdiff_t dof_room(const Model& m) { return (std::ptrdiff_t(m.n.nv) + 7) / 8 * 8; }
template <class T>
RowMatrices<T> row_matrices(const Model& m, const Data<T>& d) {
  const std::ptrdiff_t n = dof_room(m), size = n * m.n.constraint_rows;
  return {d.row_by_dof, d.row_by_dof + size, d.row_by_dof + 2 * size, d.row_by_dof + 3 * size, n};
}

// Adds to the entry of an expanded degree of freedom.
template <class T>
DYN_INLINE void add_entry(const Model& m, T* row, Index k, T x) {
  if (m.has_mimic) row[m.expand_v()[k]] += T(m.ratio_v()[k]) * x;
  else row[k] += x;
}

// The constraint forces, added to what is given, in the joints' frames.
template <class T>
const T* forces_on_joints(const Model& m, Data<T>& d, const T* fext) {
  if (fext) std::copy(fext, fext + 6 * m.n.joints, d.constraint_fext);
  else std::fill_n(d.constraint_fext, 6 * m.n.joints, T(0));
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    if (between_joints(s.c.type)) return;
    auto add = [&](Index body, const T* lanes) {
      Force<T> f = Force<T>::zero();  // at the tree's root
      for (Index r = 0; r < s.rows; ++r) {
        T unit[6];
        for (int x = 0; x < 6; ++x) unit[x] = lanes[row_lanes * x + r];
        f = f + load_force(unit) * d.lambda[s.first + r];
      }
      f = shift(f, -d.rel[body]);
      const Index joint = m.bodies()[body].joint;
      const Mat3<T> R = d.R[body] * cast<T>(m.joints()[joint].C);
      T* to = d.constraint_fext + 6 * joint;
      store6(load_force(static_cast<const T*>(to)) + Force<T>{transpose_times(R, f.linear), transpose_times(R, f.angular)}, to);
    };
    if (s.c.body1) add(s.c.body1, s.F1);
    if (s.c.body2) add(s.c.body2, s.F2);
  });
  return d.constraint_fext;
}

// H -= what J^T lambda changes by beside moving with its bodies: a force F at B, -F at A. Carried along with B it would change by S x* F.
template <class T>
void subtract_force_changes(const Model& m, Data<T>& d, const Slot<T>& s, const RowDerivatives<T>& x, T* H) {
  const std::ptrdiff_t n = m.n.nv;
  for_each_of_both(m, s, x.x1, x.x2, [&](Index l, bool lb, bool la, const Vec3<T>& at) {
    if (la && lb) return;
    const T sign = lb ? T(1) : T(-1);
    const Motion<T> S = shift(d.S[l], at);
    T own[6] = {};
    for (int k = 0; k < 6; ++k) {
      const T part = k < 3 ? S.linear[k] : S.angular[k - 3];
      for (int r = 0; r < 6; ++r) own[r] += x.P[k][r] * part;
    }
    const Force<T> P = load_force(static_cast<const T*>(own)), beside = P - cross(S, x.F);
    for_each_of_both(m, s, x.x1, x.x2, [&](Index k, bool kb, bool ka, const Vec3<T>& from) {
      const Motion<T> row = shift(d.S[k], from);
      T change = T(0);
      if (kb) change += dot(row, beside);
      if (ka) change -= dot(row, P);
      change *= sign;
      if (m.has_mimic) H[m.expand_v()[k] + n * m.expand_v()[l]] -= T(m.ratio_v()[k]) * T(m.ratio_v()[l]) * change;
      else H[k + n * l] -= change;
    });
  });
}

// A row between joints and its derivatives by q1 and q2.
template <class T>
JointRow<Dual<T>> joint_row(const Data<T>& d, const Slot<T>& s) {
  using D = Dual<T>;
  const D q1 = D::variable(d.q[s.c.q1], 0), q2 = D::variable(s.c.body2 ? d.q[s.c.q2] : T(0), 1);
  JointRow<D> row{D(T(0)), D(T(0)), D(T(0)), D(T(0))};
  visit_joint_constraint(s.c.type, [&]<class K>() { row = K::evaluate(s.c, q1, q2); });
  return row;
}

// Of its forces g1 lambda, g2 lambda.
template <class T>
void subtract_joint_force_changes(const Model& m, const Data<T>& d, const Slot<T>& s, T* H) {
  if (!s.c.body2) return;
  const JointRow<Dual<T>> row = joint_row(d, s);
  const T lambda = d.lambda[s.first];
  auto user = [&](Index k) { return std::ptrdiff_t(m.has_mimic ? m.expand_v()[k] : k); };
  const std::ptrdiff_t at[] = {user(s.c.v1), user(s.c.v2)}, n = m.n.nv;
  for (int k = 0; k < 2; ++k) H[at[0] + n * at[k]] -= lambda * row.g1.d[k], H[at[1] + n * at[k]] -= lambda * row.g2.d[k];
}

template <class T>
void joint_row_derivatives(const Model& m, const Data<T>& d, const Slot<T>& s, const T* v, const T* a, const RowMatrices<T>& X) {
  const JointRow<Dual<T>> row = joint_row(d, s);
  const bool two = s.c.body2 != 0;
  const T kp = T(s.c.stiffness), kd = T(s.c.damping);
  const T v1 = v[s.c.v1], v2 = two ? v[s.c.v2] : T(0), a1 = a[s.c.v1], a2 = two ? a[s.c.v2] : T(0);
  T *Dq = X.Dq + X.ld * s.first, *Dv = X.Dv + X.ld * s.first;
  for (int k = 0; k < (two ? 2 : 1); ++k)
    add_entry(m, Dq, k ? s.c.v2 : s.c.v1, row.g1.d[k] * a1 + row.g2.d[k] * a2 + row.curvature.d[k] * v2 * v2 + kp * row.error.d[k] +
                                              kd * (row.g1.d[k] * v1 + row.g2.d[k] * v2));
  add_entry(m, Dv, s.c.v1, kd * row.g1.x);
  if (two) add_entry(m, Dv, s.c.v2, kd * row.g2.x + T(2) * row.curvature.x * v2);
}

// D of all rows, and H less the changes of the forces; after rnea_derivatives at v, a, which are expanded here.
template <class T>
void differentiate_rows(const Model& m, Data<T>& d, const T* v, const T* a, const RowMatrices<T>& X, T* H) {
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    if (between_joints(s.c.type)) return joint_row_derivatives(m, d, s, v, a, X), subtract_joint_force_changes(m, d, s, H);
    RowDerivatives<T> x;
    frame_row_derivatives(m, d, s, v, a, d.lambda + s.first, x);
    for_each_of_both(m, s, x.x1, x.x2, [&](Index k, bool b, bool both_a, const Vec3<T>& at) {
      if (b && both_a) return;
      const T sign = b ? T(1) : T(-1);
      const Motion<T> S = shift(d.S[k], at), dS = shift(d.dS[k], at), ddS = shift(d.ddS[k], at), W = shift(d.W[k], at);
      const Motion<T> dV = dS + cross(S, x.V), dA = ddS + cross(dS, x.V) + cross(S, x.A), dA_v = W + cross(S, x.V), none = Motion<T>::zero();
      for (Index r = 0; r < s.rows; ++r) {
        add_entry(m, X.Dq + X.ld * (s.first + r), k, sign * (apply(x.c[r], S, dV) + dot(dA, x.J[r])));
        add_entry(m, X.Dv + X.ld * (s.first + r), k, sign * (apply(x.c[r], none, S) + dot(dA_v, x.J[r])));
      }
    });
    subtract_force_changes(m, d, s, x, H);
  });
}

// D += factor times the derivative of the rows' rates by q at the velocity v, expanded, for which derivative_columns was called.
template <class T>
void differentiate_rates(const Model& m, Data<T>& d, const T* v, bool restitution, const RowMatrices<T>& X) {
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    const T factor = restitution ? T(s.c.restitution) : T(1);
    if (between_joints(s.c.type)) {
      if (!s.c.body2) return;
      const JointRow<Dual<T>> row = joint_row(d, s);
      for (int k = 0; k < 2; ++k)
        add_entry(m, X.Dq + X.ld * s.first, k ? s.c.v2 : s.c.v1, factor * (row.g1.d[k] * v[s.c.v1] + row.g2.d[k] * v[s.c.v2]));
      return;
    }
    RowDerivatives<T> x;
    frame_row_derivatives(m, d, s, v, static_cast<const T*>(nullptr), d.lambda + s.first, x);
    for_each_of_both(m, s, x.x1, x.x2, [&](Index k, bool b, bool both_a, const Vec3<T>& at) {
      if (b && both_a) return;
      const Motion<T> S = shift(d.S[k], at), dV = shift(d.dS[k], at) + cross(S, x.V);
      for (Index r = 0; r < s.rows; ++r) add_entry(m, X.Dq + X.ld * (s.first + r), k, (b ? factor : -factor) * apply(x.rate[r], S, dV));
    });
  });
}

// J, rows x nv, a row's entries side by side.
template <class T>
void jacobian_rows(const Model& m, Data<T>& d, T* J, std::ptrdiff_t ld) {
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    slot_jacobian(m, d, s, d.slot_columns);
    transpose(d.slot_columns, row_lanes, s.rows, m.n.nv, T(1), J + ld * s.first, ld);
  });
}

// out_r = sum over k of rows_r[k] M_k, M symmetric nv x nv.
template <class T>
void rows_times(const Model& m, Index rows, const T* R, const T* M, T* out, std::ptrdiff_t ld) {
  using P = Pack<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  for (Index r = 0; r < rows; ++r) {
    T* to = out + ld * r;
    std::fill_n(to, ld, T(0));
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      const T x = R[ld * r + k];
      if (x == T(0)) continue;
      const T* column = M + n * k;
      std::ptrdiff_t i = 0;
      for (; i + 4 <= n; i += 4) (P::load(to + i) + P::load(column + i) * x).store(to + i);
      for (; i < n; ++i) to[i] += x * column[i];
    }
  }
}

// out_r[j] = sum over k of Z_r[k] H(k, j)
template <class T>
void rows_times_columns(const Model& m, Index rows, const T* Z, const T* H, T* out, std::ptrdiff_t ld) {
  using P = Pack<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  for (Index r = 0; r < rows; ++r)
    for (std::ptrdiff_t j = 0; j < n; ++j) {
      const T *z = Z + ld * r, *h = H + n * j;
      P sum = P::zero();
      std::ptrdiff_t k = 0;
      for (; k + 4 <= n; k += 4) sum = sum + P::load(z + k) * P::load(h + k);
      T total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
      for (; k < n; ++k) total += z[k] * h[k];
      out[ld * r + j] = total;
    }
}

// X = G^-1 X for many right-hand sides, a row of X after the other.
template <class T>
void solve_factored_rows(const T* W, const T* Dinv, std::ptrdiff_t ldw, Index n, T* X, std::ptrdiff_t ld, std::ptrdiff_t width) {
  auto axpy = [&](T* to, const T* from, T x) {
    for (std::ptrdiff_t k = 0; k < width; ++k) to[k] += x * from[k];
  };
  for (Index j = 0; j < n; ++j)
    for (Index i = j + 1; i < n; ++i) axpy(X + ld * i, X + ld * j, -W[ldw * j + i] * Dinv[j]);
  for (Index j = n - 1; j >= 0; --j) {
    for (Index i = j + 1; i < n; ++i) axpy(X + ld * j, X + ld * i, -W[ldw * j + i]);
    for (std::ptrdiff_t k = 0; k < width; ++k) X[ld * j + k] *= Dinv[j];
  }
}

// The same where rows may depend on each other or be at a bound (state, or nullptr): the least solution, by the proximal iteration.
template <class T>
void solve_dependent_rows(const Model& m, Data<T>& d, const Index* state, Index n, T* X, std::ptrdiff_t ld, std::ptrdiff_t width) {
  const std::ptrdiff_t ldg = row_room(n);
  const RowWork<T> work = row_work(m, d);
  T *Dinv = work.vector(0), *step = work.vector(1), *asked = work.vector(2), *scale = work.vector(3), *x = work.vector(4), *S = work.scaled, most = T(0);
  using std::sqrt;
  for (Index i = 0; i < n; ++i) most = std::max(most, d.row_matrix[ldg * i + i]);
  for (Index i = 0; i < n; ++i) {
    const T g = d.row_matrix[ldg * i + i];
    scale[i] = g > T(1e-24) * most && !(state && state[i]) ? T(1) / sqrt(g) : T(0);
  }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) S[ldg * j + i] = d.row_matrix[ldg * j + i] * scale[i] * scale[j];
  const T mu = T(automatic_regularisation);
  factor_rows(S, ldg, n, mu, mu / T(2), work.factor, Dinv);
  for (std::ptrdiff_t k = 0; k < width; ++k) {
    for (Index i = 0; i < n; ++i) asked[i] = X[ld * i + k] * scale[i];
    ProximalResult<T> result;
    iterate(S, ldg, n, work.factor, Dinv, asked, ProximalOptions{20, 0, 1e-13}, step, x, result);
    for (Index i = 0; i < n; ++i) X[ld * i + k] = x[i] * scale[i];
  }
}

// dlambda in the place of Z^T H - D.
template <class T>
void solve_row_columns(const Model& m, Data<T>& d, bool bounded, Index rows, T* X, std::ptrdiff_t ld) {
  const std::ptrdiff_t ldg = row_room(rows);
  const RowWork<T> work = row_work(m, d);
  if (!bounded && factor_rows(d.row_matrix, ldg, rows, T(0), T(0), work.factor, work.vector(0)) > T(clearly_independent))
    return solve_factored_rows(work.factor, work.vector(0), ldg, rows, X, ld, m.n.nv);
  solve_dependent_rows(m, d, bounded ? d.row_state : nullptr, rows, X, ld, m.n.nv);
}

// out(:, j) = factor out(:, j) + sum over r of Z_r dlambda(r, j)
template <class T>
void add_forces(const Model& m, Index rows, const T* Z, const T* dlambda, std::ptrdiff_t ld, T* out) {
  using P = Pack<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  for (std::ptrdiff_t j = 0; j < n; ++j)
    for (std::ptrdiff_t i = 0; i < n; i += 4) {
      T* to = out + n * j + i;
      if (i + 4 <= n) {
        P sum = P::load(to);
        for (Index r = 0; r < rows; ++r) sum = sum + P::load(Z + ld * r + i) * dlambda[ld * r + j];
        sum.store(to);
      } else {
        for (std::ptrdiff_t k = 0; k < n - i; ++k)
          for (Index r = 0; r < rows; ++r) to[k] += Z[ld * r + i + k] * dlambda[ld * r + j];
      }
    }
}

// out = -Minv H, both full.
template <class T>
void minus_full_product(const Model& m, const T* Minv, const T* H, T* out) {
  using P = Pack<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    T* to = out + n * j;
    std::fill_n(to, n, T(0));
    for (std::ptrdiff_t k = 0; k < n; ++k) {
      const T x = -H[k + n * j];
      if (x == T(0)) continue;
      const T* column = Minv + n * k;
      std::ptrdiff_t i = 0;
      for (; i + 4 <= n; i += 4) (P::load(to + i) + P::load(column + i) * x).store(to + i);
      for (; i < n; ++i) to[i] += x * column[i];
    }
  }
}

// Whether H has entries beside those of related degrees of freedom.
template <class T>
bool beyond_tree(const Model& m, Data<T>& d) {
  bool found = m.has_mimic;
  for_each_slot(m, d, [&](Slot<T>& s, Index) { found = found || s.c.body2 != 0; });
  return found;
}

// Inverse dynamics leaves entries of unrelated degrees of freedom zero for good; forces between bodies have filled them.
template <class T>
void clear_unrelated(const Model& m, Data<T>& d) {
  std::fill_n(d.dtau_dq, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
}

// d.Minv from d.M, Z. Returns 0 or the joint that is singular; d.dtau_dq is then cleared.
template <class T>
Index prepare_derivatives(const Model& m, Data<T>& d, Index rows, const RowMatrices<T>& X) {
  if (const Index failed = factorize(m, d)) return clear_unrelated(m, d), joint_of(m, failed - 1);
  invert(m, d);
  jacobian_rows(m, d, X.Dt, X.ld);
  rows_times(m, rows, X.Dt, d.Minv, X.Z, X.ld);
  return 0;
}
// D becomes dlambda; X.Dt is lost.
template <class T>
void solve_forces(const Model& m, Data<T>& d, bool bounded, Index rows, const RowMatrices<T>& X, const T* H, T* D) {
  rows_times_columns(m, rows, X.Z, H, X.Dt, X.ld);
  for (std::ptrdiff_t k = 0; k < X.ld * rows; ++k) D[k] = X.Dt[k] - D[k];
  solve_row_columns(m, d, bounded, rows, D, X.ld);
}

// d.constraint_ddq, d.lambda, their derivatives: d.ddq_dq, d.ddq_dv, d.constrained_Minv and, of lambda, row_matrices. Returns 0 or the joint that is
// singular.
template <class T>
Index constrained_dynamics_derivatives(const Model& m, Data<T>& d, const T* v, const T* tau, const T* fext, const ProximalOptions& options,
                                       dynConstraintResult& result) {
  T* ddq = d.constraint_ddq;
  if (const Index failed = constrained_dynamics(m, d, v, tau, fext, options, ddq, result)) return failed;
  const Index rows = result.rows;
  const RowMatrices<T> X = row_matrices(m, d);
  const bool bounded = any_bounded(m, d);
  std::fill_n(X.Dq, X.ld * rows, T(0)), std::fill_n(X.Dv, X.ld * rows, T(0));
  rnea_derivatives(m, d, v, static_cast<const T*>(ddq), forces_on_joints(m, d, fext));
  differentiate_rows(m, d, d.expand(m, v, d.vx), d.expand(m, static_cast<const T*>(ddq), d.ax), X, d.dtau_dq);
  if (const Index failed = prepare_derivatives(m, d, rows, X)) return failed;
  solve_forces(m, d, bounded, rows, X, d.dtau_dq, X.Dq);
  solve_forces(m, d, bounded, rows, X, d.dtau_dv, X.Dv);
  if (beyond_tree(m, d)) minus_full_product(m, d.Minv, d.dtau_dq, d.ddq_dq), minus_full_product(m, d.Minv, d.dtau_dv, d.ddq_dv);
  else minus_inverse_times(m, d.Minv, d.dtau_dq, d.dtau_dv, d.ddq_dq, d.ddq_dv);
  for (std::ptrdiff_t k = 0; k < X.ld * rows; ++k) X.Dt[k] = -X.Z[k];
  solve_row_columns(m, d, bounded, rows, X.Dt, X.ld);
  std::copy(d.Minv, d.Minv + std::ptrdiff_t(m.n.nv) * m.n.nv, d.constrained_Minv);
  add_forces(m, rows, X.Z, X.Dq, X.ld, d.ddq_dq);
  add_forces(m, rows, X.Z, X.Dv, X.ld, d.ddq_dv);
  add_forces(m, rows, X.Z, X.Dt, X.ld, d.constrained_Minv);
  clear_unrelated(m, d);
  return 0;
}

// The same of impulses: d.constraint_ddq is v_plus, d.ddq_dq, d.ddq_dv its derivatives.
//   M (v_plus - v) - J^T lambda = 0        J (v_plus + e v) = 0
template <class T>
Index constraint_impulse_derivatives(const Model& m, Data<T>& d, const T* v, const ProximalOptions& options, dynConstraintResult& result) {
  T *v_plus = d.constraint_ddq, *jump = d.constraint_step, *at_rest = d.constrained_Minv;
  const T *zero = d.zero, *none = nullptr;
  const std::ptrdiff_t n = m.n.nv;
  if (const Index failed = constraint_impulse(m, d, v, options, v_plus, result)) return failed;
  const Index rows = result.rows;
  const RowMatrices<T> X = row_matrices(m, d);
  const bool bounded = any_bounded(m, d);

  // by q: H of M jump - J^T lambda, what gravity and springs do left out
  std::fill_n(at_rest, n * n, T(0));
  static_torque_derivatives(m, d, none, at_rest);
  for (Index k = 0; k < m.n.nv; ++k) jump[k] = v_plus[k] - v[k];
  rnea_derivatives(m, d, zero, static_cast<const T*>(jump), forces_on_joints(m, d, none));
  for (std::ptrdiff_t k = 0; k < n * n; ++k) d.dtau_dq[k] -= at_rest[k];
  // and D of J (v_plus + e v)
  std::fill_n(X.Dq, X.ld * rows, T(0));
  const T* after = d.expand(m, static_cast<const T*>(v_plus), d.ax);
  derivative_columns(m, d, after, zero);
  differentiate_rates(m, d, after, false, X);
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    if (between_joints(s.c.type)) return subtract_joint_force_changes(m, d, s, d.dtau_dq);
    RowDerivatives<T> x;
    frame_row_derivatives(m, d, s, zero, zero, d.lambda + s.first, x);
    subtract_force_changes(m, d, s, x, d.dtau_dq);
  });
  const T* before = d.expand(m, v, d.vx);
  derivative_columns(m, d, before, zero);
  differentiate_rates(m, d, before, true, X);

  if (const Index failed = prepare_derivatives(m, d, rows, X)) return failed;
  for_each_slot(m, d, [&](Slot<T>& s, Index) {
    for (std::ptrdiff_t k = X.ld * s.first; k < X.ld * (s.first + s.rows); ++k) X.Dv[k] = -(T(1) + T(s.c.restitution)) * X.Dt[k];
  });
  solve_row_columns(m, d, bounded, rows, X.Dv, X.ld);
  solve_forces(m, d, bounded, rows, X, d.dtau_dq, X.Dq);
  minus_full_product(m, d.Minv, d.dtau_dq, d.ddq_dq);
  std::fill_n(d.ddq_dv, n * n, T(0));
  for (std::ptrdiff_t k = 0; k < n; ++k) d.ddq_dv[k + n * k] = T(1);
  add_forces(m, rows, X.Z, X.Dq, X.ld, d.ddq_dq);
  add_forces(m, rows, X.Z, X.Dv, X.ld, d.ddq_dv);
  clear_unrelated(m, d);
  return 0;
}

}  // namespace dyn
