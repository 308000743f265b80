// Values of a model's sensors (dynQuantity), at the kinematics in data.
#pragma once

#include "algorithm/actuators.hpp"
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

// [force; moment about x] that the parent exerts on a link: what the motion of all that it carries takes, less contacts.
inline Force<double> transmitted(const Model& m, const Data<double>& d, Index link, const Vector& x) {
  Force<double> sum{Vector::zero(), Vector::zero()};
  for_each_carried(m, d, link, [&](const LinkRecord& l, const SE3<double>& X, Index body) {
    const Vector f = acceleration(d, body, X.p) * l.mass, w = d.omega[body];
    sum.linear += f;
    sum.angular += cross(X.p - x, f) + angular_momentum(l, X, d.alpha[body]) + cross(w, angular_momentum(l, X, w));
  });
  if (!d.step) return sum;
  simulation::for_each_contact(*d.step, [&](const dynContactForce& f) {
    const auto on = [&](std::int32_t shape) { return shape >= 0 && hangs_on(m, m.shapes()[shape].frame, link); };
    const double sign = int(on(f.contact.shape_b)) - int(on(f.contact.shape_a));
    const Vector on_b = load3(f.force_on_b);
    sum.linear = sum.linear - on_b * sign;
    sum.angular = sum.angular - (load3(f.moment_on_b) + cross(load3(f.contact.position) - x, on_b)) * sign;
  });
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

inline double touch(const Model& m, const Data<double>& d, const dynSensor& s, const Placed& at) {
  if (!d.step) return 0;
  const Index link = link_of(m, s.object);
  double sum = 0;
  simulation::for_each_contact(*d.step, [&](const dynContactForce& f) {
    const auto on = [&](std::int32_t shape) { return shape >= 0 && m.shapes()[shape].frame == link; };
    if (!on(f.contact.shape_a) && !on(f.contact.shape_b)) return;
    const Vector n = load3(f.contact.normal) * (on(f.contact.shape_b) ? -1 : 1);  // out of the link
    const double force = std::abs(dot(load3(f.force_on_b), n));
    if (force > 0 && meets(s, transpose_times(at.X.R, load3(f.contact.position) - at.X.p), transpose_times(at.X.R, n)))
      sum += force;
  });
  return sum;
}

// Gap to a limit that is passed, below 0, and its rate; else zeros.
inline Stroke<double> passed(double x, double rate, double low, double high) {
  if (x < low) return {x - low, rate};
  if (x > high) return {high - x, -rate};
  return {0, 0};
}

inline Stroke<double> joint_stroke(const Model& m, const Data<double>& d, Index joint) {
  const JointRecord& j = m.joints()[joint];
  const Index leader = j.leader >= 0 ? j.leader : joint;
  const JointRecord& own = m.joints()[leader];
  return {j.leader >= 0 ? j.ratio * d.q[own.idx_q] + j.offset : d.q[j.idx_q],
          j.leader >= 0 ? j.ratio * d.v[own.idx_v] : d.v[j.idx_v]};
}

// Force of all actuators on a degree of freedom or a tendon.
inline double actuators_on(const Model& m, const Data<double>& d, Index dof, Index tendon) {
  double sum = 0;
  for_each_actuator(m, d, [&](const ActuatorRecord& r, Index) {
    const double f = r.spec.gear * actuator_force(r, d);
    if (tendon >= 0) sum += r.path == tendon ? actuator_force(r, d) : 0;
    else if (r.v >= 0) sum += r.v == dof ? f : 0;
    else
      for (Index k = m.paths()[r.path].first_dof, end = k + m.paths()[r.path].dofs; k < end; ++k)
        if (m.path_dofs()[k] == dof) sum += f * d.path_moment[k];
  });
  return sum;
}

inline void frame_values(const Model& m, Data<double>& d, const dynSensor& s, double* out) {
  const Placed at = placed(m, d, s.object, load_se3(s.placement));
  const bool refers = s.reference >= 0;
  const Placed ref = refers ? placed(m, d, s.reference, load_se3(s.reference_placement)) : Placed{SE3<double>::identity(), 0};
  const auto in_ref = [&](const Vector& x) { return refers ? transpose_times(ref.X.R, x) : x; };
  const auto local = [&](const Vector& x) { return transpose_times(at.X.R, x); };
  const auto put = [&](const Vector& x) { store3(x, out); };
  switch (s.quantity) {
    case DYN_QUANTITY_FRAMEPOS: return put(refers ? in_ref(at.X.p - ref.X.p) : at.X.p);
    case DYN_QUANTITY_FRAMEQUAT: return store(quaternion(refers ? transpose(ref.X.R) * at.X.R : at.X.R), out);
    case DYN_QUANTITY_FRAMEXAXIS: return put(in_ref(at.X.R * Vector::make(1, 0, 0)));
    case DYN_QUANTITY_FRAMEYAXIS: return put(in_ref(at.X.R * Vector::make(0, 1, 0)));
    case DYN_QUANTITY_FRAMEZAXIS: return put(in_ref(at.X.R * Vector::make(0, 0, 1)));
    case DYN_QUANTITY_FRAMELINVEL:
      return put(in_ref(velocity(d, at.body, at.X.p) - (refers ? velocity(d, ref.body, at.X.p) : Vector::zero())));
    case DYN_QUANTITY_FRAMEANGVEL: return put(in_ref(d.omega[at.body] - (refers ? d.omega[ref.body] : Vector::zero())));
    case DYN_QUANTITY_FRAMELINACC: return put(acceleration(d, at.body, at.X.p));
    case DYN_QUANTITY_FRAMEANGACC: return put(d.alpha[at.body]);
    case DYN_QUANTITY_ACCELEROMETER: return put(local(acceleration(d, at.body, at.X.p)));
    case DYN_QUANTITY_VELOCIMETER: return put(local(velocity(d, at.body, at.X.p)));
    case DYN_QUANTITY_GYRO: return put(local(d.omega[at.body]));
    case DYN_QUANTITY_MAGNETOMETER: return put(local(load3(s.field)));
    case DYN_QUANTITY_FORCE: return put(local(transmitted(m, d, link_of(m, s.object), at.X.p).linear));
    case DYN_QUANTITY_TORQUE: return put(local(transmitted(m, d, link_of(m, s.object), at.X.p).angular));
    case DYN_QUANTITY_TOUCH: *out = touch(m, d, s, at); return;
    case DYN_QUANTITY_SUBTREECOM: return put(carried(m, d, s.object, false).com);
    case DYN_QUANTITY_SUBTREELINVEL: {
      const Carried sum = carried(m, d, s.object, true);
      return put(sum.mass > 0 ? sum.momentum * (1 / sum.mass) : Vector::zero());
    }
    case DYN_QUANTITY_SUBTREEANGMOM: return put(carried(m, d, s.object, true).angular);
    case DYN_QUANTITY_INSIDESITE: *out = meets(s, in_ref(at.X.p - ref.X.p), Vector::zero()); return;
    default: return;
  }
}

inline void joint_values(const Model& m, Data<double>& d, const dynSensor& s, double* out) {
  const JointRecord& j = m.joints()[s.object];
  if (s.quantity == DYN_QUANTITY_BALLQUAT) {
    const double* q = d.q + j.idx_q;
    const double scale = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k) out[k] = q[k] * scale;
    return;
  }
  if (s.quantity == DYN_QUANTITY_BALLANGVEL) {
    std::copy_n(d.v + j.idx_v, 3, out);
    return;
  }
  const Stroke<double> x = joint_stroke(m, d, s.object);
  const bool own = j.leader < 0;
  const Stroke<double> gap = own ? passed(x.q, x.v, m.lower_limit()[j.idx_q], m.upper_limit()[j.idx_q]) : Stroke<double>{0, 0};
  switch (s.quantity) {
    case DYN_QUANTITY_JOINTPOS: *out = x.q; return;
    case DYN_QUANTITY_JOINTVEL: *out = x.v; return;
    case DYN_QUANTITY_JOINTACTUATORFRC: *out = own ? actuators_on(m, d, j.idx_v, -1) : 0; return;
    case DYN_QUANTITY_JOINTLIMITPOS: *out = gap.q; return;
    case DYN_QUANTITY_JOINTLIMITVEL: *out = gap.v; return;
    default: return;
  }
}

