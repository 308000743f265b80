// Passes an MJCF model to the builder. A joint's frame lies at its anchor with the body's axes at qpos 0. Several joints of one
// body become a chain; links, shapes and sites attach to the last one.
#include <algorithm>
#include <cmath>
#include <set>

#include "spatial/explog.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

using Pose = SE3<double>;

Placement placement(const Pose& X) {
  Placement out;
  store_se3(X, out.data());
  return out;
}

// Motion of a joint's frame by its coordinate.
Pose joint_motion(const MjcfJoint& j, double q) {
  Pose X = Pose::identity();
  if (j.spec.type == DYN_JOINT_TYPE_REVOLUTE) X.R = exp3(j.axis * q);
  if (j.spec.type == DYN_JOINT_TYPE_PRISMATIC) X.p = j.axis * q;
  return X;
}

void name_joints(MjcfBody& body) {
  const size_t n = body.joints.size();
  for (size_t k = 0; k < n; ++k)
    if (std::string& name = body.joints[k].spec.name; name.empty()) name = body.name + "_joint" + (n > 1 ? std::to_string(k) : "");
}

// The parent of a body's links, shapes and frames, and the body's pose in it.
struct Attachment {
  Parent parent;
  Pose X;
};

Attachment add_joints(Builder& builder, const MjcfRobot& robot, MjcfBody& body) {
  Parent on = body.parent == 0 ? Parent{"", 0} : Parent{robot.bodies[size_t(body.parent)].name, DYN_FRAME_TYPE_BODY};
  Pose X = body.X;  // of the body at the initial configuration, in the parent of the next joint
  for (MjcfJoint& j : body.joints) {
    if (j.spec.type == DYN_JOINT_TYPE_FREE_FLYER) {
      X = Pose::identity();  // its coordinates are the body's pose in the world
    } else {
      X.p += X.R * j.anchor;
      X = X * joint_motion(j, -j.reference);
      j.spec.axis = {j.axis[0], j.axis[1], j.axis[2]};
    }
    j.spec.parent = on;
    j.spec.placement = placement(X);
    with_location(j.place, [&] { builder.joint(j.spec); });
    on = {j.spec.name, DYN_FRAME_TYPE_JOINT};
    X = {Mat3<double>::identity(), -j.anchor};
  }
  return {on, X};
}

void add_body(Builder& builder, const MjcfRobot& robot, MjcfBody& body, const MjcfMass& mass) {
  name_joints(body);
  const Attachment attachment = add_joints(builder, robot, body);
  std::array<double, 9> inertia;
  store33(mass.inertia.full(), inertia.data());
  with_location(body.place, [&] {
    builder.body(body.name, attachment.parent, placement(attachment.X), mass.mass, {mass.com[0], mass.com[1], mass.com[2]}, inertia);
    if (body.compensation != 0) builder.gravity_compensation(body.name, body.compensation);
  });
}

// joints: names that sites must not have, because both are frames.
void add_shapes_and_sites(Builder& builder, MjcfBody& body, PairFilter filter, bool world, const std::set<std::string>& joints) {
  for (MjcfGeom& g : body.geoms) {
    if (g.shape.type == DYN_SHAPE_TYPE_HALF_SPACE && g.shape.role == DYN_SHAPE_ROLE_VISUAL) continue;  // a visual plane has no extent to draw
    g.shape.body = world ? "universe" : body.name;
    g.shape.placement = placement(g.X), g.shape.filter = filter;
    with_location(g.place, [&] { builder.shape(g.shape); });
  }
  for (MjcfSite& s : body.sites) {
    if (joints.count(s.name)) {
      s.place.info("the frame is called " + load::quoted(s.name + "_site"));
      s.name += "_site";
    }
    with_location(s.place, [&] { builder.frame(s.name, world ? Parent{"", 0} : Parent{body.name, DYN_FRAME_TYPE_BODY}, placement(s.X), DYN_FRAME_TYPE_OP_FRAME); });
  }
}

// A joint's coordinates from MuJoCo's, where quaternions are (w, x, y, z), and a zero one is the identity.
std::vector<double> coordinates(const MjcfJoint& j, const double* qpos) {
  const size_t nq = size_t(joint_nq(j.spec.type));
  std::vector<double> q(qpos, qpos + nq);
  if (nq >= 4) q.insert(q.end(), q[nq - 4]), q.erase(q.end() - 5);
  if (nq >= 4 && std::all_of(q.end() - 4, q.end(), [](double x) { return x == 0; })) q.back() = 1;
  return q;
}

