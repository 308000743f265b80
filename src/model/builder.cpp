#include "base/portable.hpp"
#include "model/builder.hpp"

#include <algorithm>
#include <cmath>
#include <charconv>

#include "builder_impl.hpp"
#include "builder_surface.hpp"
#include "shape/geometry.hpp"
#include "table/enums.hpp"
#include "table/names.hpp"

namespace dyn {

std::string number(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr;
  return std::string(text, end);
}

int joint_nq(dynJointType type) {
  int n = 0;
  visit_kind(type, [&]<class K>() { n = K::nq; });
  return n;
}

int joint_nv(dynJointType type) {
  int n = 0;
  visit_kind(type, [&]<class K>() { n = K::nv; });
  return n;
}

int primitive_nq(BodyType t) {
  int n = 0;
  visit(t, [&]<class J>() { n = J::nq; });
  return n;
}
int primitive_nv(BodyType t) {
  int n = 0;
  visit(t, [&]<class J>() { n = J::nv; });
  return n;
}

// The smallest rotation that takes z to the unit vector a: c 1 + w x + w w' / (1 + c), w = z x a, c = z . a; about x when
// a = -z. Its last column is a itself; for axes of the frame all entries are 0 or 1: no sines of pi/2.
Mat3<double> z_to(const Axis& a) {
  const double c = a[2], s = math::hypot(a[0], a[1]);
  if (s < 1e-300) return c > 0 ? Mat3<double>::identity() : Mat3<double>::diagonal(1, -1, -1);
  const Vec3<double> w = Vec3<double>::make(-a[1], a[0], 0), u = Vec3<double>::make(-a[1] / s, a[0] / s, 0);
  const Mat3<double> ww = c > 0 ? outer(w, w * (1 / (1 + c))) : outer(u, u * (1 - c));  // s^2 = (1 + c) (1 - c)
  return Mat3<double>::identity() * c + ww + skew(w);
}

void check_finite(const std::string& where, const double* x, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(x[i]))
      refuse(DYN_ERROR_NONFINITE, where + "[" + std::to_string(i) + "] is " + number(x[i]) + ": give a finite number");
}

SE3<double> check_placement(const std::string& where, const Placement& x) {
  check_finite(where + ": placement", x.data(), 12);
  const SE3<double> X = load_se3(x.data());
  const Mat3<double> E = transpose(X.R) * X.R - Mat3<double>::identity();
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(E(i, j)));
  if (worst > 1e-6 || dot(cross(X.R.x, X.R.y), X.R.z) < 0)
    refuse(DYN_ERROR_INVALID, where + ": placement is not a rotation (off by " + number(worst) +
                                  "): give an orthonormal right-handed matrix by columns");
  if (worst <= 4e-16) return X;  // turned by quarters, and whatever else is orthonormal to the last bit
  return {rotation(quaternion(X.R)), X.p};
}

