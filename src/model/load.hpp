// Robot files to models. Host side.
#pragma once

#include <limits>

#include "model/builder.hpp"

namespace dyn {

namespace load {
class Budget;
}

// Defaults are those of dynLoadOptions.
struct LoadLimits {
  std::int64_t bodies = 200000, shapes = 200000, rows = 6000, keys = 10000, bytes = std::int64_t(1) << 30;
  double seconds = std::numeric_limits<double>::infinity();
};

struct LoadOptions {
  dynBase base = DYN_BASE_UNSPECIFIED;
  bool strict = false;
  bool cos_sin = false;
  std::vector<std::string> package_dirs;
  std::array<double, 3> gravity = {0, 0, -9.81};
  std::string srdf;  // path, or ""
  dynMeshUse meshes = DYN_MESH_USE_AUTO;
  int constraint_slots = 8;
  int contact_capacity = 0;
  bool confined = false;
  LoadLimits limits;
  load::Budget* budget = nullptr;  // of this load: set by load_file and load_string
};

// Content decides the format. Throws Error with file, line, element and remedy.
ModelPtr load_file(const std::string& path, const LoadOptions& options);
ModelPtr load_string(const std::string& text, const LoadOptions& options);

// MJCF text; file is also the base of included files and meshes.
ModelPtr load_mjcf(const std::string& text, const std::string& file, const LoadOptions& options);

// The bytes of a .dynb.
ModelPtr load_dynb(const std::string& bytes, const std::string& file, const LoadOptions& options);

// URDF text; file names messages ("robot.urdf:12: ...") and is the base of relative mesh paths.
ModelPtr load_urdf(const std::string& text, const std::string& file, const LoadOptions& options);

}  // namespace dyn
