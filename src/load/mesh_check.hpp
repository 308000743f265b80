#pragma once

#include <string>

namespace dyn::load {

// ".stl"
std::string extension(const std::string& path);
// Throws if the file is no mesh file, is truncated, or would overflow a parser.
void check_mesh_file(const std::string& path);

}  // namespace dyn::load
