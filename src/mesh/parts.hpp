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

struct Faces {
  std::vector<std::int32_t> corners, start, of_face;  // as in HullFaces
};
// hull_qhull.cpp
Faces hull_qhull(const double* points, std::int32_t count);

}  // namespace dyn::mesh
