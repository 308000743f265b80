// Boxes by separating axes (Gottschalk, Lin, Manocha, SIGGRAPH 1996); capsules are boxes of zero width. The faces of A - B have
// three kinds of normals: faces of A, faces of B, cross products of edges. For overlapping boxes the axis of least depth is the
// result. Apart, it is the first guess for GJK.
#pragma once

#include "collision/analytic/capsules.hpp"
#include "collision/analytic/minkowski_segments.hpp"

namespace dyn::collision {

// Axis of the largest signed distance. Face of A: (i = its axis, j = -1); face of B: (i = -1, j); two edges: (i, j).
struct BoxAxis {
  Vec n;            // from A to B, in A
  double distance;
  int i, j;
  bool unique;      // no other axis is as good
};

// Handles the three entries of a vector at once. Entry i is A's axis i, or B's axis i for the faces of B.
// reach: larger distances need not be the largest.
inline BoxAxis box_axis(const Vec& ha, const Vec& hb, const Pose& X, double margin, double reach) {
  const Mat R = X.R, Rt = transpose(R), S = {sizes(R.x), sizes(R.y), sizes(R.z)}, St = {sizes(Rt.x), sizes(Rt.y), sizes(Rt.z)};
  const Vec p = X.p, q = Rt * p;
  BoxAxis best = {shape::axis(0), -shape::infinity, 0, -1, true};
  double second = -shape::infinity;
  // faces come first, unless edges are better by more than rounding
  auto consider = [&](double s, int i, int j) {
    if (s > best.distance + margin)
      second = best.distance, best.distance = s, best.i = i, best.j = j;
    else
      second = std::max(second, s);
  };
  const Vec faces_a = sizes(p) - ha - S * hb, faces_b = sizes(q) - hb - St * ha;
  for (int i = 0; i < 3; ++i) consider(faces_a[i], i, -1);
  for (int j = 0; j < 3; ++j) consider(faces_b[j], -1, j);
  for (int j = 0; j < 3 && !(best.distance > reach); ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    const Vec r = R[j], along = sizes(cross(r, p)), ry = yzx(r), rz = zxy(r);
    const Vec reach = hadamard(yzx(ha), zxy(S[j])) + hadamard(zxy(ha), yzx(S[j])) + S[l] * hb[k] + S[k] * hb[l];
    const Vec length2 = hadamard(ry, ry) + hadamard(rz, rz), gap = along - reach;
    for (int i = 0; i < 3; ++i)
      if (length2[i] > 1e-20 && (gap[i] > 0 || gap[i] > second))  // lengths are at most 1: an overlap only grows
        consider(gap[i] / std::sqrt(length2[i]), i, j);
  }
  Vec n;
  double side;
  if (best.j < 0)
    n = shape::axis(best.i), side = p[best.i];
  else if (best.i < 0)
    n = R[best.j], side = q[best.j];
  else
    n = cross(shape::axis(best.i), R[best.j]), n = n * (1 / shape::norm(n)), side = dot(n, p);
  best.n = n * std::copysign(1.0, side);
  best.unique = side != 0 && second < best.distance - 1e-7 * shape::largest(hb);
  return best;
}

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
  const BoxAxis axis = box_axis(ha, hb, d.X, d.rounding(), d.reach);
  if (axis.distance > d.reach) return beyond(axis.n, axis.distance);
  c = {axis.n, Vec::zero(), Vec::zero(), axis.distance, 0, 0, axis.unique};
  box_witness(ha, hb, d.X, axis, c.a, c.b);
  c.residual = shape::norm(c.b - c.a - c.normal * c.distance);
  if (axis.distance <= 1e-10 * d.small + d.rounding() || c.residual <= d.rounding()) return c;
  if (minkowski_pair(d, axis.n, enough, c)) return c;
  return cores(d, axis.n * -axis.distance, workspace, options);
}

}  // namespace dyn::collision
