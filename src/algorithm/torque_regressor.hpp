// The joint torque regressor Y, nv x 10 (njoints - 1): tau = Y pi + armature a. Row k of the ten columns of a body is S_k . F, F
// its body's 6 x 10 regressor, for the degrees of freedom k that carry it. All at the root of each tree, in axes of the world.
#pragma once

#include "algorithm/regressor.hpp"
#include "base/simd.hpp"

namespace dyn {

// What W degrees of freedom S, given by components, feel of a force.
template <class T, int W>
DYN_INLINE Simd<T, W> power(const Simd<T, W>* S, const Force<T>& F) {
  return (S[0] * F.linear[0] + S[1] * F.linear[1] + S[2] * F.linear[2]) +
         (S[3] * F.angular[0] + S[4] * F.angular[1] + S[5] * F.angular[2]);
}
template <class T, int W>
DYN_INLINE Simd<T, W> power(const Simd<T, W>* S, const Vec3<T>& moment) {
  return S[3] * moment[0] + S[4] * moment[1] + S[5] * moment[2];
}

// Zeros, then ones.
template <class T, int W>
inline constexpr auto zeros_and_ones = [] {
  struct {
    T x[2 * W] = {};
  } out;
  for (int k = W; k < 2 * W; ++k) out.x[k] = T(1);
  return out;
}();

// put(column, y) for ten columns y of W rows, which begin at S; the first n of them are zero.
template <int W, class T, class Put>
DYN_INLINE void torque_block(const T* Sx, std::ptrdiff_t room, Index n, const Force<T>* F, Put&& put) {
  Simd<T, W> S[6];
#pragma GCC unroll 6
  for (int x = 0; x < 6; ++x) S[x] = Simd<T, W>::load(Sx + x * room);
  if (n > 0)
#pragma GCC unroll 6
    for (auto& x : S) x = x * Simd<T, W>::load(zeros_and_ones<T, W>.x + W - n);
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) put(c, power(S, F[c]));
#pragma GCC unroll 6
  for (int c = 4; c < 10; ++c) put(c, power(S, F[c].angular));
}

// The rows of body i and of what carries it; others are zero for good. From the leaf to the root: the degrees of freedom of a
// chain of bodies are consecutive. A block may reach before the first of them: those rows are zero, or the next chain writes
// them.
template <class T>
void torque_rows(const Model& m, const Data<T>& d, Index i, const Force<T>* F, T* columns) {
  const std::ptrdiff_t nv = m.n.nv, room = padded_regressor(m);
  for (; i != 0; i = m.bodies()[d.chain[i]].parent) {
    const Index first = m.bodies()[d.chain[i]].idx_v, end = first_dof(m, i + 1);
    auto block = [&]<int W>(Index stop) DYN_INLINE_LAMBDA {
      const Index at = stop - W;
      T* rows = columns + at;
      torque_block<W>(d.Sx + at, room, first - at, F,
                      [&](int c, const Simd<T, W>& y) DYN_INLINE_LAMBDA { y.store(rows + c * nv); });
    };
    Index stop = end;
    for (; stop - first > 4 && stop >= 8; stop -= 8) block.template operator()<8>(stop);
    for (; stop > first && stop >= 4; stop -= 4) block.template operator()<4>(stop);
    if (stop <= first) continue;
    // at the matrix's first rows: blocks may overlap, but not begin before
    if (end >= 4) block.template operator()<4>(4);
    else
      torque_block<4>(d.Sx, room, 0, F, [&](int c, const Simd<T, 4>& y) DYN_INLINE_LAMBDA {
        T rows[4];
        y.store(rows);
        for (Index k = first; k < end; ++k) columns[k + c * nv] = rows[k];
      });
  }
}
// The same where joints follow others: rows of a follower are added to those of its leader.
template <class T>
void torque_rows_mimic(const Model& m, const Data<T>& d, Index i, const Force<T>* F, T* columns) {
  const std::ptrdiff_t nv = m.n.nv;
  for (std::ptrdiff_t k = 0; k < 10 * nv; ++k) columns[k] = T(0);
  for (; i != 0; i = m.bodies()[d.chain[i]].parent)
    for (Index at = m.bodies()[d.chain[i]].idx_v, end = first_dof(m, i + 1); at < end; at += 4)
      torque_block<4>(d.Sx + at, padded_regressor(m), 0, F, [&](int c, const Simd<T, 4>& y) DYN_INLINE_LAMBDA {
        T rows[4];
        y.store(rows);
        for (Index k = at; k < at + 4 && k < end; ++k) columns[m.expand_v()[k] + c * nv] += T(m.ratio_v()[k]) * rows[k - at];
      });
}

// d.regressor. Returns the sum of the squares of all that its elements are sums of products of: where that is small, no element
// overflows.
template <class T>
T joint_torque_regressor(const Model& m, Data<T>& d) {
  const Vec3<T> g = load3(d.world_gravity);
  const std::ptrdiff_t room = padded_regressor(m);
  ensure_acceleration(m, d);
  Vec3<T> size = Vec3<T>::zero();
  forward(m, [&]<class J>(Index i) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    d.chain[i] = b.parent == i - 1 && b.parent != 0 ? d.chain[i - 1] : i;
    const Vec3<T> root = b.parent == 0 ? Vec3<T>::zero() : d.root[b.parent] + d.r[i];
    d.root[i] = root;
    for (int k = 0; k < J::nv; ++k) {
      const Motion<T> s = shift(J::column(b, d.R[i], k), -root);
      T* S = d.Sx + b.idx_v + k;
      for (int x = 0; x < 3; ++x) S[x * room] = s.linear[x], S[(3 + x) * room] = s.angular[x];
    }
  });
  for (Index joint = 1; joint < m.n.joints; ++joint) {
    const FramePose<T> P = joint_pose(m, d, joint);
    const Vec3<T> root = d.root[P.body], w = d.omega[P.body], dw = d.alpha[P.body], a = d.acc[P.body] - g;
    size += hadamard(root, root) + hadamard(w, w) + hadamard(dw, dw) + hadamard(a, a);
    Force<T> F[10];
    body_regressor(P.R, w, dw, a, F);
    for (int c = 0; c < 4; ++c) F[c] = shift(F[c], root);
    T* columns = d.regressor + 10 * std::ptrdiff_t(joint - 1) * m.n.nv;
    if (m.has_mimic) torque_rows_mimic(m, d, P.body, F, columns);
    else torque_rows(m, d, P.body, F, columns);
  }
  d.mark_fresh(Stage::TorqueRegressor);
  return size[0] + size[1] + size[2];
}

}  // namespace dyn