namespace {

void check_name(const std::string& what, const std::string& name) {
  if (name.empty()) refuse(DYN_ERROR_ARGUMENT, what + " has no name: give one");
  if (name.find('\0') != std::string::npos)
    refuse(DYN_ERROR_ARGUMENT, what + " '" + name.c_str() + "': the name holds a zero byte");
}

Axis check_axis(const std::string& where, const Axis& a) {
  check_finite(where, a.data(), 3);
  const double big = std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
  if (big == 0) refuse(DYN_ERROR_INVALID, where + " is zero: give a direction such as (0, 0, 1)");
  const double x = a[0] / big, y = a[1] / big, z = a[2] / big, n = std::sqrt(x * x + y * y + z * z);
  return {x / n, y / n, z / n};
}

Axis column(const Mat3<double>& A, int k) { return {A(0, k), A(1, k), A(2, k)}; }

void check_vector(const std::string& where, const char* what, const std::vector<double>& x, int n, double minimum) {
  if (x.empty()) return;
  if (int(x.size()) != n)
    refuse(DYN_ERROR_SIZE, where + ": " + what + " has " + std::to_string(x.size()) + " numbers, needs " + std::to_string(n));
  for (double value : x) {
    if (std::isnan(value)) refuse(DYN_ERROR_NONFINITE, where + ": " + what + " is NaN: give a number");
    if (value < minimum) refuse(DYN_ERROR_INVALID, where + ": " + what + " is " + number(value) + ": it can't be negative");
  }
}

// -inf below and inf above mean no limit; the other way round nothing is left between them.
// A spring's torque must be the gradient of an energy, in coordinates of the tangent space.
void check_springs(const std::string& who, const JointSpec& s, const std::vector<PlacedElement>& elements) {
  Index q = 0, v = 0;
  for (const PlacedElement& p : elements) {
    const BodyType type = p.element.type;
    const Index nq = primitive_nq(type), nv = primitive_nv(type);
    if (!s.stiffness.empty()) {
      const double* k = s.stiffness.data() + v;
      if (type == BodyType::Spherical && (k[0] != k[1] || k[0] != k[2]))
        refuse(DYN_ERROR_INVALID, who + ": stiffness of a quaternion's three degrees of freedom is " + number(k[0]) + ", " +
                                      number(k[1]) + ", " + number(k[2]) + ": give the same three times");
      if (type == BodyType::FreeFlyer && std::any_of(k, k + nv, [](double x) { return x != 0; }))
        refuse(DYN_ERROR_INVALID, who + ": a free flyer can't have a spring: build it of a translation and a spherical joint");
    }
    if (nq != nv && type != BodyType::FreeFlyer && !s.spring_reference.empty() &&
        std::all_of(s.spring_reference.begin() + q, s.spring_reference.begin() + q + nq, [](double x) { return x == 0; }))
      refuse(DYN_ERROR_QUATERNION, who + ": the quaternion or (cos, sin) in its spring reference is zero: give one of norm 1");
    q += nq, v += nv;
  }
}

// cos of half the largest angle of a ball joint
void check_balls(const std::string& who, const JointSpec& s, const std::vector<PlacedElement>& elements) {
  Index q = 0;
  for (const PlacedElement& p : elements) {
    const BodyType type = p.element.type;
    if (type == BodyType::Spherical && !s.lower.empty() && !(s.lower[std::size_t(q) + 3] < 1))
      refuse(DYN_ERROR_INVALID, who + ": lower limit[" + std::to_string(q + 3) + "] is " + number(s.lower[std::size_t(q) + 3]) +
                                    ": of a quaternion it is cos(a/2) for an angle of at most a: give a number below 1");
    q += primitive_nq(type);
  }
}

void check_range(const std::string& where, const std::vector<double>& lower, const std::vector<double>& upper) {
  auto name = [](const char* side, std::size_t k, const std::vector<double>& x) {
    return std::string(side) + " limit" + (x.size() > 1 ? "[" + std::to_string(k) + "]" : "");
  };
  for (std::size_t k = 0; k < lower.size(); ++k)
    if (lower[k] == HUGE_VAL)
      refuse(DYN_ERROR_NONFINITE, where + ": " + name("lower", k, lower) + " is inf: give a number, or -inf for none");
  for (std::size_t k = 0; k < upper.size(); ++k)
    if (upper[k] == -HUGE_VAL)
      refuse(DYN_ERROR_NONFINITE, where + ": " + name("upper", k, upper) + " is -inf: give a number, or inf for none");
  for (std::size_t k = 0; k < lower.size() && k < upper.size(); ++k)
    if (lower[k] > upper[k])
      refuse(DYN_ERROR_INVALID,
             where + ": " + name("lower", k, lower) + " " + number(lower[k]) + " exceeds upper limit " + number(upper[k]));
}

// The simple joints of a spec in order.
void append_parts(const std::string& where, const JointSpec& s, const SE3<double>& before, std::vector<JointPart>& out) {
  if (s.type != DYN_JOINT_TYPE_COMPOSITE) {
    out.push_back({s.type, s.axis, s.axis2, s.pitch, before});
    return;
  }
  if (s.parts.empty()) refuse(DYN_ERROR_ARGUMENT, where + ": a composite joint needs at least one part");
  SE3<double> next = before;
  for (std::size_t k = 0; k < s.parts.size(); ++k) {
    const std::string part = where + ", part " + std::to_string(k);
    if (out.size() > 1000) refuse(DYN_ERROR_LIMIT, part + ": more than 1000 simple joints in one composite");
    const JointSpec& p = s.parts[k];
    const SE3<double> X = check_placement(part, p.placement);
    if (p.type == DYN_JOINT_TYPE_FIXED) {
      next = next * X;
      continue;
    }
    append_parts(part, p, next * X, out);
    next = SE3<double>::identity();
  }
  if (next.p[0] != 0 || next.p[1] != 0 || next.p[2] != 0 || next.R(0, 0) != 1 || next.R(1, 1) != 1)
    refuse(DYN_ERROR_INVALID, where + ": a composite joint can't end with a fixed part: put its placement on the bodies");
}

void append_elements(const std::string& where, const JointPart& s, std::vector<PlacedElement>& out) {
  bool needs_axis2 = false;
  visit_kind(s.type, [&]<class K>() { needs_axis2 = K::needs_axis2; });
  const Axis axis = check_axis(where + ": axis", s.axis);
  const Axis axis2 = needs_axis2 ? check_axis(where + ": axis2", s.axis2) : Axis{1, 0, 0};
  if (needs_axis2 && std::abs(axis[0] * axis2[0] + axis[1] * axis2[1] + axis[2] * axis2[2]) > 1 - 1e-12)
    refuse(DYN_ERROR_INVALID, where + ": axis and axis2 are parallel: give two directions");
  if (!std::isfinite(s.pitch)) refuse(DYN_ERROR_NONFINITE, where + ": pitch is " + number(s.pitch) + ": give metres per radian");
  const Mat3<double> Z = z_to(axis);
  const JointGeometry geometry = {axis, axis2, column(Z, 0), column(Z, 1), s.pitch};
  Elements elements{};
  visit_kind(s.type, [&]<class K>() { elements = K::elements(geometry); });
  if (elements.count == 0) refuse(DYN_ERROR_ARGUMENT, where + ": unknown joint type " + std::to_string(int(s.type)));
  SE3<double> first = s.before;
  for (const Element& element : elements) {
    out.push_back({first, element});
    first = SE3<double>::identity();
  }
}

}  // namespace

