// Reads files.
#pragma once

#include <string>

#include "report.hpp"

namespace dyn::load {

// Returns the whole file. Also reads pipes, such as the output of xacro. what: "a robot file". Throws through a report of the
// path.
std::string read_file(const std::string& path, const std::string& what);

}  // namespace dyn::load
