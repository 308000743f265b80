// Derivatives of the rows c = d2C/dt2 + stiffness C + damping dC/dt at a given ddq, and of the forces J^T lambda at a given lambda, on the tangent
// space. A row depends on the motion of B as seen from A alone, so that it is enough to know what it makes of a displacement S of B
// and of changes of B's spatial velocity and acceleration,
//   dc = c_S S + c_V dV + J dA        d(wrench) = P S
// which dual numbers give for every constraint. A step along degree of freedom k (psi', psi'': rnea_derivatives.hpp; of a body's V and A)
//   by q:  S = S_k   dV = psi' + S x V   dA = psi'' + psi' x V + S x A        by v:  dV = S_k   dA = psi' + V_k x S + S x V
// moves B when k carries B. When k carries A, the same step with B's V and A has the opposite effect, for that of both together is none.
#pragma once

#include "dyn/algorithm/rnea_derivatives.hpp"
#include "dyn/base/dual.hpp"
#include "dyn/constraint/constrained_dynamics.hpp"

namespace dyn {

// Directions: S, then dV, both at B's origin.
inline constexpr int row_directions = 12;

// d(log3 R) = Jlog of the other side, for a rotation that is turned from the left.
template <class T>
Vec3<Dual<T>> log3(const Mat3<Dual<T>>& R) {
  auto part = [&](auto&& of) {
    auto column = [&](const Vec3<Dual<T>>& c) { return Vec3<T>::make(of(c[0]), of(c[1]), of(c[2])); };
    return Mat3<T>{column(R.x), column(R.y), column(R.z)};
  };
  const Mat3<T> value = part([](const Dual<T>& a) { return a.x; });
  const Vec3<T> w = log3(value);
  const Mat3<T> J = transpose(Jlog3(w));
  Dual<T> x(w[0]), y(w[1]), z(w[2]);
  for (int k = 0; k < row_directions; ++k) {
    const Mat3<T> turn = times_transpose(part([&](const Dual<T>& a) { return a.d[k]; }), value);
    const Vec3<T> by = J * Vec3<T>::make(turn(2, 1), turn(0, 2), turn(1, 0));
    x.d[k] = by[0], y.d[k] = by[1], z.d[k] = by[2];
  }
  return Vec3<Dual<T>>::make(x, y, z);
}

template <class T>
struct RowDerivatives {
  T c[most_rows][row_directions];      // c_S, c_V
  T rate[most_rows][row_directions];   // the same of dC/dt alone
  Force<T> J[most_rows];   // at B's origin
  Motion<T> V, A;          // of B at its origin; A spatial, less gravity
  Force<T> F;              // sum of lambda times the unit wrenches, there
  T P[6][6];               // column k: its change by the k-th component of S
  Vec3<T> x1, x2;          // B's origin from the roots of the two bodies' trees
};

template <class T>
Vec3<Dual<T>> lift(const Vec3<T>& a) {
  return Vec3<Dual<T>>::make(Dual<T>(a[0]), Dual<T>(a[1]), Dual<T>(a[2]));
}
template <class T>
Mat3<Dual<T>> lift(const Mat3<T>& A) {
  return {lift(A.x), lift(A.y), lift(A.z)};
}
// a + sum over k of d(k) times direction k
template <class T, class F>
Vec3<Dual<T>> lift(const Vec3<T>& a, F&& d) {
  Dual<T> x(a[0]), y(a[1]), z(a[2]);
  for (int k = 0; k < row_directions; ++k) {
    const Vec3<T> by = d(k);
    x.d[k] = by[0], y.d[k] = by[1], z.d[k] = by[2];
  }
  return Vec3<Dual<T>>::make(x, y, z);
}

// v, a expanded: at the acceleration that dynamics found.
template <class T>
void frame_row_derivatives(const Model& m, const Data<T>& d, const Slot<T>& s, const T* v, const T* a, const T* lambda, RowDerivatives<T>& out) {
  using D = Dual<T>;
  const MovingFrame<T> A = moving_frame(m, d, s.c.body2, s.c.X2, v, a), B = moving_frame(m, d, s.c.body1, s.c.X1, v, a);
  const Vec3<T> o = Vec3<T>::zero();
  auto push = [&](int k) { return k < 3 ? unit3<T>(k) : o; };                 // displacement of the origin
  auto turn = [&](int k) { return k >= 3 && k < 6 ? unit3<T>(k - 3) : o; };   // rotation
  auto dv = [&](int k) { return (k >= 6 && k < 9 ? unit3<T>(k - 6) : o) + cross(B.w, push(k)); };
  auto dw = [&](int k) { return k >= 9 ? unit3<T>(k - 9) : o; };
  const MovingFrame<D> AD{lift(A.R), lift(A.p), lift(A.x), lift(A.v), lift(A.w), lift(A.a), lift(A.dw)};
  auto axis = [&](const Vec3<T>& c) { return lift(c, [&](int k) { return cross(turn(k), c); }); };
  const MovingFrame<D> BD{{axis(B.R.x), axis(B.R.y), axis(B.R.z)}, lift(B.p, push), lift(B.x, push), lift(B.v, dv), lift(B.w, dw),
                          lift(B.a, [&](int k) { return cross(B.dw, push(k)) + cross(dw(k), B.v) + cross(B.w, dv(k)); }), lift(B.dw)};
  const RelativeMotion<D> X = relative_motion(AD, BD);
  const T kp = T(s.c.stiffness), kd = T(s.c.damping);
  out.F = Force<T>::zero();
  for (auto& column : out.P)
    for (T& e : column) e = T(0);
  struct Row {
    Vec3<D> f, t;
    D error, extra;
  } found[most_rows];
  visit_frame_constraint(s.c.type, [&]<class K>() {
    K::evaluate(s.c, X.X, [&](int i, const Vec3<D>& f, const Vec3<D>& t, const D& error, const D& extra) { found[i] = {f, t, error, extra}; });
  });
  auto value = [](const Vec3<D>& u) { return Vec3<T>::make(u[0].x, u[1].x, u[2].x); };
  auto part = [](const Vec3<D>& u, int k) { return Vec3<T>::make(u[0].d[k], u[1].d[k], u[2].d[k]); };
  for (int i = 0; i < s.rows; ++i) {
    const Row& row = found[i];
    const D rate = dot(row.f, X.X.v) + dot(row.t, X.X.w), second = dot(row.f, X.dv) + dot(row.t, X.dw) + row.extra;
    const typename D::Lanes c = second.d + kp * row.error.d + kd * rate.d;
    for (int k = 0; k < row_directions; ++k) out.c[i][k] = c[k], out.rate[i][k] = rate.d[k];
    const Force<T> unit{A.R * value(row.f), A.R * value(row.t)};
    out.J[i] = unit;
    out.F = out.F + unit * lambda[i];
    for (int k = 0; k < 6; ++k) {
      const Vec3<T> force = A.R * part(row.f, k) * lambda[i], moment = (A.R * part(row.t, k) + cross(push(k), unit.linear)) * lambda[i];
      for (int r = 0; r < 3; ++r) out.P[k][r] += force[r], out.P[k][3 + r] += moment[r];
    }
  }
  const Vec3<T> g = Vec3<T>::make(T(m.gravity[0]), T(m.gravity[1]), T(m.gravity[2]));
  out.V = {B.v, B.w};
  out.A = {B.a - cross(B.w, B.v) - g, B.dw};
  out.x1 = B.x, out.x2 = A.x + (B.p - A.p);
}

// f(expanded degree of freedom, carries B, carries A, its column at B's origin) over those that carry one of the two or both.
template <class T, class F>
void for_each_of_both(const Model& m, const Slot<T>& s, const Vec3<T>& x1, const Vec3<T>& x2, F&& f) {
  auto parent = [&](Index i) { return m.bodies()[i].parent; };
  for (Index i = s.c.body1, j = s.c.body2; i != 0 || j != 0;) {
    const bool b = i >= j, a = j >= i;
    const Index at = b ? i : j;
    for (Index k = first_dof(m, at + 1) - 1; k >= m.bodies()[at].idx_v; --k) f(k, b, a, b ? x1 : x2);
    if (b) i = parent(i);
    if (a) j = parent(j);
  }
}

template <class T>
DYN_INLINE T apply(const T* row, const Motion<T>& s, const Motion<T>& dV) {
  T sum = T(0);
  for (int x = 0; x < 3; ++x)
    sum += row[x] * s.linear[x] + row[3 + x] * s.angular[x] + row[6 + x] * dV.linear[x] + row[9 + x] * dV.angular[x];
  return sum;
}

}  // namespace dyn
