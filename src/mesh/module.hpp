// Interface between libdyn.so and the module libdyn_mesh.so (assimp, qhull), which is opened with the first mesh. One function,
// dyn_mesh_module, returns a table of functions. Plain values and no exceptions, because the compilers may differ.
#pragma once

#include <cstdint>

#include "dyn.h"

namespace dyn::mesh {

inline constexpr std::uint32_t module_version = 2;  // of this interface

struct Failure {
  dynStatus status;
  char message[600];
};

// Triangles as in the file; corners may be shared. Points and lines are counted.
struct Soup {
  double* vertices;  // 3 each
  std::int64_t vertex_count;
  std::int32_t* triangles;  // 3 each
  std::uint32_t* colours;   // of the triangles, as in model/colour.hpp
  std::int64_t triangle_count;
  std::int64_t skipped;
};

// A convex polytope whose corners are some of the given points.
struct HullFaces {
  std::int32_t* corners;  // indices of points, ascending
  std::int32_t corner_count;
  std::int32_t* face_start;  // face_count + 1
  std::int32_t* face_corners;  // indices of corners, counter-clockwise seen from outside
  std::int32_t face_count;
};

struct Module {
  std::uint32_t version, size;
  // Reads a file's triangles in metres. up_z: the file's up axis becomes z.
  bool (*read)(const char* path, bool up_z, std::int64_t max_triangles, Soup* out, Failure* failure);
  // points: 3 each, finite
  bool (*hull)(const double* points, std::int32_t count, HullFaces* out, Failure* failure);
  void (*free_soup)(Soup*);
  void (*free_hull)(HullFaces*);
  const char* libraries;  // "assimp 5.2.5, qhull 2020.2.r"
};

// Returns null if this module has another version.
using GetModule = const Module* (*)(std::uint32_t version);
inline constexpr const char* module_function = "dyn_mesh_module";

}  // namespace dyn::mesh
