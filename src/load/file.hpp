// Reads files.
#pragma once

#include <cstdint>
#include <string>

#include "report.hpp"

namespace dyn::load {

inline constexpr std::size_t max_file_bytes = std::size_t(128) << 20;  // of a text

// Pipe: the file that the caller names may be one, such as the output of xacro. Devices, sockets and folders are refused.
enum class FileKind { Regular, Pipe };

// Returns the whole file. what: "a robot file". Throws through a report of the path, before it is read if it has more than limit
// bytes.
std::string read_file(const std::string& path, const std::string& what, FileKind kind = FileKind::Regular,
                      std::uint64_t limit = max_file_bytes);

// Size of a regular file in bytes. Throws for anything else.
std::uint64_t file_size(const std::string& path, const std::string& what);

}  // namespace dyn::load
