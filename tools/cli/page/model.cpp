// The robot as a page draws it.
#include <algorithm>
#include <map>

#include "chain.hpp"
#include "page.hpp"
#include "surface.hpp"

namespace cli::page {

namespace {

constexpr std::size_t mesh_bytes = 650'000;  // of all meshes of a page

dynShapeInfo shape(const Robot& robot, int k) {
  dynShapeInfo s{};
  s.struct_size = sizeof s;
  check(dyn_model_shape_info(robot, k, &s));
  return s;
}

// Surfaces of the robot's shapes, each file once at each scale.
class Meshes {
 public:
  Meshes(const Robot& robot, const std::vector<std::string>& package_dirs) : robot_(robot) {
    for (const auto& d : package_dirs) dirs_.push_back(d.c_str());
  }
  // Its index, or -1 for a shape that has none.
  int add(int k, const dynShapeInfo& s, json& notes) {
    std::string key = s.type == DYN_SHAPE_TYPE_MESH ? s.mesh : "shape " + std::to_string(k);
    for (const double x : s.size) key += " " + short_number(x);
    if (const auto found = known_.find(key); found != known_.end()) return found->second;
    dynMesh* made = nullptr;
    const dynStatus status = s.type == DYN_SHAPE_TYPE_MESH ? load(s, &made) : dyn_model_shape_mesh(robot_, k, &made);
    const std::unique_ptr<dynMesh, Deleter<dyn_mesh_free>> owner(made);
    if (status != DYN_OK) {
      notes.push_back("link " + std::string(dyn_model_frame_name(robot_, s.frame)) +
                      " is not drawn with its mesh: " + dyn_last_error());
      return known_[key] = -1;
    }
    surfaces_.push_back(surface_of(made));
    return known_[key] = static_cast<int>(surfaces_.size()) - 1;
  }
  json packed(Pack& pack, json& notes) const {
    std::size_t all = 0;
    for (const Surface& s : surfaces_) all += s.bytes();
    if (all > mesh_bytes) notes.push_back("meshes of " + short_number(all / 1e6, 2) + " MB are drawn with fewer triangles");
    json out = json::array();
    for (const Surface& s : surfaces_) {
      const auto share = static_cast<std::size_t>(double(mesh_bytes) * double(s.bytes()) / double(all));
      out.push_back(page::packed(all > mesh_bytes ? simplified(s, share) : s, pack));
    }
    return out;
  }

 private:
  dynStatus load(const dynShapeInfo& s, dynMesh** made) const {
    dynMeshOptions options;
    dyn_mesh_options_init(&options);
    std::copy(s.size, s.size + 3, options.scale);
    options.package_dirs = dirs_.empty() ? nullptr : dirs_.data(), options.package_dirs_count = dirs_.size();
    return dyn_mesh_load(s.mesh, &options, made);
  }
  const Robot& robot_;
  std::vector<const char*> dirs_;
  std::map<std::string, int> known_;
  std::vector<Surface> surfaces_;
};

json joint_json(const Robot& robot, int id) {
  const dynJointInfo j = robot.joint(id);
  json out = {{"name", j.name},
              {"type", id == 0 ? "universe" : joint_type_name(j.type)},
              {"parent", j.parent},
              {"placement", vector_json(j.placement, 12)},
              {"axis", vector_json(j.axis, 3)},
              {"axis2", vector_json(j.axis2, 3)},
              {"pitch", j.pitch},
              {"q", j.idx_q},
              {"nq", j.nq},
              {"v", j.idx_v},
              {"nv", j.nv}};
  dynJointTypeInfo type{};
  type.struct_size = sizeof type;
  check(dyn_joint_type_info(j.type, &type));
  out["motions"] = type.chain;
  if (j.mimic_leader >= 0) out["mimic"] = {{"leader", j.mimic_leader}, {"ratio", j.mimic_ratio}, {"offset", j.mimic_offset}};
  if (j.type == DYN_JOINT_TYPE_COMPOSITE && j.mimic_leader < 0) out["chain"] = chain_json(robot, j);
  out["lower"] = vector_json(dyn_model_array(robot, DYN_MODEL_ARRAY_LOWER_LIMIT) + j.idx_q, j.nq);
  out["upper"] = vector_json(dyn_model_array(robot, DYN_MODEL_ARRAY_UPPER_LIMIT) + j.idx_q, j.nq);
  return out;
}

}  // namespace

json model_json(const Robot& robot, const std::vector<std::string>& package_dirs, Pack& pack, json& notes) {
  json out = {{"name", dyn_model_name(robot)},
              {"nq", robot.nq},
              {"nv", robot.nv},
              {"mass", dyn_model_total_mass(robot)},
              {"gravity", vector_json(dyn_model_array(robot, DYN_MODEL_ARRAY_GRAVITY), 3)}};
  out["joints"] = json::array(), out["frames"] = json::array(), out["shapes"] = json::array();
  for (int j = 0; j < robot.njoints; ++j) out["joints"].push_back(joint_json(robot, j));
  for (int f = 0; f < robot.nframes; ++f) {
    const dynFrameInfo frame = robot.frame(f);
    json item = {{"name", frame.name},
                 {"type", frame_type_name(frame.type)},
                 {"joint", frame.joint},
                 {"placement", vector_json(frame.placement, 12)}};
    if (frame.mass > 0)
      item["mass"] = frame.mass, item["com"] = vector_json(frame.com, 3), item["inertia"] = vector_json(frame.inertia, 9);
    out["frames"].push_back(std::move(item));
  }
  Meshes meshes(robot, package_dirs);
  bool visual = false, collision = false;
  for (int k = 0; k < dyn_model_nshapes(robot); ++k) {
    const dynShapeInfo s = shape(robot, k);
    const bool drawn = s.role == DYN_SHAPE_ROLE_VISUAL;
    json item = {{"name", s.name},    {"type", shape_type_name(s.type)},           {"visual", drawn},
                 {"frame", s.frame},  {"placement", vector_json(s.placement, 12)}, {"size", vector_json(s.size, 3)},
                 {"radius", s.radius}};
    Vector rgba(4);
    check(dyn_model_shape_rgba(robot, k, rgba.data()));
    if (rgba[3] >= 0) item["rgba"] = rgba;
    if (s.type == DYN_SHAPE_TYPE_MESH || s.type == DYN_SHAPE_TYPE_CONVEX || s.type == DYN_SHAPE_TYPE_TRIANGLES ||
        s.type == DYN_SHAPE_TYPE_HEIGHT_FIELD) {
      const int mesh = meshes.add(k, s, notes);
      if (mesh >= 0) item["mesh"] = mesh;
      else item["missing"] = true;
    }
    if (!item.contains("missing") && s.type != DYN_SHAPE_TYPE_HALF_SPACE) (drawn ? visual : collision) = true;
    out["shapes"].push_back(std::move(item));
  }
  out["meshes"] = meshes.packed(pack, notes);
  if (!visual)
    notes.push_back(collision ? "there are no visual shapes to draw: collision shapes are drawn instead"
                              : "there are no shapes to draw: links are lines from joint to joint");
  return out;
}

}  // namespace cli::page
