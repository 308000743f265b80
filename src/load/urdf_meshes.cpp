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
  std::map<std::pair<std::string, std::array<double, 3>>, CollisionMesh> known;
  for (UrdfLink& link : robot.links)
    for (UrdfShape& s : link.shapes) {
      Shape& shape = s.shape;
      if (shape.type != DYN_SHAPE_TYPE_MESH || shape.role != DYN_SHAPE_ROLE_COLLISION) continue;
      const std::string who = "link " + load::quoted(link.name) + ": mesh " + load::quoted(shape.mesh);
      auto at = known.find({shape.mesh, shape.size});
      if (at == known.end()) {
        try {
          meshes::MeshOptions how;
          how.scale = shape.size, how.package_dirs = options.package_dirs, how.confined = Confined(report.file(), options);
          if (!std::filesystem::exists(shape.mesh)) how.relative_to = report.file();  // so that messages list the paths tried
          const meshes::Mesh mesh = meshes::read_mesh(shape.mesh, how);
          at = known.emplace(std::pair(shape.mesh, shape.size), collision_mesh_of(mesh, options.meshes)).first;
        } catch (const Error& e) {
          report.fail(e.status, s.line, who + ": " + e.what());
        }
      }
      if (at->second.warning) report.warning(s.line, who + at->second.message);
      else report.info(s.line, who + at->second.message);
      shape.type = options.meshes == DYN_MESH_USE_HULL ? DYN_SHAPE_TYPE_CONVEX : DYN_SHAPE_TYPE_TRIANGLES;
      shape.surface = at->second.surface;
    }
}

}  // namespace dyn::load
