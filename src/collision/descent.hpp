// Last resort of EPA, where its polytope cannot grow and Newton's method finds no root. Example: four pieces of nearly coincident
// cones meet. Minimises the support function h(n) by pattern search, then applies Newton's method to the pieces found there.
#pragma once

#include "base/portable.hpp"
#include "collision/newton_refine.hpp"

namespace dyn::collision {

namespace detail {

// Hooke and Jeeves (J. ACM 8(2), 1961) on the unit sphere. The directions turn between rounds.
template <class D>
inline Vec pattern_search(const D& d, Vec n) {
  constexpr int directions = 8, rounds = 300;
  constexpr double eighth = 0.78539816339744831;
  double least = dot(n, d.support(n).w), step = 0.05;
  for (int k = 0; step > 1e-10 && k < rounds; ++k) {
    const Vec from = n, u = shape::across(n), v = cross(n, u);
    const double before = least;
    for (int i = 0; i < directions; ++i) {
      const double angle = eighth * i + k;
      Vec m = from + u * (step * math::cos(angle)) + v * (step * math::sin(angle));
      m = m * (1 / shape::norm(m));
      const double h = dot(m, d.support(m).w);
      if (h < least) least = h, n = m;
    }
    step *= least < before ? 1.5 : 0.5;
  }
  return n;
}

// Support points along normals tilted around n. Returns the three whose triangle contains the projection of the origin best, with
// its barycentric weights.
template <class D>
inline void pieces_around(const D& d, const Vec& n, Vertex* best, double* weight) {
  constexpr int around = 12;
  constexpr double tilt = 1e-7, turn = 6.2831853071795865 / around;
  const Vec u = shape::across(n), v = cross(n, u);
  Vertex p[around];
  for (int i = 0; i < around; ++i) p[i] = d.support(n + u * (tilt * math::cos(turn * i)) + v * (tilt * math::sin(turn * i)));
  double surest = -shape::infinity;
  for (int i = 0; i < around; ++i)
    for (int j = i + 1; j < around; ++j)
      for (int k = j + 1; k < around; ++k) {
        const double area = dot(n, cross(p[j].w - p[i].w, p[k].w - p[i].w));
        if (std::abs(area) <= 1e-6 * d.small * d.small) continue;
        const double w[3] = {dot(n, cross(p[j].w, p[k].w)) / area, dot(n, cross(p[k].w, p[i].w)) / area,
                             dot(n, cross(p[i].w, p[j].w)) / area};
        const double least = std::min({w[0], w[1], w[2]});
        if (least <= surest) continue;
        surest = least;
        best[0] = p[i], best[1] = p[j], best[2] = p[k];
        std::copy(w, w + 3, weight);
      }
  if (surest > -shape::infinity) return;
  for (int i = 0; i < 3; ++i) best[i] = p[i * around / 3], weight[i] = 1.0 / 3;
}

}  // namespace detail

// from: normal near the minimum. Returns false if no solution was found.
template <class D>
[[gnu::noinline]] inline bool pattern_search_refine(const D& d, const Vec& from, double wanted, Refined& out) {
  const Vec n = detail::pattern_search(d, from);
  Vertex p[3];
  double weight[3];
  detail::pieces_around(d, n, p, weight);
  return newton_refine(d, p, weight, 3, n, wanted, out);
}

}  // namespace dyn::collision
