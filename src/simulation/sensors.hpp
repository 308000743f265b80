// Values of a model's sensors (dynQuantity), at the kinematics in data.
#pragma once

#include "algorithm/actuators.hpp"
#include "simulation/sensor_contacts.hpp"

namespace dyn::sensors {

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
  for (Index k = 0; tendon < 0 && k < m.n.force_limits; ++k) {
    const ForceLimitRecord& limit = m.force_limits()[k];
    if (limit.dof == dof) sum += d.force_sums[2 * k] + (limit.with_weight ? held_weight(m, d, dof) : 0);
  }
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
    case DYN_QUANTITY_RANGEFINDER: return ray_values(m, d, s, at, out);
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
    case DYN_QUANTITY_JOINTLIMITFRC:
      *out = 0;
      for (Index k = 0; own && k < m.n.limits; ++k)
        if (m.limits()[k].q == j.idx_q) *out = std::abs(d.step->limit_forces[k]);
      return;
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
    case DYN_QUANTITY_TENDONLIMITFRC:
      *out = std::abs(d.step->limit_forces[m.n.limits + path_rows_of_tendon * s.object]);
      return;
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
    case SensorObject::Sides:
      if (s.quantity == DYN_QUANTITY_CONTACT) contact_values(m, d, s, out);
      else distance_values(m, d, s, out);
      break;
    case SensorObject::None:
      if (s.quantity == DYN_QUANTITY_USER) return void(std::fill_n(out, s.size, 0.0));
      *out = s.quantity == DYN_QUANTITY_CLOCK ? *d.time : s.quantity == DYN_QUANTITY_E_KINETIC ? *d.kinetic : *d.potential;
      break;
  }
  const bool limits = sensor_row(s.quantity).object == SensorObject::Sides;  // their cutoff is of the search
  for (int k = 0; s.cutoff > 0 && !limits && k < s.size; ++k) out[k] = std::min(std::max(out[k], -s.cutoff), s.cutoff);
}

}  // namespace dyn::sensors
