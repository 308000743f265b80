// A convex polytope with its faces and the neighbours of each vertex. The arrays lie elsewhere.
#pragma once

#include <bit>

#include "shape/argmax.hpp"
#include "shape/shape.hpp"

namespace dyn::shape {

// Arrays of a Convex. Coordinates are stored by component. Each array is padded to a multiple of `lanes` by repeating the last
// vertex, so searches use whole registers. Faces are planes n.x <= offset with vertices counter-clockwise seen from outside.
struct Hull {
  static constexpr Index lanes = argmax_lanes;
  static constexpr Index padded(Index n) { return (n + lanes - 1) / lanes * lanes; }

  Vec center;                               // mean of the vertices
  Index vertices, faces, corners;           // corners of all faces
  alignas(8) const double* x, *y, *z;  // padded(vertices); eight bytes on every machine, where a model's block stores offsets
  alignas(8) const double* planes;          // 4 a face: unit normal, offset
  alignas(8) const Index* face_start;       // faces + 1
  alignas(8) const Index* face_vertices;    // corners
  alignas(8) const Index* neighbour_start;  // vertices + 1
  alignas(8) const Index* neighbours;       // corners
  double extent;                            // farthest vertex from the origin

  DYN_INLINE Vec vertex(Index i) const { return Vec::make(x[i], y[i], z[i]); }
  Vec normal(Index f) const { return load3(planes + 4 * f); }
  double offset(Index f) const { return planes[4 * f + 3]; }

  // Calls f for the arrays, in stored order.
  template <class F>
  void each_array(F&& f) {
    const std::size_t room = std::size_t(padded(vertices));
    f(x, room), f(y, room), f(z, room), f(planes, 4 * std::size_t(faces));
    f(face_start, std::size_t(faces) + 1), f(face_vertices, std::size_t(corners));
    f(neighbour_start, std::size_t(vertices) + 1), f(neighbours, std::size_t(corners));
  }
};

// Lists the faces around each vertex, ascending: `corners` entries, in which those of a vertex begin where its neighbours do.
// Returns false if the hull has other faces than neighbours at a vertex.
inline bool list_vertex_faces(const Hull& h, Index* out) {
  std::fill_n(out, h.corners, Index(-1));
  for (Index f = 0; f < h.faces; ++f)
    for (Index c = h.face_start[f]; c < h.face_start[f + 1]; ++c) {
      Index at = h.neighbour_start[h.face_vertices[c]];
      const Index end = h.neighbour_start[h.face_vertices[c] + 1];
      while (at < end && out[at] >= 0) ++at;
      if (at == end) return false;
      out[at] = f;
    }
  return true;
}

struct Convex : Solid<Convex> {
  static constexpr Type type = Type::Convex;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_CONVEX;
  static constexpr bool from_surface = true;
  const Hull& hull;
  const Index* vertex_faces;
  double radius;

  explicit Convex(const Shape& s) : hull(*s.hull), vertex_faces(s.vertex_faces), radius(s.radius) {}

  Vec support(const Vec& d) const { return hull.vertex(last_ = hull.vertices <= search_all ? farthest(d) : climb(d)); }
  // Number of the vertex that support() returned last, as features have it.
  std::uint16_t support_number() const { return std::uint16_t(last_); }
  // Number of a vertex of a face.
  Index corner(Index face, Index k) const { return hull.face_vertices[hull.face_start[face] + k]; }
  // Of hulls of at most 64 vertices: a bit for each one no higher than limit. Writes the heights offset + n.v, padded(vertices) of
  // them, and makes the lowest of these vertices the last support vertex.
  std::uint64_t vertices_below(double limit, const Vec& n, double offset, double* heights) const;
  // Whether that vertex, a support point of n, is the only one within `band` of its plane: no neighbour is.
  bool is_alone(const Vec& n, double band) const;
  Nearest nearest(const Vec& p) const;
  Flat flat(const Vec& n) const;
  void facing(const Vec& n, double band, Feature& f) const { facing_at(support(n), n, band, f); }
  void facing_at(const Vec& top, const Vec& n, double band, Feature& f) const;
  // Number of the face at the last support vertex, at top, that faces n: the one with most corners that is_within(vertex) holds;
  // of several, the one that faces n most. -1: none.
  template <class F>
  DYN_INLINE Index facing_face(const Vec& top, const Vec& n, F&& is_within) const;
  double extent() const { return hull.extent; }
  Inertia<double> solid() const;

 private:
  static constexpr Index search_all = 128;  // up to this count all vertices are tested

