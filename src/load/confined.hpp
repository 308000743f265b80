// Restricts the files that a robot file may make the loader read.
#pragma once

#include <string>
#include <vector>

#include "model/load.hpp"

namespace dyn::load {

class Confined {
 public:
  Confined() = default;  // any file
  // If options.confined: files in the robot file's folder ("": the working directory) and in package_dirs.
  Confined(const std::string& file, const LoadOptions& options);
  // Throws DYN_ERROR_FILE for other files. Follows links.
  void check(const std::string& path) const;

 private:
  bool confined_ = false;
  std::vector<std::string> folders_;  // links resolved
};

}  // namespace dyn::load
