// Boxes by separating axes (Gottschalk, Lin, Manocha, SIGGRAPH 1996); capsules are boxes of zero width. The faces of A - B have
// three kinds of normals: faces of A, faces of B, cross products of edges. For overlapping boxes the axis of least depth is the
// result. Apart, it is the first guess for GJK.
#pragma once

#include <bit>

#include "collision/analytic/capsules.hpp"
#include "collision/analytic/minkowski_segments.hpp"
#include "collision/lanes.hpp"

namespace dyn::collision {

// Axis of the largest signed distance. Face of A: (i = its axis, j = -1); face of B: (i = -1, j); two edges: (i, j).
struct BoxAxis {
  Vec n;            // from A to B, in A
  double distance;
  int i, j;
};

// Signed distances along the fifteen axes, three at once. Entry i is A's axis i, or B's axis i for the faces of B.
struct BoxAxes {
  const Pose& X;
  Vec q;
  Double4 faces_a, faces_b;
  Double4 gap[3], length2[3];  // of the edges of A with each of B: the distances times the lengths of the cross products

  DYN_INLINE BoxAxes(const Vec& ha, const Vec& hb, const Pose& X, const Mat& Rt) : X(X), q(Rt * X.p) {
    const Mat &R = X.R, S = {sizes(R.x), sizes(R.y), sizes(R.z)}, St = {sizes(Rt.x), sizes(Rt.y), sizes(Rt.z)};
    const Vec& p = X.p;
    const Double4 none(0.0, 0.0, 0.0, -shape::infinity);
    faces_a = lanes_of(sizes(p) - ha - S * hb) + none, faces_b = lanes_of(sizes(q) - hb - St * ha) + none;
    // an axis r of B with the sizes s; beside: extents of B's other edges
    const Vec hy = yzx(ha), hz = zxy(ha);
    const auto edges = [&](int j, const Vec& r, const Vec& s, const Vec& beside) DYN_INLINE_LAMBDA {
      const Vec ry = yzx(r), rz = zxy(r);
      gap[j] = lanes_of(sizes(cross(r, p)) - (hadamard(hy, zxy(s)) + hadamard(hz, yzx(s)) + beside));
      length2[j] = lanes_of(hadamard(ry, ry) + hadamard(rz, rz));
    };
    edges(0, R.x, S.x, S.z * hb[1] + S.y * hb[2]);
    edges(1, R.y, S.y, S.x * hb[2] + S.z * hb[0]);
    edges(2, R.z, S.z, S.y * hb[0] + S.x * hb[1]);
  }
  bool faces_apart(double reach) const { return any((faces_a > reach) | (faces_b > reach)); }
  // Whether one of the axes separates the boxes by more than the reach, 0 or more.
  bool apart(double reach) const {
    return faces_apart(reach) || edges_apart(reach);
  }
  // margin: of rounding; faces come first, unless edges are better by more.
  BoxAxis best(double margin) const {
    const double face = largest(max(faces_a, faces_b));
    BoxAxis out;
    Vec n;
    double side;
    if (edges_apart(face + margin)) {
      const Edges along = edges();
      const int k = std::countr_zero(along.at_least(along.largest() - margin) | 1u << 11);  // the last at most
      out.i = k & 3, out.j = k >> 2, out.distance = along.x[out.j][out.i];
      n = cross(shape::axis(out.i), X.R[out.j]) * (1 / std::sqrt(length2[out.j][out.i])), side = dot(n, X.p);
    } else {
      const int k = std::countr_zero(faces_at_least(face - margin) | 1u << 5);  // the last at most: no distance is a number
      out.i = k < 3 ? k : -1, out.j = k < 3 ? -1 : k - 3, out.distance = k < 3 ? faces_a[k] : faces_b[k - 3];
      n = k < 3 ? shape::axis(k) : X.R[k - 3], side = k < 3 ? X.p[k] : q[k - 3];
    }
    out.n = n * std::copysign(1.0, side);
    return out;
  }
  // Whether no other axis, nor the other side of this one, is as good. size: of the boxes.
  bool is_unique(const BoxAxis& axis, double size) const {
    const double least = axis.distance - 1e-7 * size;
    return dot(axis.n, X.p) != 0 && std::popcount(faces_at_least(least)) + std::popcount(edges().at_least(least)) == 1;
  }

 private:
  static constexpr double shortest2 = 1e-20;  // of cross products of edges that are not parallel
  // Signed distances along the axes of edges.
  struct Edges {
    Double4 x[3];
    double largest() const { return BoxAxes::largest(max(max(x[0], x[1]), x[2])); }
    unsigned at_least(double least) const {
      return bits_of(x[0] >= least) | bits_of(x[1] >= least) << 4 | bits_of(x[2] >= least) << 8;
    }
  };
  Edges edges() const {
    const Double4 none = Double4(-shape::infinity);
    const auto along = [&](int j) { return select(length2[j] > shortest2, gap[j] / sqrt(length2[j]), none); };
    return {{along(0), along(1), along(2)}};
  }
  unsigned faces_at_least(double least) const { return bits_of(faces_a >= least) | bits_of(faces_b >= least) << 3; }
  // Whether the distance along the axis of two edges is more than `least`: by squares with the numbers' signs, without roots.
  bool edges_apart(double least) const {
    const auto over = [&](int j) {
      return (gap[j] * abs(gap[j]) > length2[j] * (least * std::abs(least))) & (length2[j] > shortest2);
    };
    return any(over(0) | over(1) | over(2));
  }
  static double largest(const Double4& a) { return std::max(std::max(a[0], a[1]), std::max(a[2], a[3])); }
};

// The feature of a box that faces n: a corner, free along the axes perpendicular to n.
struct BoxFeature {
  Vec half, corner;
  bool free[3];