  Index farthest(const Vec& d) const;
  bool flat_at(Index top, const Vec& n, Flat& f) const;
  mutable Index last_ = 0;  // support vertex

  // Hill climbing over neighbours from the last support vertex. On a hull every local maximum is global.
  Index climb(const Vec& d) const {
    Index best = last_;
    double most = dot(hull.vertex(best), d);
    for (bool up = true; up;) {
      up = false;
      const Index at = best;
      for (Index k = hull.neighbour_start[at]; k < hull.neighbour_start[at + 1]; ++k) {
        const double along = dot(hull.vertex(hull.neighbours[k]), d);
        if (along > most) most = along, best = hull.neighbours[k], up = true;
      }
    }
    return best;
  }
};

inline Index Convex::farthest(const Vec& d) const {
  const std::int64_t best = argmax(hull.vertices, [&](std::int64_t i) DYN_INLINE_LAMBDA {
    const ArgmaxBlock x = ArgmaxBlock::load(hull.x + i) * d[0];  // GCC contracts the product that it meets first
    return x + ArgmaxBlock::load(hull.y + i) * d[1] + ArgmaxBlock::load(hull.z + i) * d[2];
  });
  return std::min(Index(best), hull.vertices - 1);
}

inline std::uint64_t Convex::vertices_below(double limit, const Vec& n, double offset, double* heights) const {
  std::uint64_t below = 0;
  for (Index i = 0; i < hull.vertices; i += argmax_lanes) {
    const ArgmaxBlock x = ArgmaxBlock::load(hull.x + i) * n[0];
    const ArgmaxBlock high = x + ArgmaxBlock::load(hull.y + i) * n[1] + ArgmaxBlock::load(hull.z + i) * n[2] + offset;
    high.store(heights + i);
    below |= std::uint64_t(bits_of(high <= limit)) << i;
  }
  below &= ~std::uint64_t(0) >> (64 - hull.vertices);  // without the padding
  double least = infinity;
  for_each_bit(below, [&](int k) {
    if (heights[k] < least) least = heights[k], last_ = k;
  });
  return below;
}

// Nearest point over all faces; inside, the nearest face.
inline Nearest Convex::nearest(const Vec& p) const {
  Index inner = 0;
  double height = -infinity;
  Nearest best = {Vec::zero(), Vec::zero(), infinity, true};
  // point a + t e of an edge
  auto consider = [&](const Vec& a, const Vec& e, double t) {
    const Vec c = a + e * t;
    Vec r = p - c;
    if (t > 0 && t < 1) r -= e * (dot(r, e) / dot(e, e));  // once more, because r may be far shorter than e
    const double d = norm(r);
    if (d < best.distance) best = {c, r * (1 / d), d, true};
  };
  bool tie = false;
  for (Index f = 0; f < hull.faces; ++f) {
    const Vec n = hull.normal(f);
    const double h = dot(n, p) - hull.offset(f);
    if (h >= height) tie = h == height, height = h, inner = f;
    if (h <= 0) continue;
    bool over = true;
    const Index end = hull.face_start[f + 1];
    for (Index k = hull.face_start[f]; k < end; ++k) {
      const Vec a = hull.vertex(hull.face_vertices[k]),
                b = hull.vertex(hull.face_vertices[k + 1 < end ? k + 1 : hull.face_start[f]]);
      const Vec e = b - a;
      if (dot(cross(e, p - a), n) >= 0) continue;
      over = false;
      consider(a, e, std::clamp(dot(p - a, e) / dot(e, e), 0.0, 1.0));
    }
    if (over) return {p - n * h, n, h, true};
  }
  if (height > 0) return best;
  const Vec n = hull.normal(inner);
  return {p - n * height, n, height, !tie};
}

// Edges at a vertex that are perpendicular to n. Returns false if one of them rises: the vertex is then no support vertex.
inline bool Convex::flat_at(Index top, const Vec& n, Flat& f) const {
  const Vec v = hull.vertex(top);
  f = {0, Vec::zero(), Vec::zero()};
  for (Index k = hull.neighbour_start[top]; k < hull.neighbour_start[top + 1]; ++k) {
    const Vec e = hull.vertex(hull.neighbours[k]) - v;
    const double rise = dot(e, n), length2 = dot(e, e);
    if (rise * rise > flat_slope * flat_slope * length2) {
      if (rise > 0) return false;
      continue;
    }
    const double length = std::sqrt(length2);
    if (f.dimension == 0) {
      f = {1, e * (1 / length), Vec::zero()};
    } else if (f.dimension == 1) {
      const Vec rest = e - f.u * dot(e, f.u);
      if (norm(rest) > flat_slope * length) f = {2, f.u, rest * (1 / norm(rest))};
    }
  }
  return true;
}
// The last support vertex usually is that of n too.
inline Flat Convex::flat(const Vec& n) const {
  Flat f;
  if (!flat_at(last_, n, f)) flat_at(farthest(n), n, f);
  return f;
}

inline bool Convex::is_alone(const Vec& n, double band) const {
  const auto along = [&](Index v) { return hull.x[v] * n[0] + hull.y[v] * n[1] + hull.z[v] * n[2]; };
  const double least = along(last_) - band;
  bool alone = true;
  for (Index k = hull.neighbour_start[last_]; k < hull.neighbour_start[last_ + 1]; ++k)
    alone &= along(hull.neighbours[k]) < least;
  return alone;
}

template <class F>
DYN_INLINE Index Convex::facing_face(const Vec& top, const Vec& n, F&& is_within) const {
  Index best = -1;
  double most = 0;
  const auto consider = [&](Index k) {
    const double* const plane = hull.planes + 4 * k;
    const double slope = plane[0] * n[0] + plane[1] * n[1] + plane[2] * n[2];
    int within = 0;
    for (Index c = hull.face_start[k]; c < hull.face_start[k + 1]; ++c) within += is_within(hull.face_vertices[c]);
    const double merit = slope > 0 ? within + slope / 2 : 0;  // half a cosine is less than a corner
    best = merit > most ? k : best, most = std::max(most, merit);
  };
  if (vertex_faces) {
    for (Index i = hull.neighbour_start[last_]; i < hull.neighbour_start[last_ + 1]; ++i) consider(vertex_faces[i]);
    return best;
  }
  // four planes at a time: few hold the top
  for (Index k = 0; k < hull.faces; k += 4) {
    const auto plane = [&](Index i) { return Double4::load(hull.planes + 4 * std::min(k + i, hull.faces - 1)); };
    Double4 x, y, z, offset;
    transpose4(plane(0), plane(1), plane(2), plane(3), x, y, z, offset);
    const Double4 above = x * top[0] + y * top[1] + z * top[2];
    const unsigned valid = (1u << std::min<Index>(hull.faces - k, 4)) - 1;
    for_each_bit(bits_of(offset - above <= 1e-9 * hull.extent) & valid, [&](int i) { consider(k + i); });
  }
  return best;
}

inline void Convex::facing_at(const Vec& top, const Vec& n, double band, Feature& f) const {
  const double height = dot(top, n);
  const Index best = facing_face(
      top, n, [&](Index v) { return height - (hull.x[v] * n[0] + hull.y[v] * n[1] + hull.z[v] * n[2]) <= band; });
  if (best < 0) return f.add(top, 0);
  const Index start = hull.face_start[best], corners = hull.face_start[best + 1] - start;
  const Index step = (corners + Feature::most - 1) / Feature::most;
  for (Index c = 0; c < corners; c += step) f.add(hull.vertex(hull.face_vertices[start + c]), hull.face_vertices[start + c]);
}

// Moments of the core without rounding, by tetrahedra from the centre to its triangles. With corners 0, a, b, c and 6 V = det(a,
// b, c) the second moment is V/20 (sum of x x^T over a, b, c, a + b + c).
inline Inertia<double> Convex::solid() const {
  Inertia<double> Y = Inertia<double>::zero();
  Sym3<double> S = Sym3<double>::zero();
  for (Index f = 0; f < hull.faces; ++f) {
    const Index start = hull.face_start[f], end = hull.face_start[f + 1];
    const Vec a = hull.vertex(hull.face_vertices[start]) - hull.center;
    for (Index k = start + 1; k + 1 < end; ++k) {
      const Vec b = hull.vertex(hull.face_vertices[k]) - hull.center, c = hull.vertex(hull.face_vertices[k + 1]) - hull.center;
      const double V = dot(a, cross(b, c)) / 6;
      const Vec sum = a + b + c;
      Y.m += V, Y.h += sum * (V / 4);
      S = S + (symmetric_outer(a, a) + symmetric_outer(b, b) + symmetric_outer(c, c) + symmetric_outer(sum, sum)) * (V / 20);
    }
  }
  // inertia = tr(S) 1 - S about the centre, then shifted to the origin
  const double t = S.d[0] + S.d[1] + S.d[2];
  Y.I = {Vec::make(t, t, t) - S.d, -S.o};
  return Y.shifted(hull.center);
}

}  // namespace dyn::shape
