// URDF to model: read, check, compare with urdfdom, build.
#include "budget.hpp"
#include "srdf.hpp"
#include "urdf_robot.hpp"

namespace dyn {

namespace {

using namespace load;

// Adds the file's line to errors of the builder.
template <class Call>
auto with_location(const Report& report, int line, const Call& call) {
  try {
    return call();
  } catch (const Error& e) {
    report.fail(e.status, line, e.what());
  }
}

void add_link(Builder& builder, const UrdfLink& link, const Parent& parent, PairFilter filter, const Report& report) {
  with_location(report, link.inertial_line ? link.inertial_line : link.line,
          [&] { builder.body(link.name, parent, identity_placement, link.mass, link.com, link.inertia); });
  for (UrdfShape s : link.shapes) {
    s.shape.filter = filter;
    with_location(report, s.line, [&] { builder.shape(s.shape); });
  }
}

}  // namespace

ModelPtr load_urdf(const std::string& text, const std::string& file, const LoadOptions& options) {
  Report report(file, options.strict);
  const std::int64_t bytes = check_xml(text, report);
  if (options.budget) options.budget->add_bytes(bytes, report, 0);
  UrdfRobot robot = read_urdf(Document(text, report).root(), report, options);
  const UrdfTree tree = check_tree(robot, report);
  check_mimic(robot, report);
  const bool floating = floating_base(robot, tree, options.base, report);
  for (UrdfLink& link : robot.links) check_inertia(link, report);
  check_welded_inertia(robot, tree, !floating, report);
  if (options.strict) check_moving_mass(robot, tree, report);  // otherwise the builder warns
  report_unused_data(robot, report);
  compare_with_urdfdom(text, robot, tree, report);
  read_collision_meshes(robot, report, options);
  auto entries = report.finish();
  const Srdf srdf = options.srdf.empty() ? Srdf() : load_srdf(options, robot, tree, floating, entries);

  Builder builder(robot.name);
  with_location(report, 0, [&] {
    builder.gravity(options.gravity), builder.constraint_slots(options.constraint_slots),
        builder.contact_capacity(options.contact_capacity);
  });
  if (!options.strict) builder.allow_massless_joints();
  Parent base;
  if (floating) {
    JointSpec free;
    free.name = "root_joint";
    free.type = DYN_JOINT_TYPE_FREE_FLYER;
    with_location(report, robot.links[tree.root].line, [&] { builder.joint(free); });
    base = {free.name, DYN_FRAME_TYPE_JOINT};
  }
  const PairFilter filter = srdf.pairs.empty() ? PairFilter::Guess : PairFilter::Parents;
  add_link(builder, robot.links[tree.root], base, filter, report);
  for (int i : tree.order) {
    UrdfJoint& joint = robot.joints[i];
    joint.spec.parent = {joint.parent, DYN_FRAME_TYPE_BODY};
    with_location(report, joint.line, [&] { builder.joint(joint.spec); });
    add_link(builder, robot.links[tree.child[i]], {joint.spec.name, DYN_FRAME_TYPE_JOINT | DYN_FRAME_TYPE_FIXED_JOINT}, filter,
             report);
  }
  for (const UrdfConstraint& c : robot.constraints)
    with_location(report, c.line, [&] { builder.constraint(c.name, c.spec, {c.first, 0}, {c.second, 0}); });
  for (const Srdf::State& s : srdf.states)
    with_location(Report(options.srdf, false), s.line, [&] { builder.configuration_of_joints(s.name, s.joints); });
  for (const Srdf::Pair& p : srdf.pairs) builder.disabled_pair(p.link1, p.link2, p.reason);
  for (const Report::Entry& e : entries) builder.report(e.level, e.line, e.message);
  return with_location(report, 0, [&] { return builder.finish(); });
}

}  // namespace dyn
