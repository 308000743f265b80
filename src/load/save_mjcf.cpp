// Model to MJCF: the tree. A body's frame has the axes of its last joint. Earlier joints become anchors and axes in that frame.
#include "save_mjcf.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/portable.hpp"
#include "spatial/explog.hpp"
#include "spatial/quaternion.hpp"

namespace dyn::load {

namespace {

using Pose = SE3<double>;

// MuJoCo refuses bodies that move with a mass or a principal moment below 1e-15 (mjMINVAL). Below ten times that it gets this, in
// kg and kg m2.
constexpr double least_inertia = 1e-14;
constexpr int mujoco_depth = 490;  // MuJoCo refuses elements that are nested 500 deep

bool is_identity_pose(const Pose& X) { return is_identity_rotation(X.R) && X.p[0] == 0 && X.p[1] == 0 && X.p[2] == 0; }

}  // namespace

bool is_identity_rotation(const Mat3<double>& R) {
  double off = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(R(r, c) - (r == c)));
  return off < 1e-14;
}

void put_pose(XmlElement& e, const Pose& X) {
  if (X.p[0] != 0 || X.p[1] != 0 || X.p[2] != 0) put(e, "pos", {X.p[0], X.p[1], X.p[2]});
  if (is_identity_rotation(X.R)) return;
  const Quaternion<double> u = quaternion(X.R);
  put(e, "quat", {u.w, u.v[0], u.v[1], u.v[2]});
}

MjcfWriter::MjcfWriter(const Model& model, SaveReport& report)
    : m(model), losses(report), on(frames_by_joint(model)), children(on.size()), attachments(on.size()) {
  root = doc.NewElement("mujoco");
  doc.InsertEndChild(root);
  put(*root, "model", std::string(m.string(m.model_name)));
  bodies.reserve("world");
  for (Index f = 1; f < m.n.frames; ++f)
    if (m.frames()[f].type == DYN_FRAME_TYPE_BODY) {
      body_names[f] = bodies.claim(frame_name(f));
      if (body_names[f] != frame_name(f)) losses.note("bodies were renamed, because the world has their name", frame_name(f));
    } else {
      joints.reserve(frame_name(f));
    }
  for (Index j = 1; j < m.n.joints; ++j) children[size_t(m.joints()[j].parent)].push_back(j);
  for (Index k = 1; k < m.n.configurations; ++k)
    if (std::string_view(m.string(m.configuration_names()[k])) == "qpos0") drawn = k;
}

XmlElement& MjcfWriter::section(const char* name) {
  XmlElement* e = root->FirstChildElement(name);
  return e ? *e : *root->InsertNewChildElement(name);
}

void MjcfWriter::add_option() {
  XmlElement& option = section("option");
  put(option, "gravity", std::span(m.gravity)), put(option, "timestep", m.simulation()->dt);
  if (m.n.compliances > 0) {
    const ComplianceRecord& x = m.compliances()[0];
    if (x.ratio != 1) put(option, "impratio", x.ratio);
    if (x.pyramidal == 0) put(option, "cone", std::string("elliptic"));
  }
  switch (m.simulation()->integrator) {
    case DYN_INTEGRATOR_SEMI_IMPLICIT_EULER:
      break;
    case DYN_INTEGRATOR_RK4:
      put(option, "integrator", std::string("RK4"));
      break;
    case DYN_INTEGRATOR_IMPLICIT_FAST:
      put(option, "integrator", std::string("implicitfast"));
      break;
    default:
      losses.loss("integrators that MJCF lacks");
  }
  if (m.density != 0) put(option, "density", m.density);
  if (m.viscosity != 0) put(option, "viscosity", m.viscosity);
  if (m.wind[0] != 0 || m.wind[1] != 0 || m.wind[2] != 0) put(option, "wind", std::span(m.wind));
  add_flags(option);
}

void MjcfWriter::add_flags(XmlElement& option) {
  const auto disable = [&](const char* flag) {
    XmlElement* e = option.FirstChildElement("flag");
    put(e ? *e : *option.InsertNewChildElement("flag"), flag, std::string("disable"));
  };
  const auto pairs_parents = [](const ShapeRecord& s) {
    return s.role != DYN_SHAPE_ROLE_COLLISION || s.filter == std::uint32_t(PairFilter::SameBody);
  };
  if (m.n.geoms > 0 && std::all_of(m.shapes(), m.shapes() + m.n.shapes, pairs_parents)) disable("filterparent");
  const std::uint32_t off = ~m.simulation()->effects;
  if (off & DYN_EFFECT_LIMITS) disable("limit");
  if (off & DYN_EFFECT_FRICTION) disable("frictionloss");
  if (off & DYN_EFFECT_ACTUATORS) disable("actuation");
  if (off & DYN_EFFECT_SPRINGS) disable("spring");
  if (off & DYN_EFFECT_DAMPING) disable("damper");
  if (off & link_effects) disable("passive");
}

