// Actuators, weights that are held, and the medium.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "builder_impl.hpp"
#include "table/enums.hpp"

namespace dyn {

namespace {

void check_number(const std::string& who, const char* what, double x, bool negative_too) {
  if (!std::isfinite(x)) refuse(DYN_ERROR_NONFINITE, who + ": " + what + " is " + number(x) + ": give a finite number");
  if (!negative_too && x < 0) refuse(DYN_ERROR_INVALID, who + ": " + what + " is " + number(x) + ": it can't be negative");
}

void check_ends(const std::string& who, const char* what, const double (&range)[2]) {
  if (!(range[0] <= range[1]) || range[0] == HUGE_VAL || range[1] == -HUGE_VAL)
    refuse(DYN_ERROR_INVALID,
           who + ": " + what + " is [" + number(range[0]) + ", " + number(range[1]) + "]: give a lower end, then an upper one");
}

// gain and bias of the type's formula
void set_law(const dynActuator& x, ActuatorRecord& r) {
  const auto set = [](double* to, double a, double b, double c) { to[0] = a, to[1] = b, to[2] = c; };
  set(r.gain, 1, 0, 0), set(r.bias, 0, 0, 0);
  switch (x.type) {
    case DYN_ACTUATOR_TYPE_MOTOR: break;
    case DYN_ACTUATOR_TYPE_POSITION: set(r.gain, x.kp, 0, 0), set(r.bias, 0, -x.kp, -x.kv); break;
    case DYN_ACTUATOR_TYPE_VELOCITY: set(r.gain, x.kv, 0, 0), set(r.bias, 0, 0, -x.kv); break;
    case DYN_ACTUATOR_TYPE_PD: set(r.gain, x.kp, x.kv, 1), set(r.bias, 0, -x.kp, -x.kv); break;
    case DYN_ACTUATOR_TYPE_AFFINE: set(r.gain, x.gain, 0, 0), set(r.bias, x.bias[0], x.bias[1], x.bias[2]); break;
    case DYN_ACTUATOR_TYPE_MUSCLE: break;    // effect/muscle.hpp
    case DYN_ACTUATOR_TYPE_PID:
    case DYN_ACTUATOR_TYPE_DC_MOTOR: break;  // algorithm/driver.hpp
  }
}

// Of a length that is an angle, where a servo or a PID acts on it.
double period_of(const dynActuator& a, const ActuatorRecord& r, bool ball) {
  const bool servo = r.bias[1] != 0 && r.gain[0] == -r.bias[1] && a.time_constant == 0 && !has_general_law(a);
  if (!servo && a.type != DYN_ACTUATOR_TYPE_PID) return 0;
  const double* const w = a.wrench;
  const auto turn = [](const double* x) { return 6.283185307179586 * std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]); };
  if (a.transmission == DYN_TRANSMISSION_AXES && ball) return turn(w);
  const bool turns = a.transmission == DYN_TRANSMISSION_SITE && r.spec.reference >= 0 && w[0] == 0 && w[1] == 0 && w[2] == 0;
  return turns ? turn(w + 3) : 0;
}

void check_driver(const std::string& who, const dynActuator& a) {
  const bool motor = a.type == DYN_ACTUATOR_TYPE_DC_MOTOR;
  const std::uint32_t most = motor ? 15 : 7;
  if (a.inputs & ~most)
    refuse(DYN_ERROR_ARGUMENT, who + ": inputs is " + std::to_string(a.inputs) + ": give a sum of DYN_INPUT_... up to " +
                                   std::to_string(most));
  if (a.time_constant > 0 || a.integrates)
    refuse(DYN_ERROR_INVALID, who + ": its type has states of its own: time_constant and integrates must be 0");
  for (const auto& [what, x] : {std::pair{"ki", a.ki}, {"integral_limit", a.integral_limit}, {"slew", a.slew}})
    check_number(who, what, x, false);
  check_ends(who, "velocity_range", a.velocity_range), check_ends(who, "feedforward_range", a.feedforward_range);
  if (!motor) return;
  const dynDcMotor& x = a.motor;
  const std::pair<const char*, double> sizes[] = {{"resistance", x.resistance}, {"constant", x.constant},
      {"thermal_resistance", x.thermal_resistance}, {"heat_capacity", x.heat_capacity}, {"time_constant", x.time_constant},
      {"rate", x.rate}, {"kp", x.kp}, {"kd", x.kd}, {"voltage_limit", x.voltage_limit},
      {"bristle_stiffness", x.bristle_stiffness}, {"bristle_damping", x.bristle_damping}, {"coulomb", x.coulomb},
      {"breakaway", x.breakaway}, {"stribeck", x.stribeck}};
  for (const auto& [what, value] : sizes) check_number(who, (std::string("motor.") + what).c_str(), value, false);
  for (const double y : {x.temperature_coefficient, x.reference, x.ambient, x.cogging[0], x.cogging[1], x.cogging[2]})
    check_number(who, "motor", y, true);
  if (x.resistance == 0 || x.constant == 0)
    refuse(DYN_ERROR_INVALID, who + ": motor.resistance and motor.constant must be positive");
  if (x.thermal_resistance > 0 && x.heat_capacity == 0)
    refuse(DYN_ERROR_INVALID, who + ": motor.heat_capacity is 0: it must be positive with a thermal_resistance");
}

