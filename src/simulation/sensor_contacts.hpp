// Sensors of two sides: distances and contacts; and rays.
#pragma once

#include <bit>

#include "collision/distance.hpp"
#include "collision/rays.hpp"
#include "simulation/sensor_sums.hpp"

namespace dyn::sensors {

inline bool is_within(const Model& m, Index geom, dynSide side, Index object) {
  const Index shape = m.geoms()[geom].shape, frame = m.shapes()[shape].frame;
  switch (side) {
    case DYN_SIDE_LINK: return frame == object;
    case DYN_SIDE_SHAPE: return shape == object;
    case DYN_SIDE_SUBTREE: return hangs_on(m, frame, object);
    default: return true;
  }
}

inline void distance_values(const Model& m, Data<double>& d, const dynSensor& s, double* out) {
  collision::Result best;
  double least = s.cutoff;
  bool found = false;
  collision::Workspace workspace;
  for (Index a = 0; a < m.n.geoms; ++a) {
    if (!is_within(m, a, s.side, s.object)) continue;
    for (Index b = 0; b < m.n.geoms; ++b) {
      if (b == a || !is_within(m, b, s.other_side, s.reference)) continue;
      const collision::Result r =
          collision::distance(d.geoms[a].shape, d.geom_poses[a], d.geoms[b].shape, d.geom_poses[b], workspace);
      if (r.distance < least) best = r, least = r.distance, found = true;
    }
  }
  std::fill_n(out, s.size, 0.0);
  if (s.quantity == DYN_QUANTITY_DISTANCE) *out = least;
  else if (found && s.quantity == DYN_QUANTITY_FROMTO) store3(best.point_a, out), store3(best.point_b, out + 3);
  else if (found) store3(best.distance < 0 ? -best.normal : best.normal, out);
}

// Writes what the sensor wants of the values, in the order of `bits`.
template <std::size_t n, class Value>
double* put_values(const dynSensor& s, const std::uint32_t (&bits)[n], Value&& value, double* out) {
  for (const std::uint32_t bit : bits)
    if (values_of(s) & bit) value(bit, out), out += value_sizes[std::countr_zero(bit)];
  return out;
}

inline void ray_values(const Model& m, const Data<double>& d, const dynSensor& s, const Placed& at, double* out) {
  const Index link = link_of(m, s.object);
  const collision::RayHit hit = collision::cast(m, d, at.X.p, at.X.R.z, HUGE_VAL, [&](Index geom) {
    const bool below = d.geoms[geom].shape.type == shape::Type::HalfSpace &&
                       dot(d.geom_poses[geom].R.z, at.X.p - d.geom_poses[geom].p) < 0;  // planes are seen from above
    return !below && m.shapes()[m.geoms()[geom].shape].frame != link;
  });
  const bool hits = hit.geom >= 0;
  constexpr std::uint32_t order[] = {DYN_VALUE_DISTANCE, DYN_VALUE_DIRECTION, DYN_VALUE_ORIGIN,
                                     DYN_VALUE_POSITION, DYN_VALUE_NORMAL,    DYN_VALUE_DEPTH};
  put_values(s, order, [&](std::uint32_t bit, double* to) {
    const auto vector = [&](const Vector& x, bool known) { store3(known ? x : Vector::zero(), to); };
    switch (bit) {
      case DYN_VALUE_DIRECTION: return vector(at.X.R.z, hits);
      case DYN_VALUE_ORIGIN: return vector(at.X.p, true);
      case DYN_VALUE_POSITION: return vector(at.X.p + at.X.R.z * hit.t, hits);
      case DYN_VALUE_NORMAL: return vector(hit.normal, hits);
      default: *to = hits ? hit.t : -1;
    }
  }, out);
}

// A contact as a sensor reads it: its normal points from the first side to the second.
struct SeenContact {
  const dynContactForce* f;
  bool flipped;
  double criterion;
};

// Axes of a contact: its normal, and the tangent nearest to the y axis of the world, to z where the normal is about y.
inline Mat3<double> contact_axes(const dynContact& c) {
  const Vector n = load3(c.normal), along = std::abs(n[1]) < 0.5 ? Vector::make(0, 1, 0) : Vector::make(0, 0, 1);
  const Vector across = along - n * dot(n, along), t = across * (1 / std::sqrt(dot(across, across)));
  return {n, t, cross(n, t)};
}
// [force; moment] on the second shape, in the axes.
inline Force<double> local_force(const dynContactForce& f, const Mat3<double>& R) {
  return {transpose_times(R, load3(f.force_on_b)), transpose_times(R, load3(f.moment_on_b))};
}

// 1: it is one of the sensor's; -1: with its shapes exchanged; 0: it is none.
inline int matches(const Model& m, const Data<double>& d, const dynSensor& s, const dynContactForce& f) {
  const dynContact& c = f.contact;
  if (c.distance > 0 && !(dot(load3(f.force_on_b), load3(f.force_on_b)) > 0)) return 0;
  const Index a = collision::geom_of_shape(m, c.shape_a), b = collision::geom_of_shape(m, c.shape_b);
  if (s.side == DYN_SIDE_ZONE) {
    const Placed zone = placed(m, d, s.object, load_se3(s.placement));
    if (!meets(s, transpose_times(zone.X.R, load3(c.position) - zone.X.p), Vector::zero())) return 0;
  }
  const bool a1 = is_within(m, a, s.side, s.object), b1 = is_within(m, b, s.side, s.object),
             a2 = is_within(m, a, s.other_side, s.reference), b2 = is_within(m, b, s.other_side, s.reference);
  if (!(a1 || b1) || !(a2 || b2)) return 0;
  const bool first = s.side != DYN_SIDE_ANY, second = s.other_side != DYN_SIDE_ANY;
  if (first && second) return a1 && b2 ? 1 : b1 && a2 ? -1 : 0;
  if (first) return a1 ? 1 : -1;
  return !second || b2 ? 1 : -1;
}

inline void put_contact(const dynSensor& s, const SeenContact& x, int count, double* out) {
  const dynContact& c = x.f->contact;
  const Mat3<double> R = contact_axes(c);
  const Force<double> force = local_force(*x.f, R);
  const double sign = x.flipped ? -1 : 1;
  constexpr std::uint32_t order[] = {DYN_VALUE_FOUND,    DYN_VALUE_FORCE,  DYN_VALUE_MOMENT, DYN_VALUE_DISTANCE,
                                     DYN_VALUE_POSITION, DYN_VALUE_NORMAL, DYN_VALUE_TANGENT};
  const auto mirrored = [&](const Vector& v) { return Vector::make(v[0], v[1], sign * v[2]); };
  put_values(s, order, [&](std::uint32_t bit, double* to) {
    switch (bit) {
      case DYN_VALUE_FOUND: *to = count; return;
      case DYN_VALUE_FORCE: return store3(mirrored(force.linear), to);
      case DYN_VALUE_MOMENT: return store3(mirrored(force.angular), to);
      case DYN_VALUE_DISTANCE: *to = c.distance; return;
      case DYN_VALUE_POSITION: return store3(load3(c.position), to);
      case DYN_VALUE_NORMAL: return store3(R.x * sign, to);
      default: store3(R.y * sign, to);
    }
  }, out);
}

// All contacts as one.
struct NetContact {
  Vector point = Vector::zero(), force = Vector::zero(), moment = Vector::zero();
  double weight = 0;
  int count = 0;
};

template <class F>
void for_each_match(const Model& m, const Data<double>& d, const dynSensor& s, F&& f) {
  if (!d.step) return;
  simulation::for_each_contact(*d.step, [&](const dynContactForce& x) {
    if (const int match = matches(m, d, s, x)) f(x, match < 0);
  });
}

inline void put_net_contact(const Model& m, const Data<double>& d, const dynSensor& s, double* out) {
  NetContact net;
  for_each_match(m, d, s, [&](const dynContactForce& f, bool) {
    const double size = std::sqrt(dot(load3(f.force_on_b), load3(f.force_on_b)));
    net.point += load3(f.contact.position) * size, net.weight += size, ++net.count;
  });
  net.point = net.point * (1 / std::max(net.weight, 1e-15));
  for_each_match(m, d, s, [&](const dynContactForce& f, bool flipped) {
    const Vector force = load3(f.force_on_b) * (flipped ? -1 : 1), moment = load3(f.moment_on_b) * (flipped ? -1 : 1);
    net.force += force, net.moment += moment + cross(load3(f.contact.position) - net.point, force);
  });
  if (net.count == 0) return;
  constexpr std::uint32_t order[] = {DYN_VALUE_FOUND,    DYN_VALUE_FORCE,  DYN_VALUE_MOMENT, DYN_VALUE_DISTANCE,
                                     DYN_VALUE_POSITION, DYN_VALUE_NORMAL, DYN_VALUE_TANGENT};
  put_values(s, order, [&](std::uint32_t bit, double* to) {
    switch (bit) {
      case DYN_VALUE_FOUND: *to = net.count; return;
      case DYN_VALUE_FORCE: return store3(net.force, to);
      case DYN_VALUE_MOMENT: return store3(net.moment, to);
      case DYN_VALUE_DISTANCE: return;
      case DYN_VALUE_POSITION: return store3(net.point, to);
      case DYN_VALUE_NORMAL: to[0] = 1; return;
      default: to[1] = 1;
    }
  }, out);
}

// Contacts in the order of the reduction: each pass takes the next one, so that no list of them is needed.
inline void contact_values(const Model& m, const Data<double>& d, const dynSensor& s, double* out) {
  std::fill_n(out, s.size, 0.0);
  if (s.reduction == DYN_REDUCTION_NETFORCE) return put_net_contact(m, d, s, out);
  const auto criterion = [&](const dynContactForce& f) {
    const Vector force = load3(f.force_on_b), moment = load3(f.moment_on_b);
    return s.reduction == DYN_REDUCTION_MINDIST ? f.contact.distance
           : s.reduction == DYN_REDUCTION_MAXFORCE ? -dot(force, force) - dot(moment, moment) : 0;
  };
  int count = 0, written = 0;
  for_each_match(m, d, s, [&](const dynContactForce& f, bool flipped) {
    if (s.reduction == DYN_REDUCTION_NONE && count < s.count) put_contact(s, {&f, flipped, 0}, 0, out + count * s.of_values);
    ++count;
  });
  if (s.reduction == DYN_REDUCTION_NONE) {
    written = std::min<Index>(count, s.count);
  } else {
    double last = -HUGE_VAL;
    int after = -1;  // of those with the same criterion, by their place
    for (; written < std::min<Index>(count, s.count); ++written) {
      SeenContact next{nullptr, false, HUGE_VAL};
      int place = 0, at = 0;
      for_each_match(m, d, s, [&](const dynContactForce& f, bool flipped) {
        const double x = criterion(f);
        if ((x > last || (x == last && place > after)) && x < next.criterion) next = {&f, flipped, x}, at = place;
        ++place;
      });
      put_contact(s, next, 0, out + written * s.of_values), last = next.criterion, after = at;
    }
  }
  for (int k = 0; (values_of(s) & DYN_VALUE_FOUND) && k < written; ++k) out[k * s.of_values] = count;
}

}  // namespace dyn::sensors