// The coordinate of a joint as the file draws it.
double MjcfWriter::reference(Index joint, const SimpleJoint& s) const {
  const JointRecord& r = m.joints()[joint];
  if (drawn < 0 || r.leader >= 0 || !s.leader.empty() || joint_nv(s.type) != 1) return 0;
  const double* const q = m.configurations() + std::ptrdiff_t(drawn) * m.n.nq + r.idx_q + s.q;
  return s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED ? math::atan2(q[1], q[0]) : q[0];
}

Pose MjcfWriter::drawn_motion(Index joint, const SimpleJoint& s) const {
  const Vec3<double> x = load3(s.axis.data()) * reference(joint, s);
  return s.type == DYN_JOINT_TYPE_PRISMATIC ? Pose{Mat3<double>::identity(), x} : Pose{exp3(x), Vec3<double>::zero()};
}

// A joint whose axes, as the file draws it, are those of the joint before.
bool MjcfWriter::aligned_when_drawn(Index joint) const {
  const JointRecord& r = m.joints()[joint];
  Pose X = load_se3(r.placement);
  if (r.type == DYN_JOINT_TYPE_REVOLUTE || r.type == DYN_JOINT_TYPE_CONTINUOUS)
    X = X * drawn_motion(joint, {.type = r.type,
                                 .axis = spec_of(m, r).axis,
                                 .before = {},
                                 .name = {},
                                 .q = 0,
                                 .v = 0,
                                 .leader = {},
                                 .ratio = 1,
                                 .offset = 0});
  return is_identity_rotation(X.R);
}

// Joints of one body: a chain of joints with nothing attached but the last.
std::vector<Index> MjcfWriter::joints_of_one_body(Index first) const {
  std::vector<Index> out = {first};
  for (;;) {
    const Index j = out.back();
    if (on[size_t(j)].size() != 1 || children[size_t(j)].size() != 1) return out;
    const Index child = children[size_t(j)][0];
    if (m.joints()[j].type == DYN_JOINT_TYPE_FREE_FLYER || m.joints()[child].type == DYN_JOINT_TYPE_FREE_FLYER ||
        !aligned_when_drawn(child))
      return out;
    out.push_back(child);
  }
}

// MJCF has free joints only on the world. Elsewhere a free joint becomes three slides and a ball.
std::vector<MjcfWriter::Piece> MjcfWriter::pieces_of(const std::vector<Index>& group) {
  std::vector<Piece> out;
  for (const Index j : group) {
    const JointRecord& r = m.joints()[j];
    Pose X = load_se3(r.placement);
    const std::vector<SimpleJoint> chain = chain_of(m, j, joints);
    for (const SimpleJoint& s : chain) {
      const Pose before = X * s.before;
      X = Pose::identity();
      if (s.type != DYN_JOINT_TYPE_FREE_FLYER || (r.parent == 0 && chain.size() == 1 && is_identity_pose(before))) {
        out.push_back({j, s, before});
        continue;
      }
      losses.loss(
          "free joints not on the world become three slides and a ball: their velocities are along its axes, not the body's",
          s.name);
      SimpleJoint part = s;
      for (int k = 0; k < 3; ++k) {
        part.type = DYN_JOINT_TYPE_PRISMATIC, part.axis = {double(k == 0), double(k == 1), double(k == 2)},
        part.name = joints.claim(s.name + "_" + "xyz"[k]);
        part.q = s.q + k, part.v = s.v + k;
        out.push_back({j, part, k == 0 ? before : Pose::identity()});
      }
      part.type = DYN_JOINT_TYPE_SPHERICAL, part.name = s.name, part.q = s.q + 3, part.v = s.v + 3;
      out.push_back({j, part, Pose::identity()});
    }
    if (chain.size() > 1) losses.note("joint types that MJCF lacks become several joints of a body", m.string(r.name));
  }
  return out;
}