  BoxFeature(const Vec& half, const Vec& n) : half(half), corner(shape::with_sign(half, n)) {
    for (int i = 0; i < 3; ++i) free[i] = std::abs(n[i]) <= shape::flat_slope;
  }
  Vec middle() const { return nearest(Vec::zero()); }
  Vec nearest(const Vec& x) const {
    auto at = [&](int i) { return free[i] ? std::clamp(x[i], -half[i], half[i]) : corner[i]; };
    return Vec::make(at(0), at(1), at(2));
  }
};

// Witness points of overlapping boxes for an axis.
inline void box_witness(const Vec& ha, const Vec& hb, const Pose& X, const BoxAxis& axis, Vec& a, Vec& b) {
  const BoxFeature fa(ha, axis.n), fb(hb, transpose_times(X.R, -axis.n));
  if (axis.i >= 0 && axis.j >= 0) {
    BoxFeature ea = fa, eb = fb;
    ea.free[axis.i] = eb.free[axis.j] = true;
    const Vec u = shape::axis(axis.i), v = X.R[axis.j], a0 = ea.corner - u * ea.corner[axis.i],
              b0 = X.act(eb.corner - shape::axis(axis.j) * eb.corner[axis.j]);
    const SegmentPair s = nearest_on_segments(u, ha[axis.i], b0 - a0, v, hb[axis.j]);
    a = a0 + u * s.s, b = b0 + v * s.t;
    return;
  }
  // a common point of both features along the normal, by alternating projection
  a = fa.middle(), b = X.act(fb.middle());
  for (int i = 0; i < 64; ++i) {
    const Vec shift = axis.n * axis.distance;
    a = fa.nearest(b - shift);
    const Vec next = X.act(fb.nearest(X.act_inverse(a + shift)));
    const Vec moved = next - b;
    b = next;
    if (dot(moved, moved) <= 1e-30 * (dot(b, b) + dot(ha, ha))) break;  // rounding moves them by a few bits
  }
}

// A segment along B's z, of which a point nearest to a face of a box lies over that face. Returns false where there is none.
template <class D>
inline bool segment_over_face(const D& d, const Vec& box, double half, double enough, Cores& c) {
  const Vec &p = d.X.p, z = d.X.R.z, gap = sizes(p) - box - sizes(z) * half;
  const int i = gap[0] >= gap[1] && gap[0] >= gap[2] ? 0 : gap[1] >= gap[2] ? 1 : 2;
  if (!(gap[i] > enough)) return false;
  const double side = std::copysign(1.0, p[i]), rise = z[i] * side;
  const double end = rise > 0 ? -half : half;
  const Vec b = p + z * (std::abs(rise) * half <= enough / 4 ? std::clamp(-dot(p, z), -half, half) : end);
  const Vec over = sizes(b) - box;
  for (int k = 0; k < 3; ++k)
    if (k != i && over[k] > 0) return false;
  const Vec n = shape::axis(i) * side;
  c = {n, b - n * over[i], b, gap[i], over[i] - gap[i], 0, true};
  return true;
}

template <class A, class B>
inline Cores box_pair(const Difference<A, B>& d, const Vec& ha, const Vec& hb, EpaWorkspace& workspace, const Options& options) {
  Cores c;
  const double enough = wanted(d, options);
  // far apart along the line between the centres: the best axis is not needed
  const Vec& p = d.X.p;
  if (dot(sizes(p), ha) + dot(sizes(d.Rt * p), hb) < dot(p, p) && minkowski_pair(d, p, enough, c)) return c;
  const BoxAxes axes(ha, hb, d.X, d.Rt);
  const BoxAxis axis = axes.best(d.rounding());
  if (axis.distance > d.reach) return beyond(axis.n, axis.distance);
  c = {axis.n, Vec::zero(), Vec::zero(), axis.distance, 0, 0,
       options.says_unique && axes.is_unique(axis, shape::largest(hb))};
  box_witness(ha, hb, d.X, axis, c.a, c.b);
  c.residual = shape::norm(c.b - c.a - c.normal * c.distance);
  if (axis.distance <= 1e-10 * d.small + d.rounding() || c.residual <= d.rounding()) return c;
  if (minkowski_pair(d, axis.n, enough, c)) return c;
  return cores(d, axis.n * -axis.distance, workspace, options);
}

}  // namespace dyn::collision
