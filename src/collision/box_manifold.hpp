// Contact points of two boxes along the normal of a face or of two edges: of two faces that face each other, one clipped against
// the rectangle of the other. The same points as clip_faces finds, in the frame of the face.
#pragma once

#include "base/simd_shuffle.hpp"
#include "collision/analytic/boxes.hpp"
#include "collision/ascending.hpp"
#include "collision/sphere_manifold.hpp"
#include "convex_methods.hpp"

namespace dyn::collision {

namespace detail {

// A point over a face: its coordinates on the plane across n, and the gap below it along n.
struct OverFace {
  double x, y, gap;
};

// A face of a box, seen along a normal n of the contact that is the face's own or tilted about its axis x. Across n the face is a
// rectangle, whose sides are along x and y and whose height along n is slope * y.
struct FaceView {
  int f, e, m;  // axes of the box: across the face, along x, along y
  double side, half;  // of the face: at side * half on axis f
  double c, s;        // n is side * c along f, and s along m
  double hx, hy, slope;

  FaceView(const Vec& box, const Vec& n, int f, int e, int m)
      : f(f), e(e), m(m), side(std::copysign(1.0, n[f])), half(box[f]), c(std::abs(n[f])), s(n[m]), hx(box[e]), hy(box[m] * c),
        slope(s / c) {}
  // Part of the view that a direction changes, and a point, both in the box's axes.
  OverFace along(const Vec& u) const { return {u[e], u[m] * c - u[f] * (side * s), u[f] * (side / c)}; }
  OverFace over(const Vec& p) const { return along(p - shape::axis(f) * (side * half)); }
};

// A parallelogram over the face, whose corners have numbers.
struct FacingFace {
  OverFace middle, u, v;  // corners: middle -+ u -+ v
  std::uint32_t id[4];
  Double4 x, y, gap, ex, ey, length2;  // corners, and the edges that begin there

  FacingFace(const OverFace& middle, const OverFace& u, const OverFace& v, std::uint32_t first, std::uint32_t ug,
             std::uint32_t vg)
      : middle(middle),
        u(u),
        v(v),
        id{first, first | ug, first | ug | vg, first | vg},
        x(corners(middle.x, u.x, v.x)),
        y(corners(middle.y, u.y, v.y)),
        gap(corners(middle.gap, u.gap, v.gap)),
        ex(next(x) - x),
        ey(next(y) - y),
        length2(ex * ex + ey * ey) {}
  static Double4 corners(double middle, double u, double v) {
    return Double4(middle) + Double4(-1, 1, 1, -1) * u + Double4(-1, -1, 1, 1) * v;
  }
  static Double4 next(const Double4& a) { return shuffle<1, 2, 3, 0>(a); }

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

// Corners of the overlap of a face and one that faces it, no higher than the margin, without those that are one.
class FaceOverlap {
 public:
  OverFace p[Manifold::most];
  int count = 0;
  bool full = false;  // there are more
  double deepest = shape::infinity;

