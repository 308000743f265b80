// Converts meshes to the data of shapes, and back.
#include <algorithm>

#include "mesh.hpp"
#include "model/builder_surface.hpp"

namespace dyn::meshes {

using namespace shape;

namespace {

Polytope polytope_of(const Hull& h) {
  Polytope p;
  const auto room = std::size_t(Hull::padded(h.vertices)), corners = std::size_t(h.corners);
  p.x.assign(h.x, h.x + room), p.y.assign(h.y, h.y + room), p.z.assign(h.z, h.z + room);
  p.planes.assign(h.planes, h.planes + 4 * std::size_t(h.faces));
  p.face_start.assign(h.face_start, h.face_start + h.faces + 1),
      p.face_corners.assign(h.face_vertices, h.face_vertices + corners);
  p.neighbour_start.assign(h.neighbour_start, h.neighbour_start + h.vertices + 1),
      p.neighbours.assign(h.neighbours, h.neighbours + corners);
  p.center = h.center, p.extent = h.extent;
  return p;
}

void add(std::vector<double>& to, const Vec& p) { to.insert(to.end(), {p[0], p[1], p[2]}); }

Mesh mesh_of(const Hull& h) {
  Mesh out;
  for (Index k = 0; k < h.vertices; ++k) add(out.vertices, h.vertex(k));
  for (Index f = 0; f < h.faces; ++f)
    for (Index k = h.face_start[f] + 1; k + 1 < h.face_start[f + 1]; ++k)
      out.triangles.insert(out.triangles.end(), {h.face_vertices[h.face_start[f]], h.face_vertices[k], h.face_vertices[k + 1]});
  out.polytope = polytope_of(h);
  return out;
}
Mesh mesh_of(const TriangleTree& t) {
  Mesh out;
  out.vertices.assign(t.vertex, t.vertex + 3 * std::size_t(t.vertices));
  out.triangles.assign(t.corner, t.corner + 3 * std::size_t(t.triangles));
  return out;
}
Mesh mesh_of(const Grid& g) {
  Mesh out;
  for (Index j = 0; j < g.rows; ++j)
    for (Index i = 0; i < g.columns; ++i) add(out.vertices, g.at(i, j));
  for (Index j = 0; j + 1 < g.rows; ++j)
    for (Index i = 0; i + 1 < g.columns; ++i) {
      const Index a = j * g.columns + i, b = a + g.columns;
      out.triangles.insert(out.triangles.end(), {a, a + 1, b + 1, a, b + 1, b});
    }
  return out;
}

}  // namespace

std::shared_ptr<const SurfaceData> convex_of(const Mesh& mesh) {
  const Polytope& p = *mesh.polytope;
  if (mesh.vertex_count() > max_hull_vertices)
    throw Error(DYN_ERROR_LIMIT, "a hull of " + std::to_string(mesh.vertex_count()) + " vertices, and the limit is " +
                                     std::to_string(max_hull_vertices) + ": simplify the mesh");
  Hull h{};
  h.vertices = mesh.vertex_count(), h.faces = Index(p.face_start.size()) - 1, h.corners = Index(p.face_corners.size());
  h.x = p.x.data(), h.y = p.y.data(), h.z = p.z.data(), h.planes = p.planes.data();
  h.face_start = p.face_start.data(), h.face_vertices = p.face_corners.data();
  h.neighbour_start = p.neighbour_start.data(), h.neighbours = p.neighbours.data();
  h.center = p.center, h.extent = p.extent;
  return std::make_shared<SurfaceData>(SurfaceData{Held<Hull>(h)});
}

std::shared_ptr<const SurfaceData> tree_of(const Mesh& mesh) {
  return triangle_tree(mesh.vertices, mesh.triangles, mesh.topology.closed);
}

void prepare(Mesh& mesh) {
  if (mesh.polytope && !mesh.convex && mesh.vertex_count() <= max_hull_vertices) mesh.convex = convex_of(mesh);
  if (!mesh.triangles.empty() && !mesh.tree && !mesh.polytope) mesh.tree = tree_of(mesh);
}

Mesh height_field(const double* heights, Index columns, Index rows, double step_x, double step_y, double bottom) {
  return mesh_of(height_grid(heights, columns, rows, step_x, step_y, bottom));
}

Mesh mesh_of(const std::shared_ptr<const SurfaceData>& surface) {
  Mesh out = std::visit([](const auto& held) { return mesh_of(held.view()); }, surface->held);
  out.topology = topology_of(out.triangles);
  switch (surface->held.index()) {
    case 0: out.convex = surface; break;
    case 1: out.tree = surface; break;
    default: out.grid = surface;
  }
  return out;
}

}  // namespace dyn::meshes
