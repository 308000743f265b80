// CRBA for deep trees. The columns S_i and the forces F_j = Ic_j S_j are referred to the origin of the tree's root (so that
// distance from the world's origin costs no digits), and M_ij = S_i . F_j. The descendants j of i are consecutive, and their F
// lie component by component in memory: a column of the lower triangle is six vector operations over them.
#pragma once

#include "dyn/algorithm/kinematics.hpp"
#include "dyn/base/pack.hpp"

namespace dyn {

// S at the tree's root, composite inertias, and F = Ic S at the tree's root: by components, in blocks of four.
template <class T>
void composite_inertias(const Model& m, Data<T>& d) {
  for (Index i = 1; i < m.n.bodies; ++i) {
    const Index p = m.bodies()[i].parent;
    d.rel[i] = p == 0 ? Vec3<T>::zero() : d.rel[p] + d.r[i];
    d.Ic[i] = world_inertia(m.bodies()[i], d.R[i]);
  }
  backward(m, Up<Inertia<T>>{Inertia<T>::zero()}, [&]<class J>(Index i, Up<Inertia<T>>& up) DYN_INLINE_LAMBDA {
    const Body& b = m.bodies()[i];
    Inertia<T> Y = d.Ic[i];
    if (up.chain) Y = Y + up.x;
    for (int k = 0; k < J::nv; ++k) {
      const Index at = b.idx_v + k;
      const Motion<T> s = J::column(b, d.R[i], k);
      const Force<T> F = shift(momentum<J>(Y, s), d.rel[i]);
      T* lane = d.F + at / 4 * 24 + at % 4;
      for (int x = 0; x < 3; ++x) lane[4 * x] = F.linear[x], lane[12 + 4 * x] = F.angular[x];
      d.S[at] = J::rotates ? shift(s, -d.rel[i]) : s;
    }
    up.x = Y.shifted(d.r[i]);
    up.chain = b.parent == i - 1;
    if (!up.chain && b.parent) d.Ic[b.parent] = d.Ic[b.parent] + up.x;
  });
}

// F_j . s for the four degrees of freedom of a block of d.F
template <class T>
DYN_INLINE Pack<T, 4> project_block(const T* F, const Motion<T>& s) {
  using P = Pack<T, 4>;
  return (P::load(F) * s.linear[0] + P::load(F + 4) * s.linear[1] + P::load(F + 8) * s.linear[2]) +
         (P::load(F + 12) * s.angular[0] + P::load(F + 16) * s.angular[1] + P::load(F + 20) * s.angular[2]);
}

// out[j] = F_j . s for j in [first, last), in whole blocks of four: up to three numbers before first are overwritten, and
// past last unless exact.
template <class T>
DYN_INLINE void project_columns(const T* F, Index first, Index last, const Motion<T>& s, T* out, bool exact) {
  const Index begin = first / 4, end = exact ? last / 4 : (last + 3) / 4;
  const T* block = F + std::ptrdiff_t(begin) * 24;
  T *o = out + 4 * std::ptrdiff_t(begin), *stop = out + 4 * std::ptrdiff_t(end);
  for (; o < stop; o += 4, block += 24) project_block(block, s).store(o);
  if (exact && last % 4 != 0) {
    const Pack<T, 4> rest = project_block(block, s);
    for (int k = 0; k < last % 4; ++k) o[k] = rest[k];
  }
}

// Columns i0 .. i1 - 1 (at most 8) of the lower triangle copied to the same rows of the upper one: eight rows are a line of
// cache.
template <class T>
DYN_INLINE void mirror(T* M, std::ptrdiff_t n, std::ptrdiff_t i0, std::ptrdiff_t i1) {
  auto scalar = [&](std::ptrdiff_t first, std::ptrdiff_t end, std::ptrdiff_t j0, std::ptrdiff_t j1) {
    for (std::ptrdiff_t j = j0; j < j1; ++j)
      for (std::ptrdiff_t i = first; i < end && i < j; ++i) M[i + n * j] = M[j + n * i];
  };
  if (i1 - i0 < 8) return scalar(i0, i1, i0, n);
  scalar(i0, i0 + 4, i0, i0 + 4);
  transpose4(M + i0 + 4 + n * i0, n, M + i0 + n * (i0 + 4), n);
  scalar(i0 + 4, i1, i0 + 4, i1);
  std::ptrdiff_t j = i1;
  for (; j + 4 <= n; j += 4) {
    transpose4(M + j + n * i0, n, M + i0 + n * j, n);
    transpose4(M + j + n * (i0 + 4), n, M + i0 + 4 + n * j, n);
  }
  scalar(i0, i1, j, n);
}

// d.M, full and symmetric, rotors left out. For models without mimic joints.
template <class T>
void crba_deep(const Model& m, Data<T>& d) {
  composite_inertias(m, d);
  const Index nv = m.n.nv;
  // from the last column to the first: what is written above the diagonal and past the last row is overwritten by the mirror
  // images that follow
  Index at = nv, mirrored = nv;
  for (Index i = m.n.bodies - 1; i >= 1; --i) {
    const Index last = first_dof(m, m.subtree_end()[i]);
    while (at > m.bodies()[i].idx_v) {
      --at;
      project_columns(d.F, at, last, d.S[at], d.M + std::ptrdiff_t(nv) * at, last != nv || at < 2 || at == nv - 1);
      if (at % 8 == 0) mirror<T>(d.M, nv, at, mirrored), mirrored = at;
    }
  }
}

}  // namespace dyn
