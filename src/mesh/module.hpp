// Interface between libdyn.so and the module libdyn_mesh.so (qhull), which is opened with the first hull. One function,
// dyn_mesh_module, returns a table of functions. Plain values and no exceptions, because the compilers may differ.
#pragma once

#include <cstdint>

#include "dyn.h"

namespace dyn::mesh {

inline constexpr std::uint32_t module_version = 3;  // of this interface

struct Failure {
  dynStatus status;
  char message[600];
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
  // points: 3 each, finite
  bool (*hull)(const double* points, std::int32_t count, HullFaces* out, Failure* failure);
  void (*free_hull)(HullFaces*);
  const char* libraries;  // "qhull 2020.2.r"
};

// Returns null if this module has another version.
using GetModule = const Module* (*)(std::uint32_t version);
inline constexpr const char* module_function = "dyn_mesh_module";

}  // namespace dyn::mesh