void check_muscle(const std::string& who, const dynMuscle& x) {
  const std::pair<const char*, double> positive[] = {
      {"force", x.force}, {"vmax", x.vmax}, {"t_act", x.t_act}, {"t_deact", x.t_deact}};
  for (const auto& [what, value] : positive) {
    check_number(who, what, value, false);
    if (value == 0) refuse(DYN_ERROR_INVALID, who + ": " + what + " is 0: it must be positive");
  }
  for (const auto& [what, value] : {std::pair{"fpmax", x.fpmax}, {"fvmax", x.fvmax}, {"smoothing", x.smoothing}})
    check_number(who, what, value, false);
  check_ends(who, "range", x.range), check_ends(who, "length_range", x.length_range);
  if (!(x.range[0] < x.range[1] && x.length_range[0] < x.length_range[1]))
    refuse(DYN_ERROR_INVALID, who + ": range and length_range need two different ends");
  if (!(x.lmin < 1 && 1 < x.lmax && std::isfinite(x.lmin) && std::isfinite(x.lmax)))
    refuse(DYN_ERROR_INVALID, who + ": lmin and lmax are " + number(x.lmin) + " and " + number(x.lmax) +
        ": 1 must lie between them");
  if (!(x.fvmax >= 1)) refuse(DYN_ERROR_INVALID, who + ": fvmax is " + number(x.fvmax) + ": it is at least 1");
}

// The joint that an actuator drives by one degree of freedom.
void check_driven_joint(const std::vector<JointEntry>& joints, const std::string& who, const std::string& name, int number,
                        int component) {
  if (number < 0) refuse(DYN_ERROR_NAME, who + ": there is no moving joint '" + name + "'");
  const JointEntry* const at = &joints[std::size_t(number)];
  if (!at->spec.mimic.empty())
    refuse(DYN_ERROR_INVALID, who + ": joint '" + name + "' follows '" + at->spec.mimic + "': name that one");
  if (component < 0 || component >= spec_nv(at->spec))
    refuse(DYN_ERROR_ARGUMENT, who + ": component is " + std::to_string(component) + ", and joint '" + name + "' has " +
                                   std::to_string(spec_nv(at->spec)) + " degrees of freedom");
}

// The limit of the sum that an actuator is part of, or -1.
int limit_of(const std::vector<ForceLimitEntry>& limits, const ActuatorEntry& a) {
  const dynTransmission by = a.spec.transmission;
  for (std::size_t k = 0; k < limits.size(); ++k)
    if (limits[k].target == a.target && by == (limits[k].tendon ? DYN_TRANSMISSION_TENDON : DYN_TRANSMISSION_JOINT))
      return int(k);
  return -1;
}

}  // namespace

void Builder::Impl::check_actuator_name(const std::string& name) const {
  if (name.empty()) refuse(DYN_ERROR_ARGUMENT, "actuator has no name: give one");
  if (name.find('\0') != std::string::npos)
    refuse(DYN_ERROR_ARGUMENT, "actuator '" + std::string(name.c_str()) + "': the name holds a zero byte");
  if (names.actuators.find(actuators, name) >= 0)
    refuse(DYN_ERROR_NAME, "actuator '" + name + "' is there already: choose another name");
}

