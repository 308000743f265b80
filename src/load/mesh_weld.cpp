// Cleans a mesh: welds equal vertices, drops triangles without area and duplicates.
#include <algorithm>
#include <bit>
#include <cmath>

#include "mesh.hpp"
#include "base/portable.hpp"
#include "report.hpp"

namespace dyn::meshes {

using namespace load;

namespace {

constexpr double max_coordinate = 1e30;  // m; keeps fifth powers finite

// Hash grid of vertices. The cell size is the tolerance, or a single point.
class VertexGrid {
 public:
  VertexGrid(std::size_t points, double tolerance)
      : tolerance_(tolerance), heads_(std::bit_ceil(2 * points + 1), -1) { next_.reserve(points); }

  // Returns the vertex that p is welded to, or a new one.
  Index add(const double* p, std::vector<double>& vertices) {
    std::int64_t home[3];
    for (int k = 0; k < 3; ++k) home[k] = cell(p[k]);
    const int cells_around = tolerance_ > 0 ? 1 : 0;
    for (int dx = -cells_around; dx <= cells_around; ++dx)
      for (int dy = -cells_around; dy <= cells_around; ++dy)
        for (int dz = -cells_around; dz <= cells_around; ++dz)
          for (Index i = heads_[slot(home[0] + dx, home[1] + dy, home[2] + dz)]; i >= 0; i = next_[std::size_t(i)])
            if (near(p, vertices.data() + 3 * std::ptrdiff_t(i))) return i;
    const Index added = Index(next_.size());
    Index& head = heads_[slot(home[0], home[1], home[2])];
    next_.push_back(head);
    head = added;
    vertices.insert(vertices.end(), {p[0] + 0.0, p[1] + 0.0, p[2] + 0.0});  // -0 becomes 0
    return added;
  }

 private:
  std::int64_t cell(double x) const {
    return tolerance_ > 0 ? std::int64_t(std::floor(x / tolerance_)) : std::bit_cast<std::int64_t>(x + 0.0);
  }
  std::size_t slot(std::int64_t x, std::int64_t y, std::int64_t z) const {
    std::uint64_t h = std::uint64_t(x) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 32 ^ std::uint64_t(y)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 29 ^ std::uint64_t(z)) * 0x94d049bb133111ebu;
    return std::size_t(h ^ h >> 32) & (heads_.size() - 1);
  }
  bool near(const double* p, const double* q) const {
    if (tolerance_ > 0) return math::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) <= tolerance_;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
  }

  double tolerance_;
  std::vector<Index> heads_, next_;
};

// Returns whether the corners are collinear within rounding.
bool is_degenerate(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> e = b - a, f = c - b, g = a - c;
  const double longest = std::max({dot(e, e), dot(f, f), dot(g, g)});
  return !(length(cross(e, g)) > 1e-14 * longest);
}

struct Triangle {
  Index a, b, c;
  bool operator==(const Triangle&) const = default;
};
// The same cyclic order, beginning with the lowest corner.
Triangle canonical(Triangle t) {
  while (t.a > t.b || t.a > t.c) t = {t.b, t.c, t.a};
  return t;
}

// Set of triangles. add returns whether the triangle is new.
class TriangleSet {
 public:
  explicit TriangleSet(std::size_t n) : slots_(std::bit_ceil(2 * n + 1), {-1, -1, -1}) {}
  bool add(const Triangle& given) {
    const Triangle t = canonical(given);
    std::uint64_t h = (std::uint64_t(std::uint32_t(t.a)) << 32 | std::uint32_t(t.b)) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 31 ^ std::uint32_t(t.c)) * 0xbf58476d1ce4e5b9u;
    for (std::size_t i = std::size_t(h >> 20);; ++i) {
      Triangle& s = slots_[i & (slots_.size() - 1)];
      if (s == t) return false;
      if (s.a < 0) return s = t, true;
    }
  }

 private:
  std::vector<Triangle> slots_;
};

}  // namespace