inline void path_values(const Model& m, Data<double>& d, const dynSensor& s, double* out) {
  if (sensor_row(s.quantity).object == SensorObject::Actuator) {
    const ActuatorRecord& r = m.actuators()[s.object];
    if (s.quantity == DYN_QUANTITY_ACTUATORFRC) {
      *out = 0;
      for_each_actuator(m, d, [&](const ActuatorRecord& x, Index k) {
        if (k == s.object) *out = actuator_force(x, d);
      });
      return;
    }
    const Stroke<double> x = stroke_of(r, d);
    *out = r.spec.gear * (s.quantity == DYN_QUANTITY_ACTUATORPOS ? x.q : x.v);
    return;
  }
  const dynTendon& t = m.tendons()[s.object].spec;
  const double length = d.path_length[s.object], rate = d.path_velocity[s.object];
  switch (s.quantity) {
    case DYN_QUANTITY_TENDONPOS: *out = length; return;
    case DYN_QUANTITY_TENDONVEL: *out = rate; return;
    case DYN_QUANTITY_TENDONACTUATORFRC: *out = actuators_on(m, d, -1, s.object); return;
    case DYN_QUANTITY_TENDONLIMITPOS: *out = passed(length, rate, t.range[0], t.range[1]).q; return;
    case DYN_QUANTITY_TENDONLIMITVEL: *out = passed(length, rate, t.range[0], t.range[1]).v; return;
    default: return;
  }
}

// Paths must have been measured, energies computed.
inline void read(const Model& m, Data<double>& d, const dynSensor& s, double* out) {
  switch (sensor_row(s.quantity).object) {
    case SensorObject::Joint: joint_values(m, d, s, out); break;
    case SensorObject::Tendon:
    case SensorObject::Actuator: path_values(m, d, s, out); break;
    case SensorObject::Frame: frame_values(m, d, s, out); break;
    case SensorObject::None:
      *out = s.quantity == DYN_QUANTITY_CLOCK ? *d.time : s.quantity == DYN_QUANTITY_E_KINETIC ? *d.kinetic : *d.potential;
      break;
  }
  for (int k = 0; s.cutoff > 0 && k < s.size; ++k) out[k] = std::min(std::max(out[k], -s.cutoff), s.cutoff);
}

}  // namespace dyn::sensors
