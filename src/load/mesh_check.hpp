#pragma once

#include <string>

namespace dyn::load {

// ".stl"
std::string extension(const std::string& path);
// Throws for what is no mesh file, is cut off, or would drown a parser.
void check_mesh_file(const std::string& path);

}  // namespace dyn::load
