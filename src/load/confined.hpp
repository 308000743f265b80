// Which files a robot file may make the loader read.
#pragma once

#include <string>
#include <vector>

#include "model/load.hpp"

namespace dyn::load {

class Confined {
 public:
  Confined() = default;  // any
  // Those in the folder of the robot file ("": the working directory) and in package_dirs, if the caller wants it so.
  Confined(const std::string& file, const LoadOptions& options);
  // Throws DYN_ERROR_FILE for another one, links followed.
  void check(const std::string& path) const;

 private:
  bool confined_ = false;
  std::vector<std::string> folders_;  // without links
};

}  // namespace dyn::load
