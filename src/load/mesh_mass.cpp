// Volume integrals by the divergence theorem: tetrahedra from one point to all triangles (Tonon 2004; second moments: Eberly
// 2002). Exact up to rounding.
#include <algorithm>
#include <limits>

#include "mesh.hpp"

namespace dyn::meshes {

Box box_of(const Mesh& mesh) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  double low[3] = {inf, inf, inf}, high[3] = {-inf, -inf, -inf};
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    low[i % 3] = std::min(low[i % 3], mesh.vertices[i]), high[i % 3] = std::max(high[i % 3], mesh.vertices[i]);
  return {load3(low), load3(high)};
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    area += length(cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0))) / 2;
  return area;
}

Solid solid_of(const Mesh& mesh) {
  const Box box = box_of(mesh);
  const Vec3<double> o = (box.low + box.high) * 0.5;
  Inertia<double> Y = Inertia<double>::zero();
  Sym3<double> S = Sym3<double>::zero();  // integral of x x^T
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    // corners 0, a, b, c: 6 V = det(a, b, c), h = V/4 (a + b + c), S = V/20 (sum of x x^T over a, b, c, a + b + c)
    const Vec3<double> a = mesh.corner(t, 0) - o, b = mesh.corner(t, 1) - o, c = mesh.corner(t, 2) - o, s = a + b + c;
    const double V = dot(a, cross(b, c)) / 6;
    Y.m += V, Y.h += s * (V / 4);
    S = S + (symmetric_outer(a, a) + symmetric_outer(b, b) + symmetric_outer(c, c) + symmetric_outer(s, s)) * (V / 20);
  }
  const double trace = S.d[0] + S.d[1] + S.d[2];
  Y.I = {Vec3<double>::make(trace, trace, trace) - S.d, -S.o};
  const Vec3<double> c = Y.h * (1 / Y.m);
  return {Y.m, o + c, Y.shifted(-c).I};
}

}  // namespace dyn::meshes