void check_joint_numbers(const std::string& who, const JointSpec& s, const std::vector<PlacedElement>& elements) {
  const int nq = spec_nq(s), nv = spec_nv(s);
  check_vector(who, "lower limit", s.lower, nq, -HUGE_VAL);
  check_vector(who, "upper limit", s.upper, nq, -HUGE_VAL);
  check_vector(who, "velocity limit", s.velocity, nv, 0);
  check_vector(who, "effort limit", s.effort, nv, 0);
#define COEFFICIENT(name, has, sentence) check_vector(who, #name, s.name, nv, 0);
#include "effect/coefficients.def"
  check_vector(who, "spring reference", s.spring_reference, nq, -HUGE_VAL);
  check_range(who, s.lower, s.upper);
  for (const auto& [what, x] : {
#define COEFFICIENT(name, has, sentence) std::pair{#name, &s.name},
#include "effect/coefficients.def"
           std::pair{"spring reference", &s.spring_reference}})
    for (double a : *x)
      if (!std::isfinite(a)) refuse(DYN_ERROR_NONFINITE, who + ": " + what + " is " + number(a) + ": give a finite number");
  check_springs(who, s, elements), check_balls(who, s, elements);
  if (!std::isfinite(s.rotor_inertia) || !std::isfinite(s.gear_ratio) ||
      !std::isfinite(s.rotor_inertia * s.gear_ratio * s.gear_ratio))
    refuse(DYN_ERROR_NONFINITE, who + ": rotor inertia and gear ratio must be finite, and rotor_inertia * gear_ratio^2, too");
  if (s.rotor_inertia < 0)
    refuse(DYN_ERROR_INVALID, who + ": rotor inertia is " + number(s.rotor_inertia) + ": it can't be negative");
  if (s.rotor_inertia != 0 && nv != 1)
    refuse(DYN_ERROR_INVALID, who + ": a rotor inertia needs a joint of one degree of freedom; use armature");
}

std::vector<PlacedElement> elements_of(const JointSpec& s, const std::vector<JointPart>& parts) {
  const std::string who = "joint '" + s.name + "'";
  std::vector<PlacedElement> out;
  for (std::size_t k = 0; k < parts.size(); ++k)
    append_elements(s.type == DYN_JOINT_TYPE_COMPOSITE ? who + ", part " + std::to_string(k) : who, parts[k], out);
  return out;
}

int spec_nq(const JointSpec& s) {
  int n = joint_nq(s.type);
  for (const JointSpec& p : s.parts) n += spec_nq(p);
  return n;
}
int spec_nv(const JointSpec& s) {
  int n = joint_nv(s.type);
  for (const JointSpec& p : s.parts) n += spec_nv(p);
  return n;
}

