// The contact point of a sphere with a box, capsule or cylinder in closed form: the nearest point and the part that it lies on.
#pragma once

#include "collision/lanes.hpp"
#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace detail {

inline constexpr std::uint32_t inside_part = 0xffffffff;
constexpr std::uint32_t edge_part(std::uint32_t i, std::uint32_t j) { return std::min(i, j) << 16 | std::max(i, j); }

// Part of the facing feature at the nearest point, as part_of names it. Returns false where points within `same` of it have
// other names.
inline bool nearest_part(const shape::Box& s, const shape::Nearest& near, double same, std::uint32_t& part) {
  const Vec room = s.half - sizes(near.point);
  std::uint32_t on = 0, number = 0;
  for (int i = 0; i < 3; ++i) {
    const bool flush = room[i] == 0;
    if (!flush && !(room[i] > 2 * same)) return false;
    if (!(s.half[i] > 2 * same)) return false;
    on |= std::uint32_t(flush) << i, number |= std::uint32_t(flush && near.point[i] > 0) << i;
  }
  const std::uint32_t open = 7 & ~on;
  if (open == 0)
    part = edge_part(number, number);
  else if (open & (open - 1))  // two directions are open: a face
    part = inside_part;
  else
    part = edge_part(number, number | open);
  return on != 0;
}
inline bool nearest_part(const shape::Capsule& s, const shape::Nearest& near, double same, std::uint32_t& part) {
  const double z = near.point[2], room = s.half - std::abs(z);
  part = room > 0 ? edge_part(0, 1) : z > 0 || s.half == 0 ? edge_part(0, 0) : edge_part(1, 1);
  return s.half == 0 || (0.1 * s.half > same && (room == 0 || room > 2 * same));
}
inline bool nearest_part(const shape::Cylinder& s, const shape::Nearest& near, double same, std::uint32_t& part) {
  using shape::Feature;
  const Vec& n = near.normal;
  const double z = near.point[2], room = s.half - std::abs(z), square = n[0] * n[0] + n[1] * n[1];
  if (!(s.half > 2 * same && s.r > 4 * same)) return false;
  if (n[2] * n[2] < square) {  // a line
    constexpr std::uint32_t up = 2 * Feature::rim, down = up + 1;
    part = room > 0 ? edge_part(up, down) : z > 0 ? edge_part(up, up) : edge_part(down, down);
    return room == 0 || room > 2 * same;
  }
  const std::uint32_t first = n[2] > 0 ? 0 : Feature::rim;
  if (square > Feature::tilted * Feature::tilted * (n[2] * n[2]) * 1.001) return part = edge_part(first, first), true;
  const double rho2 = near.point[0] * near.point[0] + near.point[1] * near.point[1];
  return part = inside_part, rho2 < 0.85 * (s.r * s.r);  // within the octagon: cos^2 of pi/8
}

}  // namespace detail

namespace detail {

// over: how far a point is outside the slabs of a box. The nearest point of the box and its part; returns false where the part is
// not certain, or the point is inside.
inline bool outside_box(const shape::Box& s, const Vec& p, const Vec& over, double square, double same, shape::Nearest& near,
                        std::uint32_t& part) {
  const Double4 half = lanes_of(s.half), slack = half - lanes_of(sizes(p));
  const unsigned on = bits_of(slack < 0.0), number = on & bits_of(lanes_of(p) > 0.0), open = 7 & ~on;
  if (!(square > 0) || (open & bits_of(slack <= 2 * same)) || (7 & bits_of(half <= 2 * same))) return false;
  part = open & (open - 1) ? inside_part : edge_part(number, number | open);  // two directions are open: a face
  near.distance = std::sqrt(square);
  near.normal = shape::with_sign(over, p) * (1 / near.distance);
  return true;
}

}  // namespace detail

// The sphere has its centre at p. Returns false, with nothing written, where the part is not certain.
template <class S>
DYN_INLINE bool sphere_contact(const S& s, const Pose& X, const Vec& p, double radius, bool sphere_is_a, double margin, Manifold& out) {
  const Vec center = X.act_inverse(p);
  shape::Nearest near;
  std::uint32_t part = 0;
  bool known = false;
  if constexpr (S::type == shape::Type::Box) {
    const Vec over = shape::greater(sizes(center) - s.half, Vec::zero());
    const double away = std::max(0.0, margin + s.radius + radius) * (1 + 1e-12), square = dot(over, over);
    if (square > away * away + 1e-24 * dot(center, center)) return clear(out), true;
    known = detail::outside_box(s, center, over, square, same_point * radius, near, part);
  }
  if (!known) near = s.nearest(center);
  const double distance = near.distance - s.radius - radius;
  if (!known && distance <= margin) {
    const double size = std::min(s.extent() + s.radius, radius);
    if (!detail::nearest_part(s, near, same_point * size, part)) return false;
  }
  clear(out);
  if (!(distance <= margin)) return true;
  const Vec n = X.R * near.normal;
  out.normal = sphere_is_a ? -n : n;
  const std::uint64_t feature = sphere_is_a ? std::uint64_t(part) : std::uint64_t(part) << 32;
  out.points[out.count++] = {p - n * (radius + distance / 2), distance, feature};
  return true;
}

}  // namespace dyn::collision
