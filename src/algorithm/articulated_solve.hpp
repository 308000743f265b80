// x = M^-1 b by the articulated inertias that forward dynamics left (U, D; aba.hpp): O(n) for a right-hand side, two times eight
// of them side by side, the two to hide each other's latency (the recursions of Carpentier 2018, "Analytical inverse of the joint
// space inertia matrix", at the tree's root, where they need no change of frame). For models without mimic joints.
#pragma once

#include "algorithm/aba.hpp"
#include "base/simd.hpp"
#include "base/transpose.hpp"

namespace dyn {

inline constexpr int solve_width = 16;

// S and U referred to the tree's root.
template <class T, class Part = WholeModel>
void articulated_columns(const Model& m, Data<T>& d, const Part& part = {}) {
  for (Index l = 0; l < part.joint_run_count(m); ++l) {
    const JointRun& run = part.joint_runs(m)[l];
    visit(run.type, [&]<class J>() DYN_INLINE_LAMBDA {
      for (Index i = run.first; i < run.last; ++i) {
        const Body& b = m.bodies()[i];
        d.rel[i] = b.parent == 0 ? Vec3<T>::zero() : d.rel[b.parent] + d.r[i];
        for (int k = 0; k < J::nv; ++k) {
          d.S[b.idx_v + k] = shift(J::column(b, d.R[i], k), -d.rel[i]);
          d.U_root[b.idx_v + k] = shift(d.U[b.idx_v + k], d.rel[i]);
        }
      }
    });
  }
}

// Eight 6-vectors.
template <class T>
struct SixEights {
  using P = Simd<T, 8>;
  P x, y, z, u, v, w;

  static DYN_INLINE SixEights load(const T* p) {
    return {P::load(p), P::load(p + 8), P::load(p + 16), P::load(p + 24), P::load(p + 32), P::load(p + 40)};
  }
  DYN_INLINE void store(T* p) const {
    x.store(p), y.store(p + 8), z.store(p + 16), u.store(p + 24), v.store(p + 32), w.store(p + 40);
  }
  static DYN_INLINE SixEights zero() {
    const P o = P::load(zeros);
    return {o, o, o, o, o, o};
  }
  template <class V>  // Motion or Force
  DYN_INLINE P dot(const V& s) const {
    return (x * s.linear[0] + y * s.linear[1] + z * s.linear[2]) + (u * s.angular[0] + v * s.angular[1] + w * s.angular[2]);
  }
  template <class V>
  DYN_INLINE void add(const V& s, const P& k) {
    x = x + k * s.linear[0], y = y + k * s.linear[1], z = z + k * s.linear[2];
    u = u + k * s.angular[0], v = v + k * s.angular[1], w = w + k * s.angular[2];
  }
  DYN_INLINE SixEights operator+(const SixEights& b) const { return {x + b.x, y + b.y, z + b.z, u + b.u, v + b.v, w + b.w}; }

 private:
  static constexpr T zeros[8] = {};
};

// The rows up to last of X = M^-1 X for sixteen columns, row by row; rows past it are zero on entry.
template <class T>
void articulated_solve(const Model& m, Data<T>& d, T* X, Index last) {
  using P = Simd<T, 8>;
  using Six = SixEights<T>;
  const Index *parent = m.dof_parent(), *forks = m.dof_forks();
  auto at_fork = [&](Index k) { return d.at_forks + 6 * solve_width * std::ptrdiff_t(k); };
  for (Index k = 0; k <= last; ++k)
    if (forks[k]) Six::zero().store(at_fork(k)), Six::zero().store(at_fork(k) + 48);
  Six F = Six::zero(), G = F;
  for (Index k = last; k >= 0; --k) {
    if (forks[k]) F = F + Six::load(at_fork(k)), G = G + Six::load(at_fork(k) + 48);
    T* row = X + solve_width * std::ptrdiff_t(k);
    const P y = (P::load(row) - F.dot(d.S[k])) * d.Dinv[k], z = (P::load(row + 8) - G.dot(d.S[k])) * d.Dinv[k];
    y.store(row), z.store(row + 8);
    F.add(d.U_root[k], y), G.add(d.U_root[k], z);
    const Index p = parent[k];
    if (p == k - 1 && p >= 0) continue;
    if (p >= 0) (Six::load(at_fork(p)) + F).store(at_fork(p)), (Six::load(at_fork(p) + 48) + G).store(at_fork(p) + 48);
    F = G = Six::zero();
  }
  Six A = Six::zero(), B = A;
  for (Index k = 0; k <= last; ++k) {
    const Index p = parent[k];
    if (p != k - 1) {
      if (p >= 0) A = Six::load(at_fork(p)), B = Six::load(at_fork(p) + 48);
      else A = B = Six::zero();
    }
    T* row = X + solve_width * std::ptrdiff_t(k);
    const P x = P::load(row) - A.dot(d.U_root[k]) * d.Dinv[k], y = P::load(row + 8) - B.dot(d.U_root[k]) * d.Dinv[k];
    x.store(row), y.store(row + 8);
    A.add(d.S[k], x), B.add(d.S[k], y);
    if (forks[k]) A.store(at_fork(k)), B.store(at_fork(k) + 48);
  }
}

// out = -M^-1 B, both nv x nv and column-major, a block of columns at a time.
template <class T>
void minus_articulated_solve(const Model& m, Data<T>& d, const T* B, T* out) {
  const std::ptrdiff_t n = m.n.nv;
  T* X = d.some_columns;
  for (std::ptrdiff_t c = 0; c < n; c += solve_width) {
    const std::ptrdiff_t width = std::min<std::ptrdiff_t>(solve_width, n - c);
    transpose(B + n * c, n, n, width, T(-1), X, solve_width);
    articulated_solve(m, d, X, Index(n) - 1);
    transpose(X, solve_width, width, n, T(1), out + n * c, n);
  }
}

// d.Minv, full and symmetric to the last bit.
template <class T>
void articulated_inverse(const Model& m, Data<T>& d) {
  const std::ptrdiff_t n = m.n.nv;
  T* X = d.some_columns;
  for (std::ptrdiff_t c = 0; c < n; c += solve_width) {
    const std::ptrdiff_t width = std::min<std::ptrdiff_t>(solve_width, n - c);
    std::fill_n(X, solve_width * (c + width), T(0));
    for (std::ptrdiff_t k = 0; k < width; ++k) X[solve_width * (c + k) + k] = T(1);
    articulated_solve(m, d, X, Index(c + width) - 1);
    transpose(X, solve_width, width, c + width, T(1), d.Minv + n * c, n);
  }
  mirror_upper(d.Minv, n);
  d.mark_fresh(Stage::Minv);
}

}  // namespace dyn