void Builder::actuator(const std::string& name, const dynActuator& spec, const std::string& target,
                       const std::string& reference) {
  impl->check_actuator_name(name);
  const std::string who = "actuator '" + name + "'";
  if (!is_value(spec.type))
    refuse(DYN_ERROR_ARGUMENT, who + ": type " + std::to_string(int(spec.type)) + " is no dynActuatorType");
  if (!is_value(spec.transmission))
    refuse(DYN_ERROR_ARGUMENT, who + ": transmission " + std::to_string(int(spec.transmission)) + " is no dynTransmission");
  ActuatorEntry entry{name, spec, -1};
  const bool crank = spec.transmission == DYN_TRANSMISSION_SLIDER_CRANK;
  if (!reference.empty() && spec.transmission != DYN_TRANSMISSION_SITE && !crank)
    refuse(DYN_ERROR_ARGUMENT, who + ": a reference frame needs the transmission SITE or SLIDER_CRANK");
  if (reference.empty() && crank) refuse(DYN_ERROR_ARGUMENT, who + ": its reference is missing: the frame of the slider");
  const bool measured = spec.transmission != DYN_TRANSMISSION_BODY;
  if (spec.transmission == DYN_TRANSMISSION_AXES) {
    entry.target = impl->find_joint(target);
    if (entry.target < 0) refuse(DYN_ERROR_NAME, who + ": there is no moving joint '" + target + "'");
    const JointSpec& j = impl->joints[std::size_t(entry.target)].spec;
    if (j.type != DYN_JOINT_TYPE_SPHERICAL && j.type != DYN_JOINT_TYPE_FREE_FLYER)
      refuse(DYN_ERROR_INVALID, who + ": joint '" + target + "' is no ball and no free joint, as AXES needs");
  } else if (spec.transmission == DYN_TRANSMISSION_BODY) {
    entry.target = impl->find({target, DYN_FRAME_TYPE_BODY}, who);
  } else if (spec.transmission == DYN_TRANSMISSION_JOINT) {
    entry.target = impl->find_joint(target);
    check_driven_joint(impl->joints, who, target, entry.target, spec.component);
    if (has_general_law(spec) && joint_nq(impl->joints[std::size_t(entry.target)].spec.type) != 1)
      refuse(DYN_ERROR_INVALID, who + ": its law needs a length, and joint '" + target + "' has none");
  } else if (spec.transmission == DYN_TRANSMISSION_TENDON) {
    entry.target = impl->find_tendon(target, who);
  } else {
    entry.target = impl->find_frame(target, who);
    entry.reference = reference.empty() ? -1 : impl->find_frame(reference, who);
  }
  if (spec.transmission == DYN_TRANSMISSION_SITE || spec.transmission == DYN_TRANSMISSION_AXES) {
    for (const double w : spec.wrench) check_number(who, "wrench", w, true);
    if (spec.gear != 1)
      refuse(DYN_ERROR_INVALID, who + ": gear is " + number(spec.gear) + ": with SITE and AXES, wrench says it all");
  }
  if (crank && !(spec.rod > 0 && std::isfinite(spec.rod)))
    refuse(DYN_ERROR_INVALID, who + ": rod is " + number(spec.rod) + ": give a positive length");
  if (!measured && (spec.type != DYN_ACTUATOR_TYPE_MOTOR && spec.type != DYN_ACTUATOR_TYPE_AFFINE))
    refuse(DYN_ERROR_INVALID, who + ": adhesion has no length: use MOTOR or AFFINE");
  for (const double x : spec.gain_slope) check_number(who, "gain_slope", x, true);
  if (spec.type != DYN_ACTUATOR_TYPE_AFFINE && (spec.gain_slope[0] != 0 || spec.gain_slope[1] != 0))
    refuse(DYN_ERROR_INVALID, who + ": gain_slope needs the type AFFINE");
  if (has_driver(spec)) check_driver(who, spec);
  if (spec.type == DYN_ACTUATOR_TYPE_MUSCLE) check_muscle(who, spec.muscle);
  check_number(who, "gear", spec.gear, true);
  check_number(who, "kp", spec.kp, false), check_number(who, "kv", spec.kv, false);
  check_number(who, "gain", spec.gain, true);
  for (const double b : spec.bias) check_number(who, "bias", b, true);
  check_number(who, "time_constant", spec.time_constant, false);
  check_ends(who, "control_range", spec.control_range), check_ends(who, "force_range", spec.force_range),
      check_ends(who, "act_range", spec.act_range);
  if (spec.integrates && spec.time_constant > 0)
    refuse(DYN_ERROR_INVALID,
           who + ": it integrates its control, and has a time constant, " + number(spec.time_constant) + ": give one of them");
  if (spec.type == DYN_ACTUATOR_TYPE_MUSCLE && (spec.integrates || spec.time_constant > 0))
    refuse(DYN_ERROR_INVALID, who + ": the activation of a muscle has its own time constants, t_act and t_deact");
  impl->actuators.push_back(std::move(entry));
}

