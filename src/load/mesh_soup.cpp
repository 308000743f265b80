#include "mesh_soup.hpp"

#include <filesystem>

#include "confined.hpp"
#include "file.hpp"
#include "mesh.hpp"
#include "model/colour.hpp"
#include "number.hpp"

namespace dyn::load {

void check_mesh_size(std::int64_t vertices, std::int64_t triangles, const Report& report) {
  const auto check = [&](std::int64_t n, const char* what, std::int64_t limit) {
    if (n > limit)
      report.fail(DYN_ERROR_LIMIT, 0,
                  std::to_string(n) + what + ", and the limit is " + std::to_string(limit) + ": simplify the mesh");
  };
  check(triangles, " triangles", meshes::max_triangles), check(vertices, " vertices", 3 * meshes::max_triangles);
}

std::string read_beside(const Report& mesh, const std::string& name, std::uint64_t limit) {
  const std::filesystem::path path = std::filesystem::path(mesh.file()).parent_path() / name;
  LoadOptions own_folder;
  own_folder.confined = true;
  Confined(mesh.file(), own_folder).check(path.string());
  return read_file(path.string(), "a file that a mesh names", FileKind::Regular, limit);
}

double mesh_number(std::string_view word, const char* what, int line, const Report& report) {
  double x = 0;
  if (const std::string wrong = word.empty() ? "is missing" : parse_number(word, x); !wrong.empty())
    report.fail(
        DYN_ERROR_PARSE, line,
        std::string(what) + ": a number " + (word.empty() ? "" : in_quotes(std::string(word.substr(0, 60))) + " ") + wrong);
  return x;
}

std::uint32_t packed_rgb(const Rgb& c) {
  const double rgba[4] = {c[0], c[1], c[2], 1};
  return packed_colour(rgba);
}

void add_placed(const Soup& part, const Affine& X, Soup& to, const Report& report) {
  check_mesh_size(to.vertex_count() + part.vertex_count(), to.triangle_count() + part.triangle_count(), report);
  const std::int32_t first = std::int32_t(to.vertex_count());
  for (std::size_t i = 0; i < part.vertices.size(); i += 3)
    for (int r = 0; r < 3; ++r)
      to.vertices.push_back(X.A[r][0] * part.vertices[i] + X.A[r][1] * part.vertices[i + 1] + X.A[r][2] * part.vertices[i + 2] +
                            X.p[r]);
  const bool mirrored = X.determinant() < 0;
  for (std::size_t t = 0; t < part.triangles.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) to.triangles.push_back(first + part.triangles[t + (mirrored ? 2 - k : k)]);
  to.colours.insert(to.colours.end(), part.colours.begin(), part.colours.end());
  to.skipped += part.skipped;
}

}  // namespace dyn::load
