// Nearest point to the origin on a simplex of up to four vertices, and the smallest face that holds it. Source: signed volumes,
// Montanari, Petrinic, Barbieri, ACM Trans. Graphics 36(3), 2017. A negative barycentric coordinate excludes its vertex.
// Coordinates come from edges, and the nearest point of a triangle from its normal. So it stays exact when the origin almost lies
// in the plane.
#pragma once

#include "collision/difference.hpp"

namespace dyn::collision {

struct Simplex {
  Vertex p[4];
  double weight[4];  // of each vertex in the nearest point
  int size;

  Vec point_a() const { return combine([](const Vertex& x) { return x.a; }); }
  Vec point_b() const { return combine([](const Vertex& x) { return x.b; }); }

 private:
  template <class F>
  Vec combine(F&& f) const {
    Vec s = f(p[0]) * weight[0];
    for (int i = 1; i < size; ++i) s += f(p[i]) * weight[i];
    return s;
  }
};

// A face of a simplex, with vertices by number.
struct Part {
  Vec v;      // its nearest point to the origin
  double vv;  // |v|^2
  int size, at[3];
  double weight[3];
};

DYN_INLINE Part nearest_on_segment(const Vec& a, const Vec& b, int i, int j) {
  const Vec e = b - a;
  const double t = -dot(a, e), ee = dot(e, e);
  if (t <= 0) return {a, dot(a, a), 1, {i, 0, 0}, {1, 0, 0}};
  if (t >= ee) return {b, dot(b, b), 1, {j, 0, 0}, {1, 0, 0}};
  const double l = t / ee;
  Vec v = a + e * l;
  v -= e * (dot(v, e) / ee);  // once more, because v may be far shorter than a
  return {v, dot(v, v), 2, {i, j, 0}, {1 - l, l, 0}};
}

// Normal of a triangle. A needle takes its two shorter edges, because two long ones would cancel.
DYN_INLINE Vec triangle_normal(const Vec& a, const Vec& b, const Vec& c) {
  const Vec ab = b - a, ac = c - a, n = cross(ab, ac);
  if (dot(n, n) > 1e-2 * dot(ab, ab) * dot(ac, ac)) return n;
  const Vec bc = c - b, ca = -ac;
  const double c2 = dot(ab, ab), a2 = dot(bc, bc), b2 = dot(ca, ca);
  return a2 >= b2 && a2 >= c2 ? cross(ca, ab) : b2 >= c2 ? cross(ab, bc) : cross(bc, ca);
}

// i, j, k: numbers of the vertices
[[gnu::noinline]] inline Part nearest_on_triangle(const Vec& a, const Vec& b, const Vec& c, int i = 0, int j = 1, int k = 2) {
  const Vec e = b - a, f = c - a, n = triangle_normal(a, b, c);
  const double nn = dot(n, n);
  const bool thin = nn <= 1e-30 * dot(e, e) * dot(f, f);
  const Vec nf = cross(n, f), ne = cross(n, e);
  double lj = dot(nf, a), lk = -dot(ne, a), li = nn - lj - lk;
  if (!thin && li > 0 && lj > 0 && lk > 0) {
    const double h = dot(n, a) / nn;
    if (nn <= 1e-4 * dot(e, e) * dot(f, f)) {  // a needle: correct by the remainder
      const Vec left = (a * li + b * lj + c * lk) * (1 / nn) - n * h;
      const double cj = dot(nf, left), ck = -dot(ne, left);
      lj += cj, lk += ck, li -= cj + ck;
    }
    return {n * h, h * h * nn, 3, {i, j, k}, {li / nn, lj / nn, lk / nn}};
  }
  Part best;
  best.vv = shape::infinity;
  auto consider = [&](const Part& x) {
    if (x.vv < best.vv) best = x;
  };
  if (thin || li <= 0) consider(nearest_on_segment(b, c, j, k));
  if (thin || lj <= 0) consider(nearest_on_segment(a, c, i, k));
  if (thin || lk <= 0) consider(nearest_on_segment(a, b, i, j));
  return best;
}

// Returns false if the origin lies inside.
inline bool nearest_on_tetrahedron(const Simplex& s, Part& best) {
  const Vec a = s.p[0].w, e = s.p[1].w - a, f = s.p[2].w - a, g = s.p[3].w - a;
  const Vec fg = cross(f, g), ge = cross(g, e), ef = cross(e, f);
  const double volume = dot(e, fg), sign = volume < 0 ? -1 : 1;
  const double l1 = -dot(a, fg) * sign, l2 = -dot(a, ge) * sign, l3 = -dot(a, ef) * sign, l0 = volume * sign - l1 - l2 - l3;
  const bool flat = volume * volume <= 1e-30 * dot(e, e) * dot(f, f) * dot(g, g);
  if (!flat && l0 >= 0 && l1 >= 0 && l2 >= 0 && l3 >= 0) return false;
  best.vv = shape::infinity;
  auto consider = [&](int i, int j, int k) {
    const Part x = nearest_on_triangle(s.p[i].w, s.p[j].w, s.p[k].w, i, j, k);
    if (x.vv < best.vv) best = x;
  };
  if (flat || l0 < 0) consider(1, 2, 3);
  if (flat || l1 < 0) consider(0, 2, 3);
  if (flat || l2 < 0) consider(0, 1, 3);
  if (flat || l3 < 0) consider(0, 1, 2);
  return true;
}

// Reduces s to the face that holds the nearest point v. Returns false if the origin lies inside; s then keeps its four vertices.
[[gnu::noinline]] inline bool reduce(Simplex& s, Vec& v) {
  Part part;
  if (s.size == 4) {
    if (!nearest_on_tetrahedron(s, part)) return false;
  } else if (s.size == 3) {
    part = nearest_on_triangle(s.p[0].w, s.p[1].w, s.p[2].w);
  } else {
    part = nearest_on_segment(s.p[0].w, s.p[1].w, 0, 1);
  }
  // numbers ascend, so vertices only move down
  for (int i = 0; i < part.size; ++i) s.p[i] = s.p[part.at[i]], s.weight[i] = part.weight[i];
  s.size = part.size;
  v = part.v;
  return true;
}

}  // namespace dyn::collision