void Builder::limit_actuators(bool tendon, const std::string& target, double lower, double upper, bool with_weight) {
  const std::string who = "limit of the actuators on " + std::string(tendon ? "tendon" : "joint") + " '" + target + "'";
  ForceLimitEntry entry{tendon, with_weight, tendon ? impl->find_tendon(target, who) : impl->find_joint(target), {lower, upper}};
  if (entry.target < 0) refuse(DYN_ERROR_NAME, who + ": there is no such moving joint");
  if (!tendon) {
    const JointSpec& j = impl->joints[std::size_t(entry.target)].spec;
    if (!j.mimic.empty()) refuse(DYN_ERROR_INVALID, who + ": it follows '" + j.mimic + "': name that one");
    if (spec_nq(j) != 1) refuse(DYN_ERROR_INVALID, who + ": it has not one coordinate, as is needed");
  }
  check_ends(who, "the range", entry.range);
  for (const ForceLimitEntry& x : impl->force_limits)
    if (x.tendon == tendon && x.target == entry.target) refuse(DYN_ERROR_INVALID, who + ": it has one already");
  impl->force_limits.push_back(entry);
}

void Builder::gravity_compensation(const std::string& body, double share) {
  const std::string who = "gravity compensation of body '" + body + "'";
  check_number(who, "share", share, true);
  impl->frames[std::size_t(impl->find({body, DYN_FRAME_TYPE_BODY}, who))].compensation = share;
}

void Builder::mocap(const std::string& body) {
  const std::string who = "mocap body '" + body + "'";
  FrameEntry& f = impl->frames[std::size_t(impl->find({body, DYN_FRAME_TYPE_BODY}, who))];
  if (f.joint >= 0)
    refuse(DYN_ERROR_INVALID, who + ": joint '" + impl->joints[std::size_t(f.joint)].spec.name +
                                  "' moves it: only a link that is fixed to the world can be a mocap body");
  for (int k = f.parent; k > 0; k = impl->frames[std::size_t(k)].parent)
    if (impl->frames[std::size_t(k)].mocap)
      refuse(DYN_ERROR_INVALID, who + ": it hangs on mocap body '" + impl->frames[std::size_t(k)].name + "', which moves it");
  f.mocap = true;
}

void Builder::medium(double density, double viscosity, const std::array<double, 3>& wind) {
  check_number("medium", "density", density, false), check_number("medium", "viscosity", viscosity, false);
  for (const double w : wind) check_number("medium", "wind", w, true);
  impl->density = density, impl->viscosity = viscosity, impl->wind = wind;
}

int Builder::Impl::find_shape(const std::string& name, const std::string& who) const {
  for (std::size_t& k = names.known_shapes; k < shapes.size(); ++k)
    if (const Shape& s = shapes[k].shape; s.role == DYN_SHAPE_ROLE_COLLISION) names.shapes[s.name].push_back(int(k));
  const auto at = names.shapes.find(name);
  if (at != names.shapes.end() && at->second.size() > 1)
    refuse(DYN_ERROR_NAME, who + ": there are several shapes '" + name + "'");
  return at == names.shapes.end() ? -1 : at->second[0];
}