Mesh make_mesh(const double* points, std::int64_t n, const Index* triangles, std::int64_t m, double weld_tolerance,
               const std::string& who, const std::uint32_t* colours) {
  const auto fail = [&](dynStatus status, const std::string& message) { throw Error(status, who + ": " + message); };
  if (m > max_triangles)
    fail(DYN_ERROR_LIMIT,
         std::to_string(m) + " triangles, and the limit is " + std::to_string(max_triangles) + ": simplify the mesh");
  if (n > 3 * max_triangles)
    fail(DYN_ERROR_LIMIT, std::to_string(n) + " vertices, and the limit is " + std::to_string(3 * max_triangles));
  for (std::int64_t i = 0; i < 3 * n; ++i) {
    const std::string where = "vertex " + std::to_string(i / 3) + " has " + std::string(1, "xyz"[i % 3]) + " = ";
    if (!std::isfinite(points[i]))
      fail(DYN_ERROR_NONFINITE, where + (std::isnan(points[i]) ? "NaN" : "infinity") + ": export the mesh again");
    if (std::abs(points[i]) > max_coordinate)
      fail(DYN_ERROR_LIMIT, where + text(points[i]) + " m, and the limit is " + text(max_coordinate));
  }
  double size = 0;
  for (std::int64_t i = 0; i < 3 * n; ++i) size = std::max(size, std::abs(points[i]));
  if (!(weld_tolerance >= 0) || !(weld_tolerance <= max_coordinate))
    fail(DYN_ERROR_ARGUMENT, "the weld tolerance is " + text(weld_tolerance) + ": give metres, at least 0");
  if (weld_tolerance < size * 1e-15) weld_tolerance = 0;  // below one rounding error

  std::vector<bool> used(static_cast<std::size_t>(n), m == 0);
  for (std::int64_t k = 0; k < 3 * m; ++k) {
    const Index i = triangles[k];
    if (i < 0 || i >= n)
      fail(DYN_ERROR_ARGUMENT,
           "triangle " + std::to_string(k / 3) + " has the vertex " + std::to_string(i) + ": give 0 to " + std::to_string(n - 1));
    used[std::size_t(i)] = true;
  }

  Mesh out;
  VertexGrid cells{std::size_t(n), weld_tolerance};
  std::vector<Index> id(static_cast<std::size_t>(n), -1);
  for (std::int64_t i = 0; i < n; ++i)
    if (used[std::size_t(i)]) {
      const Index before = out.vertex_count();
      id[std::size_t(i)] = cells.add(points + 3 * i, out.vertices);
      out.welded += id[std::size_t(i)] < before;
    }

  TriangleSet seen{std::size_t(m)};
  std::vector<Index> all;  // includes triangles without area, which also connect others
  all.reserve(3 * std::size_t(m));
  out.triangles.reserve(3 * std::size_t(m));
  for (std::int64_t t = 0; t < m; ++t) {
    const auto corner = [&](int k) { return id[std::size_t(triangles[3 * t + k])]; };
    const Index a = corner(0), b = corner(1), c = corner(2);
    if (a == b || b == c || c == a) {
      ++out.degenerate;
      continue;
    }
    if (!seen.add({a, b, c})) {
      ++out.duplicates;
      continue;
    }
    all.insert(all.end(), {a, b, c});
    if (is_degenerate(out.vertex(a), out.vertex(b), out.vertex(c))) ++out.degenerate;
    else {
      out.triangles.insert(out.triangles.end(), {a, b, c});
      if (colours) out.colours.push_back(colours[t]);
    }
  }
  if (std::all_of(out.colours.begin(), out.colours.end(), [](std::uint32_t c) { return c == 0; })) out.colours.clear();
  if (m > 0 && out.triangles.empty())
    fail(DYN_ERROR_INVALID, "no triangle has an area: all " + std::to_string(m) + " are degenerate");
  out.topology = topology_of(all);
  return out;
}

}  // namespace dyn::meshes
