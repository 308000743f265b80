// Start of the expanding polytope algorithm: a tetrahedron from the last simplex of GJK.
#pragma once

#include "collision/simplex.hpp"

namespace dyn::collision::detail {

// Four vertices p that span a volume: those of s, completed by support points at least `least` apart. Returns false if D is flat;
// n is then its normal.
template <class D>
inline bool spanning_vertices(const D& d, const Simplex& s, double least, Vertex* p, Vec& n) {
  int size = 0;
  // adds the support point along u or -u that is farther from p[0]
  auto add_along = [&](const Vec& u) {
    const Vertex up = d.support(u), down = d.support(-u);
    const double hu = dot(u, up.w - p[0].w), hd = dot(u, p[0].w - down.w);
    p[size] = hu >= hd ? up : down;
    return std::max(hu, hd) > least;
  };
  p[size++] = s.p[0];
  n = shape::axis(0);
  if (s.size > 1 && shape::norm(s.p[1].w - p[0].w) > least) {
    ++size, p[1] = s.p[1];
  } else {
    int i = 0;
    while (i < 3 && !add_along(shape::axis(i))) ++i;
    if (i == 3) return false;
    ++size;
  }
  const Vec e = (p[1].w - p[0].w) * (1 / shape::norm(p[1].w - p[0].w));
  auto off_line = [&](const Vertex& x) { return shape::norm(cross(e, x.w - p[0].w)); };
  for (int i = 2; i < s.size && size == 2; ++i)
    if (off_line(s.p[i]) > least) p[size++] = s.p[i];
  if (size == 2) {
    const Vec u = shape::across(e), v = cross(e, u);
    if (!add_along(u) && !add_along(v)) {
      n = u;
      return false;
    }
    ++size;
  }
  n = cross(e, p[2].w - p[0].w);
  n = n * (1 / shape::norm(n));
  if (s.size == 4 && std::abs(dot(n, s.p[3].w - p[0].w)) > least)
    p[3] = s.p[3];
  else if (!add_along(n))
    return false;
  if (dot(n, p[3].w - p[0].w) > 0) std::swap(p[1], p[2]);  // now face 0 1 2 points away from vertex 3
  return true;
}

}  // namespace dyn::collision::detail
