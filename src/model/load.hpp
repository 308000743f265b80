// Robot files to models. Host side.
#pragma once

#include "model/builder.hpp"

namespace dyn {

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
