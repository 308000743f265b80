// What libdyn.so asks of libdyn_mesh.so, the module with assimp and qhull in it, which is opened when the first mesh is: one function,
// dyn_mesh_module, that answers a table of functions. Plain values, no exceptions: both sides may be of different compilers.
#pragma once

#include <cstdint>

#include "dyn.h"

namespace dyn::mesh {

inline constexpr std::uint32_t module_version = 2;  // of this file

struct Failure {
  dynStatus status;
  char message[600];
};

// Triangles as the file has them, each corner on its own or shared; points and lines are counted.
struct Soup {
  double* vertices;  // 3 each
  std::int64_t vertex_count;
  std::int32_t* triangles;  // 3 each
  std::uint32_t* colours;   // of the triangles, as in dyn/model/colour.hpp
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
  // The file's triangles in metres. up_z: what the file calls up becomes z.
  bool (*read)(const char* path, bool up_z, std::int64_t max_triangles, Soup* out, Failure* failure);
  // points: 3 each, finite
  bool (*hull)(const double* points, std::int32_t count, HullFaces* out, Failure* failure);
  void (*free_soup)(Soup*);
  void (*free_hull)(HullFaces*);
  const char* libraries;  // "assimp 5.2.5, qhull 2020.2.r"
};

// nullptr: this module has another version.
using GetModule = const Module* (*)(std::uint32_t version);
inline constexpr const char* module_function = "dyn_mesh_module";

}  // namespace dyn::mesh
