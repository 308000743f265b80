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

  void start() { out.count = 0, out.normal = plane_is_a ? n : -n; }
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

inline constexpr Index few_vertices = 64;  // a word has a bit for each
// The same of a hull of few vertices, by the heights of all of them.
inline bool hull_contacts(const shape::Convex& s, const Pose& X, const Vec& m, double height, double steep, double same, double eps,
                          PlaneContacts& contacts) {
  const shape::Hull& hull = s.hull;
  alignas(64) double gap[few_vertices];
  const std::uint64_t near = s.vertices_below(contacts.margin + eps, m, height, gap);
  contacts.out.count = 0;
  if (near == 0) return true;
  const Index low = s.support_number();
  if (gap[low] > contacts.margin) return true;
  std::uint64_t corners = near;
  if (near & (near - 1)) {  // no branch for a corner: which ones are near cannot be predicted
    const Index face = s.facing_face(hull.vertex(low), -m, [&](Index v) { return near >> v & 1; });
    if (face < 0) return false;
    const double facing = dot(hull.normal(face), m);
    bool certain = facing * facing > 4 * steep * steep;
    const Index start = hull.face_start[face], end = hull.face_start[face + 1];
    Index from = hull.face_vertices[end - 1];
    corners = 0;
    for (Index k = start; k < end; ++k) {
      const Index to = hull.face_vertices[k];
      const Vec e = hull.vertex(to) - hull.vertex(from);
      const double along = gap[to] - gap[from];
      certain &= dot(e, e) - along * along > 4 * same * same;  // across the normal they are not one
      corners |= std::uint64_t(gap[to] <= contacts.margin) << to, from = to;
    }
    if (!certain || std::popcount(corners) > Manifold::most) return false;
  }
  for_each_bit(corners, [&](int v) { contacts.put(contacts.out.count++, X.act(hull.vertex(v)), gap[v], std::uint32_t(v)); });
  return true;
}

// The cap or the line of a cylinder that faces the plane, numbered as Cylinder::facing does. Returns false, with nothing written,
// where no corner of the cap is as deep as its rim, or corners are one.
inline bool cylinder_contacts(const shape::Cylinder& s, const Pose& X, double height, PlaneContacts& contacts) {
  using shape::Feature;
  Manifold& out = contacts.out;
  const Vec &z = X.R.z, &n = contacts.n;
  const double upright = dot(z, n), rise = upright * s.half, steep = std::abs(upright);
  const Vec across = n - z * upright;
  const double square = dot(across, across), rho = std::sqrt(square), fall = rho * s.r, center = height - std::abs(rise);
  if (center - fall > contacts.margin) return clear(out), true;
  const double size = s.extent() + s.radius, same = same_point * size;
  if (s.r < 4 * same || s.half < same) return false;
  const bool cap = upright * upright >= square, turned = !cap || rho > Feature::tilted * steep;
  // the first corner of the rim, from its centre: the lowest one, if the cylinder leans
  const Vec u = turned ? across * (-s.r / rho) : X.R.x * s.r, up = z * std::copysign(s.half, upright);
  if (!cap) {
    contacts.start();
    constexpr std::uint32_t top = 2 * Feature::rim;
    const double lowest = height - fall;
    contacts.add(X.p + u + z * s.half, lowest + rise, top), contacts.add(X.p + u - z * s.half, lowest - rise, top + 1);
    return true;
  }
  constexpr double d = Feature::diagonal;
  const Vec v = cross(z, u), corner[4] = {u, (u + v) * d, v, (v - u) * d}, middle = X.p - up;
  // heights of these corners over the centre; four more are opposite
  const Double4 over = turned ? Double4(-1, -d, 0, d) * fall : Double4(1, d, 0, -d) * dot(n, u) + Double4(0, d, 1, d) * dot(n, v);
  if (!turned && !any(abs(over) >= fall - coincident * size)) return false;
  const Double4 gap[2] = {Double4(center) + over, Double4(center) - over};
  const unsigned near = bits_of(gap[0] <= contacts.margin) | bits_of(gap[1] <= contacts.margin) << 4;
  const std::uint32_t first = upright > 0 ? Feature::rim : 0;
  contacts.start();
  const auto put = [&](unsigned k, unsigned place) DYN_INLINE_LAMBDA {
    contacts.put(int(place), k < 4 ? middle + corner[k] : middle - corner[k - 4], gap[k / 4][k % 4], first + k);
  };
  put(0, 0);
  // no branch for a corner: the next near one takes the place of one that is not
  if (near != 1)
    for (unsigned k = 1, place = near & 1; k < Feature::rim; place += near >> k++ & 1) put(k, place);
  out.count = std::popcount(near);
  return true;
}

}  // namespace detail

// Lower bound of the height of a shape whose origin lies at a height above a plane with the normal m in the shape's axes.
template <class S>
double lowest_corner(const S& s, const Vec& m, double height) {
  if constexpr (S::type == shape::Type::Sphere) return height;
  if constexpr (S::type == shape::Type::Box) return height - dot(sizes(m), s.half);
  if constexpr (S::type == shape::Type::Capsule) return height - std::abs(m[2]) * s.half;
  if constexpr (S::type == shape::Type::Ellipsoid) return height - shape::norm(hadamard(s.semi, m));
  return height - s.extent();
}

// Returns false, with nothing written, if corners lie so close that they are one, or are all less deep than the shape.
template <class S>
bool plane_contacts(const shape::HalfSpace& plane, const Pose& P, const S& s, const Pose& X, bool plane_is_a, double margin,
                    Manifold& out) {
  constexpr double steep = 0.05;  // sine: a line seen end-on is a point (project)
  const Vec& n = P.R.z;
  const double height = dot(n, X.p - P.p) - plane.radius - s.radius;
  detail::PlaneContacts contacts = {n, s.radius, margin, plane_is_a, out};
  if constexpr (S::type == shape::Type::Cylinder) return detail::cylinder_contacts(s, X, height, contacts);
  const Vec m = transpose_times(X.R, n);  // in the shape
  if (lowest_corner(s, m, height) > margin) return clear(out), true;
  const double size = s.extent() + s.radius, same = same_point * size, eps = coincident * size;
  if constexpr (S::type == shape::Type::Sphere) {
    contacts.start();
    contacts.add(X.p, height, 0);
  } else if constexpr (S::type == shape::Type::Box) {
    const Vec t = sizes(m), tilt = hadamard(m, s.half);
    const int i = t[0] >= t[1] && t[0] >= t[2] ? 0 : t[1] >= t[2] ? 1 : 2, j = i == 0 ? 1 : 0, k = i == 2 ? 1 : 2;
    if (s.half[j] < same || s.half[k] < same) return false;
    contacts.start();
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
    contacts.start();
    if (!(s.half > 0 && upright && rise > 0)) contacts.add(X.p + end, height + rise, 0);
    if (s.half > 0 && !(upright && !(rise > 0))) contacts.add(X.p - end, height - rise, 1);
  } else if constexpr (S::type == shape::Type::Ellipsoid) {
    contacts.start();
    const Vec deepest = s.support(-m);
    contacts.add(X.act(deepest), height + dot(m, deepest), 0);
  } else {
    out.normal = plane_is_a ? n : -n;
    if constexpr (S::type == shape::Type::Convex)
      if (s.hull.vertices <= detail::few_vertices) return detail::hull_contacts(s, X, m, height, steep, same, eps, contacts);
    return detail::facing_contacts(s, X, m, height, steep, same, eps, contacts);
  }
  return true;
}

}  // namespace dyn::collision
