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
    if (std::string& name = body.joints[k].spec.name; name.empty())
      name = body.name + "_joint" + (n > 1 ? std::to_string(k) : "");
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
  const Attachment attachment = add_joints(builder, robot, body);
  std::array<double, 9> inertia;
  store33(mass.inertia.full(), inertia.data());
  with_location(body.place, [&] {
    builder.body(body.name, attachment.parent, placement(attachment.X), mass.mass, {mass.com[0], mass.com[1], mass.com[2]},
                 inertia);
    if (body.compensation != 0) builder.gravity_compensation(body.name, body.compensation);
    if (body.mocap) builder.mocap(body.name);
  });
}

void add_shapes(Builder& builder, MjcfBody& body, const MjcfRobot& robot, bool world) {
  for (MjcfGeom& g : body.geoms) {
    if (g.discarded || (g.shape.type == DYN_SHAPE_TYPE_HALF_SPACE && g.shape.role == DYN_SHAPE_ROLE_VISUAL))
      continue;  // a visual plane has no extent to draw
    g.shape.body = world ? "universe" : body.name;
    g.shape.placement = placement(g.X), g.shape.filter = robot.filter;
    if (g.shape.role == DYN_SHAPE_ROLE_COLLISION && g.shape.type != DYN_SHAPE_TYPE_MESH) g.shape.radius = g.margin;
    if (!robot.contacts) g.shape.contype = g.shape.conaffinity = 0;
    with_location(g.place, [&] {
      builder.shape(g.shape);
      if (g.fluid) builder.fluid(*g.fluid, g.fluid->semiaxes[0] > 0 ? std::optional(g.fluid->placement) : std::nullopt);
    });
  }
}

// Sites, and wrapped geoms.
void add_frames(Builder& builder, const MjcfRobot& robot) {
  for (const MjcfBody& body : robot.bodies) {
    const Parent parent = body.parent < 0 ? Parent{"", 0} : Parent{body.name, DYN_FRAME_TYPE_BODY};
    const auto add = [&](const MjcfPlace& place, const std::string& name, const Pose& X) {
      with_location(place, [&] { builder.frame(name, parent, placement(X), DYN_FRAME_TYPE_OP_FRAME); });
    };
    for (const MjcfSite& s : body.sites) add(s.place, s.frame, s.X);
    for (const MjcfGeom& g : body.geoms)
      if (g.wrapped && !g.has_site) add(g.place, g.frame, g.X);
  }
}

void check_body(const MjcfRobot& robot, const MjcfPlace& place, const std::string& name) {
  if (find_body(robot, name)) return;
  std::vector<const std::string*> names;
  for (const MjcfBody& b : robot.bodies) names.push_back(&b.name);
  place.fail(DYN_ERROR_NAME, "there is no body " + load::in_quotes(name) + did_you_mean(name, names));
}

// Adds bodies, joints and the initial configuration only.
void add_mechanism(Builder& builder, MjcfRobot& robot, const std::vector<MjcfMass>& masses) {
  for (size_t i = 1; i < robot.bodies.size(); ++i) add_body(builder, robot, robot.bodies[i], masses[i]);
  add_mjcf_initial_configuration(builder, robot);
}

std::string universe(const std::string& body) { return body == "world" ? "universe" : body; }

}  // namespace

ModelPtr build_mjcf(MjcfRobot& robot, MjcfSource& source, const LoadOptions& options) {
  const std::vector<MjcfMass> masses = mjcf_masses(robot);
  const MjcfPlace file{robot.bodies[0].place.report, 0, ""};
  const bool massless = robot.lost_mass && !options.strict;
  for (MjcfBody& body : robot.bodies) name_joints(body);
  robot.names.reset();
  name_mjcf_frames(robot);
  if (has_springdampers(robot)) {
    Builder bodies_only(robot.name);
    add_mechanism(bodies_only, robot, masses);
    compute_mjcf_springs(*with_location(file, [&] { return bodies_only.finish(); }), robot);
  }
  override_mjcf_contacts(robot), mark_mjcf_pairs(robot), set_mjcf_priorities(robot), limit_mjcf_actuators(robot);
  if (has_measured_actuators(robot)) {
    Builder motors_only(robot.name);
    if (massless) motors_only.allow_massless_joints();
    add_mechanism(motors_only, robot, masses), add_frames(motors_only, robot), add_mjcf_tendons(motors_only, robot),
        add_mjcf_motors(motors_only, robot);
    measure_mjcf_actuators(*with_location(file, [&] { return motors_only.finish(); }), robot);
  }
  Builder builder(robot.name);
  with_location(file, [&] {
    builder.gravity(robot.gravity), builder.constraint_slots(options.constraint_slots),
        builder.contact_capacity(options.contact_capacity), builder.medium(robot.density, robot.viscosity, robot.wind),
        builder.stepping(robot.timestep, robot.integrator, robot.effects);
    builder.compliant(robot.impratio, robot.pyramidal);
    if (massless) builder.allow_massless_joints();
  });
  add_mechanism(builder, robot, masses), add_frames(builder, robot);
  for (size_t i = 0; i < robot.bodies.size(); ++i) add_shapes(builder, robot.bodies[i], robot, i == 0);
  for (const MjcfExclude& x : robot.excludes) {
    if (robot.has_lost(x.bodies[0]) || robot.has_lost(x.bodies[1])) continue;
    for (const std::string& name : x.bodies) check_body(robot, x.place, name);
    with_location(x.place, [&] { builder.disabled_pair(universe(x.bodies[0]), universe(x.bodies[1]), "exclude"); });
  }
  add_mjcf_tendons(builder, robot);
  add_mjcf_actuators(builder, robot), add_mjcf_sensors(builder, robot, masses), add_mjcf_keys(builder, robot), add_mjcf_equalities(builder, robot),
      add_mjcf_pairs(builder, robot);
  for (const Report::Entry& e : source.finish()) builder.report(e.level, e.line, e.message);
  return with_location(file, [&] { return builder.finish(); });
}

}  // namespace dyn::load