void check_link_numbers(const std::string& who, double mass, const std::array<double, 3>& com,
                        const std::array<double, 9>& inertia) {
  if (!std::isfinite(mass)) refuse(DYN_ERROR_NONFINITE, who + ": mass is " + number(mass) + ": give a finite number");
  if (mass < 0) refuse(DYN_ERROR_INVALID, who + ": mass is " + number(mass) + " kg: it can't be negative");
  check_finite(who + ": com", com.data(), 3);
  check_finite(who + ": inertia", inertia.data(), 9);
  double big = 0;
  for (double x : inertia) big = std::max(big, std::abs(x));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      if (std::abs(inertia[std::size_t(i + 3 * j)] - inertia[std::size_t(j + 3 * i)]) > 1e-9 * big)
        refuse(DYN_ERROR_INVALID, who + ": inertia is not symmetric");
}

Builder::Builder(std::string name) : impl(std::make_unique<Impl>()) {
  impl->name = std::move(name);
  impl->frames.push_back({"universe", DYN_FRAME_TYPE_OP_FRAME, -1, SE3<double>::identity(), Inertia<double>::zero(), {}, {}, {}});
  impl->frame_index["universe"].push_back(0);
}
Builder::~Builder() = default;

void Builder::gravity(const std::array<double, 3>& g) {
  check_finite("gravity", g.data(), 3);
  impl->gravity = g;
}

int Builder::Impl::find_joint(const std::string& wanted) const {
  const auto it = frame_index.find(wanted);
  if (it != frame_index.end())
    for (const int k : it->second)
      if (frames[std::size_t(k)].type == DYN_FRAME_TYPE_JOINT) return frames[std::size_t(k)].joint;
  return -1;
}

int Builder::Impl::find(const Parent& parent, const std::string& who) const {
  if (parent.name.empty()) return 0;
  const auto it = frame_index.find(parent.name);
  if (it != frame_index.end()) {
    // joints and user frames answer before links
    int body = -1;
    for (int k : it->second) {
      if (parent.types && !(frames[std::size_t(k)].type & parent.types)) continue;
      if (frames[std::size_t(k)].type != DYN_FRAME_TYPE_BODY) return k;
      body = k;
    }
    if (body >= 0) return body;
  }
  refuse(DYN_ERROR_NAME, who + ": there is no parent '" + parent.name + "': add it first");
}

void Builder::Impl::add_frame(FrameEntry entry, const std::string& who) {
  for (int k : frame_index[entry.name])
    if (frames[std::size_t(k)].type == entry.type ||
        (frames[std::size_t(k)].type != DYN_FRAME_TYPE_BODY && entry.type != DYN_FRAME_TYPE_BODY))
      refuse(DYN_ERROR_NAME, who + ": the name '" + entry.name + "' is taken: choose another");
  frame_index[entry.name].push_back(int(frames.size()));
  frames.push_back(std::move(entry));
}

void Builder::joint(const JointSpec& s) { impl->add_joint(s); }

void Builder::Impl::add_joint(const JointSpec& s) {
  check_name("joint", s.name);
  const std::string who = "joint '" + s.name + "'";
  if (s.name == "universe") refuse(DYN_ERROR_NAME, who + ": the name 'universe' is the world's: choose another");
  const int parent = find(s.parent, who);
  const FrameEntry& carrier = frames[std::size_t(parent)];
  const SE3<double> X = carrier.X * check_placement(who, s.placement);
  if (s.type == DYN_JOINT_TYPE_FIXED) {
    if (!s.mimic.empty()) refuse(DYN_ERROR_INVALID, who + ": a fixed joint can't mimic '" + s.mimic + "'");
    add_frame({s.name, DYN_FRAME_TYPE_FIXED_JOINT, carrier.joint, X, Inertia<double>::zero(), 0, {}, {}, 0, parent}, who);
    return;
  }
  JointEntry entry;
  entry.spec = s;
  entry.parent = carrier.joint;
  append_parts(who, s, SE3<double>::identity(), entry.parts);
  entry.elements = elements_of(s, entry.parts);
  entry.placement = X;
  if (entry.elements.empty()) refuse(DYN_ERROR_ARGUMENT, who + ": a composite joint needs at least one part that moves");
  check_joint_numbers(who, s, entry.elements);
  const int nq = spec_nq(s), nv = spec_nv(s);
  if (!s.mimic.empty()) {
    if (nv != 1 || nq != 1)
      refuse(DYN_ERROR_INVALID, who + ": only joints of one degree of freedom can mimic; this is " + name_of(s.type));
    if (!std::isfinite(s.mimic_ratio) || !std::isfinite(s.mimic_offset))
      refuse(DYN_ERROR_NONFINITE,
             who + ": mimic ratio " + number(s.mimic_ratio) + " and offset " + number(s.mimic_offset) + " must be finite");
    if (s.mimic == s.name) refuse(DYN_ERROR_INVALID, who + ": it mimics itself: name another joint");
  }
  const int index = int(joints.size());
  add_frame({s.name, DYN_FRAME_TYPE_JOINT, index, SE3<double>::identity(), Inertia<double>::zero(), 0, {}, {}, 0, parent}, who);
  joints.push_back(std::move(entry));
}

