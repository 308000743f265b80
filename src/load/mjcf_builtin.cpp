// Corners of MuJoCo's builtin meshes that are convex: their hull is the mesh.
#include <cmath>

#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;

constexpr int finest_sphere = 4, finest_hemisphere = 10, most_edges = 1000;  // MuJoCo's limits

Vec unit(const Vec& a) { return a * (1 / std::sqrt(dot(a, a))); }

// An icosahedron whose faces are split into four, so many times.
std::vector<Vec> sphere(int times) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const double a : {-1.0, 1.0})
      for (const double b : {-t, t}) {
        double v[3];
        v[axis] = 0, v[(axis + 1) % 3] = a, v[(axis + 2) % 3] = b;
        corners.push_back(unit(Vec::make(v[0], v[1], v[2])));
      }
  double edge = 2 / std::sqrt(1 + t * t);  // of the icosahedron
  for (int k = 0; k < times; ++k, edge *= 0.5) {
    const std::size_t n = corners.size();
    double longest = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        if (const Vec d = corners[i] - corners[j]; dot(d, d) < 1.69 * edge * edge) {  // edges differ by less than 1.2, and diagonals exceed 1.5
          longest = std::max(longest, dot(d, d));
          corners.push_back(unit(corners[i] + corners[j]));
        }
    edge = std::sqrt(longest);
  }
  return corners;
}

// Points of a grid on the octahedron, above the plane z = 0.
std::vector<Vec> hemisphere(int resolution) {
  const int n = resolution + 1;
  std::vector<Vec> corners;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      if (std::abs(x) + std::abs(y) <= n) corners.push_back(unit(Vec::make(x, y, n - std::abs(x) - std::abs(y))));
  return corners;
}

// From the unit circle at z = -1 to another radius at z = 1.
std::vector<Vec> cone(int edges, double radius) {
  std::vector<Vec> corners;
  for (int k = 0; k < edges; ++k) {
    const double angle = 6.28318530717958648 * k / edges, c = std::cos(angle), s = std::sin(angle);
    corners.push_back(Vec::make(c, s, -1));
    if (radius > 0) corners.push_back(Vec::make(radius * c, radius * s, 1));
  }
  if (radius == 0) corners.push_back(Vec::make(0, 0, 1));
  return corners;
}

}  // namespace

std::optional<std::vector<double>> mjcf_builtin_corners(const Reader& reader, const Element& e) {
  const std::string_view kind = e.Attribute("builtin");
  if (kind != "sphere" && kind != "hemisphere" && kind != "cone") return std::nullopt;
  const auto params = reader.numbers(e, "params", kind == "cone" ? 2 : 1);
  if (!params) reader.fail(DYN_ERROR_PARSE, e, "builtin=" + load::quoted(std::string(kind)) + " needs params");
  const double count = (*params)[0];
  const int least = kind == "cone" ? 3 : 0, most = kind == "cone" ? most_edges : kind == "sphere" ? finest_sphere : finest_hemisphere;
  if (!(count >= least && count <= most && count == std::floor(count))) reader.bad_numbers(e, "params", "an integer from " + std::to_string(least) + " to " + std::to_string(most) + " is expected first");
  if (kind == "cone" && !((*params)[1] >= 0)) reader.bad_numbers(e, "params", "a radius of 0 or more is expected second");
  std::vector<double> out;
  for (const Vec& v : kind == "sphere" ? sphere(int(count)) : kind == "hemisphere" ? hemisphere(int(count)) : cone(int(count), (*params)[1]))
    out.insert(out.end(), {v[0], v[1], v[2]});
  return out;
}

}  // namespace dyn::load
