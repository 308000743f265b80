// What a mesh file holds, and the reader of each format. A reader checks every count, length and index that the file states, and
// throws through the report.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "report.hpp"

namespace dyn::load {

struct Soup {
  std::vector<double> vertices;         // 3 each
  std::vector<std::int32_t> triangles;  // 3 each
  std::vector<std::uint32_t> colours;   // of the triangles, as in model/colour.hpp
  std::int64_t skipped = 0;             // points and lines

  std::int64_t vertex_count() const { return std::int64_t(vertices.size() / 3); }
  std::int64_t triangle_count() const { return std::int64_t(triangles.size() / 3); }
};

// The whole file as bytes; report: of its path. up_z: the file's up axis becomes z.
Soup read_stl(std::string_view bytes, const Report& report);
Soup read_obj(std::string_view text, const Report& report);
Soup read_collada(const std::string& text, bool up_z, const Report& report);
Soup read_gltf(std::string_view bytes, bool binary, bool up_z, const Report& report);

// Throws DYN_ERROR_LIMIT for more than the limits of a mesh. To be called before what is counted is made.
void check_mesh_size(std::int64_t vertices, std::int64_t triangles, const Report& report);

// The content of a file that a mesh file names: a regular file in its folder or below. limit: bytes.
std::string read_beside(const Report& mesh, const std::string& name, std::uint64_t limit);

// A number of the file, finite. what begins the message: "vertex".
double mesh_number(std::string_view word, const char* what, int line, const Report& report);

// A number of a binary file.
template <class T>
T little_endian(const char* bytes) {
  static_assert(std::endian::native == std::endian::little);
  T x;
  std::memcpy(&x, bytes, sizeof x);
  return x;
}

using Rgb = std::array<double, 3>;
std::uint32_t packed_rgb(const Rgb& c);

// Adds the triangles of a polygon with these corners (mesh_polygon.cpp). A quadrilateral is split at the shorter diagonal, as
// readers of OBJ files do, a larger polygon where it has ears.
void add_polygon(const std::vector<double>& vertices, const std::vector<std::int32_t>& corners, std::vector<std::int32_t>& out);

// y = A x + p, of nodes
struct Affine {
  double A[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, p[3] = {0, 0, 0};

  friend Affine operator*(const Affine& X, const Affine& Y) {
    Affine Z;
    for (int r = 0; r < 3; ++r) {
      Z.p[r] = X.p[r];
      for (int c = 0; c < 3; ++c) {
        Z.A[r][c] = 0;
        for (int k = 0; k < 3; ++k) Z.A[r][c] += X.A[r][k] * Y.A[k][c];
        Z.p[r] += X.A[r][c] * Y.p[c];
      }
    }
    return Z;
  }
  double determinant() const {
    return A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1]) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
           A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]);
  }
};
// y up to z up
inline constexpr Affine y_to_z = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, 0, 0}};

// Adds a part of the scene, moved. Mirrored triangles are turned round.
void add_placed(const Soup& part, const Affine& X, Soup& to, const Report& report);

}  // namespace dyn::load
