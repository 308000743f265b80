// Contribution of each constraint to the system of derivatives (derivatives.hpp): D at fixed ddq and lambda, and the correction
// of H for forces that change relative to their bodies.
#pragma once

#include "algorithm/constrained/kkt_inverse.hpp"
#include "algorithm/constrained/row_derivatives.hpp"

namespace dyn {

// A user's degree of freedom and its ratio in an expanded one.
DYN_INLINE Index user_dof(const Model& m, Index k) { return m.has_mimic ? m.expand_v()[k] : k; }
template <class T>
DYN_INLINE T user_ratio(const Model& m, Index k) {
  return m.has_mimic ? T(m.ratio_v()[k]) : T(1);
}

// Adds the constraint forces to those of the composites, before these are summed.
template <class T>
void subtract_constraint_forces(const Model& m, Data<T>& d) {
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    if (between_joints(s.c.type)) return;
    auto subtract = [&](Index body, const T* lanes) {
      T f[6] = {};
      for (int x = 0; x < 6; ++x)
        for (Index r = 0; r < s.rows; ++r) f[x] += lanes[row_lanes * x + r] * d.lambda[s.first + r];
      d.composite[body].f = d.composite[body].f - load_force(static_cast<const T*>(f));
    };
    if (s.c.body1) subtract(s.c.body1, s.F1);
    if (s.c.body2) subtract(s.c.body2, s.F2);
  });
}

// H(k, l) -= S_k . f_l for degrees of freedom k from one body up to another (exclusive) and l of a constraint.
template <class T>
DYN_INLINE void subtract_products(const Model& m, const Data<T>& d, Index from, Index to, const Index* dofs, Index count,
                                  const Force<T>* f, T* H) {
  using P = Simd<T, 4>;
  const std::ptrdiff_t n = m.n.nv;
  for (Index i = from; i != to; i = m.bodies()[i].parent) {
    Index first = m.bodies()[i].idx_v;
    const Index last = first_dof(m, i + 1);
    for (; m.bodies()[i].parent == i - 1 && i - 1 != to; --i) first = m.bodies()[i - 1].idx_v;
    for (Index k = first; k < last; k += 4) {
      const Six<T> S = Six<T>::transposed(d.S + k);
      for (Index c = 0; c < count; ++c) {
        const P change = S.dot(f[c]);
        T* to_H = H + k + n * dofs[c];
        if (k + 4 <= last) (P::load(to_H) - change).store(to_H);
        else
          for (Index x = 0; x < last - k; ++x) to_H[x] -= change[int(x)];
      }
    }
  }
}
// The same with mimic joints.
template <class T>
void subtract_products_of_mimics(const Model& m, const Data<T>& d, Index from, Index to, const Index* dofs, Index count,
                                 const Force<T>* f, T* H) {
  for (Index i = from; i != to; i = m.bodies()[i].parent)
    for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
      for (Index c = 0; c < count; ++c)
        H[user_dof(m, k) + std::ptrdiff_t(m.n.nv) * user_dof(m, dofs[c])] -=
            user_ratio<T>(m, k) * user_ratio<T>(m, dofs[c]) * dot(d.S[k], f[c]);
}

// H -= change of J^T lambda relative to moving bodies, with a force F at B and -F at A. A step S of B changes the wrench by PS; a
// force that moves with the body changes by S x* F. A feels -PS. A step of A has the opposite effect.
template <class T>
void subtract_force_changes(const Model& m, Data<T>& d, const ConstraintInstance<T>& s, const RowDerivatives<T>& x,
                            const Index* dofs, Index of_first, Index common, T* H) {
  Force<T> *on_B = d.Fq, *on_both = d.Fv, *on_A = d.F;  // reused buffers
  for (Index c = 0; c < s.support_count; ++c) {
    const Index k = dofs[c];
    const bool first = c < of_first;
    const Motion<T> S = shift(d.S[k], first ? x.x1 : x.x2) * (first ? T(1) : T(-1));
    Force<T> PS{x.F_step * S.linear, x.F_turn * S.angular}, transported = cross(S, x.F);
    PS.angular += cross(S.linear, x.F.linear);
    on_B[c] = shift(PS - transported, x.x1), on_both[c] = shift(Force<T>::zero() - transported, x.x1),
    on_A[c] = shift(Force<T>::zero() - PS, x.x2);
  }
  auto subtract = [&](Index from, Index to, const Force<T>* f) {
    if (m.has_mimic) subtract_products_of_mimics(m, d, from, to, dofs, s.support_count, f, H);
    else subtract_products(m, d, from, to, dofs, s.support_count, f, H);
  };
  subtract(s.c.body1, common, on_B), subtract(common, 0, on_both), subtract(s.c.body2, common, on_A);
}

// Rows x nv.
template <class T>
DYN_INLINE void add_lanes(const Simd<T, row_lanes>& x, T* to) {
  (Simd<T, row_lanes>::load(to) + x).store(to);
}

