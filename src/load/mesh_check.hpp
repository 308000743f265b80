#pragma once

#include <cstdint>
#include <string>

namespace dyn::load {

inline constexpr std::uint64_t max_mesh_bytes = std::uint64_t(1) << 30;

// ".stl"
std::string extension(const std::string& path);
// Returns the size in bytes. Throws if this is no regular file or no mesh file, if it is too large, or an STL that is cut off.
std::uint64_t check_mesh_file(const std::string& path);

}  // namespace dyn::load
