// Collision shapes of a robot's meshes: dynMeshUse.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "collision_mesh.hpp"
#include "report.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

void read_collision_meshes(UrdfRobot& robot, Report& report, const LoadOptions& options) {
  if (options.meshes == DYN_MESH_USE_NONE) return;
  std::map<std::pair<std::string, std::array<double, 3>>, CollisionMesh> known;  // without a surface: there is none, with the reason
  for (UrdfLink& link : robot.links)
    for (UrdfShape& s : link.shapes) {
      Shape& shape = s.shape;
      if (shape.type != DYN_SHAPE_TYPE_MESH || shape.role != DYN_SHAPE_ROLE_COLLISION) continue;
      if (options.meshes == DYN_MESH_USE_AUTO && !std::filesystem::exists(shape.mesh)) continue;  // the reader has said so
      const std::string who = "link " + load::quoted(link.name) + ": mesh " + load::quoted(shape.mesh);
      auto at = known.find({shape.mesh, shape.size});
      if (at == known.end()) {
        CollisionMesh made{nullptr, true, ""};
        bool read = false;
        try {
          meshes::MeshOptions how;
          how.scale = shape.size, how.package_dirs = options.package_dirs, how.confined = Confined(report.file(), options);
          if (!std::filesystem::exists(shape.mesh)) how.relative_to = report.file();  // so that messages list the paths tried
          const meshes::Mesh mesh = meshes::read_mesh(shape.mesh, how);
          read = true;
          made = collision_mesh_of(mesh, options.meshes);
        } catch (const Error& e) {
          if (!read && options.meshes != DYN_MESH_USE_AUTO) report.fail(e.status, s.line, who + ": " + e.what());
          made.message = ": " + std::string(e.what()) + not_tested;
        }
        at = known.emplace(std::pair(shape.mesh, shape.size), std::move(made)).first;
      }
      if (!at->second.surface) {
        report.physics(s.line, who + at->second.message);
        continue;
      }
      if (at->second.warning) report.warning(s.line, who + at->second.message);
      else if (!at->second.message.empty()) report.info(s.line, who + at->second.message);
      shape.type = collision_type_of(options.meshes);
      shape.surface = at->second.surface;
    }
}

}  // namespace dyn::load
