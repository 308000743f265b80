// Resolves mesh file names of a URDF to paths.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::load {

class MeshPaths {
 public:
  struct Found {
    std::string path;                // "" if not found
    std::vector<std::string> tried;  // every path, in order
    bool first_time = true;          // first request for this name
  };

  // file: the robot file, or "" for text in memory. package_dirs: folders in which package://NAME/rest is looked up.
  MeshPaths(const std::string& file, std::vector<std::string> package_dirs);

  // package://NAME/rest (also model://) is looked up as DIR/NAME/rest and DIR/rest in each package directory. Then as NAME/rest
  // in every folder above the robot file, and last in ROS_PACKAGE_PATH. Relative names are relative to the robot file's folder.
  const Found& find(const std::string& name);

 private:
  std::vector<std::string> candidates(const std::string& name) const;

  std::string folder_;
  std::vector<std::string> package_dirs_, above_, ros_;
  std::unordered_map<std::string, Found> known_;
};

}  // namespace dyn::load