void Builder::body(const std::string& name, const Parent& parent, const Placement& placement, double mass,
                   const std::array<double, 3>& com, const std::array<double, 9>& inertia) {
  check_name("body", name);
  const std::string who = "body '" + name + "'";
  const int on = impl->find(parent, who);
  const FrameEntry& carrier = impl->frames[std::size_t(on)];
  const SE3<double> X = carrier.X * check_placement(who, placement);
  check_link_numbers(who, mass, com, inertia);
  const Inertia<double> Y = Inertia<double>::at_com(mass, load3(com.data()), load33(inertia.data()));
  FrameEntry entry{name, DYN_FRAME_TYPE_BODY, carrier.joint, X, act(X, Y), {}, {}, {}};
  entry.mass = mass, entry.com = com, entry.inertia = inertia, entry.parent = on;
  impl->add_frame(std::move(entry), who);
}

void Builder::frame(const std::string& name, const Parent& parent, const Placement& placement, dynFrameType type) {
  check_name("frame", name);
  const std::string who = "frame '" + name + "'";
  if (type != DYN_FRAME_TYPE_OP_FRAME && type != DYN_FRAME_TYPE_SENSOR)
    refuse(DYN_ERROR_ARGUMENT, who + ": type must be OP_FRAME or SENSOR; joints and bodies bring their own frames");
  const int on = impl->find(parent, who);
  const FrameEntry& carrier = impl->frames[std::size_t(on)];
  impl->add_frame(
      {name, type, carrier.joint, carrier.X * check_placement(who, placement), Inertia<double>::zero(), 0, {}, {}, 0, on}, who);
}

void Builder::shape(const Shape& shape) {
  const std::string who = "shape of body '" + shape.body + "'";
  ShapeEntry entry{shape, shape.body == "universe" ? 0 : impl->find({shape.body, DYN_FRAME_TYPE_BODY}, who)};
  check_placement(who, shape.placement);
  check_finite(who + ": size", shape.size.data(), 3);
  for (std::size_t k = 0; k < std::size_t(shape::size_count(shape.type)); ++k)
    if (!(shape.size[k] >= shape::min_length && shape.size[k] <= shape::max_length))
      refuse(DYN_ERROR_INVALID, who + ": size " + number(shape.size[k]) + ": give metres from 1e-12 to 1e12");
  if (!(shape.radius >= 0 && shape.radius <= shape::max_length))
    refuse(DYN_ERROR_INVALID, who + ": radius " + number(shape.radius) + ": give metres from 0 to 1e12");
  if (shape.radius > 0 && shape.type == DYN_SHAPE_TYPE_MESH) refuse(DYN_ERROR_UNSUPPORTED, who + ": a mesh can't be rounded");
  if (const shape::BadNumber bad = shape::bad_number(shape.material); bad.name)
    refuse(DYN_ERROR_INVALID, who + ": material: " + bad.name + " is " + number(bad.value) +
                                  ": give 0 or more, restitution up to 1, finite velocities");
  const bool made_of_facets =
      shape.type == DYN_SHAPE_TYPE_CONVEX || shape.type == DYN_SHAPE_TYPE_TRIANGLES || shape.type == DYN_SHAPE_TYPE_HEIGHT_FIELD;
  if (made_of_facets != bool(shape.surface) || (shape.surface && type_of(*shape.surface) != shape.type))
    refuse(DYN_ERROR_ARGUMENT, who + ": its type and its surface don't belong together");
  impl->shapes.push_back(std::move(entry));
}

void Builder::colour(std::uint32_t of_last_shape) {
  if (impl->shapes.empty()) refuse(DYN_ERROR_INVALID, "there is no shape to be coloured: add it first");
  impl->shapes.back().shape.colour = of_last_shape;
}

void Builder::Impl::check_configuration_name(const std::string& name) const {
  check_name("configuration", name);
  if (name == "neutral") refuse(DYN_ERROR_NAME, "configuration 'neutral' is always there: choose another name");
  if (names.configurations.find(configurations, name) >= 0)
    refuse(DYN_ERROR_NAME, "configuration '" + name + "' is there already: choose another name");
}

