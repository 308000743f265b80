// What sensors read: frames, sums over what a link carries, and zones.
#pragma once

#include "algorithm/actuators.hpp"
#include "constraint/list.hpp"
#include "simulation/workspace.hpp"
#include "spatial/quaternion.hpp"
#include "table/sensors.hpp"

namespace dyn::sensors {

using Vector = Vec3<double>;

// A frame in the world, with the body that carries it.
struct Placed {
  SE3<double> X;
  Index body;
};

inline Placed placed(const Model& m, const Data<double>& d, Index frame, const SE3<double>& in_frame) {
  const FrameRecord& r = m.frames()[frame];
  const SE3<double> X = r.X * in_frame;
  return {{d.R[r.body] * X.R, d.p[r.body] + d.R[r.body] * X.p}, r.body};
}
inline Vector velocity(const Data<double>& d, Index body, const Vector& x) {
  return d.vel[body] + cross(d.omega[body], x - d.p[body]);
}
// Minus gravity.
inline Vector acceleration(const Data<double>& d, Index body, const Vector& x) {
  const Vector r = x - d.p[body];
  return d.acc[body] + cross(d.alpha[body], r) + cross(d.omega[body], cross(d.omega[body], r)) - load3(d.world_gravity);
}

// The link that a frame belongs to; 0: the world.
inline Index link_of(const Model& m, Index frame) {
  while (frame != 0 && m.frames()[frame].link < 0) frame = m.frames()[frame].parent;
  return frame;
}
inline bool hangs_on(const Model& m, Index frame, Index link) {
  while (frame != 0 && frame != link) frame = m.frames()[frame].parent;
  return frame == link;
}
// Calls f(link, placement of its centre of mass, body) for a link and all that it carries.
template <class F>
void for_each_carried(const Model& m, const Data<double>& d, Index link, F&& f) {
  for (Index k = 0; k < m.n.frames; ++k) {
    if (m.frames()[k].link < 0 || !hangs_on(m, k, link)) continue;
    const LinkRecord& l = m.links()[m.frames()[k].link];
    const Placed at = placed(m, d, k, {Mat3<double>::identity(), load3(l.com)});
    if (l.mass != 0) f(l, at.X, at.body);
  }
}
inline Vector angular_momentum(const LinkRecord& l, const SE3<double>& X, const Vector& w) {
  return X.R * (load33(l.inertia) * transpose_times(X.R, w));
}

// Sums over what a link carries.
struct Carried {
  double mass = 0;
  Vector com = Vector::zero(), momentum = Vector::zero(), angular = Vector::zero();  // about com
};
inline Carried carried(const Model& m, const Data<double>& d, Index link, bool moves) {
  Carried sum;
  for_each_carried(m, d, link, [&](const LinkRecord& l, const SE3<double>& X, Index body) {
    sum.mass += l.mass, sum.com += X.p * l.mass;
    if (moves) sum.momentum += velocity(d, body, X.p) * l.mass;
  });
  if (sum.mass > 0) sum.com = sum.com * (1 / sum.mass);
  if (!moves) return sum;
  for_each_carried(m, d, link, [&](const LinkRecord& l, const SE3<double>& X, Index body) {
    sum.angular += cross(X.p - sum.com, velocity(d, body, X.p) * l.mass) + angular_momentum(l, X, d.omega[body]);
  });
  return sum;
}

// Whether a link carries the first link of a joint.
inline bool carries_joint(const Model& m, Index link, Index joint) {
  for (Index f = 1; f < m.n.frames; ++f)
    if (m.frames()[f].joint == joint && m.frames()[f].link >= 0) return hangs_on(m, f, link);
  return false;
}

// [force; moment about x] that the parent exerts on a link: what the motion of all that it carries takes, less contacts and
// constraints between frames.
inline Force<double> transmitted(const Model& m, const Data<double>& d, Index link, const Vector& x) {
  Force<double> sum{Vector::zero(), Vector::zero()};
  for_each_carried(m, d, link, [&](const LinkRecord& l, const SE3<double>& X, Index body) {
    const Vector f = acceleration(d, body, X.p) * l.mass, w = d.omega[body];
    sum.linear += f;
    sum.angular += cross(X.p - x, f) + angular_momentum(l, X, d.alpha[body]) + cross(w, angular_momentum(l, X, w));
  });
  if (!d.step) return sum;
  for (Index j = 1; (d.pushed & acting_wrenches) && j < m.n.joints; ++j) {
    const Index body = m.joints()[j].last_body;
    if (!carries_joint(m, link, j)) continue;
    const Force<double> f = d.wrenches[j].at(d.R[body], d.p[body]);
    sum.linear = sum.linear - f.linear;
    sum.angular = sum.angular - f.angular - cross(d.p[body] - x, f.linear);
  }
  simulation::for_each_contact(*d.step, [&](const dynContactForce& f) {
    const auto on = [&](std::int32_t shape) { return shape >= 0 && hangs_on(m, m.shapes()[shape].frame, link); };
    const double sign = int(on(f.contact.shape_b)) - int(on(f.contact.shape_a));
    const Vector on_b = load3(f.force_on_b);
    sum.linear = sum.linear - on_b * sign;
    sum.angular = sum.angular - (load3(f.moment_on_b) + cross(load3(f.contact.position) - x, on_b)) * sign;
  });
  for (Index k = 0; d.step->frame_forces && k < m.n.slots; ++k) {
    if (d.slots[k].rows == 0 || between_joints(d.slots[k].c.type)) continue;
    const dynConstraint& c = d.constraint_specs[k];
    const double* const forces = d.step->frame_forces + 12 * k;
    for (const auto& [frame, f] : {std::pair{c.first, forces}, {c.second, forces + 6}}) {
      if (!hangs_on(m, frame, link)) continue;
      const Vector force = load3(f);
      sum.linear = sum.linear - force;
      sum.angular = sum.angular - (load3(f + 3) - cross(x, force));
    }
  }
  return sum;
}

// Whether a half line from x along u, in the zone's axes, meets the zone; u zero: whether x is inside.
inline bool meets(const dynSensor& s, const Vector& x, const Vector& u) {
  const double r = s.extent[0], half = s.extent[1] / 2;
  // t >= 0 with (x + t u)' S (x + t u) <= 1, S diagonal: the closest point of the quadric's axis ratio
  const auto quadric = [](const Vector& a, const Vector& b, double size) {
    const double aa = dot(a, a) - size * size, ab = dot(a, b), bb = dot(b, b);
    return aa <= 0 || (bb > 0 && ab < 0 && ab * ab >= aa * bb);
  };
  switch (s.shape) {
    case DYN_SHAPE_TYPE_SPHERE: return quadric(x, u, r);
    case DYN_SHAPE_TYPE_ELLIPSOID: {
      const auto scaled = [&](const Vector& a) {
        return Vector::make(a[0] / s.extent[0], a[1] / s.extent[1], a[2] / s.extent[2]);
      };
      return quadric(scaled(x), scaled(u), 1);
    }
    case DYN_SHAPE_TYPE_BOX: {
      double low = 0, high = HUGE_VAL;
      for (int k = 0; k < 3; ++k) {
        const double h = s.extent[k] / 2;
        if (u[k] == 0) {
          if (std::abs(x[k]) > h) return false;
          continue;
        }
        const double a = (-h - x[k]) / u[k], b = (h - x[k]) / u[k];
        low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
      }
      return low <= high;
    }
    default: break;
  }
  // cylinder: the part of the line between the discs, then the round side; the caps of a capsule are spheres
  const Vector along = Vector::make(0, 0, half);
  if (s.shape == DYN_SHAPE_TYPE_CAPSULE && (quadric(x - along, u, r) || quadric(x + along, u, r))) return true;
  double low = 0, high = HUGE_VAL;
  if (u[2] == 0) {
    if (std::abs(x[2]) > half) return false;
  } else {
    const double a = (-half - x[2]) / u[2], b = (half - x[2]) / u[2];
    low = std::max(low, std::min(a, b)), high = std::max(a, b);
  }
  const double bb = u[0] * u[0] + u[1] * u[1], ab = x[0] * u[0] + x[1] * u[1];
  const double t = bb > 0 ? std::min(std::max(-ab / bb, low), high) : low;
  const Vector y = Vector::make(x[0] + t * u[0], x[1] + t * u[1], 0);
  return low <= high && dot(y, y) <= r * r;
}

}  // namespace dyn::sensors
