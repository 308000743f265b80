// Model to MJCF: actuators and equalities.
#include <algorithm>
#include <cmath>

#include "constraint/list.hpp"
#include "polynomial.hpp"
#include "save_mjcf.hpp"

namespace dyn::load {

void put_range(XmlElement& e, const char* attribute, const double (&range)[2]) {
  if (std::isfinite(range[0]) || std::isfinite(range[1]))
    put(e, attribute, {std::max(range[0], -no_limit_written), std::min(range[1], no_limit_written)});
}

const MjcfWriter::Piece& MjcfWriter::piece(Index joint, int dof) const {
  const Piece* found = nullptr;
  for (const Piece& p : pieces)
    if (p.joint == joint && p.simple.v <= dof) found = &p;
  return *found;
}

bool MjcfWriter::pushes_free_joint(const dynActuator& a) const {
  if (a.transmission != DYN_TRANSMISSION_JOINT || a.gear == 0) return false;
  const SimpleJoint& s = piece(a.joint, a.component).simple;
  return s.type == DYN_JOINT_TYPE_FREE_FLYER && a.component - s.v < 3;
}

// What an actuator acts through, with its gear.
void MjcfWriter::put_transmission(XmlElement& e, const dynActuator& a) {
  if (a.transmission == DYN_TRANSMISSION_BODY)
    return put(e, "body", a.frame == 0 ? std::string("world") : body_names[a.frame]);
  if (a.transmission == DYN_TRANSMISSION_SLIDER_CRANK) {
    put(e, "cranksite", site(a.frame)), put(e, "slidersite", site(a.reference)), put(e, "cranklength", a.rod);
    if (a.gear != 1) put(e, "gear", a.gear);
    return;
  }
  if (a.transmission == DYN_TRANSMISSION_AXES) {
    put(e, a.in_parent ? "jointinparent" : "joint", piece(a.joint, 0).simple.name);
    return put(e, "gear", std::span(a.wrench));
  }
  if (a.transmission == DYN_TRANSMISSION_SITE) {
    put(e, "site", site(a.frame)), put(e, "gear", std::span(a.wrench));
    if (a.reference >= 0) put(e, "refsite", site(a.reference));
    return;
  }
  if (a.transmission == DYN_TRANSMISSION_TENDON) {
    put(e, "tendon", std::string(m.string(m.tendons()[a.tendon].name)));
    if (a.gear != 1) put(e, "gear", a.gear);
    return;
  }
  const SimpleJoint& s = piece(a.joint, a.component).simple;
  put(e, "joint", s.name);
  if (s.type == DYN_JOINT_TYPE_SPHERICAL || s.type == DYN_JOINT_TYPE_FREE_FLYER) {
    std::vector<double> gear(s.type == DYN_JOINT_TYPE_SPHERICAL ? 3 : 6, 0);
    gear[size_t(a.component - s.v)] = a.gear;
    put(e, "gear", gear);
    if (a.gear == 0) losses.note("actuators without a force keep their controls", e.Attribute("name"));
  } else if (a.gear != 1) {
    put(e, "gear", a.gear);
  }
}

void MjcfWriter::put_muscle(XmlElement& e, const dynActuator& a) {
  const dynMuscle& x = a.muscle;
  const double scale = 1;  // of a force that the file leaves open
  for (const char* parameters : {"gainprm", "biasprm"})
    put(e, parameters, {x.range[0], x.range[1], x.force, scale, x.lmin, x.lmax, x.vmax, x.fpmax, x.fvmax});
  put(e, "dynprm", {x.t_act, x.t_deact, x.smoothing}), put(e, "lengthrange", std::span(x.length_range));
  for (const char* part : {"gaintype", "biastype", "dyntype"}) put(e, part, std::string("muscle"));
}

const ForceLimitRecord* MjcfWriter::force_limit(Index joint, Index tendon) const {
  const ForceLimitRecord *const all = m.force_limits(), *const end = all + m.n.force_limits;
  const auto at = std::find_if(all, end, [&](const ForceLimitRecord& x) { return x.joint == joint && x.tendon == tendon; });
  return at == end ? nullptr : at;
}

void MjcfWriter::put_compliance(XmlElement& e, const Compliance& law, const char* reference, const char* impedance) {
  const Compliance usual;
  if (!std::equal(law.reference, law.reference + 2, usual.reference)) put(e, reference, std::span(law.reference));
  if (!std::equal(law.impedance, law.impedance + 5, usual.impedance)) put(e, impedance, std::span(law.impedance));
}

// PID or DC motor.
void MjcfWriter::put_driver(XmlElement& e, const dynActuator& a) {
  const dynDcMotor& x = a.motor;
  std::string inputs;
  for (const auto& [bit, word] : {std::pair{DYN_INPUT_POSITION, "pos"}, {DYN_INPUT_VELOCITY, "vel"}, {DYN_INPUT_FORCE, "ff"},
                                  {DYN_INPUT_VOLTAGE, "voltage"}})
    if (a.inputs & std::uint32_t(bit)) inputs += (inputs.empty() ? "" : " ") + std::string(word);
  put(e, "input", inputs.empty() ? std::string("none") : inputs);
  put_range(e, "velrange", a.velocity_range), put_range(e, "ffrange", a.feedforward_range);
  if (a.type == DYN_ACTUATOR_TYPE_PID) {
    put_range(e, "posrange", a.control_range), put_range(e, "forcerange", a.force_range);
    put(e, "kp", a.kp), put(e, "kv", a.kv), put(e, "ki", a.ki);
    return put(e, "imax", a.integral_limit), put(e, "slewmax", a.slew);
  }
  put_range(e, "ctrlrange", a.control_range);
  put(e, "motorconst", x.constant), put(e, "resistance", x.resistance), put(e, "inductance", {0, x.time_constant});
  const bool limited = std::isfinite(a.force_range[1]) && a.force_range[0] == -a.force_range[1];
  if (!limited && (std::isfinite(a.force_range[0]) || std::isfinite(a.force_range[1])))
    losses.loss("ranges of force of motors that are not alike in both directions", e.Attribute("name"));
  put(e, "saturation", {limited ? a.force_range[1] : 0, 0, x.rate});
  put(e, "controller", {x.kp, a.ki, x.kd, a.slew, a.integral_limit, x.voltage_limit}), put(e, "cogging", std::span(x.cogging));
  if (x.thermal_resistance > 0)
    put(e, "thermal", {x.thermal_resistance, x.heat_capacity, 0, x.temperature_coefficient, x.reference, x.ambient});
  if (x.bristle_stiffness > 0)
    put(e, "lugre", {x.bristle_stiffness, x.bristle_damping, x.coulomb, x.breakaway, x.stribeck});
}

void MjcfWriter::add_actuators() {
  for (Index k = 0; k < m.n.actuators; ++k) {
    const dynActuator& a = m.actuators()[k].spec;
    const std::string name = m.string(m.actuators()[k].name);
    if (a.type == DYN_ACTUATOR_TYPE_PD) {
      losses.loss("actuators of type PD, which have three controls, are left out", name);
      continue;
    }
    if (pushes_free_joint(a)) {
      losses.loss("actuators that push a free joint along its own axes are left out", name);
      continue;
    }
    const bool filtered = a.time_constant > 0, muscle = a.type == DYN_ACTUATOR_TYPE_MUSCLE,
               early = a.activations > 0 && !a.late, sloped = a.gain_slope[0] != 0 || a.gain_slope[1] != 0,
               affine = a.type == DYN_ACTUATOR_TYPE_AFFINE ||
                        ((filtered || a.integrates) && (early || a.type != DYN_ACTUATOR_TYPE_POSITION));
    XmlElement& e = *section("actuator")
                         .InsertNewChildElement(a.type == DYN_ACTUATOR_TYPE_PID          ? "pid"
                                                : a.type == DYN_ACTUATOR_TYPE_DC_MOTOR ? "dcmotor"
                                                : affine || muscle                     ? "general"
                                                : a.type == DYN_ACTUATOR_TYPE_MOTOR    ? "motor"
                                                : a.type == DYN_ACTUATOR_TYPE_VELOCITY ? "velocity"
                                                : a.integrates                         ? "intvelocity"
                                                                                       : "position");
    put(e, "name", name), put_transmission(e, a);
    written_actuators.push_back(k);
    if (has_driver(a)) {
      put_driver(e, a);
      if (early && a.type == DYN_ACTUATOR_TYPE_PID && a.ki > 0)
        losses.note("integrals of <pid> are those of the beginning of a step", name);
      continue;
    }
    if (muscle) {
      put_muscle(e, a);
    } else if (affine) {
      const ActuatorRecord& law = m.actuators()[k];
      put(e, "gaintype", std::string(sloped ? "affine" : "fixed"));
      if (sloped) put(e, "gainprm", {law.gain[0], a.gain_slope[0], a.gain_slope[1]});
      else put(e, "gainprm", law.gain[0]);
      put(e, "biastype", std::string("affine")), put(e, "biasprm", std::span(law.bias));
      if (filtered) put(e, "dyntype", std::string("filterexact")), put(e, "dynprm", a.time_constant);
      if (a.integrates) put(e, "dyntype", std::string("integrator"));
    } else if (a.type == DYN_ACTUATOR_TYPE_POSITION) {
      put(e, "kp", a.kp), put(e, "kv", a.kv);
      if (filtered) put(e, "timeconst", a.time_constant);
    } else if (a.type == DYN_ACTUATOR_TYPE_VELOCITY) {
      put(e, "kv", a.kv);
    }
    if (early) put(e, "actearly", std::string("true"));
    put_range(e, "ctrlrange", a.control_range), put_range(e, "forcerange", a.force_range), put_range(e, "actrange", a.act_range);
  }
}

// Returns the name of a site at the placement: the frame itself or an added one.
std::string MjcfWriter::site(Index frame, const double (&placement)[12], const std::string& wanted) {
  const FrameRecord& r = m.frames()[frame];
  if (frame != 0 && r.type != DYN_FRAME_TYPE_BODY && r.type != DYN_FRAME_TYPE_JOINT && is_identity(placement))
    return frame_name(frame);
  const Attachment& attachment = attachments[size_t(r.joint)];
  const std::string name = joints.claim(wanted);
  XmlElement& e = *attachment.element->InsertNewChildElement("site");
  put(e, "name", name);
  put_pose(e, attachment.X.inverse() * load_se3(r.placement) * load_se3(placement));
  losses.note("sites were added for frames of bodies and joints, and for the ends of constraints", name);
  return name;
}

void MjcfWriter::add_constraints() {
  for (Index k = 0; k < m.n.constraints; ++k) {
    const dynConstraint& c = m.constraints()[k].spec;
    const std::string name = m.string(m.constraints()[k].name);
    const bool coupling = c.type == DYN_CONSTRAINT_TYPE_COUPLING;
    if (!coupling && c.type != DYN_CONSTRAINT_TYPE_CONNECT && c.type != DYN_CONSTRAINT_TYPE_WELD) {
      losses.loss("constraints that are no connect, weld or coupling are left out", name);
      continue;
    }
    if (c.stiffness != 0 || c.damping != 0 || c.restitution != 0) losses.loss("gains and restitution of constraints", name);
    XmlElement& e = *section("equality")
                         .InsertNewChildElement(coupling                             ? "joint"
                                                : c.type == DYN_CONSTRAINT_TYPE_WELD ? "weld"
                                                                                     : "connect");
    put(e, "name", name);
    if (!c.enabled) put(e, "active", std::string("false"));
    if (m.n.compliances > 0) {
      const Compliance& law = m.constraint_compliances()[k].law;
      put_compliance(e, law, "solref", "solimp");
      if (c.type == DYN_CONSTRAINT_TYPE_WELD && law.scale != 1) put(e, "torquescale", law.scale);
    }
    if (coupling) {
      const Piece& first = piece(c.first, 0);
      std::array<double, 5> polynomial = {c.coefficients[0]};  // of the coordinates from where they are drawn
      put(e, "joint1", first.simple.name);
      if (c.second != 0) {
        const Piece& second = piece(c.second, 0);
        shift_polynomial(c.coefficients, -reference(second.joint, second.simple), polynomial.data());
        put(e, "joint2", second.simple.name);
      }
      polynomial[0] -= reference(first.joint, first.simple);
      put(e, "polycoef", std::span(polynomial));
    } else {
      put(e, "site1", site(c.first, c.placement1, name + "_1")), put(e, "site2", site(c.second, c.placement2, name + "_2"));
    }
  }
}

}  // namespace dyn::load
