// Contact points of two capsules: the ends of one axis over the surface of the other, and the nearest points if they are deeper.
// The same points as clip_lines finds, without projection.
#pragma once

#include "collision/analytic/capsules.hpp"
#include "collision/sphere_manifold.hpp"

namespace dyn::collision {

// Returns false where an axis is so short that its ends may be one.
inline bool capsule_contacts(const shape::Capsule& a, const Pose& XA, const shape::Capsule& b, const Pose& XB, double margin,
                             Manifold& out) {
  constexpr double steep = 0.05;  // sine: an axis seen end-on is a point (project)
  constexpr double rounding = 1e-9;
  struct Axis {
    Vec center, z;      // from the origin of A
    double half, rise;  // rise: z.n
    double square;      // of the sine of the angle to n
    bool is_line;

    std::uint32_t part(const Vec& p, double same) const {
      const double at = dot(z, p - center), room = half - std::abs(at);
      if (!is_line || room * room * square <= same * same) return at > 0 ? detail::edge_part(0, 0) : detail::edge_part(1, 1);
      return detail::edge_part(0, 1);
    }
  };
  const Vec p = XB.p - XA.p;
  const Cores c = capsule_pair(a, b, XA.R.z, XB.R.z, p);
  const double distance = c.distance - a.radius - b.radius, least = std::min(a.half, b.half);
  const double size = std::min(a.half + a.radius, b.half + b.radius), eps = coincident * size, same = same_point * size;
  clear(out);
  if (!(distance <= margin)) return true;
  if (!(steep * least > same)) return false;
  const Vec& n = c.normal;
  out.normal = n;
  // where the axes cross at such an angle that no end is over the other capsule
  const double uv = dot(XA.R.z, XB.R.z), cross_square = (1 - rounding) * (1 - uv * uv);
  const double room_a = a.half - std::abs(dot(XA.R.z, c.a)), room_b = b.half - std::abs(dot(XB.R.z, c.b - p));
  const auto ends_beside = [&](double room, double radius) {
    return room > same && room * room * cross_square > std::max(radius, eps) * std::max(radius, eps);
  };
  if (ends_beside(room_a, b.radius) && ends_beside(room_b, a.radius)) {
    const std::uint64_t inside = detail::edge_part(0, 1);
    out.points[out.count++] = {XA.p + (c.a + n * (a.radius + distance / 2)), distance, inside << 32 | inside};
    return true;
  }
  const auto axis = [&](const Vec& center, const Vec& z, double half) {
    const double rise = dot(n, z), square = std::max(0.0, 1 - rise * rise);
    return Axis{center, z, half, rise, square, square >= steep * steep};
  };
  const Axis axes[2] = {axis(Vec::zero(), XA.R.z, a.half), axis(p, XB.R.z, b.half)};
  // heights along n, along the axes and across them, of which those of an end are a sum
  const Vec across_b = cross(XB.R.z, n), across_a = cross(XA.R.z, n);
  const double high = dot(n, p), twist = dot(XA.R.z, across_b);
  const double along_b = dot(p, XB.R.z), beside_b = dot(p, across_b), along_a = dot(p, XA.R.z), beside_a = dot(p, across_a);
  struct Point {
    Vec at;
    double gap;
    std::uint64_t feature;
  };
  Point points[5];
  int count = 0;
  double deepest = shape::infinity;
  if (axes[0].is_line && axes[1].is_line) {
    // the ends of A, then those of B, four at once: most are not over the other capsule, or too high
    const Axis &A = axes[0], &B = axes[1];
    const auto both = [](double x, double y) { return Double4(x, x, y, y); };
    const Double4 ends = both(A.half, B.half) * Double4(1.0, -1.0, 1.0, -1.0), sign = both(1, -1);
    const Double4 other_rise = both(B.rise, A.rise), other_square = both(B.square, A.square), other_half = both(B.half, A.half);
    const Double4 up_rel = ends * both(A.rise, B.rise) - sign * high, along = both(-along_b, along_a) + ends * uv;
    // times the sine
    const Double4 t_sine = along - other_rise * up_rel, beside_sine = abs(both(-beside_b, beside_a) + sign * ends * twist);
    const Double4 wide = both(std::max(b.radius, eps), std::max(a.radius, eps));
    const Double4 least_gap = sign * (t_sine * other_rise - up_rel * other_square);  // times the squared sine, of the axes
    unsigned over_other = bits_of((beside_sine * beside_sine <= wide * wide * other_square) &
                                  (abs(t_sine) <= other_half * other_square + eps) &
                                  (least_gap <= other_square * (margin + a.radius + b.radius + eps)));
    // the nearest points alone: an end that is one of them says nothing more
    const Double4 nearest = both(dot(A.z, c.a), dot(B.z, c.b - p));
    const unsigned others = over_other & ~bits_of(ends * nearest >= ends * ends - abs(ends) * eps);
    if (!others) over_other = 0;
    if (over_other) {
      const Double4 sine = sqrt(other_square), inverse = Double4(1) / sine, t = t_sine * inverse, beside = beside_sine * inverse;
      const Double4 over = abs(t) - other_half * sine, curvature = both(b.radius, a.radius), none = Double4::zero();
      const Double4 falls = (curvature - sqrt(max(none, curvature * curvature - beside * beside))) * inverse;
      // from the end to the other axis along n; A lies below
      const Double4 gap = sign * (t * inverse * other_rise - up_rel) - a.radius - b.radius + falls;
      over_other &= bits_of((over <= eps) & (gap <= margin));
      const unsigned at_end = bits_of(over * over + beside * beside <= same * same),
                     on_line = bits_of((beside <= same) & (over <= 0.0)), upper = bits_of(t > 0.0);
      for_each_bit(over_other, [&](int lane) {
        const bool of_a = lane < 2;
        const unsigned bit = 1u << lane;
        const std::uint32_t corner = lane & 1 ? detail::edge_part(1, 1) : detail::edge_part(0, 0);
        const std::uint32_t part = at_end & bit    ? upper & bit ? detail::edge_part(0, 0) : detail::edge_part(1, 1)
                                   : on_line & bit ? detail::edge_part(0, 1)
                                                   : detail::inside_part;
        const double height = gap[lane];
        const Vec end = of_a ? A.z * ends[lane] + n * (a.radius + height / 2)
                             : p + B.z * ends[lane] - n * (b.radius + height / 2);
        deepest = std::min(deepest, height);
        int place = 0;  // of the point that it is one with; the deeper of the two stays
        for (; place < count; ++place) {
          const Vec way = points[place].at - end;
          const double rise = dot(way, n);
          if (dot(way, way) - rise * rise <= same * same) break;
        }
        if (place == count || height < points[place].gap)
          points[place] = {end, height, of_a ? std::uint64_t(corner) << 32 | part : std::uint64_t(part) << 32 | corner};
        count = std::max(count, place + 1);
      });
    }
  }
  if (deepest > distance + eps) {
    const std::uint32_t part_a = axes[0].part(c.a, same), part_b = axes[1].part(c.b, same);
    points[count++] = {c.a + n * (a.radius + distance / 2), distance, std::uint64_t(part_a) << 32 | part_b};
  }
  for (int i = 0; i < count; ++i) {
    int k = i;
    for (; k > 0 && out.points[k - 1].feature > points[i].feature; --k) out.points[k] = out.points[k - 1];
    out.points[k] = {XA.p + points[i].at, points[i].gap, points[i].feature};
  }
  out.count = count;
  return true;
}

}  // namespace dyn::collision