void MjcfWriter::add_moving(Index first) {
  const std::vector<Index> group = joints_of_one_body(first);
  const Index last = group.back();
  const std::vector<Piece> chain = pieces_of(group);
  Index main = -1;  // the body itself: the first one with the joint's axes
  for (const Index f : on[size_t(last)])
    if (main < 0 && m.frames()[f].type == DYN_FRAME_TYPE_BODY && is_identity_rotation(load_se3(m.frames()[f].placement).R))
      main = f;
  const Pose in_joint = main < 0 ? Pose::identity() : Pose{Mat3<double>::identity(), load3(m.frames()[main].placement + 9)};
  const Attachment& parent = attachments[size_t(m.joints()[first].parent)];
  XmlElement* at = parent.element;
  Pose X = parent.X.inverse();  // of the parent joint in the element
  for (size_t begin = 0; begin < chain.size();) {
    size_t end = begin + 1;  // a ball's coordinates are in the body's axes, so a rotation behind it needs another body
    bool ball = chain[begin].simple.type == DYN_JOINT_TYPE_SPHERICAL;
    for (; end < chain.size() &&
           !(ball && !is_identity_rotation((chain[end].before * drawn_motion(chain[end].joint, chain[end].simple)).R));
         ++end)
      ball |= chain[end].simple.type == DYN_JOINT_TYPE_SPHERICAL;
    const bool whole = end == chain.size();
    for (size_t k = begin; k < end; ++k) X = X * chain[k].before * drawn_motion(chain[k].joint, chain[k].simple);
    const Pose frame = whole ? in_joint : Pose::identity();
    XmlElement& body = *at->InsertNewChildElement("body");
    if (++depth > mujoco_depth)
      throw Error(DYN_ERROR_LIMIT, "bodies are nested more than " + std::to_string(mujoco_depth) +
                                       " deep, which readers of MJCF refuse: save as URDF or .dynb");
    if (whole && main >= 0) {
      put(body, "name", body_name(main));
    } else {
      put(body, "name", bodies.claim(chain[end - 1].simple.name + "_body"));
      losses.note("bodies without mass were added, with 1e-14 kg and kg m2, as MuJoCo refuses less", body.Attribute("name"));
      XmlElement& inertial = *body.InsertNewChildElement("inertial");
      put(inertial, "pos", {0, 0, 0}), put(inertial, "mass", least_inertia);
      put(inertial, "diaginertia", {least_inertia, least_inertia, least_inertia});
    }
    Pose pose = X * frame;
    if (chain[begin].simple.type == DYN_JOINT_TYPE_FREE_FLYER) {
      const double* q = drawn >= 0 ? m.configurations() + std::ptrdiff_t(drawn) * m.n.nq + m.joints()[first].idx_q : nullptr;
      pose = q ? Pose{rotation(Quaternion<double>{load3(q + 3), q[6]}), load3(q)} * frame : frame;
      if (!is_identity_pose(frame))
        losses.loss("free joints whose frame is not their body's: their coordinates become the body's", chain[begin].simple.name);
    }
    put_pose(body, pose);
    if (whole && main >= 0) add_link(body, main, mass_of(m, on[size_t(last)]) == 0 ? least_inertia : 0, least_inertia);
    Pose to_end = frame;  // of the body in the frame of the piece
    std::vector<Pose> ends(end - begin);
    for (size_t k = end; k-- > begin;)
      ends[k - begin] = to_end, to_end = chain[k].before * drawn_motion(chain[k].joint, chain[k].simple) * to_end;
    for (size_t k = begin; k < end; ++k) add_joint(body, chain[k], ends[k - begin]), pieces.push_back(chain[k]);
    at = &body, X = Pose::identity();
    begin = end;
  }
  for (const Index j : group) attachments[size_t(j)] = {at, in_joint};
  add_content(last, main);
}

// Inertia by its principal axes and moments.
static void put_principal(XmlElement& inertial, Eigen::Matrix3d axes, const Eigen::Vector3d& moments) {
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Quaternion<double> u = quaternion(load33(axes.data()));
  put(inertial, "quat", {u.w, u.v[0], u.v[1], u.v[2]}), put(inertial, "diaginertia", {moments[0], moments[1], moments[2]});
}

