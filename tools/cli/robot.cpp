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
  command.add_option("FILE", options.file, "The robot: a URDF, MJCF or .dynb file")->required();
  auto* fixed = command.add_flag("--fixed", options.fixed, "The root link is welded to the world");
  auto* floating = command.add_flag("--floating", options.floating, "A free flyer carries the root link");
  fixed->excludes(floating);
  command.add_option("--package-dir", options.package_dirs, "Folder to search for package://NAME/...; may be repeated")
      ->allow_extra_args(false)
      ->check(not_empty)
      ->type_name("DIR");
  command.add_option("--srdf", options.srdf, "An SRDF for this robot: named configurations, disabled pairs")
      ->check(not_empty)
      ->type_name("FILE");
  command
      .add_option("--collision-meshes", options.meshes,
                  "Shapes for collision meshes: none, hull, triangles, or auto, hulls of those that can be read")
      ->check(CLI::IsMember(names_of("dynMeshUse")))
      ->type_name(join(names_of("dynMeshUse"), "|"))
      ->capture_default_str();
  command
      .add_option("--contact-capacity", options.contact_capacity,
                  "Contact points that a step can hold (the deepest stay); 0: by the number of shapes")
      ->check(whole)
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  const auto limit = [&](const char* name, auto& to, const char* what) {
    command.add_option(name, to, what)->check(decimal)->check(CLI::NonNegativeNumber);
  };
  limit("--max-bodies", options.max_bodies, "Refuse a file with more links, or more joints; default 200000");
  limit("--max-shapes", options.max_shapes, "Refuse a file with more shapes; default 200000");
  limit("--max-constraint-rows", options.max_constraint_rows, "Refuse a file with more rows of constraints; default 6000");
  limit("--max-keys", options.max_keys, "Refuse a file with more named configurations; default 10000");
  limit("--max-bytes", options.max_bytes, "Refuse a file that takes more memory, by estimate; default 2^30");
  limit("--max-seconds", options.max_seconds, "Refuse a file that takes more processor time to load; default: no limit");
  command.add_flag("--strict", options.strict, "Refuse a file with physics that would be dropped");
  command.add_flag("--confined", options.confined, "Refuse included files and meshes outside of FILE's folder and --package-dir");
  command.add_flag("--cos-sin", options.cos_sin, "Store continuous joints as (cos, sin)");
  command.add_flag("--json", options.json, "Print JSON");
}

Robot::Robot(const RobotOptions& options, int contacts) {
  std::vector<const char*> folders;
  for (const auto& f : options.package_dirs) folders.push_back(f.c_str());
  dynLoadOptions load;
  dyn_load_options_init(&load);
  load.base = options.fixed ? DYN_BASE_FIXED : options.floating ? DYN_BASE_FLOATING : DYN_BASE_UNSPECIFIED;
  load.strict = options.strict;
  load.constraint_slots = std::max(load.constraint_slots, contacts);
  load.contact_capacity = options.contact_capacity;
  load.cos_sin = options.cos_sin;
  load.confined = options.confined;
  load.max_bodies = options.max_bodies, load.max_shapes = options.max_shapes;
  load.max_constraint_rows = options.max_constraint_rows, load.max_keys = options.max_keys;
  load.max_bytes = options.max_bytes, load.max_seconds = options.max_seconds;
  if (!folders.empty()) load.package_dirs = folders.data();
  load.package_dirs_count = folders.size();
  load.meshes = static_cast<dynMeshUse>(value_of("dynMeshUse", "--collision-meshes", options.meshes));
  if (!options.srdf.empty()) load.srdf = options.srdf.c_str();
  dynModel* model = nullptr;
  const dynStatus status = dyn_model_load(options.file.c_str(), &load, &model);
  check(status);
  *this = Robot(model);
}

Robot::Robot(dynModel* model) {
  handle.reset(model);
  nq = dyn_model_nq(model);
  nv = dyn_model_nv(model);
  njoints = dyn_model_njoints(model);
  nframes = dyn_model_nframes(model);
  for (int i = 1; i < njoints; ++i) has_mimic |= joint(i).mimic_leader >= 0;
}

void Robot::add_ground() {
  dynBuilder* made = nullptr;
  check(dyn_builder_from_model(*this, &made));
  const std::unique_ptr<dynBuilder, Deleter<dyn_builder_free>> builder(made);
  dynShapeSpec ground;
  dyn_shape_spec_init(&ground);
  ground.type = DYN_SHAPE_TYPE_HALF_SPACE, ground.name = "ground", ground.material.friction = 0;
  check(dyn_builder_add_shape(made, &ground));
  dynModel* model = nullptr;
  check(dyn_builder_finish(made, &model));
  handle.reset(model);
}

dynJointInfo Robot::joint(int id) const {
  dynJointInfo info{};
  info.struct_size = sizeof info;
  check(dyn_model_joint_info(*this, id, &info));
  return info;
}

dynFrameInfo Robot::frame(int id) const {
  dynFrameInfo info{};
  info.struct_size = sizeof info;
  check(dyn_model_frame_info(*this, id, &info));
  return info;
}

Vector Robot::neutral() const {
  Vector q(nq);
  check(dyn_configuration_neutral(*this, q.data()));
  return q;
}

dynParts Robot::forward_parts() const { return DYN_PART_KINEMATICS | DYN_PART_FORWARD | (has_mimic ? DYN_PART_CHOLESKY : 0); }

Data::Data(const Robot& robot, dynParts parts, std::uint32_t effects) {
  dynData* data = nullptr;
  check(dyn_data_new(robot, parts, &data));
  handle.reset(data);
  apply_effects(robot, data, effects);
}

Vector field(const Robot& robot, const Data& data, const char* name) {
  dynArray array{};
  array.struct_size = sizeof array;
  const dynField id = dyn_field_id(name);
  if (id < 0) fail(library_error());
  check(dyn_data_array(robot, data, id, &array));
  Vector out;
  for (int j = 0; j < array.cols; ++j)
    for (int i = 0; i < array.rows; ++i) out.push_back(array.data[i * array.stride[0] + j * array.stride[1]]);
  return out;
}

}  // namespace cli
