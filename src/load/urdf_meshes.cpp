// Collision shapes of a robot's meshes: dynMeshUse.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "collision_mesh.hpp"
#include "report.hpp"
#include "urdf_robot.hpp"
#include "system.hpp"

namespace dyn::load {

void read_collision_meshes(UrdfRobot& robot, Report& report, const LoadOptions& options) {
  if (options.meshes == DYN_MESH_USE_NONE) return;
  std::map<std::pair<std::string, std::array<double, 3>>, CollisionMesh> known;  // without a surface: cannot be read
  for (UrdfLink& link : robot.links)
    for (UrdfShape& s : link.shapes) {
      Shape& shape = s.shape;
      if (shape.type != DYN_SHAPE_TYPE_MESH || shape.role != DYN_SHAPE_ROLE_COLLISION) continue;
      const bool found = std::filesystem::exists(utf8_path(shape.mesh));
      if (!found && options.meshes == DYN_MESH_USE_AUTO) continue;  // reported with the link
      const std::string who = "link " + load::in_quotes(link.name) + ": mesh " + load::in_quotes(shape.mesh);
      auto at = known.find({shape.mesh, shape.size});
      if (at == known.end()) {
        CollisionMesh collision;
        try {
          meshes::MeshOptions how;
          how.scale = shape.size, how.package_dirs = options.package_dirs, how.confined = Confined(report.file(), options);
          how.budget = options.budget;
          if (!found) how.relative_to = report.file();  // so that messages list the paths tried
          collision = collision_mesh_of(meshes::read_mesh(shape.mesh, how), options.meshes);
        } catch (const Error& e) {
          if (options.meshes != DYN_MESH_USE_AUTO) report.fail(e.status, s.line, who + ": " + e.what());
          collision.message = std::string(" is left out of collisions: ") + e.what();
        }
        at = known.emplace(std::pair(shape.mesh, shape.size), collision).first;
      }
      if (!at->second.surface) {
        report.physics(s.line, who + at->second.message);
        continue;
      }
      if (at->second.warning) report.warning(s.line, who + at->second.message);
      else report.info(s.line, who + at->second.message);
      shape.type = at->second.type;
      shape.surface = at->second.surface;
    }
}

}  // namespace dyn::load
