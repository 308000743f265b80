// Contact points of a half-space with a convex shape, without a distance query: the corners of the feature that faces the plane.
#pragma once

#include <bit>

#include "collision/ascending.hpp"
#include "collision/manifold.hpp"
#include "collision/manifold_clip.hpp"
#include "shape/list.hpp"

namespace dyn::collision {

namespace detail {

// The corner of a rounded shape at p in the world, at a signed distance from the plane.
struct PlaneContacts {
  const Vec& n;          // of the plane, outward
  double radius, margin;
  bool plane_is_a;
  Manifold& out;

  void add(const Vec& p, double distance, std::uint32_t id) {
    if (distance <= margin) put(out.count++, p, distance, id);
  }
  void put(int at, const Vec& p, double distance, std::uint32_t id) {
    const std::uint64_t corner = id << 16 | id, inside = 0xffffffff;
    const std::uint64_t feature = plane_is_a ? inside << 32 | corner : corner << 32 | inside;
    out.points[at] = {p - n * (radius + distance / 2), distance, feature};
  }
};

// The corners of the face or line that faces the plane. Returns false where corners are too many or one, or the feature is seen
// edge-on.
template <class S>
bool facing_contacts(const S& s, const Pose& X, const Vec& m, double height, double steep, double same, double eps,
                     PlaneContacts& contacts) {
  shape::Feature f;
  const Vec deepest = s.support(-m);
  const double distance = height + dot(m, deepest);
  contacts.out.count = 0;
  if (distance > contacts.margin) return true;
  if constexpr (S::type == shape::Type::Convex)
    if (s.is_alone(-m, contacts.margin - distance + eps))
      return contacts.add(X.act(deepest), distance, s.support_number()), true;
  s.facing_at(deepest, -m, std::max(contacts.margin - distance, 0.0) + eps, f);
  double gap[shape::Feature::most];
  unsigned kept = 0;  // a bit each
  bool near = false;
  for (int k = 0; k < f.count; ++k) {
    gap[k] = height + dot(m, f.p[k]);
    kept |= unsigned(gap[k] <= contacts.margin) << k, near |= gap[k] <= distance + eps;
  }
  if (!near || std::popcount(kept) > Manifold::most) return false;
  // distances across the normal
  Vec normal = Vec::zero();
  for (int k = 0; k < f.count; ++k) {
    const Vec e = f.p[k + 1 < f.count ? k + 1 : 0] - f.p[k];
    const double along = dot(e, m), length2 = dot(e, e);
    const double least = std::max(4 * same * same, f.count == 2 ? steep * steep * length2 : 0);
    if (f.count > 1 && length2 - along * along <= least) return false;
    if (f.count > 2) normal += cross(f.p[k] - f.p[0], e);
  }
  const double facing = dot(normal, m);
  if (f.count > 2 && !(facing * facing > 4 * steep * steep * dot(normal, normal))) return false;
  std::uint16_t id[Manifold::most];
  int corner[Manifold::most], place[Manifold::most], count = 0;
  for_each_bit(kept, [&](int k) { id[count] = f.id[k], corner[count++] = k; });
  ascending(id, count, place);
  for (int i = 0; i < count; ++i) contacts.put(place[i], X.act(f.p[corner[i]]), gap[corner[i]], id[i]);
  contacts.out.count = count;
  return true;
}

}  // namespace detail

// Lower bound of the height of a shape whose origin lies at a height above a plane with the normal m in the shape's axes.
template <class S>
double lowest_corner(const S& s, const Vec& m, double height) {
  if constexpr (S::type == shape::Type::Sphere) return height;
  if constexpr (S::type == shape::Type::Box) return height - dot(sizes(m), s.half);
  if constexpr (S::type == shape::Type::Capsule) return height - std::abs(m[2]) * s.half;
  if constexpr (S::type == shape::Type::Cylinder)
    return height - std::abs(m[2]) * s.half - std::sqrt(m[0] * m[0] + m[1] * m[1]) * s.r;
  if constexpr (S::type == shape::Type::Ellipsoid) return height - shape::norm(hadamard(s.semi, m));
  return height - s.extent();
}

// Returns false, with nothing written, if corners lie so close that they are one, or are all less deep than the shape.
template <class S>
bool plane_contacts(const shape::HalfSpace& plane, const Pose& P, const S& s, const Pose& X, bool plane_is_a, double margin,
                    Manifold& out) {
  constexpr double steep = 0.05;  // sine: a line seen end-on is a point (project)
  const Vec &n = P.R.z, m = transpose_times(X.R, n);  // m: in the shape
  const double height = dot(n, X.p - P.p) - plane.radius - s.radius;
  if (lowest_corner(s, m, height) > margin) return clear(out), true;
  const double size = s.extent() + s.radius, same = same_point * size, eps = coincident * size;
  detail::PlaneContacts contacts = {n, s.radius, margin, plane_is_a, out};
  const auto start = [&] { out.count = 0, out.normal = plane_is_a ? n : -n; };
  if constexpr (S::type == shape::Type::Sphere) {
    start();
    contacts.add(X.p, height, 0);
  } else if constexpr (S::type == shape::Type::Box) {
    const Vec t = sizes(m), tilt = hadamard(m, s.half);
    const int i = t[0] >= t[1] && t[0] >= t[2] ? 0 : t[1] >= t[2] ? 1 : 2, j = i == 0 ? 1 : 0, k = i == 2 ? 1 : 2;
    if (s.half[j] < same || s.half[k] < same) return false;
    start();
    const double face = height - std::abs(tilt[i]), dj = tilt[j], dk = tilt[k];
    const bool upper = m[i] < 0;
    const Vec u = X.R[j] * s.half[j], v = X.R[k] * s.half[k], middle = X.p + X.R[i] * (upper ? s.half[i] : -s.half[i]);
    const std::uint32_t first = std::uint32_t(upper) << i, uj = 1u << j, uk = 1u << k;
    contacts.add(middle - u - v, face - dj - dk, first), contacts.add(middle + u - v, face + dj - dk, first | uj);
    contacts.add(middle - u + v, face - dj + dk, first | uk), contacts.add(middle + u + v, face + dj + dk, first | uj | uk);
  } else if constexpr (S::type == shape::Type::Capsule) {
    const Vec end = X.R.z * s.half;
    const double rise = m[2] * s.half;
    const bool upright = 1 - m[2] * m[2] < steep * steep;
    if (s.half > 0 && !upright && steep * s.half < same) return false;
    start();
    if (!(s.half > 0 && upright && rise > 0)) contacts.add(X.p + end, height + rise, 0);
    if (s.half > 0 && !(upright && !(rise > 0))) contacts.add(X.p - end, height - rise, 1);
  } else if constexpr (S::type == shape::Type::Ellipsoid) {
    start();
    const Vec deepest = s.support(-m);
    contacts.add(X.act(deepest), height + dot(m, deepest), 0);
  } else if constexpr (S::type != shape::Type::Cylinder) {
    out.normal = plane_is_a ? n : -n;
    return detail::facing_contacts(s, X, m, height, steep, same, eps, contacts);
  } else {
    const double square = m[0] * m[0] + m[1] * m[1], rho = std::sqrt(square);
    if (s.r < 4 * same || s.half < same) return false;
    if (m[2] * m[2] >= square) {  // a cap
      const double z = m[2] > 0 ? -s.half : s.half, lowest = height + m[2] * z, scale = s.r / rho;
      const bool turned = rho > shape::Feature::tilted * std::abs(m[2]);
      const double x = turned ? -m[0] * scale : s.r, y = turned ? -m[1] * scale : 0;
      const double along = m[0] * x + m[1] * y, across = m[1] * x - m[0] * y;
      constexpr double diagonal = shape::Feature::diagonal;
      const double c[4] = {along, diagonal * (along + across), across, diagonal * (across - along)};
      double deepest = 0;
      for (const double fall : c) deepest = std::max(deepest, std::abs(fall));
      if (rho * s.r - deepest > eps) return false;
      start();
      if (lowest - deepest > margin) return true;
      const Vec u = X.R.x * x + X.R.y * y, v = X.R.y * x - X.R.x * y, center = X.p + X.R.z * z;
      const Vec p[4] = {u, (u + v) * diagonal, v, (v - u) * diagonal};
      const std::uint32_t first = m[2] > 0 ? shape::Feature::rim : 0;  // numbers as Cylinder::facing has them
      for (std::uint32_t k = 0; k < 4; ++k) contacts.add(center + p[k], lowest + c[k], first + k);
      for (std::uint32_t k = 0; k < 4; ++k) contacts.add(center - p[k], lowest - c[k], first + 4 + k);
    } else {  // the line that faces the plane
      start();
      const double lowest = height - rho * s.r, rise = m[2] * s.half, scale = -s.r / rho;
      const Vec middle = X.p + X.R.x * (m[0] * scale) + X.R.y * (m[1] * scale), end = X.R.z * s.half;
      constexpr std::uint32_t first = 2 * shape::Feature::rim;
      contacts.add(middle + end, lowest + rise, first), contacts.add(middle - end, lowest - rise, first + 1);
    }
  }
  return true;
}

}  // namespace dyn::collision
