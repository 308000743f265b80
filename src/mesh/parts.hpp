// Parts of the module. These throw.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "dyn.h"

namespace dyn::mesh {

struct Refusal : std::runtime_error {
  dynStatus status;
  Refusal(dynStatus s, const std::string& message) : std::runtime_error(message), status(s) {}
};

struct Triangles {
  std::vector<double> vertices;
  std::vector<std::int32_t> corners;
  std::vector<std::uint32_t> colours;  // of the triangles
  std::int64_t skipped = 0;
};
// read_assimp.cpp
Triangles read_assimp(const char* path, bool up_z, std::int64_t max_triangles);

struct Faces {
  std::vector<std::int32_t> corners, start, of_face;  // as in HullFaces
};
// hull_qhull.cpp
Faces hull_qhull(const double* points, std::int32_t count);

}  // namespace dyn::mesh