void Builder::pair(const std::string& shape1, const std::string& shape2, const dynMaterial* material,
                   const Compliance& compliance) {
  const std::string who = "pair of '" + shape1 + "' and '" + shape2 + "'";
  const auto find = [&](const std::string& name) {
    const int found = impl->find_shape(name, who);
    if (name.empty() || found < 0) refuse(DYN_ERROR_NAME, who + ": there is no collision shape '" + name + "': add it first");
    return found;
  };
  const int a = find(shape1), b = find(shape2);
  if (a == b) refuse(DYN_ERROR_INVALID, who + ": that is one shape");
  if (impl->frames[std::size_t(impl->shapes[std::size_t(a)].frame)].joint ==
      impl->frames[std::size_t(impl->shapes[std::size_t(b)].frame)].joint)
    refuse(DYN_ERROR_INVALID, who + ": both are on the same body");
  if (material)
    if (const shape::BadNumber bad = shape::bad_number(*material); bad.name)
      refuse(std::isfinite(bad.value) ? DYN_ERROR_ARGUMENT : DYN_ERROR_NONFINITE,
             who + ": " + bad.name + " is " + number(bad.value));
  impl->pairs.push_back({a, b, material ? std::optional(*material) : std::nullopt, compliance});
}

std::vector<ActuatorRecord> actuators_of(const std::vector<ActuatorEntry>& actuators,
                                         const std::vector<ForceLimitEntry>& limits, const std::vector<Index>& id,
                                         const std::vector<JointRecord>& joints,
                                         const std::vector<EuclideanSpan>& euclidean_spans, ModelSizes& n) {
  std::vector<ActuatorRecord> out;
  n.paths = n.tendons + n.couplings, n.path_rows = path_rows_of_tendon * n.tendons + n.couplings;
  Index rows = 0;
  for (const ActuatorEntry& a : actuators) {
    ActuatorRecord r{};
    r.spec = a.spec;
    const dynTransmission by = a.spec.transmission;
    const bool on_joint = by == DYN_TRANSMISSION_JOINT, joint = on_joint || by == DYN_TRANSMISSION_AXES;
    r.spec.struct_size = sizeof r.spec, r.spec.joint = joint ? id[std::size_t(a.target)] : 0;
    r.spec.tendon = by == DYN_TRANSMISSION_TENDON ? a.target : -1;
    r.spec.frame = joint || by == DYN_TRANSMISSION_TENDON ? -1 : a.target, r.spec.reference = a.reference;
    r.limit = Index(limit_of(limits, a));
    const bool has_path = !on_joint || has_general_law(a.spec) || r.limit >= 0;
    r.path = by == DYN_TRANSMISSION_TENDON ? a.target : has_path ? n.paths++ : -1;
    r.row = r.path >= 0 ? rows++ : -1;
    r.spec.controls = controls_of(a.spec), r.spec.idx_u = n.nu;
    r.spec.in_parent = a.spec.in_parent != 0, r.spec.late = a.spec.late != 0;
    n.nu += r.spec.controls;
    set_law(a.spec, r);
    r.v = r.path >= 0 ? -1 : joints[std::size_t(r.spec.joint)].idx_v + a.spec.component, r.q = -1;
    const auto after = std::upper_bound(euclidean_spans.begin(), euclidean_spans.end(), r.v,
                                        [](Index v, const EuclideanSpan& s) { return v < s.first_v; });
    if (after != euclidean_spans.begin())
      if (const EuclideanSpan& s = after[-1]; r.v < s.first_v + s.count) r.q = s.first_q + r.v - s.first_v;
    if (r.bias[1] != 0 && r.q < 0 && r.path < 0)
      refuse(DYN_ERROR_INVALID,
             "actuator '" + a.name +
                 "' depends on a length, and the coordinates of its joint are no lengths: use MOTOR or VELOCITY");
    r.spec.integrates = a.spec.integrates != 0;
    r.spec.activations = activations_of(a.spec);
    r.act = r.spec.idx_act = r.spec.activations > 0 ? n.na : -1, n.na += r.spec.activations;
    r.period = period_of(a.spec, r, joint && joints[std::size_t(r.spec.joint)].type == DYN_JOINT_TYPE_SPHERICAL);
    out.push_back(r);
  }
  n.actuators = Index(out.size());
  n.path_rows += rows;
  return out;
}

std::optional<DragBox> drag_box(const FrameEntry& link, const SE3<double>& X) {
  if (!(link.mass > 0)) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(Eigen::Map<const Eigen::Matrix3d>(link.inertia.data()));
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Vector3d I = principal.eigenvalues();
  DragBox box{};
  box.X = X * SE3<double>{load33(axes.data()), load3(link.com.data())};
  for (int i = 0; i < 3; ++i) box.half[i] = std::sqrt(std::max(0.0, 1.5 / link.mass * (I.sum() - 2 * I[i])));
  return box;
}

}  // namespace dyn
