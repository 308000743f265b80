// Triangle meshes from files or arrays, their solids and hulls.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "budget.hpp"
#include "confined.hpp"
#include "model/builder.hpp"
#include "spatial/inertia.hpp"

namespace dyn::meshes {

inline constexpr std::int64_t max_triangles = 10000000;

// Edge statistics. The triangles of a solid pass each edge once in each direction.
struct Topology {
  Index components = 0;  // parts that share no edge
  Index open = 0;        // edges of one triangle
  Index flipped = 0;     // edges that two triangles pass in the same direction
  Index crowded = 0;     // edges of more than two triangles (not manifold)
  bool closed = false;   // each edge is passed equally often both ways: the triangles bound a solid
};

// Faces of a convex mesh: planes n . x <= offset with corners counter-clockwise seen from outside. Neighbours share an edge.
// Coordinates are stored by component in whole registers, padded with the last corner.
struct Polytope {
  static constexpr std::size_t lanes = 8;
  std::vector<double> x, y, z, planes;
  std::vector<Index> face_start, face_corners, neighbour_start, neighbours;
  Vec3<double> center = Vec3<double>::zero();  // mean of the corners
  double extent = 0;                           // farthest corner from the origin
};

struct Mesh {
  std::vector<double> vertices;  // 3 each, no two equal
  std::vector<Index> triangles;  // 3 each, none degenerate
  std::vector<std::uint32_t> colours;  // of the triangles, as in model/colour.hpp; empty: no triangle has one
  std::int64_t welded = 0, degenerate = 0, duplicates = 0, skipped = 0;  // counts of what was removed
  Topology topology;
  std::optional<Polytope> polytope;  // of a hull
  // data of shapes where present: hull, triangles, height field (prepare)
  std::shared_ptr<const SurfaceData> convex, tree, grid;

  Index vertex_count() const { return Index(vertices.size() / 3); }
  Index triangle_count() const { return Index(triangles.size() / 3); }
  Vec3<double> vertex(Index i) const { return load3(vertices.data() + 3 * std::ptrdiff_t(i)); }
  Vec3<double> corner(Index t, int k) const { return vertex(triangles[3 * std::size_t(t) + std::size_t(k)]); }
};

inline double length(const Vec3<double>& a) { return std::sqrt(dot(a, a)); }

struct Box {
  Vec3<double> low, high;
  double diagonal() const { return length(high - low); }
};

struct MeshOptions {
  std::array<double, 3> scale = {1, 1, 1};
  double weld_tolerance = 0;  // m; 0: equal vertices only
  bool up_z = false;
  std::vector<std::string> package_dirs;
  std::string relative_to;  // the robot file that names the mesh
  load::Confined confined = {};
  bool points = false;  // an OBJ of vertices alone is a mesh without triangles, not an error
  load::Budget* budget = nullptr;  // of the load that reads it
};

// mesh_read.cpp
Mesh read_mesh(const std::string& name, const MeshOptions& options);
// mesh_weld.cpp: welds vertices, drops degenerate triangles. Corners must be in range, vertices finite. who: begins messages.
// colours: m, or null.
Mesh make_mesh(const double* vertices, std::int64_t n, const Index* triangles, std::int64_t m, double weld_tolerance,
               const std::string& who, const std::uint32_t* colours = nullptr);
// mesh_topology.cpp
Topology topology_of(const std::vector<Index>& triangles);
// mesh_mass.cpp: the solid of a closed mesh at density 1. Volume and inertia are negative if the mesh is inside out.
struct Solid {
  double volume;
  Vec3<double> com;
  Sym3<double> inertia;  // about com
};
Solid solid_of(const Mesh& mesh);
double area_of(const Mesh& mesh);
Box box_of(const Mesh& mesh);
// mesh_hull.cpp
Mesh hull_of(const Mesh& mesh);
// Largest depth of triangle centres under the hull's faces.
double depth_under(const Mesh& mesh, const Polytope& hull);

inline constexpr double convex_tolerance = 1e-6;  // bound of depth_under over the box's diagonal
inline constexpr Index max_hull_vertices = 65536;
// mesh_surface.cpp: data of shapes. convex_of needs a hull.
std::shared_ptr<const SurfaceData> convex_of(const Mesh& hull);
std::shared_ptr<const SurfaceData> tree_of(const Mesh& mesh);
void prepare(Mesh& mesh);
Mesh height_field(const double* heights, Index columns, Index rows, double step_x, double step_y, double bottom);
// The mesh of a model's surface.
Mesh mesh_of(const std::shared_ptr<const SurfaceData>& surface);

}  // namespace dyn::meshes
