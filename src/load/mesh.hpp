// Triangle meshes: from files or arrays, what they bound, and their hulls.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "confined.hpp"
#include "model/builder.hpp"
#include "spatial/inertia.hpp"

namespace dyn::meshes {

inline constexpr std::int64_t max_triangles = 10000000;

// How often each edge is passed, each way: the triangles of a solid pass it once there and once back.
struct Topology {
  Index components = 0;  // parts that share no edge
  Index open = 0;        // edges of one triangle
  Index flipped = 0;     // edges that two triangles pass the same way
  Index crowded = 0;     // edges of more than two (not manifold)
  bool closed = false;   // all as often there as back: the triangles bound a solid
};

// The faces of a convex mesh. Faces are planes n . x <= offset with their corners counter-clockwise seen from outside; neighbours are
// joined by an edge. Coordinates by component, in whole registers: the last corner is repeated.
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
  std::vector<std::uint32_t> colours;  // of the triangles, as in dyn/model/colour.hpp; empty: none has one
  std::int64_t welded = 0, degenerate = 0, duplicates = 0, skipped = 0;  // what is not there any more
  Topology topology;
  std::optional<Polytope> polytope;  // of a hull
  // what shapes are made of, where there is any: a hull, the triangles, a height field (prepare)
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
};

// mesh_read.cpp
Mesh read_mesh(const std::string& name, const MeshOptions& options);
// mesh_weld.cpp: welds and drops; corners must be in range and vertices finite. who begins messages. colours: m, or nullptr.
Mesh make_mesh(const double* vertices, std::int64_t n, const Index* triangles, std::int64_t m, double weld_tolerance, const std::string& who, const std::uint32_t* colours = nullptr);
// mesh_topology.cpp
Topology topology_of(const std::vector<Index>& triangles);
// mesh_mass.cpp: what a closed mesh bounds, at density 1; volume and inertia are negative when it is inside out.
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
// How deep the middles of the triangles lie under the hull's faces, at most.
double depth_under(const Mesh& mesh, const Polytope& hull);

inline constexpr double convex_tolerance = 1e-6;  // of the box's diagonal, for that depth
inline constexpr Index max_hull_vertices = 65536;
// mesh_surface.cpp: what shapes are made of. A hull has to be one.
std::shared_ptr<const SurfaceData> convex_of(const Mesh& hull);
std::shared_ptr<const SurfaceData> tree_of(const Mesh& mesh);
void prepare(Mesh& mesh);
Mesh height_field(const double* heights, Index columns, Index rows, double step_x, double step_y, double bottom);
// The mesh that a surface of a model is.
Mesh mesh_of(const std::shared_ptr<const SurfaceData>& surface);

}  // namespace dyn::meshes
