#include "collision_mesh.hpp"

#include <cmath>

#include "model/builder_impl.hpp"

namespace dyn::load {

namespace {

std::string count(long n, const char* one, const char* many) { return std::to_string(n) + " " + (n == 1 ? one : many); }

// asked: a hull was asked for, so that a mesh which is not convex is a warning. By default, as in MuJoCo, it is no news.
CollisionMesh hull(const meshes::Mesh& mesh, bool asked) {
  const meshes::Mesh hull = meshes::hull_of(mesh);
  const double depth = meshes::depth_under(mesh, *hull.polytope);
  const std::string vertices = count(hull.vertex_count(), "vertex", "vertices");
  const bool closed = mesh.topology.closed && meshes::solid_of(mesh).volume != 0;
  if (depth <= meshes::convex_tolerance * meshes::box_of(mesh).diagonal())
    return {DYN_SHAPE_TYPE_CONVEX, meshes::convex_of(hull), false, " is convex: a hull of " + vertices + " replaces it"};
  std::string ratio = "unknown times the mesh's, which is not closed";
  if (closed) ratio = number(meshes::solid_of(hull).volume / std::abs(meshes::solid_of(mesh).volume)) + " times the mesh's";
  return {DYN_SHAPE_TYPE_CONVEX, meshes::convex_of(hull), asked,
          " is not convex, and its hull of " + vertices + " replaces it: hull_volume_ratio: the hull's volume is " + ratio +
              "; hull_depth: the mesh lies up to " + number(depth) + " m below the hull"};
}

CollisionMesh triangles(const meshes::Mesh& mesh) {
  const std::string what = ": " + count(mesh.triangle_count(), "triangle", "triangles");
  if (mesh.topology.closed) return {DYN_SHAPE_TYPE_TRIANGLES, meshes::tree_of(mesh), false, what + " that enclose a solid"};
  return {DYN_SHAPE_TYPE_TRIANGLES, meshes::tree_of(mesh), true,
          what + " that do not enclose a solid (" + count(mesh.topology.open, "open edge", "open edges") +
              "): shapes inside are not in contact"};
}

bool is_flat(const meshes::Mesh& mesh) {
  const meshes::Box box = meshes::box_of(mesh);
  const Vec3<double> o = mesh.corner(0, 0);
  Vec3<double> normal = Vec3<double>::zero();  // of the largest triangle
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3<double> area = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (dot(area, area) > dot(normal, normal)) normal = area;
  }
  normal = normal * (1 / meshes::length(normal));
  double height = 0;
  for (Index i = 0; i < mesh.vertex_count(); ++i) height = std::max(height, std::abs(dot(normal, mesh.vertex(i) - o)));
  return height <= 1e-9 * box.diagonal();
}

}  // namespace

CollisionMesh collision_mesh_of(const meshes::Mesh& mesh, dynMeshUse use) {
  if (use == DYN_MESH_USE_TRIANGLES) return triangles(mesh);
  if (mesh.triangle_count() == 0 || !is_flat(mesh)) return hull(mesh, use == DYN_MESH_USE_HULL);
  CollisionMesh out = triangles(mesh);
  out.message = " is flat and has no hull: its " + count(mesh.triangle_count(), "triangle replaces", "triangles replace") + " it";
  return out;
}

}  // namespace dyn::load
