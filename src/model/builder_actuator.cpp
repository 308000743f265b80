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
    case DYN_ACTUATOR_TYPE_MUSCLE: break;  // effect/muscle.hpp
  }
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

// Muscles act through a path, those of joints too.
bool has_own_path(const ActuatorEntry& a) {
  return a.spec.transmission == DYN_TRANSMISSION_SITE ||
         (a.spec.transmission == DYN_TRANSMISSION_JOINT && a.spec.type == DYN_ACTUATOR_TYPE_MUSCLE);
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
  if (!reference.empty() && spec.transmission != DYN_TRANSMISSION_SITE)
    refuse(DYN_ERROR_ARGUMENT, who + ": a reference frame needs the transmission SITE");
  if (spec.transmission == DYN_TRANSMISSION_JOINT) {
    entry.target = impl->find_joint(target);
    check_driven_joint(impl->joints, who, target, entry.target, spec.component);
    if (spec.type == DYN_ACTUATOR_TYPE_MUSCLE && joint_nq(impl->joints[std::size_t(entry.target)].spec.type) != 1)
      refuse(DYN_ERROR_INVALID, who + ": a muscle needs a length, and joint '" + target + "' has none");
  } else if (spec.transmission == DYN_TRANSMISSION_TENDON) {
    entry.target = impl->find_tendon(target, who);
  } else {
    entry.target = impl->find_frame(target, who);
    entry.reference = reference.empty() ? -1 : impl->find_frame(reference, who);
    for (const double w : spec.wrench) check_number(who, "wrench", w, true);
    if (spec.gear != 1) refuse(DYN_ERROR_INVALID, who + ": gear is " + number(spec.gear) + ": with SITE, wrench says it all");
  }
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

void Builder::pair(const std::string& shape1, const std::string& shape2, const dynMaterial* material) {
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
  impl->pairs.push_back({a, b, material ? std::optional(*material) : std::nullopt});
}

std::vector<ActuatorRecord> actuators_of(const std::vector<ActuatorEntry>& actuators, const std::vector<Index>& id,
                                         const std::vector<JointRecord>& joints,
                                         const std::vector<EuclideanSpan>& euclidean_spans, ModelSizes& n) {
  std::vector<ActuatorRecord> out;
  n.paths = n.tendons + n.couplings, n.path_rows = path_rows_of_tendon * n.tendons + n.couplings;
  Index rows = 0;
  for (const ActuatorEntry& a : actuators) {
    ActuatorRecord r{};
    r.spec = a.spec;
    const dynTransmission by = a.spec.transmission;
    r.spec.struct_size = sizeof r.spec, r.spec.joint = by == DYN_TRANSMISSION_JOINT ? id[std::size_t(a.target)] : 0;
    r.spec.tendon = by == DYN_TRANSMISSION_TENDON ? a.target : -1;
    r.spec.frame = by == DYN_TRANSMISSION_SITE ? a.target : -1, r.spec.reference = a.reference;
    r.path = by == DYN_TRANSMISSION_TENDON ? a.target : has_own_path(a) ? n.paths++ : -1;
    r.row = r.path >= 0 ? rows++ : -1;
    r.spec.controls = a.spec.type == DYN_ACTUATOR_TYPE_PD ? 3 : 1, r.spec.idx_u = n.nu;
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
    r.act = r.spec.idx_act = has_activation(a.spec) ? n.na++ : -1;
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
