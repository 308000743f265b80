// Contact points of two boxes along the normal of a face: the face of the other box that faces it, clipped against the rectangle.
// The same points as clip_faces finds, in the frame of the face.
#pragma once

#include <bit>

#include "base/simd_shuffle.hpp"
#include "collision/analytic/boxes.hpp"
#include "collision/sphere_manifold.hpp"
#include "convex_methods.hpp"

namespace dyn::collision {

namespace detail {

// A point over a face: its coordinates on the face, and the gap below it.
struct OverFace {
  double x, y, gap;
};

// Clips a convex polygon at sign * coordinate <= limit. Points within eps of the line stay. Returns the number of corners.
template <double OverFace::*coordinate, int sign>
inline int clip_side(const OverFace* from, int count, double limit, double eps, OverFace* to) {
  int kept = 0;
  double here = limit - sign * from[0].*coordinate;
  for (int i = 0; i < count; ++i) {
    const OverFace &p = from[i], &q = from[i + 1 < count ? i + 1 : 0];
    const double there = limit - sign * q.*coordinate;
    if (here >= -eps) to[kept++] = p;
    if ((here > eps && there < -eps) || (here < -eps && there > eps)) {
      const double t = here / (here - there);
      to[kept++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.gap + t * (q.gap - p.gap)};
    }
    here = there;
  }
  return kept;
}

// A parallelogram on the face, whose corners have numbers.
struct FacingFace {
  OverFace corner[4];
  std::uint32_t id[4];
  Double4 x, y, ex, ey, length2;  // corners, and the edges that begin there

  FacingFace(const OverFace& a, const OverFace& b, const OverFace& c, const OverFace& d, std::uint32_t i, std::uint32_t j,
             std::uint32_t k, std::uint32_t l)
      : corner{a, b, c, d},
        id{i, j, k, l},
        x(a.x, b.x, c.x, d.x),
        y(a.y, b.y, c.y, d.y),
        ex(b.x - a.x, c.x - b.x, d.x - c.x, a.x - d.x),
        ey(b.y - a.y, c.y - b.y, d.y - c.y, a.y - d.y),
        length2(ex * ex + ey * ey) {}