  // Corners of the other face within eps of a side are inside.
  FaceOverlap(const FaceView& own, const FacingFace& other, double margin, double eps, double same)
      : same2_(same * same) {
    const Double4 &x = other.x, &y = other.y, &gap = other.gap;
    const double wide = own.hx + eps, high = own.hy + eps;
    double at[3][24];  // points that may be such corners
    unsigned corners = 0;
    const auto put = [&](int k, const auto& which, const Double4& px, const Double4& py, const Double4& pgap) DYN_INLINE_LAMBDA {
      px.store(at[0] + 4 * k), py.store(at[1] + 4 * k), pgap.store(at[2] + 4 * k);
      corners |= bits_of(which & (pgap <= margin)) << 4 * k;
    };
    put(0, (abs(x) <= wide) & (abs(y) <= high), x, y, gap);
    // its edges where they cross the sides of the rectangle
    const Double4 eg = FacingFace::next(gap) - gap;
    const auto crossings = [&](int k, const Double4& d, const Double4& beside, const Double4& eb, double room) DYN_INLINE_LAMBDA {
      const Double4 there = FacingFace::next(d), t = d / (d - there);
      const auto passes = ((d > eps) & (there < -eps)) | ((d < -eps) & (there > eps));
      put(k, passes & (abs(beside + t * eb) <= room), x + t * other.ex, y + t * other.ey, gap + t * eg);
    };
    crossings(1, x - own.hx, y, other.ey, high), crossings(2, x + own.hx, y, other.ey, high);
    crossings(3, y - own.hy, x, other.ex, wide), crossings(4, y + own.hy, x, other.ex, wide);
    // corners of the rectangle
    const OverFace &u = other.u, &v = other.v;
    const Double4 cx = Double4(-1, 1, 1, -1) * own.hx, cy = Double4(-1, -1, 1, 1) * own.hy;
    const Double4 rx = cx - other.middle.x, ry = cy - other.middle.y, a = rx * v.y - ry * v.x, b = ry * u.x - rx * u.y;
    const double area = u.x * v.y - u.y * v.x, size = std::abs(area);
    put(5, (abs(a) <= size) & (abs(b) <= size), cx, cy, Double4(other.middle.gap) + (a * u.gap + b * v.gap) * (1 / area));
    for_each_bit(corners, [&](int k) { add({at[0][k], at[1][k], at[2][k]}); });
  }

 private:
  double same2_;

