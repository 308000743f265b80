// Operations on configurations, joint by joint: the space is a product of the joints' own.
#pragma once

#include "algorithm/passes.hpp"
#include "model/unit_norms.hpp"

namespace dyn {

// f.template operator()<J>(body) for every body that has coordinates of its own.
template <class F>
DYN_INLINE void for_each_leader(const Model& m, F&& f) {
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    if (!b.follower) f.template operator()<J>(b);
  });
}

// The factors of the configuration space: flat(in q, in v, count) for coordinates of vector spaces side by side, and
// on_manifold.template operator()<J>(body) for the bodies that have others.
template <class Part, class Flat, class OnManifold>
DYN_INLINE void for_each_factor(const Model& m, const Part& part, Flat&& flat, OnManifold&& on_manifold) {
  for (Index k = 0; k < part.euclidean_span_count(m); ++k) {
    const EuclideanSpan& s = part.euclidean_spans(m)[k];
    flat(s.first_q, s.first_v, s.count);
  }
  for (Index k = 0; k < part.manifold_joint_count(m); ++k) {
    const Body& b = m.bodies()[part.manifold_joints(m)[k]];
    visit(b.type, [&]<class J>() DYN_INLINE_LAMBDA { on_manifold.template operator()<J>(b); });
  }
}
template <class Flat, class OnManifold>
DYN_INLINE void for_each_factor(const Model& m, Flat&& flat, OnManifold&& on_manifold) {
  for_each_factor(m, WholeModel{}, flat, on_manifold);
}

// out = q (+) v; out may be q. Part: of some of the trees.
template <class T, class Part>
void integrate(const Model& m, const Part& part, const T* q, const T* v, T* out) {
  for_each_factor(
      m, part,
      [&](Index iq, Index iv, Index n) DYN_INLINE_LAMBDA {
#pragma GCC ivdep
        for (Index k = 0; k < n; ++k) out[iq + k] = q[iq + k] + v[iv + k];
      },
      [&]<class J>(const Body& b) DYN_INLINE_LAMBDA { J::integrate(q + b.user_q, v + b.user_v, out + b.user_q); });
}
template <class T>
void integrate(const Model& m, const T* q, const T* v, T* out) {
  integrate(m, WholeModel{}, q, v, out);
}

// v = q1 (-) q0
template <class T>
void difference(const Model& m, const T* q0, const T* q1, T* v) {
  for_each_factor(
      m,
      [&](Index iq, Index iv, Index n) DYN_INLINE_LAMBDA {
#pragma GCC ivdep
        for (Index k = 0; k < n; ++k) v[iv + k] = q1[iq + k] - q0[iq + k];
      },
      [&]<class J>(const Body& b) DYN_INLINE_LAMBDA { J::difference(b, q0 + b.user_q, q1 + b.user_q, v + b.user_v); });
}

// out = q0 (+) u (q1 (-) q0); out may be q0 or q1.
template <class T>
void interpolate(const Model& m, const T* q0, const T* q1, T u, T* out) {
  for_each_factor(
      m,
      [&](Index iq, Index, Index n) DYN_INLINE_LAMBDA {
#pragma GCC ivdep
        for (Index k = 0; k < n; ++k) out[iq + k] = q0[iq + k] + (q1[iq + k] - q0[iq + k]) * u;
      },
      [&]<class J>(const Body& b) DYN_INLINE_LAMBDA {
        T v[6];
        J::difference(b, q0 + b.user_q, q1 + b.user_q, v);
        for (int k = 0; k < J::nv; ++k) v[k] *= u;
        J::integrate(q0 + b.user_q, v, out + b.user_q);
      });
}

template <class T>
T distance(const Model& m, const T* q0, const T* q1) {
  using std::sqrt;
  constexpr int lanes = 4;
  T sum[lanes] = {T(0), T(0), T(0), T(0)};
  auto square = [](T x) { return x * x; };
  for_each_factor(
      m,
      [&](Index iq, Index, Index n) DYN_INLINE_LAMBDA {
        const T *a = q0 + iq, *b = q1 + iq;
        Index k = 0;
        for (; k + lanes <= n; k += lanes)
          for (int l = 0; l < lanes; ++l) sum[l] += square(b[k + l] - a[k + l]);
        for (; k < n; ++k) sum[0] += square(b[k] - a[k]);
      },
      [&]<class J>(const Body& b) DYN_INLINE_LAMBDA {
        T v[6];
        J::difference(b, q0 + b.user_q, q1 + b.user_q, v);
        for (int k = 0; k < J::nv; ++k) sum[k % lanes] += square(v[k]);
      });
  return sqrt((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

// Uniform between lower and upper, nq each.
void random_configuration(const Model& m, std::uint64_t seed, const double* lower, const double* upper, double* q);

namespace detail {

// The block on the diagonal of an nv x nv matrix; room for one where none is asked for.
template <class T>
inline Block<T> diagonal_block(const Model& m, Index at, T* out, T* room) {
  return out ? Block<T>{out + at + std::ptrdiff_t(at) * m.n.nv, m.n.nv} : Block<T>{room, 6};
}
template <class T>
inline void clear(const Model& m, T* out) {
  if (out) std::fill_n(out, std::ptrdiff_t(m.n.nv) * m.n.nv, T(0));
}
// x on some of the diagonal
template <class T>
inline void put_diagonal(const Model& m, Index first, Index n, T x, T* out) {
  for (Index k = first; out && k < first + n; ++k) out[k + std::ptrdiff_t(m.n.nv) * k] = x;
}

}  // namespace detail

// Jacobians of (+) and (-), nv x nv each, fully written; either may be nullptr.
template <class T>
void integrate_jacobians(const Model& m, const T* q, const T* v, T* dq, T* dv) {
  detail::clear(m, dq), detail::clear(m, dv);
  for_each_factor(
      m, [&](Index, Index iv, Index n) { detail::put_diagonal(m, iv, n, T(1), dq), detail::put_diagonal(m, iv, n, T(1), dv); },
      [&]<class J>(const Body& b) {
        T room[36];
        J::integrate_jacobians(q + b.user_q, v + b.user_v, detail::diagonal_block(m, b.user_v, dq, room),
                               detail::diagonal_block(m, b.user_v, dv, room));
      });
}
template <class T>
void difference_jacobians(const Model& m, const T* q0, const T* q1, T* d0, T* d1) {
  detail::clear(m, d0), detail::clear(m, d1);
  for_each_factor(
      m, [&](Index, Index iv, Index n) { detail::put_diagonal(m, iv, n, T(-1), d0), detail::put_diagonal(m, iv, n, T(1), d1); },
      [&]<class J>(const Body& b) {
        T room[36];
        J::difference_jacobians(b, q0 + b.user_q, q1 + b.user_q, detail::diagonal_block(m, b.user_v, d0, room),
                                detail::diagonal_block(m, b.user_v, d1, room));
      });
}

// Rate of the exponential coordinates u at which the configuration q (+) u moves with velocity v: the inverse of the
// right Jacobian of (+) (Munthe-Kaas 1999).
template <class T>
void chart_rate(const Model& m, const T* u, const T* v, T* du) {
  for_each_leader(m, [&]<class J>(const Body& b) { J::chart_rate(u + b.user_v, v + b.user_v, du + b.user_v); });
}

}  // namespace dyn