  // Part that a point lies on, as part_of names it. Returns false between two edges that are both near.
  bool part(double px, double py, double same, std::uint32_t& out) const {
    const double square = same * same;
    const Double4 rx = Double4(px) - x, ry = Double4(py) - y, beside = ex * ry - ey * rx, along = ex * rx + ey * ry;
    out = inside_part;
    if (const unsigned at = bits_of(rx * rx + ry * ry <= square)) {
      const std::uint32_t i = id[std::countr_zero(at)];
      return out = edge_part(i, i), true;
    }
    const unsigned on = bits_of(beside * beside <= length2 * square) & bits_of(along >= 0) & bits_of(along <= length2);
    if (on == 0) return true;
    const int k = std::countr_zero(on);
    out = edge_part(id[k], id[(k + 1) & 3]);
    return (on & (on - 1)) == 0;
  }
};

// own: the box of the face, whose normal is side times its axis i; other: at X in its frame. distance: of the shapes, along that
// normal; apart: it is the distance only if a point of the face is as near. Returns false if no point is as deep, or where parts
// are not certain.
inline bool face_contacts(const shape::Box& own, const Pose& XO, int i, double side, const shape::Box& other, const Pose& X,
                          double distance, bool apart, double margin, bool own_is_a, double size, Manifold& out) {
  const double eps = coincident * size, same = same_point * size;
  const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
  const Vec facing = Vec::make(X.R.x[i], X.R.y[i], X.R.z[i]) * -side, s = sizes(facing);
  const int f = s[0] >= s[1] && s[0] >= s[2] ? 0 : s[1] >= s[2] ? 1 : 2, g = f == 2 ? 0 : f + 1, h = f == 0 ? 2 : f - 1;
  const bool upper = facing[f] > 0;
  const Vec u = X.R[g] * other.half[g], v = X.R[h] * other.half[h];
  const Vec middle = X.p + X.R[f] * (upper ? other.half[f] : -other.half[f]);
  const double below = own.half[i] + own.radius + other.radius;
  const auto over = [&](const Vec& p) { return OverFace{p[j], p[k], side * p[i] - below}; };
  const std::uint32_t first = std::uint32_t(upper) << f, ug = 1u << g, uh = 1u << h;
  const FacingFace face(over(middle - u - v), over(middle + u - v), over(middle + u + v), over(middle - u + v), first, first | ug,
                        first | ug | uh, first | uh);
  const double hx = own.half[j], hy = own.half[k];
  OverFace buffers[2][9];
  int count = clip_side<&OverFace::x, 1>(face.corner, 4, hx, eps, buffers[0]);
  if (count) count = clip_side<&OverFace::x, -1>(buffers[0], count, hx, eps, buffers[1]);
  if (count) count = clip_side<&OverFace::y, 1>(buffers[1], count, hy, eps, buffers[0]);
  if (count) count = clip_side<&OverFace::y, -1>(buffers[0], count, hy, eps, buffers[1]);
  if (count > Manifold::most) return false;

  OverFace* const points = buffers[1];
  double deepest = shape::infinity;
  int kept = 0;
  for (int c = 0; c < count; ++c) {
    const OverFace p = points[c];
    if (!(p.gap <= margin)) continue;
    deepest = std::min(deepest, p.gap);
    int at = 0;  // of the point that it is one with; the deeper of the two stays
    for (; at < kept; ++at) {
      const double dx = points[at].x - p.x, dy = points[at].y - p.y;
      if (dx * dx + dy * dy <= same * same) break;
    }
    if (at == kept || p.gap < points[at].gap) points[at] = p;
    kept = std::max(kept, at + 1);
  }
  if (!(deepest <= distance + eps)) return false;
  bool is_nearest = !apart;
  const double rounding = 1e-14 * size;
  for (int c = 0; c < kept && !is_nearest; ++c)
    is_nearest = points[c].gap <= distance + rounding && std::abs(points[c].x) <= hx + rounding &&
                 std::abs(points[c].y) <= hy + rounding;
  if (!is_nearest) return false;
  const std::uint32_t base = std::uint32_t(side > 0) << i, uj = 1u << j, uk = 1u << k;
  std::uint64_t feature[Manifold::most];
  int order[Manifold::most];
  for (int c = 0; c < kept; ++c) {
    const OverFace& p = points[c];
    std::uint32_t part_own = inside_part, part_other;
    const double nx = hx - std::abs(p.x), ny = hy - std::abs(p.y);
    const std::uint32_t sx = p.x > 0 ? uj : 0, sy = p.y > 0 ? uk : 0;
    const bool near_x = std::abs(nx) <= same, near_y = std::abs(ny) <= same;
    if (near_x && near_y) {
      if (nx * nx + ny * ny > same * same) return false;
      part_own = edge_part(base | sx | sy, base | sx | sy);
    } else if (near_x && ny >= 0) {
      part_own = edge_part(base | sx, base | sx | uk);
    } else if (near_y && nx >= 0) {
      part_own = edge_part(base | sy, base | sy | uj);
    }
    if (!face.part(p.x, p.y, same, part_other)) return false;
    feature[c] = own_is_a ? std::uint64_t(part_own) << 32 | part_other : std::uint64_t(part_other) << 32 | part_own;
    int at = c;
    for (; at > 0 && feature[order[at - 1]] > feature[c]; --at) order[at] = order[at - 1];
    order[at] = c;
  }
  const Vec normal = XO.R[i] * side, x = XO.R[j], y = XO.R[k], origin = XO.p + normal * (own.half[i] + own.radius);
  out.normal = own_is_a ? normal : -normal, out.count = kept;
  for (int c = 0; c < kept; ++c) {
    const OverFace& p = points[order[c]];
    out.points[c] = {origin + x * p.x + y * p.y + normal * (p.gap / 2), p.gap, feature[order[c]]};
  }
  return true;
}

}  // namespace detail

enum class BoxContacts { Found, Overlap, Unknown };

// Overlap: the boxes overlap, and their result is known, but not the contact points (two edges meet, or parts are not certain).
inline BoxContacts box_contacts(const shape::Box& a, const Pose& XA, const shape::Box& b, const Pose& XB, double margin,
                                Manifold& out, Result& overlap) {
  clear(out);
  // along the line between the centres
  const Vec p = XB.p - XA.p;
  const double square = dot(p, p), gap = square - dot(sizes(transpose_times(XA.R, p)), a.half) -
                                         dot(sizes(transpose_times(XB.R, p)), b.half);
  const double away = std::max(0.0, margin + a.radius + b.radius);
  if (gap > 0 && gap * gap > square * (away * away * (1 + 1e-12) + 1e-24 * square)) return BoxContacts::Found;
  Difference<shape::Box, shape::Box> d(a, b, relative(XA, XB));
  d.limit(margin);
  const BoxAxis axis = box_axis(a.half, b.half, d.X, d.rounding(), d.reach);
  if (axis.distance > d.reach) return BoxContacts::Found;
  const double distance = axis.distance - a.radius - b.radius, size = d.small;
  const bool apart = axis.distance > 1e-10 * size + d.rounding();
  if ((axis.i < 0 || axis.j < 0) && std::min(shape::smallest(a.half), shape::smallest(b.half)) > 4 * same_point * size) {
    if (axis.j < 0) {
      if (detail::face_contacts(a, XA, axis.i, axis.n[axis.i], b, d.X, distance, apart, margin, true, size, out))
        return BoxContacts::Found;
    } else {
      const double side = -std::copysign(1.0, dot(axis.n, d.X.R[axis.j]));
      if (detail::face_contacts(b, XB, axis.j, side, a, {d.Rt, -(d.Rt * d.X.p)}, distance, apart, margin, false, size, out))
        return BoxContacts::Found;
    }
  }
  if (apart) return BoxContacts::Unknown;
  Cores c = {axis.n, Vec::zero(), Vec::zero(), axis.distance, 0, 0, false};
  box_witness(a.half, b.half, d.X, axis, c.a, c.b);
  c.residual = shape::norm(c.b - c.a - c.normal * c.distance);
  overlap = in_world(rounded(c, a.radius, b.radius, size, default_options), XA);
  return BoxContacts::Overlap;
}

}  // namespace dyn::collision
