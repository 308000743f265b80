// Checks mesh files before they are read: kind, format, size.
#include "mesh_check.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "file.hpp"
#include "mesh.hpp"
#include "mesh_soup.hpp"
#include "system.hpp"

namespace dyn::load {

using meshes::max_triangles;

namespace {

std::string read(std::ifstream& file, std::uint64_t from, std::uint64_t bytes) {
  std::string text(std::size_t(bytes), '\0');
  file.clear();
  file.seekg(std::streamoff(from)), file.read(text.data(), std::streamsize(bytes));
  text.resize(std::size_t(std::max<std::streamsize>(file.gcount(), 0)));
  return text;
}

bool holds(const std::string& text, std::string_view word) {
  return std::search(text.begin(), text.end(), word.begin(), word.end(),
                     [](char a, char b) { return (a >= 'A' && a <= 'Z' ? char(a - 'A' + 'a') : a) == b; }) != text.end();
}

// Binary: 80 bytes, a count, 50 bytes a triangle. Other files that begin with "solid" are ASCII.
void check_stl(std::ifstream& file, std::uint64_t size, const Report& report) {
  const std::string head = read(file, 0, std::min<std::uint64_t>(size, 84));
  const std::uint64_t count = head.size() < 84 ? 0 : little_endian<std::uint32_t>(head.data() + 80), needed = 84 + 50 * count;
  const bool ascii = head.substr(0, 5) == "solid" && size != needed;
  if (ascii) {
    const std::uint64_t tail = std::min<std::uint64_t>(size, 4096);
    if (!holds(read(file, size - tail, tail), "endsolid"))
      report.fail(DYN_ERROR_PARSE, 0, "the file is cut off: an ASCII STL ends with 'endsolid'");
    return;
  }
  if (size < 84)
    report.fail(DYN_ERROR_PARSE, 0,
                "this is not an STL: it has " + std::to_string(size) + " bytes, and the header of a binary one alone has 84");
  if (count > std::uint64_t(max_triangles))
    report.fail(size == needed ? DYN_ERROR_LIMIT : DYN_ERROR_PARSE, 0,
                "its header says " + std::to_string(count) + " triangles, and the limit is " + std::to_string(max_triangles) +
                    (size == needed ? "" : " (the file has " + std::to_string(size) + " bytes: it is damaged, or no STL)"));
  if (size != needed)
    report.fail(DYN_ERROR_PARSE, 0,
                "its header says " + std::to_string(count) + " triangles, which take " + std::to_string(needed) +
                    " bytes, but the file has " + std::to_string(size) + ": it is " + (size < needed ? "cut off" : "damaged") +
                    ", or no STL");
  if (count == 0) report.fail(DYN_ERROR_INVALID, 0, "no triangles: its header says 0");
}

}  // namespace

std::string extension(const std::string& path) {
  std::string out = std::filesystem::path(path).extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return out;
}

std::uint64_t check_mesh_file(const std::string& path) {
  const Report report(path, false);
  const std::string kind = extension(path);
  const std::uint64_t size = file_size(path, "a mesh file");
  if (kind != ".stl" && kind != ".obj" && kind != ".dae" && kind != ".gltf" && kind != ".glb")
    report.fail(DYN_ERROR_UNSUPPORTED, 0, "mesh files are .stl, .obj, .dae, .gltf and .glb: convert it to one of them");
  std::ifstream file(utf8_path(path), std::ios::binary);
  if (!file) report.fail(DYN_ERROR_FILE, 0, "cannot be opened");
  if (size == 0) report.fail(DYN_ERROR_PARSE, 0, "the file is empty");
  if (size > max_mesh_bytes)
    report.fail(DYN_ERROR_LIMIT, 0,
                std::to_string(size) + " bytes, and the limit is " + std::to_string(max_mesh_bytes) + ": simplify the mesh");
  if (read(file, 0, std::min<std::uint64_t>(size, 40)).starts_with("version https://git-lfs"))
    report.fail(DYN_ERROR_PARSE, 0, "this is a Git LFS placeholder, not the mesh: run git lfs pull");
  if (kind == ".stl") check_stl(file, size, report);
  return size;
}

}  // namespace dyn::load
