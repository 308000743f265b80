// Polygons to triangles.
#include <algorithm>
#include <cmath>

#include "mesh_soup.hpp"
#include "spatial/vec3.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;
using Corners = std::vector<std::int32_t>;

constexpr std::size_t max_clipped = 256;  // corners; clipping takes the square of their number

struct Polygon {
  const std::vector<double>& vertices;
  Vec normal = Vec::zero();  // Newell's: twice the area

  Vec at(std::int32_t i) const { return load3(vertices.data() + 3 * std::ptrdiff_t(i)); }
  // Twice the area of a triangle, seen from the normal; below zero: it is turned round.
  double area(std::int32_t a, std::int32_t b, std::int32_t c) const { return dot(cross(at(b) - at(a), at(c) - at(a)), normal); }
  bool inside(std::int32_t p, std::int32_t a, std::int32_t b, std::int32_t c) const {
    return area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
  }
};

void add(Corners& out, std::int32_t a, std::int32_t b, std::int32_t c) { out.insert(out.end(), {a, b, c}); }

void add_fan(const Corners& c, Corners& out) {
  for (std::size_t k = 1; k + 1 < c.size(); ++k) add(out, c[0], c[k], c[k + 1]);
}

// Cuts off corners whose triangle holds no other corner, one after the other around the polygon.
void clip_ears(const Polygon& p, Corners c, Corners& out) {
  std::size_t at = 0, since = 0;  // since: corners tried since the last ear
  while (c.size() > 3) {
    const std::size_t n = c.size(), before = (at + n - 1) % n, after = (at + 1) % n;
    const std::int32_t a = c[before], b = c[at], d = c[after];
    const auto blocks = [&](std::int32_t x) { return x != a && x != b && x != d && p.inside(x, a, b, d); };
    if (since < n && (!(p.area(a, b, d) > 0) || std::any_of(c.begin(), c.end(), blocks))) {
      at = after, ++since;
      continue;
    }
    add(out, a, b, d);  // after a round without an ear any corner: the polygon crosses itself
    c.erase(c.begin() + std::ptrdiff_t(at));
    at = at == c.size() ? 0 : at, since = 0;
  }
  add(out, c[0], c[1], c[2]);
}

}  // namespace

void add_polygon(const std::vector<double>& vertices, const std::vector<std::int32_t>& c, std::vector<std::int32_t>& out) {
  const std::size_t n = c.size();
  Polygon p{vertices};
  if (n == 3) return add(out, c[0], c[1], c[2]);
  if (n == 4) {
    const auto square = [&](std::size_t i, std::size_t j) {
      const Vec d = p.at(c[i]) - p.at(c[j]);
      return dot(d, d);
    };
    const std::size_t first = square(0, 2) < square(1, 3) ? 0 : 1;
    add(out, c[first], c[first + 1], c[first + 2]), add(out, c[first], c[first + 2], c[(first + 3) % 4]);
    return;
  }
  for (std::size_t k = 1; k + 1 < n; ++k) p.normal += cross(p.at(c[k]) - p.at(c[0]), p.at(c[k + 1]) - p.at(c[0]));
  const auto convex_at = [&](std::size_t k) { return p.area(c[(k + n - 1) % n], c[k], c[(k + 1) % n]) >= 0; };
  bool convex = n > max_clipped;
  for (std::size_t k = 0; !convex && k < n && convex_at(k); ++k) convex = k + 1 == n;
  if (convex)
    add_fan(c, out);
  else
    clip_ears(p, c, out);
}

}  // namespace dyn::load
