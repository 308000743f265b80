// Surfaces of <mesh builtin>, by MuJoCo's definitions. A wedge is the hull of its corners and has no faces.
#include <cmath>

#include "mesh.hpp"
#include "mjcf_robot.hpp"

namespace dyn::load {

namespace {

using Vec = Vec3<double>;

constexpr double pi = 3.14159265358979323846;
constexpr int finest_sphere = 4, finest_hemisphere = 10, most_parts = 1000;  // the first two are MuJoCo's limits

struct Surface {
  std::vector<Vec> corners = {};
  std::vector<Index> faces = {};

  Index add(const Vec& corner) { return corners.push_back(corner), Index(corners.size()) - 1; }
  void triangle(Index a, Index b, Index c) { faces.insert(faces.end(), {a, b, c}); }
  void quad(Index a, Index b, Index c, Index d) { triangle(a, b, d), triangle(b, c, d); }
};

// The attribute params with its checks.
struct Params {
  const Reader& reader;
  const Element& e;
  std::vector<double> x;

  int whole(size_t k, int least, int most) const {
    if (!(x[k] >= least && x[k] <= most && x[k] == std::floor(x[k])))
      reader.bad_numbers(
          e, "params",
          "number " + std::to_string(k + 1) + " is an integer from " + std::to_string(least) + " to " + std::to_string(most));
    return int(x[k]);
  }
  double real(size_t k, double least, double most, bool positive) const {
    if (!(x[k] >= least && x[k] <= most) || (positive && x[k] == 0))
      reader.bad_numbers(e, "params",
                         "number " + std::to_string(k + 1) + " is " + (positive ? "positive" : text(least) + " or more") +
                             (std::isfinite(most) ? ", at most " + text(most) : ""));
    return x[k];
  }
};

constexpr double no_bound = std::numeric_limits<double>::infinity();

// A result of arithmetic in single precision. Volatile, as GCC 12 without AVX leaves out a rounding where it vectorises.
double single(double x) {
  volatile const float rounded = float(x);
  return rounded;
}
Vec rounded(const Vec& v) { return Vec::make(single(v[0]), single(v[1]), single(v[2])); }

Vec unit(const Vec& a) { return a * (1 / std::sqrt(dot(a, a))); }

// Sine and cosine with an exponent of their size.
double power(double x, double exponent) { return std::copysign(std::pow(std::abs(x), exponent), x); }
double cosine(double angle, double exponent) { return power(std::cos(angle), exponent); }
double sine(double angle, double exponent) { return power(std::sin(angle), exponent); }

// An icosahedron whose faces are split into four, so many times, in single precision.
Surface sphere(const Params& p) {
  const double t = single((1 + std::sqrt(5.0)) / 2), norm = std::sqrt(1 + single(t * t));
  Surface s;
  for (const auto& [x, y, z] : {std::array{-1.0, t, 0.0},
                                {1, t, 0},
                                {-1, -t, 0},
                                {1, -t, 0},
                                {0, -1, t},
                                {0, 1, t},
                                {0, -1, -t},
                                {0, 1, -t},
                                {t, 0, -1},
                                {t, 0, 1},
                                {-t, 0, -1},
                                {-t, 0, 1}})
    s.add(Vec::make(single(x / norm), single(y / norm), single(z / norm)));
  s.faces = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
             3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  for (int times = p.whole(0, 0, finest_sphere); times > 0; --times) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, made] = middles.emplace(std::minmax(a, b), 0);
      if (made) {
        const Vec half = rounded(rounded(s.corners[size_t(a)] + s.corners[size_t(b)]) * 0.5);
        const auto square = [&](int k) { return single(half[k] * half[k]); };
        const double length = single(std::sqrt(single(single(square(0) + square(1)) + square(2))));
        at->second = s.add(Vec::make(single(half[0] / length), single(half[1] / length), single(half[2] / length)));
      }
      return at->second;
    };
    const std::vector<Index> coarse = std::exchange(s.faces, {});
    for (size_t k = 0; k < coarse.size(); k += 3) {
      const Index a = coarse[k], b = coarse[k + 1], c = coarse[k + 2], ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      s.triangle(a, ab, ca), s.triangle(b, bc, ab), s.triangle(c, ca, bc), s.triangle(ab, bc, ca);
    }
  }
  return s;
}

// Rings of the octahedron above the plane z = 0, each with four corners more than the one before, and a flat lid.
Surface hemisphere(const Params& p) {
  const int rings = p.whole(0, 0, finest_hemisphere) + 1;
  Surface s;
  s.add(Vec::make(0, 0, 1));
  for (int ring = 1; ring <= rings; ++ring)
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < ring; ++i) {
        const double along = double(ring - i), across = double(i), up = double(rings - ring);  // of the octahedron of size rings
        s.add(unit(side == 0   ? Vec::make(along, across, up)
                   : side == 1 ? Vec::make(-across, along, up)
                   : side == 2 ? Vec::make(-along, -across, up)
                               : Vec::make(across, -along, up)));
      }
  const auto at = [](int ring, int side, int i) {
    return ring == 0 ? 0 : Index(1 + 2 * ring * (ring - 1) + (side * ring + i) % (4 * ring));
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i <= ring; ++i) {
        s.triangle(at(ring, side, i), at(ring + 1, side, i), at(ring + 1, side, i + 1));
        if (i < ring) s.triangle(at(ring, side, i), at(ring + 1, side, i + 1), at(ring, side, i + 1));
      }
  const Index middle = s.add(Vec::zero());
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < rings; ++i) s.triangle(at(rings, side, i), middle, at(rings, side, i + 1));
  return s;
}