  // Of two points that are one, the deeper stays.
  void add(const OverFace& q) {
    deepest = std::min(deepest, q.gap);
    int at = 0;
    for (; at < count; ++at) {
      const double dx = p[at].x - q.x, dy = p[at].y - q.y;
      if (dx * dx + dy * dy <= same2_) break;
    }
    if (at == Manifold::most) {
      full = true;
      return;
    }
    if (at == count || q.gap < p[at].gap) p[at] = q;
    count = std::max(count, at + 1);
  }
};

// own: the box of the face in view; other: at X in its axes, with Rt the transposed rotation. n: normal of the contact, from own
// to other, in own's axes. distance: of the shapes along n; apart: it is the distance only if a point of the face is as near.
// Returns false if no point is as deep, or where parts are not certain.
inline bool face_contacts(const shape::Box& own, const Pose& XO, const FaceView& view, const shape::Box& other, const Pose& X,
                          const Mat& Rt, const Vec& n, double distance, bool apart, double margin, bool own_is_a, double size,
                          Manifold& out) {
  const double eps = coincident * size, same = same_point * size;
  const Vec facing = -(Rt * n), s = sizes(facing);
  const int f = s[0] >= s[1] && s[0] >= s[2] ? 0 : s[1] >= s[2] ? 1 : 2, g = f == 2 ? 0 : f + 1, h = f == 0 ? 2 : f - 1;
  const bool upper = facing[f] > 0;
  OverFace middle = view.over(X.p + X.R[f] * (upper ? other.half[f] : -other.half[f]));
  middle.gap -= own.radius + other.radius;
  const FacingFace face(middle, view.along(X.R[g] * other.half[g]), view.along(X.R[h] * other.half[h]),
                        std::uint32_t(upper) << f, 1u << g, 1u << h);
  const FaceOverlap overlap(view, face, margin, eps, same);
  if (overlap.full || !(overlap.deepest <= distance + eps)) return false;
  const OverFace* const points = overlap.p;
  const int count = overlap.count;
  const double hx = view.hx, hy = view.hy, rounding = 1e-14 * size;
  bool is_nearest = !apart;
  for (int c = 0; c < count && !is_nearest; ++c)
    is_nearest = points[c].gap <= distance + rounding && std::abs(points[c].x) <= hx + rounding &&
                 std::abs(points[c].y) <= hy + rounding;
  if (!is_nearest) return false;
  const std::uint32_t base = std::uint32_t(view.side > 0) << view.f, ue = 1u << view.e, um = 1u << view.m;
  std::uint64_t feature[Manifold::most];
  int place[Manifold::most];
  for (int c = 0; c < count; ++c) {
    const OverFace& p = points[c];
    std::uint32_t part_own = inside_part, part_other;
    const double nx = hx - std::abs(p.x), ny = hy - std::abs(p.y);
    const std::uint32_t sx = p.x > 0 ? ue : 0, sy = p.y > 0 ? um : 0;
    const bool near_x = std::abs(nx) <= same, near_y = std::abs(ny) <= same;
    if (near_x && near_y) {
      if (nx * nx + ny * ny > same * same) return false;
      part_own = edge_part(base | sx | sy, base | sx | sy);
    } else if (near_x && ny >= 0) {
      part_own = edge_part(base | sx, base | sx | um);
    } else if (near_y && nx >= 0) {
      part_own = edge_part(base | sy, base | sy | ue);
    }
    if (!face.part(p.x, p.y, same, part_other)) return false;
    feature[c] = own_is_a ? std::uint64_t(part_own) << 32 | part_other : std::uint64_t(part_other) << 32 | part_own;
  }
  ascending(feature, count, place);
  const Vec across = XO.R[view.f] * view.side, normal = across * view.c + XO.R[view.m] * view.s;
  const Vec x = XO.R[view.e], y = XO.R[view.m] * view.c - across * view.s;
  const Vec origin = XO.p + across * view.half + normal * own.radius;
  out.normal = own_is_a ? normal : -normal, out.count = count;
  for (int c = 0; c < count; ++c) {
    const OverFace& p = points[c];
    out.points[place[c]] = {origin + x * p.x + y * p.y + normal * (view.slope * p.y + p.gap / 2), p.gap, feature[c]};
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
  const BoxAxes axes(a.half, b.half, d.X, d.Rt);
  if (axes.apart(d.reach)) return BoxContacts::Found;
  const BoxAxis axis = axes.best(d.rounding());
  const double distance = axis.distance - a.radius - b.radius, size = d.small;
  const bool apart = axis.distance > 1e-10 * size + d.rounding();
  if (std::min(shape::smallest(a.half), shape::smallest(b.half)) > 4 * same_point * size) {
    bool found;
    if (axis.i < 0) {
      const double side = -std::copysign(1.0, dot(axis.n, d.X.R[axis.j]));
      const int j = axis.j;
      const Vec n = shape::axis(j) * side;
      const detail::FaceView view(b.half, n, j, j == 2 ? 0 : j + 1, j == 0 ? 2 : j - 1);
      found = detail::face_contacts(b, XB, view, a, {d.Rt, -(d.Rt * d.X.p)}, d.X.R, n, distance, apart, margin, false, size, out);
    } else {
      // of A a face of its own, or the one at its edge that faces the normal more
      const int i = axis.i, k = i == 0 ? 2 : i - 1, j = i == 2 ? 0 : i + 1;
      const bool upper = std::abs(axis.n[j]) >= std::abs(axis.n[k]);
      const detail::FaceView view = axis.j < 0 ? detail::FaceView(a.half, axis.n, i, j, k)
                                               : detail::FaceView(a.half, axis.n, upper ? j : k, i, upper ? k : j);
      found = detail::face_contacts(a, XA, view, b, d.X, d.Rt, axis.n, distance, apart, margin, true, size, out);
    }
    if (found) return BoxContacts::Found;
  }
  if (apart) return BoxContacts::Unknown;
  Cores c = {axis.n, Vec::zero(), Vec::zero(), axis.distance, 0, 0, false};
  box_witness(a.half, b.half, d.X, axis, c.a, c.b);
  c.residual = shape::norm(c.b - c.a - c.normal * c.distance);
  overlap = in_world(rounded(c, a.radius, b.radius, size, default_options), XA);
  return BoxContacts::Overlap;
}

}  // namespace dyn::collision
