// What stands for the collision meshes of a robot: dynMeshUse.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "mesh.hpp"
#include "model/builder_impl.hpp"
#include "report.hpp"
#include "urdf_robot.hpp"

namespace dyn::load {

namespace {

struct Stand {
  std::shared_ptr<const SurfaceData> surface;
  bool warning;
  std::string said;
};

std::string count(long n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

Stand hull(const meshes::Mesh& mesh) {
  const meshes::Mesh hull = meshes::hull_of(mesh);
  const double depth = meshes::depth_under(mesh, *hull.polytope);
  const std::string vertices = count(hull.vertex_count(), "vertex", "vertices");
  const bool closed = mesh.topology.closed && meshes::solid_of(mesh).volume != 0;
  if (depth <= meshes::convex_tolerance * meshes::box_of(mesh).diagonal())
    return {meshes::convex_of(hull), false, " is convex: a hull of " + vertices + " stands for it"};
  std::string ratio = "unknown times the mesh's, which is not closed";
  if (closed) ratio = number(meshes::solid_of(hull).volume / std::abs(meshes::solid_of(mesh).volume)) + " times the mesh's";
  return {meshes::convex_of(hull), true, " is not convex, and its hull of " + vertices + " stands for it: hull_volume_ratio: the hull's volume is " + ratio +
                                             "; hull_depth: the mesh lies up to " + number(depth) + " m below the hull"};
}

Stand triangles(const meshes::Mesh& mesh) {
  const std::string what = ": " + count(mesh.triangle_count(), "triangle", "triangles");
  if (mesh.topology.closed) return {meshes::tree_of(mesh), false, what + " that enclose a solid"};
  return {meshes::tree_of(mesh), true, what + " that enclose nothing (" + count(mesh.topology.open, "open edge", "open edges") + "): what lies inside touches nothing"};
}

}  // namespace

void read_collision_meshes(UrdfRobot& robot, Report& report, const LoadOptions& options) {
  if (options.meshes == DYN_MESH_NONE) return;
  std::map<std::pair<std::string, std::array<double, 3>>, Stand> known;
  for (UrdfLink& link : robot.links)
    for (UrdfShape& s : link.shapes) {
      Shape& shape = s.shape;
      if (shape.type != DYN_SHAPE_MESH || shape.role != DYN_ROLE_COLLISION) continue;
      const std::string who = "link " + load::quoted(link.name) + ": mesh " + load::quoted(shape.mesh);
      auto at = known.find({shape.mesh, shape.size});
      if (at == known.end()) {
        try {
          meshes::MeshOptions how;
          how.scale = shape.size, how.package_dirs = options.package_dirs;
          if (!std::filesystem::exists(shape.mesh)) how.relative_to = report.file();  // to say what was tried
          const meshes::Mesh mesh = meshes::read_mesh(shape.mesh, how);
          at = known.emplace(std::pair(shape.mesh, shape.size), options.meshes == DYN_MESH_HULL ? hull(mesh) : triangles(mesh)).first;
        } catch (const Error& e) {
          report.fail(e.status, s.line, who + ": " + e.what());
        }
      }
      if (at->second.warning) report.warning(s.line, who + at->second.said);
      else report.info(s.line, who + at->second.said);
      shape.type = options.meshes == DYN_MESH_HULL ? DYN_SHAPE_CONVEX : DYN_SHAPE_TRIANGLES;
      shape.surface = at->second.surface;
    }
}

}  // namespace dyn::load