// From the unit circle at z = -1 to another radius at z = 1. Its hull has the faces.
Surface cone(const Params& p) {
  const int edges = p.whole(0, 3, most_parts);
  const double radius = p.real(1, 0, no_bound, false);
  Surface s;
  for (const double z : {-1.0, 1.0})
    for (int k = 0; k < (z > 0 && radius == 0 ? 1 : edges); ++k) {
      const double r = z < 0 ? 1 : radius, angle = 2 * pi * k / edges;
      s.add(Vec::make(r * std::cos(angle), r * std::sin(angle), z));
    }
  return s;
}

// Rings of res corners between two poles.
Surface supersphere(const Params& p) {
  const int res = p.whole(0, 3, most_parts);
  const double e = p.real(1, 0, no_bound, false), n = p.real(2, 0, no_bound, false);
  Surface s;
  const Index south = s.add(Vec::make(0, 0, -1));
  for (int i = 1; i < res; ++i)
    for (int j = 0; j < res; ++j) {
      const double v = -pi / 2 + i * pi / res, u = -pi + j * 2 * pi / res;
      s.add(Vec::make(cosine(v, n) * cosine(u, e), cosine(v, n) * sine(u, e), sine(v, n)));
    }
  const Index north = s.add(Vec::make(0, 0, 1));
  const auto at = [&](int ring, int j) { return Index(1 + ring * res + j % res); };
  for (int j = 0; j < res; ++j) {
    s.triangle(south, at(0, j + 1), at(0, j)), s.triangle(at(res - 2, j), at(res - 2, j + 1), north);
    for (int i = 0; i + 2 < res; ++i) s.quad(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  }
  return s;
}

Surface supertorus(const Params& p) {
  const int res = p.whole(0, 3, most_parts);
  const double radius = p.real(1, 0, 1, true), s1 = p.real(2, 0, no_bound, true), t = p.real(3, 0, no_bound, true);
  Surface s;
  for (int i = 0; i < res; ++i)
    for (int j = 0; j < res; ++j) {
      const double u = 2 * pi * i / res, v = 2 * pi * j / res, out = 1 + radius * cosine(v, s1);
      s.add(Vec::make(out * cosine(u, t), out * sine(u, t), radius * sine(v, s1)));
    }
  const auto at = [&](int i, int j) { return Index(i % res * res + j % res); };
  for (int i = 0; i < res; ++i)
    for (int j = 0; j < res; ++j) s.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return s;
}

// Directions of a field of view around -z, whose middle is finer by gamma.
Surface wedge(const Params& p) {
  const int columns = p.whole(0, 1, most_parts), rows = p.whole(1, 1, most_parts);
  const double half[2] = {p.real(2, 0, 180, true) * pi / 180, p.real(3, 0, 90, true) * pi / 180}, gamma = p.real(4, 0, 1, false);
  const auto edge = [&](int k, int n) {
    const double x = -1 + 2.0 * k / n;
    return gamma * std::pow(x, 5) + (1 - gamma) * x;
  };
  Surface s;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const double azimuth = half[0] * (edge(i, columns) + edge(i + 1, columns)) / 2,
                   elevation = half[1] * (edge(j, rows) + edge(j + 1, rows)) / 2;
      s.add(Vec::make(std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)));
    }
  return s;
}

// Middles of the cells of a square at z = -1.
Surface plate(const Params& p) {
  const int columns = p.whole(0, 2, most_parts), rows = p.whole(1, 2, most_parts);
  Surface s;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) s.add(Vec::make(-1 + (2 * i + 1.0) / columns, -1 + (2 * j + 1.0) / rows, -1));
  const auto at = [&](int i, int j) { return Index(i * rows + j); };
  for (int i = 1; i < columns; ++i)
    for (int j = 1; j < rows; ++j)
      s.triangle(at(i - 1, j - 1), at(i, j - 1), at(i - 1, j)), s.triangle(at(i, j), at(i - 1, j), at(i, j - 1));
  return s;
}

struct Kind {
  std::string_view name;
  size_t params;
  Surface (*make)(const Params&);
};
constexpr Kind kinds[] = {
    {"sphere", 1, sphere},         {"hemisphere", 1, hemisphere}, {"cone", 2, cone},  {"supersphere", 3, supersphere},
    {"supertorus", 4, supertorus}, {"wedge", 5, wedge},           {"plate", 2, plate}};

}  // namespace

meshes::Mesh mjcf_builtin_mesh(const Reader& reader, const Element& e) {
  const std::string_view name = e.Attribute("builtin");
  const auto kind = std::find_if(std::begin(kinds), std::end(kinds), [&](const Kind& k) { return k.name == name; });
  if (kind == std::end(kinds)) {
    std::string known;
    for (const Kind& k : kinds) known += (known.empty() ? "" : ", ") + std::string(k.name);
    reader.fail(DYN_ERROR_PARSE, e, "builtin=" + load::in_quotes(std::string(name)) + " is none of " + known);
  }
  const auto params = reader.numbers(e, "params", kind->params);
  if (!params) reader.fail(DYN_ERROR_PARSE, e, "builtin=" + load::in_quotes(std::string(name)) + " needs params");
  const Surface surface = kind->make({reader, e, *params});
  meshes::Mesh out;
  for (const Vec& v : surface.corners)
    for (int k = 0; k < 3; ++k) out.vertices.push_back(single(v[k]));
  if (surface.faces.empty()) return out;
  return meshes::make_mesh(out.vertices.data(), Index(surface.corners.size()), surface.faces.data(),
                           Index(surface.faces.size() / 3), 0, reader.owner);
}

}  // namespace dyn::load
