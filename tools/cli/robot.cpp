// Loading a robot, and what the subcommands ask of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include "cli.hpp"

namespace cli {

void add_robot_options(CLI::App& command, RobotOptions& options) {
  command.add_option("FILE", options.file, "The robot: a URDF or MJCF file")->required();
  auto* fixed = command.add_flag("--fixed", options.fixed, "The root link is welded to the world");
  auto* floating = command.add_flag("--floating", options.floating, "A free flyer carries the root link");
  fixed->excludes(floating);
  command.add_option("--package-dir", options.package_dirs, "Where package://NAME/... is looked up; may be repeated")
      ->allow_extra_args(false)
      ->check(not_empty)
      ->type_name("DIR");
  command.add_option("--srdf", options.srdf, "An SRDF for this robot: named configurations, disabled pairs")->check(not_empty)->type_name("FILE");
  command.add_option("--collision-meshes", options.meshes, "What stands for collision meshes: nothing, their convex hulls, or their triangles")
      ->check(CLI::IsMember({"none", "hull", "triangles"}))
      ->type_name("none|hull|triangles")
      ->capture_default_str();
  command.add_flag("--strict", options.strict, "Physics that would be dropped is an error");
  command.add_flag("--cos-sin", options.cos_sin, "Continuous joints store (cos, sin)");
  command.add_flag("--json", options.json, "Answer in JSON");
}

Robot::Robot(const RobotOptions& options, int contacts) {
  std::vector<const char*> folders;
  for (const auto& f : options.package_dirs) folders.push_back(f.c_str());
  dynLoadOptions load;
  dyn_load_options_init(&load);
  load.base = options.fixed ? DYN_BASE_FIXED : options.floating ? DYN_BASE_FLOATING : DYN_BASE_UNSPECIFIED;
  load.strict = options.strict;
  load.constraint_slots = std::max(load.constraint_slots, contacts);
  load.cos_sin = options.cos_sin;
  if (!folders.empty()) load.package_dirs = folders.data();
  load.package_dirs_count = folders.size();
  load.meshes = options.meshes == "hull" ? DYN_MESH_HULL : options.meshes == "triangles" ? DYN_MESH_TRIANGLES : DYN_MESH_NONE;
  if (!options.srdf.empty()) load.srdf = options.srdf.c_str();
  dynModel* model = nullptr;
  const dynStatus status = dyn_model_load(options.file.c_str(), &load, &model);
  check(status);
  handle.reset(model);
  nq = dyn_nq(model);
  nv = dyn_nv(model);
  njoints = dyn_njoints(model);
  nframes = dyn_nframes(model);
  for (int i = 1; i < njoints; ++i) has_mimic |= joint(i).mimic_leader >= 0;
}

void Robot::add_ground() {
  dynBuilder* made = nullptr;
  check(dyn_builder_from_model(*this, &made));
  const std::unique_ptr<dynBuilder, Deleter<dyn_builder_free>> builder(made);
  dynShapeSpec ground;
  dyn_shape_spec_init(&ground);
  ground.type = DYN_SHAPE_HALF_SPACE, ground.name = "ground", ground.material.friction = 0;
  check(dyn_builder_shape(made, &ground));
  dynModel* model = nullptr;
  check(dyn_builder_finish(made, &model));
  handle.reset(model);
}

dynJointInfo Robot::joint(int id) const {
  dynJointInfo info{};
  info.struct_size = sizeof info;
  check(dyn_joint_info(*this, id, &info));
  return info;
}

dynFrameInfo Robot::frame(int id) const {
  dynFrameInfo info{};
  info.struct_size = sizeof info;
  check(dyn_frame_info(*this, id, &info));
  return info;
}

Vector Robot::neutral() const {
  Vector q(nq);
  check(dyn_neutral(*this, q.data()));
  return q;
}

dynParts Robot::forward_parts() const { return DYN_PART_KINEMATICS | DYN_PART_FORWARD | (has_mimic ? DYN_PART_FACTOR : 0); }

Data::Data(const Robot& robot, dynParts parts, std::uint32_t effects) {
  dynData* data = nullptr;
  check(dyn_data_new(robot, parts, &data));
  handle.reset(data);
  check(dyn_data_set_effects(robot, data, 0, effects));
}

Vector field(const Robot& robot, const Data& data, const char* name) {
  dynArray array{};
  array.struct_size = sizeof array;
  const dynField id = dyn_field_id(name);
  if (id < 0) fail(dyn_last_error());
  check(dyn_data_array(robot, data, id, &array));
  Vector out;
  for (int j = 0; j < array.cols; ++j)
    for (int i = 0; i < array.rows; ++i) out.push_back(array.data[i * array.stride[0] + j * array.stride[1]]);
  return out;
}

const char* joint_type_name(dynJointType type) {
  static const char* const names[] = {"fixed",       "revolute",   "continuous", "prismatic",         "helical",
                                      "cylindrical", "universal",  "spherical",  "spherical_zyx",     "planar",
                                      "translation", "free_flyer", "composite",  "revolute_unbounded"};
  return type >= 0 && type < static_cast<int>(std::size(names)) ? names[type] : "unknown";
}

const char* frame_type_name(dynFrameType type) {
  switch (type) {
    case DYN_FRAME_OP_FRAME:
      return "OP_FRAME";
    case DYN_FRAME_JOINT:
      return "JOINT";
    case DYN_FRAME_FIXED_JOINT:
      return "FIXED_JOINT";
    case DYN_FRAME_BODY:
      return "BODY";
    case DYN_FRAME_SENSOR:
      return "SENSOR";
  }
  return "unknown";
}

constexpr struct {
  const char* name;
  std::uint32_t bits;
} effect_names[] = {{"armature", DYN_EFFECT_ARMATURE}, {"damping", DYN_EFFECT_DAMPING}, {"springs", DYN_EFFECT_SPRINGS},
                    {"friction", DYN_EFFECT_FRICTION}, {"limits", DYN_EFFECT_LIMITS}, {"all", DYN_EFFECT_ALL}, {"none", 0}};

void add_effects_option(CLI::App& command, std::string& names) {
  command.add_option("--effects", names, "What joints do: armature, damping, springs, friction, limits with commas between, all or none")
      ->check(not_empty)
      ->type_name("LIST")
      ->capture_default_str();
}

std::uint32_t parse_effects(const std::string& names) {
  std::uint32_t bits = 0;
  std::istringstream words(names);
  for (std::string word; std::getline(words, word, ',');) {
    const auto* found = std::find_if(std::begin(effect_names), std::end(effect_names), [&](const auto& e) { return word == e.name; });
    if (found == std::end(effect_names))
      bad_usage("--effects: \"" + shown(word) + "\" is none of armature, damping, springs, friction, limits, all, none.");
    bits |= found->bits;
  }
  return bits;
}

json effects(const Robot& robot, std::uint32_t on) {
  json list = json::array();
  const auto add = [&](const char* name, bool active, const std::string& reason) {
    list.push_back({{"name", name}, {"active", active}, {"reason", reason}});
  };
  const auto count = [&](dynModelArray which, int n, auto&& present) {
    const double* x = dyn_model_array(robot, which);
    return x ? static_cast<int>(std::count_if(x, x + n, present)) : 0;
  };
  const auto nonzero = [](double x) { return x != 0; };
  const auto of_nv = [&](int n) { return std::to_string(n) + " of " + std::to_string(robot.nv) + " degrees of freedom"; };
  const auto of_joints = [&](const char* name, dynModelArray which, std::uint32_t bit, const char* what) {
    const int n = count(which, robot.nv, nonzero);
    add(name, n && on & bit, !n ? std::string("no joint has ") + what : of_nv(n) + " have " + what + (on & bit ? "" : "; switched off"));
  };
  const double* g = dyn_model_array(robot, DYN_GRAVITY);
  const bool falls = g && (g[0] != 0 || g[1] != 0 || g[2] != 0);
  add("gravity", falls,
      falls ? "gravity is (" + short_number(g[0]) + ", " + short_number(g[1]) + ", " + short_number(g[2]) + ") m/s^2"
            : "gravity is zero");
  of_joints("armature", DYN_ARMATURE, DYN_EFFECT_ARMATURE, "armature");
  of_joints("damping", DYN_DAMPING, DYN_EFFECT_DAMPING, "damping");
  of_joints("springs", DYN_STIFFNESS, DYN_EFFECT_SPRINGS, "springs");
  of_joints("friction", DYN_FRICTION, DYN_EFFECT_FRICTION, "dry friction");
  const auto finite = [](double x) { return std::isfinite(x); };
  const int limits = std::max(count(DYN_LOWER_LIMIT, robot.nq, finite), count(DYN_UPPER_LIMIT, robot.nq, finite));
  add("limits", limits && on & DYN_EFFECT_LIMITS,
      limits ? std::to_string(limits) + " of " + std::to_string(robot.nq) + " coordinates have limits" + (on & DYN_EFFECT_LIMITS ? "" : "; switched off")
             : "no joint has limits");
  int tested = 0;
  for (int k = 0, n = dyn_npairs(robot); k < n; ++k) {
    dynPairReason reason;
    check(dyn_pair(robot, k, nullptr, nullptr, &reason));
    tested += reason == DYN_PAIR_TESTED;
  }
  add("contact", tested > 0, tested ? std::to_string(tested) + (tested == 1 ? " pair" : " pairs") + " of shapes may touch" : "no pair of shapes is tested");
  const int constraints = dyn_nconstraints(robot);
  add("constraints", constraints > 0,
      constraints ? "the file has " + std::to_string(constraints) + (constraints == 1 ? " constraint" : " constraints") : "the file has none");
  int followers = 0;
  for (int i = 1; i < robot.njoints; ++i) followers += robot.joint(i).mimic_leader >= 0;
  add("mimic", followers > 0,
      followers ? std::to_string(followers) + (followers == 1 ? " joint follows" : " joints follow") + " another"
                : "no joint follows another");
  return list;
}

}  // namespace cli
