// Model to MJCF: joints with their parameters, and named configurations.
#include <cmath>

#include "base/portable.hpp"
#include "save_mjcf.hpp"
#include "spatial/quaternion.hpp"

namespace dyn::load {

namespace {

using Pose = SE3<double>;

bool alike(const std::vector<double>& x, int first, int n) {
  return std::all_of(x.begin() + first, x.begin() + first + n, [&](double e) { return e == x[size_t(first)]; });
}

// The slide of a helical joint, whose coordinate is that of its rotation.
bool slides_with_rotation(const Model& m, const JointRecord& r, const SimpleJoint& s) {
  return !s.leader.empty() && (r.leader < 0 || s.leader != m.string(m.joints()[r.leader].name));
}

}  // namespace

void MjcfWriter::add_joint(XmlElement& body, const Piece& p, const Pose& end) {
  const SimpleJoint& s = p.simple;
  XmlElement& e = *body.InsertNewChildElement("joint");
  put(e, "name", s.name);
  const bool slides = s.type == DYN_JOINT_TYPE_PRISMATIC, ball = s.type == DYN_JOINT_TYPE_SPHERICAL,
             free = s.type == DYN_JOINT_TYPE_FREE_FLYER;
  put(e, "type", std::string(slides ? "slide" : ball ? "ball" : free ? "free" : "hinge"));
  const Vec3<double> anchor = end.inverse().p;
  if (!free && (anchor[0] != 0 || anchor[1] != 0 || anchor[2] != 0)) put(e, "pos", {anchor[0], anchor[1], anchor[2]});
  if (!free && !ball) {
    const Vec3<double> axis = is_identity_rotation(end.R) ? load3(s.axis.data()) : transpose(end.R) * load3(s.axis.data());
    put(e, "axis", {axis[0], axis[1], axis[2]});
  }
  if (const double x = reference(p.joint, s); x != 0) put(e, "ref", x);
  add_numbers(e, p);
  if (s.type == DYN_JOINT_TYPE_CONTINUOUS)
    losses.note("continuous joints become hinges without a range: differences of their angles are not wrapped", s.name);
  if (s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED)
    losses.note("joints that store (cos, sin) become hinges with an angle", s.name);
  if (s.leader.empty()) return;
  losses.loss("mimic joints become equalities, which are no exact reduction: each adds a degree of freedom", s.name);
  XmlElement& equality = *section("equality").InsertNewChildElement("joint");
  put(equality, "name", s.name + "_follows"), put(equality, "joint1", s.name), put(equality, "joint2", s.leader);
  const auto leader = std::find_if(pieces.begin(), pieces.end(), [&](const Piece& x) { return x.simple.name == s.leader; });
  const double drawn_leader = leader == pieces.end() ? 0 : reference(leader->joint, leader->simple);
  put(equality, "polycoef", {s.offset + s.ratio * drawn_leader, s.ratio, 0, 0, 0});
}

template <class E>
void MjcfWriter::put_coefficient(XmlElement& e, double c, const std::string& joint) {
  if (c == 0) return;
  if (E::mjcf) put(e, E::mjcf, c);
  else losses.loss(std::string(E::quantity) + " of joints", joint);
}

void MjcfWriter::add_numbers(XmlElement& e, const Piece& p) {
  const SimpleJoint& s = p.simple;
  for (Index k = m.n.compliances > 0 ? m.n.limits - 1 : -1; k >= 0; --k)
    if (m.bodies()[m.limits()[k].body].joint == p.joint) {
      put_compliance(e, m.limit_compliances()[k].law, "solreflimit", "solimplimit");
      break;
    }
  if (const JointRecord& r = m.joints()[p.joint]; m.n.compliances > 0 && r.nv > 0)
    put_compliance(e, m.dof_compliances()[r.idx_v].law, "solreffriction", "solimpfriction");
  const JointSpec spec = spec_of(m, m.joints()[p.joint]);
  if (s.type == DYN_JOINT_TYPE_SPHERICAL || s.type == DYN_JOINT_TYPE_FREE_FLYER) {
    const int nv = joint_nv(s.type), nq = joint_nq(s.type);
    for_each_coefficient([&]<class E>() {
      const std::vector<double>& x = E::of(spec);
      if (!alike(x, s.v, nv))
        losses.loss("armature, damping or dry friction that differs between a joint's degrees of freedom: the first one counts",
                    s.name);
      put_coefficient<E>(e, x[size_t(s.v)], s.name);
    });
    if (spec.stiffness[size_t(s.v)] != 0) {
      const double* rest = spec.spring_reference.data() + s.q;
      if (rest[0] != 0 || rest[1] != 0 || rest[2] != 0) losses.loss("rest orientations of ball joint springs", s.name);
    }
    const auto limited = [&](const std::vector<double>& x, int first, int n) {
      return std::any_of(x.begin() + first, x.begin() + first + n, [](double l) { return std::isfinite(l); });
    };
    const bool ball = s.type == DYN_JOINT_TYPE_SPHERICAL;
    if (const double half = ball ? spec.lower[size_t(s.q) + 3] : -1; half >= 0)
      put(e, "range", {0, 2 * math::atan2(std::sqrt(1 - half * half), half)});
    if ((!ball && limited(spec.lower, s.q, nq)) || limited(spec.upper, s.q, nq) || limited(spec.velocity, s.v, nv) ||
        limited(spec.effort, s.v, nv))
      losses.loss("limits of free joints, and of a ball joint's velocity and effort", s.name);
    return;
  }
  const ScalarNumbers x = numbers_of(spec, s);
  if (std::isfinite(x.lower) || std::isfinite(x.upper)) {
    if (x.lower < x.upper) put(e, "range", {std::max(x.lower, -no_limit_written), std::min(x.upper, no_limit_written)});
    else losses.loss("ranges of a single point", s.name);
  }
  if (const ForceLimitRecord* const limit = force_limit(p.joint, -1)) {
    put_range(e, "actuatorfrcrange", limit->range);
    if (limit->with_weight) put(e, "actuatorgravcomp", std::string("true"));
  } else if (std::isfinite(x.effort)) {
    if (x.effort > 0) put(e, "actuatorfrcrange", {-x.effort, x.effort});
    else losses.loss("limits of effort that are zero", s.name);
  }
  if (std::isfinite(x.velocity)) losses.loss("velocity limits of joints", s.name);
  for_each_coefficient([&]<class E>() { put_coefficient<E>(e, E::of(x), s.name); });
  if (x.rest != 0) put(e, "springref", x.rest);
}

std::vector<double> MjcfWriter::qpos_of(Index configuration) const {
  const double* q = m.configurations() + std::ptrdiff_t(configuration) * m.n.nq;
  std::vector<double> qpos;
  for (const Piece& p : pieces) {
    const JointRecord& r = m.joints()[p.joint];
    const SimpleJoint& s = p.simple;
    const double* own = q + r.idx_q + s.q;
    if (s.type == DYN_JOINT_TYPE_SPHERICAL || s.type == DYN_JOINT_TYPE_FREE_FLYER) {
      const int n = joint_nq(s.type);
      qpos.insert(qpos.end(), own, own + n - 4);
      qpos.insert(qpos.end(), {own[n - 1], own[n - 4], own[n - 3], own[n - 2]});
      continue;
    }
    double x = s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED ? math::atan2(own[1], own[0]) : own[0];
    if (r.leader >= 0) x = r.ratio * x + r.offset;
    if (slides_with_rotation(m, r, s)) x *= s.ratio;
    qpos.push_back(x);
  }
  return qpos;
}

// The linear velocity of a free joint is in world axes there, and in those of the body here.
std::vector<double> MjcfWriter::qvel_of(Index configuration) const {
  const double *q = m.configurations() + std::ptrdiff_t(configuration) * m.n.nq, *v = m.configuration_state(configuration);
  std::vector<double> qvel;
  for (const Piece& p : pieces) {
    const JointRecord& r = m.joints()[p.joint];
    const SimpleJoint& s = p.simple;
    const double* own = v + r.idx_v + s.v;
    if (r.type == DYN_JOINT_TYPE_FREE_FLYER) {
      const double* const u = q + r.idx_q + 3;
      std::array<double, 6> moved;
      store3(rotation(Quaternion<double>{load3(u), u[3]}) * load3(v + r.idx_v), moved.data());
      std::copy_n(v + r.idx_v + 3, 3, moved.begin() + 3);
      qvel.insert(qvel.end(), moved.begin() + s.v, moved.begin() + s.v + joint_nv(s.type));
      continue;
    }
    qvel.insert(qvel.end(), own, own + joint_nv(s.type));
    if (r.leader >= 0) qvel.back() *= r.ratio;
    if (slides_with_rotation(m, r, s)) qvel.back() *= s.ratio;
  }
  return qvel;
}

void MjcfWriter::put_state(XmlElement& key, Index configuration) {
  const double *u = m.configuration_state(configuration) + m.n.nv, *act = u + m.n.nu, time = act[m.n.na];
  std::vector<double> ctrl, activations;
  for (const Index k : written_actuators) {
    const ActuatorRecord& a = m.actuators()[k];
    ctrl.insert(ctrl.end(), u + a.spec.idx_u, u + a.spec.idx_u + a.spec.controls);
    if (a.act >= 0) activations.insert(activations.end(), act + a.act, act + a.act + a.spec.activations);
  }
  const auto put_some = [&](const char* attribute, const std::vector<double>& x) {
    if (std::any_of(x.begin(), x.end(), [](double e) { return e != 0; })) put(key, attribute, x);
  };
  put_some("qvel", qvel_of(configuration)), put_some("ctrl", ctrl), put_some("act", activations);
  if (time != 0) put(key, "time", time);
}

void MjcfWriter::add_keys() {
  Names names;
  for (Index k = 1; k < m.n.configurations; ++k) {
    std::string name = m.string(m.configuration_names()[k]);
    if (k == drawn) {
      if (given_by_poses()) continue;
      losses.note("the configuration qpos0 becomes key 'qpos0_2': the file's initial configuration is another"), name = "qpos0_2";
    }
    XmlElement& key = *section("keyframe").InsertNewChildElement("key");
    put(key, "name", names.claim(name)), put(key, "qpos", qpos_of(k));
    put_state(key, k);
    std::vector<double> mpos, mquat;
    for (Index i = 0; i < m.n.mocaps; ++i) {
      const SE3<double> X = load_se3(m.configuration_mocaps() + 12 * (std::ptrdiff_t(k) * m.n.mocaps + i));
      const Quaternion<double> u = quaternion(X.R);
      mpos.insert(mpos.end(), {X.p[0], X.p[1], X.p[2]}), mquat.insert(mquat.end(), {u.w, u.v[0], u.v[1], u.v[2]});
    }
    if (m.n.mocaps > 0) put(key, "mpos", mpos), put(key, "mquat", mquat);
  }
}

// Balls are drawn at the identity, and followers at zero.
bool MjcfWriter::given_by_poses() const {
  const std::vector<double> qpos = qpos_of(drawn);
  auto at = qpos.begin();
  for (const Piece& p : pieces) {
    if (p.simple.type == DYN_JOINT_TYPE_SPHERICAL && *at != 1) return false;
    if (joint_nv(p.simple.type) == 1 && *at != reference(p.joint, p.simple)) return false;
    at += joint_nq(p.simple.type) + (p.simple.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED ? -1 : 0);
  }
  return true;
}

}  // namespace dyn::load
