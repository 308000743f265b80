#include "collision_mesh.hpp"

#include <cmath>

#include "model/builder_impl.hpp"

namespace dyn::load {

namespace {

std::string count(long n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

CollisionMesh hull(const meshes::Mesh& mesh) {
  const meshes::Mesh hull = meshes::hull_of(mesh);
  const double depth = meshes::depth_under(mesh, *hull.polytope);
  const std::string vertices = count(hull.vertex_count(), "vertex", "vertices");
  const bool closed = mesh.topology.closed && meshes::solid_of(mesh).volume != 0;
  if (depth <= meshes::convex_tolerance * meshes::box_of(mesh).diagonal())
    return {meshes::convex_of(hull), false, " is convex: a hull of " + vertices + " replaces it"};
  std::string ratio = "unknown times the mesh's, which is not closed";
  if (closed) ratio = number(meshes::solid_of(hull).volume / std::abs(meshes::solid_of(mesh).volume)) + " times the mesh's";
  return {meshes::convex_of(hull), true, " is not convex, and its hull of " + vertices + " replaces it: hull_volume_ratio: the hull's volume is " + ratio +
                                             "; hull_depth: the mesh lies up to " + number(depth) + " m below the hull"};
}

CollisionMesh triangles(const meshes::Mesh& mesh) {
  const std::string what = ": " + count(mesh.triangle_count(), "triangle", "triangles");
  if (mesh.topology.closed) return {meshes::tree_of(mesh), false, what + " that enclose a solid"};
  return {meshes::tree_of(mesh), true, what + " that do not enclose a solid (" + count(mesh.topology.open, "open edge", "open edges") + "): shapes inside are not in contact"};
}

}  // namespace

CollisionMesh collision_mesh_of(const meshes::Mesh& mesh, dynMeshUse use) {
  if (use == DYN_MESH_USE_AUTO) return {meshes::convex_of(meshes::hull_of(mesh)), false, ""};
  return use == DYN_MESH_USE_HULL ? hull(mesh) : triangles(mesh);
}

dynShapeType collision_type_of(dynMeshUse use) { return use == DYN_MESH_USE_TRIANGLES ? DYN_SHAPE_TYPE_TRIANGLES : DYN_SHAPE_TYPE_CONVEX; }

}  // namespace dyn::load