// Adds a constraint's part of Dq, Dv, H. Stores its degrees of freedom and J in place of those of G.
template <class T>
void differentiate_frames(const Model& m, Data<T>& d, ConstraintInstance<T>& s, Index slot, const T* v, const T* a,
                          const KktSystem<T>& K, T* H) {
  using Six = SixEights<T>;
  RowDerivatives<T> x;
  frame_row_derivatives(m, d, s, v, a, d.lambda + s.first, x);
  Index* dofs = supporting_dofs_of(m, d, slot);
  T* J = propagated_jacobian_of(m, d, slot);
  const Index common = common_body(m, s.c.body1, s.c.body2);
  s.support_count = 0;
  auto along = [&](Index body, const typename RowDerivatives<T>::Wrenches& w) {
    const Six alpha = Six::load(w.alpha), beta = Six::load(w.beta), gamma = Six::load(w.gamma);
    for (Index i = body; i != common; i = m.bodies()[i].parent)
      for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k) {
        const T ratio = user_ratio<T>(m, k);
        const std::ptrdiff_t at = s.first + std::ptrdiff_t(K.rows) * user_dof(m, k);
        add_lanes((alpha.dot(d.S[k]) + beta.dot(d.dS[k]) + gamma.dot(d.ddS[k])) * ratio, K.Dq + at);
        add_lanes((beta.dot(d.S[k]) + gamma.dot(d.W[k])) * ratio, K.Dv + at);
        (gamma.dot(d.S[k]) * ratio).store(J + row_lanes * std::ptrdiff_t(s.support_count));
        dofs[s.support_count++] = k;
      }
  };
  along(s.c.body1, x.by1);
  const Index of_first = s.support_count;
  along(s.c.body2, x.by2);
  subtract_force_changes(m, d, s, x, dofs, of_first, common, H);
  if (m.has_mimic)
    for (Index c = 0; c < s.support_count; ++c) dofs[c] = m.expand_v()[dofs[c]];
}

// The same for a row between joints, which follow no other (check_constraint): their ratio is one.
template <class T>
void differentiate_joints(const Model& m, Data<T>& d, ConstraintInstance<T>& s, Index slot, const T* v, const T* a,
                          const KktSystem<T>& K, T* H) {
  const bool two = s.c.body2 != 0;
  JointRow<T> row{};
  visit_joint_constraint(s.c.type, [&]<class K_>() { row = K_::evaluate(s.c, d.q[s.c.q1], two ? d.q[s.c.q2] : T(0)); });
  const T kp = T(s.c.stiffness), kd = T(s.c.damping), lambda = d.lambda[s.first];
  const std::ptrdiff_t u1 = user_dof(m, s.c.v1), rows = K.rows;
  Index* dofs = supporting_dofs_of(m, d, slot);
  T *J = propagated_jacobian_of(m, d, slot), *Dq = K.Dq + s.first, *Dv = K.Dv + s.first;
  std::fill_n(J, 2 * row_lanes, T(0));
  Dq[rows * u1] += kp * row.slope;
  Dv[rows * u1] += kd * row.g1;
  dofs[0] = Index(u1), J[0] = row.g1;
  s.support_count = 1;
  if (!two) return;
  const T v2 = v[s.c.v2];
  const std::ptrdiff_t u2 = user_dof(m, s.c.v2);
  Dq[rows * u2] += row.curvature * a[s.c.v2] + row.third * v2 * v2 + kp * row.g2 + kd * row.curvature * v2;
  Dv[rows * u2] += kd * row.g2 + T(2) * row.curvature * v2;
  H[u2 + m.n.nv * u2] -= lambda * row.curvature;
  dofs[1] = Index(u2), J[row_lanes] = row.g2;
  s.support_count = 2;
}

template <class T>
void differentiate_constraints(const Model& m, Data<T>& d, const T* v, const T* a, const KktSystem<T>& K, T* H) {
  std::fill_n(K.Dq, K.rows * std::ptrdiff_t(m.n.nv), T(0)), std::fill_n(K.Dv, K.rows * std::ptrdiff_t(m.n.nv), T(0));
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index slot) {
    if (between_joints(s.c.type)) differentiate_joints(m, d, s, slot, v, a, K, H);
    else differentiate_frames(m, d, s, slot, v, a, K, H);
  });
}

// D += factor times the derivative of the rows' rates by q at the expanded velocity v. Call derivative_columns with zero a
// before.
template <class T>
void differentiate_rates(const Model& m, Data<T>& d, const T* v, bool restitution, const KktSystem<T>& K, T* D) {
  using Six = SixEights<T>;
  for_each_constraint(m, d, [&](ConstraintInstance<T>& s, Index) {
    const T factor = restitution ? T(s.c.restitution) : T(1);
    if (between_joints(s.c.type)) {
      if (s.c.body2) {
        JointRow<T> row{};
        visit_joint_constraint(s.c.type, [&]<class K_>() { row = K_::evaluate(s.c, d.q[s.c.q1], d.q[s.c.q2]); });
        D[s.first + std::ptrdiff_t(K.rows) * user_dof(m, s.c.v2)] += factor * row.curvature * v[s.c.v2];
      }
      return;
    }
    RowDerivatives<T> x;
    frame_row_derivatives(m, d, s, v, static_cast<const T*>(d.zero), d.lambda + s.first, x);
    const Index common = common_body(m, s.c.body1, s.c.body2);
    auto along = [&](Index body, const typename RowDerivatives<T>::Wrenches& w) {
      const Six rate = Six::load(w.rate), gamma = Six::load(w.gamma);
      for (Index i = body; i != common; i = m.bodies()[i].parent)
        for (Index k = m.bodies()[i].idx_v, end = first_dof(m, i + 1); k < end; ++k)
          add_lanes((rate.dot(d.S[k]) + gamma.dot(d.dS[k])) * (factor * user_ratio<T>(m, k)),
                    D + s.first + std::ptrdiff_t(K.rows) * user_dof(m, k));
    };
    along(s.c.body1, x.by1), along(s.c.body2, x.by2);
  });
}

}  // namespace dyn