void Builder::configuration(const std::string& name, const std::vector<double>& q) {
  impl->check_configuration_name(name);
  check_finite("configuration '" + name + "'", q.data(), q.size());
  impl->configurations.push_back({name, false, q, {}});
}

void Builder::configuration_of_joints(const std::string& name,
                                      const std::vector<std::pair<std::string, std::vector<double>>>& joints,
                                      const ConfigurationState& state) {
  impl->check_configuration_name(name);
  ConfigurationEntry entry{name, true, {}, std::vector<std::vector<double>>(impl->joints.size())};
  entry.v_by_joint.resize(impl->joints.size());
  const auto set = [&](const auto& given, std::vector<std::vector<double>>& by_joint, int (*size)(const JointEntry&)) {
    for (const auto& [joint, x] : given) {
      const std::string who = "configuration '" + name + "', joint '" + joint + "'";
      const int at = impl->find_joint(joint);
      if (at < 0) refuse(DYN_ERROR_NAME, who + ": there is no such moving joint");
      check_finite(who, x.data(), x.size());
      if (const int needed = size(impl->joints[std::size_t(at)]); int(x.size()) != needed)
        refuse(DYN_ERROR_SIZE, who + " has " + std::to_string(x.size()) + " numbers, needs " + std::to_string(needed));
      by_joint[std::size_t(at)] = x;
    }
  };
  set(joints, entry.by_joint, own_nq), set(state.v, entry.v_by_joint, own_nv);
  for (const auto& [actuator, x] : state.actuators) {
    const std::string who = "configuration '" + name + "', actuator '" + actuator + "'";
    if (impl->names.actuators.find(impl->actuators, actuator) < 0) refuse(DYN_ERROR_NAME, who + ": there is no such actuator");
    check_finite(who, x.control.data(), x.control.size()), check_finite(who, x.activation.data(), x.activation.size());
    entry.actuators[actuator] = x;
  }
  for (const auto& [body, X] : state.mocaps) {
    const std::string who = "configuration '" + name + "', mocap body '" + body + "'";
    if (!impl->frames[std::size_t(impl->find({body, DYN_FRAME_TYPE_BODY}, who))].mocap)
      refuse(DYN_ERROR_INVALID, who + ": this body is no mocap body");
    check_finite(who, X.data(), X.size());
    entry.mocaps[body] = X;
  }
  check_finite("configuration '" + name + "': time", &state.time, 1);
  entry.time = state.time;
  impl->configurations.push_back(std::move(entry));
}

void Builder::allow_massless_joints() { impl->allow_massless = true; }
void Builder::initial_configuration(const std::string& name) {
  if (name != "neutral" && impl->names.configurations.find(impl->configurations, name) < 0)
    refuse(DYN_ERROR_NAME, "initial configuration: there is no configuration '" + name + "'");
  impl->initial = name;
}

void Builder::stepping(double dt, dynIntegrator integrator, std::uint32_t effects) {
  if (!(dt > 0) || !std::isfinite(dt)) refuse(DYN_ERROR_INVALID, "stepping: dt is " + number(dt) + " s: give a positive number");
  if (!is_value(integrator))
    refuse(DYN_ERROR_ARGUMENT, "stepping: integrator " + std::to_string(int(integrator)) + " is no dynIntegrator");
  if (effects & ~std::uint32_t(DYN_EFFECT_ALL)) refuse(DYN_ERROR_ARGUMENT, "stepping: effects have unknown bits");
  impl->simulation.dt = dt, impl->simulation.integrator = integrator, impl->simulation.effects = effects;
}

void Builder::compliant(double impratio, bool pyramidal) {
  if (!(impratio > 0 && impratio <= 1e15))
    refuse(DYN_ERROR_INVALID, "impratio is " + number(impratio) + ": give a positive number");
  impl->compliant = true, impl->impratio = impratio, impl->pyramidal = pyramidal;
}

void Builder::disabled_pair(const std::string& body1, const std::string& body2, const std::string& reason) {
  const std::string who = "pair '" + body1 + "', '" + body2 + "'";
  const auto frame = [&](const std::string& body) {
    return body == "universe" ? 0 : impl->find({body, DYN_FRAME_TYPE_BODY}, who);
  };
  impl->disabled.push_back({frame(body1), frame(body2), reason});
}

void Builder::report(dynReportLevel level, int line, const std::string& message) {
  impl->reports.push_back({level, line, message});
}

}  // namespace dyn
