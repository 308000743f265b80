// Model to URDF. Each joint has a main link, whose frame is the joint's. Other links attach to it by fixed joints. Joint types
// that URDF lacks become chains of joints with massless links between them.
#include <cmath>

#include "collision/pair_search.hpp"
#include "save_urdf.hpp"

namespace dyn::load {

namespace {

double bounded(double x) { return std::min(std::max(x, -no_limit_written), no_limit_written); }

const char* type_name(dynJointType type) {
  switch (type) {
    case DYN_JOINT_TYPE_PRISMATIC: return "prismatic";
    case DYN_JOINT_TYPE_CONTINUOUS: case DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED: return "continuous";
    case DYN_JOINT_TYPE_SPHERICAL: return "spherical";
    case DYN_JOINT_TYPE_FREE_FLYER: return "floating";
    case DYN_JOINT_TYPE_PLANAR: return "planar";
    default: return "revolute";
  }
}

bool all(const std::vector<double>& x, double value) {
  return std::all_of(x.begin(), x.end(), [&](double e) { return e == value; });
}

bool unlimited(const JointSpec& s) {
  const auto infinite = [](const std::vector<double>& x) {
    return std::none_of(x.begin(), x.end(), [](double e) { return std::isfinite(e); });
  };
  return infinite(s.lower) && infinite(s.upper) && infinite(s.velocity) && infinite(s.effort);
}

}  // namespace

UrdfWriter::UrdfWriter(const Model& model, SaveReport& report)
    : m(model), losses(report), on(frames_by_joint(model)), main(size_t(model.n.joints), -1) {
  robot = doc.NewElement("robot");
  doc.InsertEndChild(robot);
  put(*robot, "name", std::string(m.string(m.model_name)));
  for (Index f = 1; f < m.n.frames; ++f)
    (m.frames()[f].type == DYN_FRAME_TYPE_BODY ? links : joints).reserve(m.string(m.frames()[f].name));
  for (size_t j = 0; j < on.size(); ++j)
    for (const Index f : on[j])
      if (main[j] < 0 && m.frames()[f].type == DYN_FRAME_TYPE_BODY && is_identity(m.frames()[f].placement)) main[j] = f;
  for (Index j = 0; j < m.n.joints; ++j) {
    const std::string name = m.string(m.joints()[j].name);
    if (main[size_t(j)] >= 0) main_name.push_back(frame_name(main[size_t(j)]));
    else main_name.push_back(links.claim(j ? name + "_link" : "world"));
  }
  bool shapes_on_world = false;
  for (Index k = 0; k < m.n.shapes; ++k) shapes_on_world |= m.shapes()[k].frame == 0;
  floating = m.n.joints > 1 && on[0].empty() && !shapes_on_world && m.joints()[1].type == DYN_JOINT_TYPE_FREE_FLYER &&
             is_identity(m.joints()[1].placement) && std::string_view(m.string(m.joints()[1].name)) == "root_joint" &&
             main[1] >= 0;
  for (Index j = 2; j < m.n.joints; ++j) floating &= m.joints()[j].parent != 0;
}

XmlElement& UrdfWriter::add_joint(const std::string& name, const char* type, const std::string& parent, const std::string& child,
                                  const SE3<double>& X) {
  XmlElement& e = *robot->InsertNewChildElement("joint");
  put(e, "name", name), put(e, "type", std::string(type));
  put_origin(e, X);
  put(*e.InsertNewChildElement("parent"), "link", parent), put(*e.InsertNewChildElement("child"), "link", child);
  return e;
}

void UrdfWriter::add_numbers(XmlElement& e, const JointSpec& spec, const SimpleJoint& s) {
  const std::string& name = s.name;
  // coefficient(E): the number of an effect E that URDF has
  const auto dynamics = [&](auto&& coefficient) {
    bool any = false;
    for_each_coefficient([&]<class E>() { any |= E::urdf && coefficient.template operator()<E>() != 0; });
    if (!any) return;
    XmlElement& d = *e.InsertNewChildElement("dynamics");
    for_each_coefficient([&]<class E>() {
      if (E::urdf) put(d, E::urdf, coefficient.template operator()<E>());
    });
  };
  if (s.type == DYN_JOINT_TYPE_SPHERICAL || s.type == DYN_JOINT_TYPE_FREE_FLYER || s.type == DYN_JOINT_TYPE_PLANAR) {
    const size_t nv = size_t(joint_nv(s.type)), first = size_t(s.v);
    const auto own = [&](const std::vector<double>& x) {
      return x.empty() ? std::vector<double>(nv, 0) : std::vector<double>(x.begin() + first, x.begin() + first + nv);
    };
    bool alike = s.type == DYN_JOINT_TYPE_SPHERICAL, any = false;
    for_each_coefficient([&]<class E>() {
      const auto x = own(E::of(spec));
      if (E::urdf) alike = alike && all(x, x[0]), any |= !all(x, 0);
      else if (!all(x, 0)) losses.loss(std::string(E::quantity) + " of joints", name);
    });
    if (alike) dynamics([&]<class E>() { return own(E::of(spec))[0]; });
    else if (any) losses.loss("damping and dry friction of joints with several degrees of freedom", name);
    if (!unlimited(spec)) losses.loss("limits of joints with several degrees of freedom", name);
    return;
  }
  const ScalarNumbers x = numbers_of(spec, s);
  put(*e.InsertNewChildElement("axis"), "xyz", std::span(s.axis));
  const bool turns = s.type == DYN_JOINT_TYPE_CONTINUOUS || s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED;
  if (!turns || std::isfinite(x.velocity) || std::isfinite(x.effort)) {
    XmlElement& limit = *e.InsertNewChildElement("limit");
    if (!turns) put(limit, "lower", bounded(x.lower)), put(limit, "upper", bounded(x.upper));
    put(limit, "effort", bounded(x.effort)), put(limit, "velocity", bounded(x.velocity));
  }
  if (turns && (std::isfinite(x.lower) || std::isfinite(x.upper))) losses.loss("limits of continuous joints", name);
  dynamics([&]<class E>() { return E::of(x); });
  for_each_coefficient([&]<class E>() {
    if (!E::urdf && E::of(x) != 0) losses.loss(std::string(E::quantity) + " of joints", name);
  });
  if (s.type == DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED)
    losses.note("joints that store (cos, sin) become continuous: load the file with cos_sin", name);
  if (!s.leader.empty()) {
    XmlElement& mimic = *e.InsertNewChildElement("mimic");
    put(mimic, "joint", s.leader), put(mimic, "multiplier", s.ratio), put(mimic, "offset", s.offset);
  }
}

// A link of the world without shapes.
std::string UrdfWriter::bare_world() {
  const auto has_shapes = [&](Index frame) {
    return frame >= 0 && std::any_of(m.shapes(), m.shapes() + m.n.shapes, [&](const ShapeRecord& s) {
             return s.frame == frame && s.role == DYN_SHAPE_ROLE_COLLISION;
           });
  };
  if (bare.empty()) {
    bare = main_name[0];
    if (has_shapes(0) || has_shapes(main[0])) {
      bare = links.claim("bare_world");
      add_joint(joints.claim(bare + "_joint"), "fixed", main_name[0], bare, SE3<double>::identity()), add_link(bare, -1);
      losses.note("a link without shapes was added for joints on the world itself", bare);
    }
  }
  return bare;
}

void UrdfWriter::add_moving(Index j) {
  const JointRecord& r = m.joints()[j];
  JointSpec spec = spec_of(m, r);
  std::vector<SimpleJoint> chain = chain_of(m, j, joints);
  if (r.type == DYN_JOINT_TYPE_PLANAR && unlimited(spec) && all(spec.damping, 0) && all(spec.friction, 0))
    chain = {
        {DYN_JOINT_TYPE_PLANAR, {r.axis[0], r.axis[1], r.axis[2]}, SE3<double>::identity(), m.string(r.name), 0, 0, "", 1, 0}};
  if (chain.size() > 1) losses.note("joint types that URDF lacks become chains of joints", m.string(r.name));
  std::string parent = main_name[size_t(r.parent)];
  SE3<double> X = load_se3(r.placement);
  if (r.parent == 0 && r.type != DYN_JOINT_TYPE_FREE_FLYER) {  // a joint does not collide with the link it attaches to
    const Index link = collision::fixed_link(m.frames(), on[size_t(j)].front());
    if (link == 0) parent = bare_world();
    else if (link != main[0]) parent = frame_name(link), X = load_se3(m.frames()[link].placement).inverse() * X;
  }
  for (const SimpleJoint& s : chain) {
    const bool last = &s == &chain.back();
    const std::string child = last ? main_name[size_t(j)] : links.claim(s.name + "_link");
    XmlElement& e = add_joint(s.name, type_name(s.type), parent, child, X * s.before);
    if (s.type == DYN_JOINT_TYPE_PLANAR) put(*e.InsertNewChildElement("axis"), "xyz", std::span(s.axis));
    add_numbers(e, spec, s);
    add_link(child, last ? main[size_t(j)] : -1);
    parent = child, X = SE3<double>::identity();
  }
  if (main[size_t(j)] < 0) losses.note("links without mass were added", main_name[size_t(j)]);
  else if (mass_of(m, on[size_t(j)]) == 0) losses.note("moving links have no mass", main_name[size_t(j)]);
}

void UrdfWriter::add_fixed(Index f, std::set<Index>& done) {
  const FrameRecord& r = m.frames()[f];
  const std::string& parent = main_name[size_t(r.joint)];
  const SE3<double> X = load_se3(r.placement);
  const std::string name = frame_name(f);
  if (r.type == DYN_FRAME_TYPE_BODY) {
    const std::string joint = joints.claim(name + "_joint");
    losses.note("fixed joints were added for links away from their joint's frame", joint);
    add_joint(joint, "fixed", parent, name, X), add_link(name, f);
    return;
  }
  if (r.type == DYN_FRAME_TYPE_FIXED_JOINT)
    for (const Index b : on[size_t(r.joint)])
      if (m.frames()[b].type == DYN_FRAME_TYPE_BODY && b != main[size_t(r.joint)] &&
          std::equal(r.placement, r.placement + 12, m.frames()[b].placement) && done.insert(b).second) {
        add_joint(name, "fixed", parent, frame_name(b), X), add_link(frame_name(b), b);
        return;
      }
  const std::string link = links.claim(name);
  losses.note("frames without a link become fixed joints with a massless link", name);
  add_joint(name, "fixed", parent, link, X), add_link(link, -1);
}

std::string UrdfWriter::write() {
  std::set<Index> done(main.begin(), main.end());
  const size_t root = floating ? 1 : 0;
  add_link(main_name[root], root == 0 && main[0] < 0 ? 0 : main[root]);
  if (main[root] >= 0 && root == 0) {  // shapes on the world itself
    XmlElement* link = robot->LastChildElement("link");
    for (Index k = 0; k < m.n.shapes; ++k)
      if (m.shapes()[k].frame == 0) add_shape(*link, m.shapes()[k]);
  }
  for (Index f = 1; f < m.n.frames; ++f) {
    const FrameRecord& r = m.frames()[f];
    if (r.type == DYN_FRAME_TYPE_JOINT) {
      if (!(floating && r.joint == 1)) add_moving(r.joint);
    } else if (!done.count(f)) {
      add_fixed(f, done);
    }
  }
  add_constraints();
  report_losses();
  losses.write_report();
  return printed(doc);
}

}  // namespace dyn::load

namespace dyn {

std::string save_urdf(const Model& m, SaveReport& report) { return load::UrdfWriter(m, report).write(); }

}  // namespace dyn