// Adds the initial configuration as the first key if it is not the neutral one.
void add_initial_key(MjcfRobot& robot) {
  bool needs_key = false;
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) needs_key = needs_key || j.reference != 0 || j.spec.type == DYN_JOINT_TYPE_FREE_FLYER;
  if (!needs_key) return;
  MjcfKey qpos0{robot.bodies[0].place, "qpos0", {}};
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) {
      const size_t n = size_t(joint_nq(j.spec.type));
      if (n == 1) {
        qpos0.qpos.push_back(j.reference);
        continue;
      }
      const Pose& X = body.X;
      if (n == 7) qpos0.qpos.insert(qpos0.qpos.end(), {X.p[0], X.p[1], X.p[2]});
      const Quaternion<double> u = n == 7 ? quaternion(X.R) : Quaternion<double>::identity();
      qpos0.qpos.insert(qpos0.qpos.end(), {u.w, u.v[0], u.v[1], u.v[2]});
    }
  robot.keys.insert(robot.keys.begin(), qpos0);
}

void add_configurations(Builder& builder, const MjcfRobot& robot) {
  size_t nq = 0;
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) nq += size_t(joint_nq(j.spec.type));
  for (const MjcfKey& key : robot.keys) {
    if (key.qpos.size() != nq)
      key.place.fail(DYN_ERROR_SIZE, "qpos has " + std::to_string(key.qpos.size()) + " numbers, and the model's configurations have " + std::to_string(nq));
    std::vector<std::pair<std::string, std::vector<double>>> joints;
    const double* q = key.qpos.data();
    for (const MjcfBody& body : robot.bodies)
      for (const MjcfJoint& j : body.joints) joints.emplace_back(j.spec.name, coordinates(j, q)), q += joint_nq(j.spec.type);
    with_location(key.place, [&] { builder.configuration_of_joints(key.name, joints); });
  }
}

void check_body(const MjcfRobot& robot, const MjcfPlace& place, const std::string& name) {
  std::vector<const std::string*> names;
  for (const MjcfBody& b : robot.bodies) {
    if (b.name == name) return;
    names.push_back(&b.name);
  }
  place.fail(DYN_ERROR_NAME, "there is no body " + load::quoted(name) + did_you_mean(name, names));
}

// Adds bodies, joints and configurations only.
void add_mechanism(Builder& builder, MjcfRobot& robot, const std::vector<MjcfMass>& masses) {
  for (size_t i = 1; i < robot.bodies.size(); ++i) add_body(builder, robot, robot.bodies[i], masses[i]);
  add_configurations(builder, robot);
}

std::string universe(const std::string& body) { return body == "world" ? "universe" : body; }

}  // namespace

ModelPtr build_mjcf(MjcfRobot& robot, MjcfSource& source, const LoadOptions& options) {
  const std::vector<MjcfMass> masses = mjcf_masses(robot);
  const MjcfPlace file{robot.bodies[0].place.report, 0, ""};
  add_initial_key(robot);
  if (has_springdampers(robot)) {
    Builder bodies_only(robot.name);
    add_mechanism(bodies_only, robot, masses);
    compute_mjcf_springs(*with_location(file, [&] { return bodies_only.finish(); }), robot);
  }
  Builder builder(robot.name);
  with_location(file, [&] { builder.gravity(robot.gravity), builder.constraint_slots(options.constraint_slots), builder.contact_capacity(options.contact_capacity), builder.medium(robot.density, robot.viscosity, robot.wind); });
  mark_mjcf_pairs(robot), limit_mjcf_actuators(robot);
  add_mechanism(builder, robot, masses);
  std::set<std::string> joints;
  for (const MjcfBody& body : robot.bodies)
    for (const MjcfJoint& j : body.joints) joints.insert(j.spec.name);
  for (size_t i = 0; i < robot.bodies.size(); ++i) add_shapes_and_sites(builder, robot.bodies[i], robot.filter, i == 0, joints);
  for (const MjcfExclude& x : robot.excludes) {
    for (const std::string& name : x.bodies) check_body(robot, x.place, name);
    with_location(x.place, [&] { builder.disabled_pair(universe(x.bodies[0]), universe(x.bodies[1]), "exclude"); });
  }
  if (damped_by_ratio(robot)) compute_mjcf_damping(*with_location(file, [&] { return builder.finish(); }), robot);
  add_mjcf_actuators(builder, robot), add_mjcf_equalities(builder, robot), add_mjcf_pairs(builder, robot);
  for (const Report::Entry& e : source.finish()) builder.report(e.level, e.line, e.message);
  return with_location(file, [&] { return builder.finish(); });
}

}  // namespace dyn::load