void MjcfWriter::add_link(XmlElement& body, Index frame, double least_mass, double least_moment) {
  const LinkRecord& l = m.links()[m.frames()[frame].link];
  if (const double held = m.compensation(m.frames()[frame].link); held != 0) put(body, "gravcomp", held);
  const double mass = std::max(l.mass, least_mass);
  if (mass != 0 || std::any_of(l.inertia, l.inertia + 9, [](double x) { return x != 0; })) {
    XmlElement& inertial = *body.InsertNewChildElement("inertial");
    put(inertial, "pos", std::span(l.com)), put(inertial, "mass", mass);
    const Eigen::Matrix3d I = Eigen::Map<const Eigen::Matrix3d>(l.inertia);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(I);
    const Eigen::Vector3d moments = principal.eigenvalues();
    if (moments[0] < -1e-9 * moments[2])
      losses.loss("negative principal moments become the least that MuJoCo takes", frame_name(frame));
    if (mass > l.mass || moments[0] < least_moment)
      losses.loss("moving bodies get 1e-14 kg and kg m2 at least, as MuJoCo refuses less", frame_name(frame));
    constexpr double least_of_full = 2e-14;  // MuJoCo's bound of the smallest principal moment of a fullinertia
    const bool diagonal = I(0, 1) == 0 && I(0, 2) == 0 && I(1, 2) == 0;
    if (diagonal)
      put(inertial, "diaginertia", std::span(I.diagonal().cwiseMax(least_moment).eval().data(), 3));
    else if (moments[0] < least_of_full)
      put_principal(inertial, principal.eigenvectors(), moments.cwiseMax(least_moment));
    else
      put(inertial, "fullinertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
    if (moments[0] + moments[1] < moments[2] * (1 - 1e-9)) {
      losses.loss("impossible inertias: each principal moment becomes their mean (balanceinertia)", frame_name(frame));
      put(section("compiler"), "balanceinertia", std::string("true"));
    }
  }
  for (Index k = 0; k < m.n.shapes; ++k)
    if (m.shapes()[k].frame == frame) add_geom(body, m.shapes()[k], k);
}

// Adds what a joint carries besides the body: fixed bodies, frames, and child joints.
void MjcfWriter::add_content(Index joint, Index main) {
  const Attachment attachment = attachments[size_t(joint)];
  for (const Index f : on[size_t(joint)]) {
    const FrameRecord& r = m.frames()[f];
    if (r.type == DYN_FRAME_TYPE_JOINT || f == main) continue;
    Attachment on = attachment;  // or the mocap body that carries it
    if (r.place >= m.n.bodies)
      if (const Index carrier = m.mocaps()[r.place - m.n.bodies]; carrier != f)
        on = {mocap_elements[size_t(carrier)], load_se3(m.frames()[carrier].placement)};
    const Pose X = on.X.inverse() * load_se3(r.placement);
    XmlElement& e = *on.element->InsertNewChildElement(r.type == DYN_FRAME_TYPE_BODY ? "body" : "site");
    put(e, "name", r.type == DYN_FRAME_TYPE_BODY ? body_name(f) : frame_name(f));
    put_pose(e, X);
    if (r.place >= m.n.bodies && m.mocaps()[r.place - m.n.bodies] == f)
      put(e, "mocap", std::string("true")), mocap_elements[size_t(f)] = &e;
    if (r.type == DYN_FRAME_TYPE_BODY) add_link(e, f);
    if (r.type == DYN_FRAME_TYPE_FIXED_JOINT) losses.note("fixed joints become sites", frame_name(f));
    if (r.type == DYN_FRAME_TYPE_SENSOR) losses.note("frames of sensors become sites", frame_name(f));
  }
  const int here = depth;
  for (const Index j : children[size_t(joint)]) add_moving(j), depth = here;
}

std::string MjcfWriter::write() {
  XmlElement& compiler = section("compiler");
  put(compiler, "angle", std::string("radian")), put(compiler, "autolimits", std::string("true")),
      put(compiler, "inertiafromgeom", std::string("false"));
  add_option();
  section("asset");
  XmlElement& world = section("worldbody");
  attachments[0].element = &world;
  for (Index k = 0; k < m.n.shapes; ++k)
    if (m.shapes()[k].frame == 0) add_geom(world, m.shapes()[k], k);
  add_content(0, -1);
  add_contacts(), add_constraints(), add_tendons(), add_actuators(), add_sensors(), add_keys();
  if (section("asset").NoChildren()) root->DeleteChild(&section("asset"));
  losses.write_report();
  return printed(doc);
}

}  // namespace dyn::load

namespace dyn {

std::string save_mjcf(const Model& m, SaveReport& report) { return load::MjcfWriter(m, report).write(); }

}  // namespace dyn
