// Shapes made of pieces in a tree of boxes: triangles.hpp, height_field.hpp. They are not convex. Every query searches the tree
// for the deciding piece. A surface S derives from Surface<S> and holds `radius`. In its own frame, for its core, it has
//   type, name
//   Node, root, max_children    a node of the tree, the root, the largest number of children
//   box(node)                    box of all pieces below the node
//   slab(node)                   slab of all pieces below the node; thin where they are flat
//   split(node, out)             children of the node; returns their number, 0 for a leaf
//   pieces(node), piece(node, i, facet)    number of pieces of a leaf, and a piece as a convex shape (facet.hpp)
//   triangle(node, i, corners)   the piece's triangle on the surface, counter-clockwise seen from outside
//   number(node, i, k)           vertex number of the triangle's corner k
//   closed()                     the surface bounds a solid
//   extent(), solid()            as in shape.hpp; solid() is NaN if the surface is not closed
// It inherits support, bounds, signed_distance, ray, mass_properties, volume.
#pragma once

#include "shape/facet.hpp"

namespace dyn::shape {

// Visits leaves whose lower(node) is at most the limit, smallest first. leaf(node) may lower the limit.
template <class S, class Lower, class Leaf>
inline void search(const S& s, const double& limit, Lower&& lower, Leaf&& leaf) {
  struct Entry {
    typename S::Node node;
    double lower;
  };
  Entry stack[S::max_stack];
  Index depth = 0;
  stack[depth++] = {S::root(s), lower(S::root(s))};
  while (depth > 0) {
    const Entry e = stack[--depth];
    if (!(e.lower <= limit)) continue;
    typename S::Node below[S::max_children];
    const Index n = s.split(e.node, below);
    if (n == 0) {
      leaf(e.node);
      continue;
    }
    const Index first = depth;
    for (Index i = 0; i < n; ++i) {
      const Entry x = {below[i], lower(below[i])};
      if (!(x.lower <= limit)) continue;
      Index at = depth++;
      for (; at > first && stack[at - 1].lower < x.lower; --at) stack[at] = stack[at - 1];
      stack[at] = x;
    }
  }
}

DYN_INLINE Vec middle(const Bounds& b) { return (b.lower + b.upper) * 0.5; }
DYN_INLINE Vec half_of(const Bounds& b) { return (b.upper - b.lower) * 0.5; }
DYN_INLINE Vec positive(const Vec& a) { return Vec::make(std::max(a[0], 0.0), std::max(a[1], 0.0), std::max(a[2], 0.0)); }
// Distance from a point to a box, and between two boxes. Between overlapping boxes: minus the least overlap along an axis, a
// lower bound.
DYN_INLINE double distance_to(const Bounds& b, const Vec& p) { return norm(positive(sizes(p - middle(b)) - half_of(b))); }
DYN_INLINE double distance_between(const Bounds& a, const Bounds& b) {
  const Vec gap = sizes(middle(a) - middle(b)) - half_of(a) - half_of(b);
  const double most = largest(gap);
  return most <= 0 ? most : norm(positive(gap));
}

// Support height of a box along n.
DYN_INLINE double support_height(const Bounds& b, const Vec& n) { return dot(n, middle(b)) + dot(sizes(n), half_of(b)); }

// All points between two planes perpendicular to a unit normal.
struct Slab {
  Vec normal;
  double low, high;
};
// Upper bound of the support height along n of the intersection of box and slab. The slab bounds the normal component, the box
// the rest.
DYN_INLINE double support_height(const Bounds& b, const Slab& s, const Vec& n) {
  const double along = dot(n, s.normal);
  return std::min(support_height(b, n), support_height(b, n - s.normal * along) + std::max(along * s.low, along * s.high));
}

// Intersection of a ray and a triangle from either side (Moeller, Trumbore 1997): t and two weights. No hit: t infinite.
struct Crossing {
  double t, u, v, facing;  // facing: direction . normal, not normalised
};
inline Crossing cross_triangle(const Vec corner[3], const Vec& origin, const Vec& direction) {
  const Vec e = corner[1] - corner[0], f = corner[2] - corner[0], h = cross(direction, f), s = origin - corner[0],
            q = cross(s, e);
  const double det = dot(e, h);
  if (det == 0) return {infinity, 0, 0, 0};
  const double u = dot(s, h) / det, v = dot(direction, q) / det, t = dot(f, q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0)) return {infinity, u, v, 0};
  return {t, u, v, -det};
}
// Parameter at which a ray enters a box, or infinite.
inline double enters(const Bounds& b, const Vec& origin, const Vec& direction) {
  double enter = 0, leave = infinity;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) {
      if (origin[i] < b.lower[i] || origin[i] > b.upper[i]) return infinity;
      continue;
    }
    const double a = (b.lower[i] - origin[i]) / direction[i], c = (b.upper[i] - origin[i]) / direction[i];
    enter = std::max(enter, std::min(a, c)), leave = std::min(leave, std::max(a, c));
  }
  return enter <= leave * (1 + 1e-15) ? enter : infinity;
}

template <class S>
struct Surface {
  static constexpr std::array<const char*, 0> size_names = {};
  static constexpr FileForm mjcf = {}, urdf = {};
  static constexpr bool from_surface = false;
  static void store(const double*, Shape&) {}
  static constexpr bool curved = false;

  Bounds bounds(const Pose& X) const {
    const Bounds b = self().bounds(X.R);
    const Vec r = Vec::make(self().radius, self().radius, self().radius);
    return {X.p + b.lower - r, X.p + b.upper + r};
  }
  Bounds bounds(const Mat& R) const {
    const Mat Rt = transpose(R);
    auto extreme = [&](int i, double sign) { return dot(Rt[i], support(Rt[i] * sign)); };
    return {Vec::make(extreme(0, -1), extreme(1, -1), extreme(2, -1)), Vec::make(extreme(0, 1), extreme(1, 1), extreme(2, 1))};
  }
  Vec support(const Vec& d) const {
    double limit = infinity;  // of minus the height
    Vec best = Vec::zero();
    Facet piece;
    search(self(), limit, [&](const auto& node) { return -support_height(self().box(node), d); },
           [&](auto node) {
             for (Index i = 0, n = self().pieces(node); i < n; ++i) {
               self().piece(node, i, piece);
               for (int k = 0; k < piece.hull.vertices; ++k)
                 if (const double low = -dot(d, piece.corner(k)); low < limit) limit = low, best = piece.corner(k);
             }
           });
    return best;
  }

  // Has no feature: contacts of surfaces are cut from their triangles.
  void facing(const Vec&, double, Feature&) const {}

  // Signed distance of the rounded surface, negative inside a closed one.
  Nearest signed_distance(const Vec& p) const {
    const Nearest n = self().nearest(p);
    return {n.point + n.normal * self().radius, n.normal, n.distance - self().radius, n.unique};
  }
  Nearest nearest(const Vec& p) const {
    Nearest best = nearest_triangle(p);
    if (!self().closed() || !self().inside(p)) return best;
    return {best.point, -best.normal, -best.distance, best.unique};
  }
  // Ray parity test of a closed surface. Takes another direction when the ray passes close to an edge.
  bool inside(const Vec& p) const {
    if (!(distance_to(self().box(S::root(self())), p) <= 0)) return false;
    Vec direction = Vec::make(0.5385, 0.3170, 0.7807);
    int crossings = 0;
    for (int attempt = 0; attempt < 16; ++attempt) {
      const double limit = 0;  // lower() returns infinity for nodes that the ray misses
      bool clear = true;
      crossings = 0;
      search(self(), limit, [&](const auto& node) { return enters(self().box(node), p, direction) < infinity ? 0 : infinity; },
             [&](auto node) {
               Vec corner[3];
               for (Index i = 0, n = self().pieces(node); i < n; ++i) {
                 self().triangle(node, i, corner);
                 const Crossing c = cross_triangle(corner, p, direction);
                 constexpr double edge = 1e-9;
                 if (c.u > -edge && c.v > -edge && c.u + c.v < 1 + edge && (c.u < edge || c.v < edge || c.u + c.v > 1 - edge))
                   clear = false;
                 if (c.t < infinity) crossings += c.facing > 0 ? 1 : -1;
               }
             });
      if (clear) break;
      direction = zxy(direction) + Vec::make(0.1371, -0.4143, 0.2937) * (1.0 + attempt);
    }
    return crossings != 0;
  }

  // First piece hit. A ray from inside a closed surface hits at t = 0.
  Hit ray(const Vec& origin, const Vec& direction) const {
    if (self().closed()) {
      const Nearest n = signed_distance(origin);
      if (n.distance <= 0) return {0, n.normal};
    }
    Hit best = {infinity, Vec::zero()};
    const double r = self().radius;
    const Vec rounding = Vec::make(r, r, r);
    Facet piece;
    search(self(), best.t,
           [&](const auto& node) {
             const Bounds b = self().box(node);
             return enters({b.lower - rounding, b.upper + rounding}, origin, direction);
           },
           [&](auto node) {
             for (Index i = 0, n = self().pieces(node); i < n; ++i) {
               self().piece(node, i, piece);
               const Hit hit = ray_of(piece, origin - piece.origin, direction);
               if (hit.t < best.t) best = hit;
             }
           });
    return best;
  }

  Inertia<double> mass_properties(double density) const {
    const Inertia<double> Y = self().solid();
    return {Y.m * density, Y.h * density, Y.I * density};
  }
  double volume() const { return self().solid().m; }

 protected:
  // Nearest point of the triangles; the normal points away from it.
  Nearest nearest_triangle(const Vec& p) const {
    return nearest_of(p, [&](auto node, Index i, Facet&) {
      Vec corner[3];
      self().triangle(node, i, corner);
      const Vec c = nearest_of_triangle(corner[0], corner[1], corner[2], p), away = p - c,
                n = cross(corner[1] - corner[0], corner[2] - corner[0]);
      const double d = norm(away);
      return Nearest{c, d > 0 ? away * (1 / d) : n * (1 / norm(n)), d, d > 0 || self().closed()};
    });
  }
  // Nearest point of the pieces, which have volume.
  Nearest nearest_piece(const Vec& p) const {
    return nearest_of(p, [&](auto node, Index i, Facet& piece) {
      self().piece(node, i, piece);
      Nearest n = Convex(piece.shape(0)).nearest(p - piece.origin);
      n.point += piece.origin;
      return n;
    });
  }

 private:
  const S& self() const { return static_cast<const S&>(*this); }

  template <class Of>
  Nearest nearest_of(const Vec& p, Of&& of) const {
    Nearest best = {Vec::zero(), Vec::zero(), infinity, true};
    double limit = infinity;
    Facet piece;
    search(self(), limit, [&](const auto& node) { return distance_to(self().box(node), p); },
           [&](auto node) {
             for (Index i = 0, n = self().pieces(node); i < n; ++i) {
               const Nearest x = of(node, i, piece);
               const double tie = 1e-12 * (std::abs(x.distance) + self().extent());
               if (x.distance > best.distance + tie) continue;
               const bool tied = std::abs(x.distance - best.distance) <= tie,
                          other = tied && norm(x.point - best.point) > 1e3 * tie;
               const bool unique = x.unique && (best.unique || !tied) && !other;
               if (x.distance < best.distance) best = x, limit = x.distance + tie;
               best.unique = unique;
             }
           });
    return best;
  }

  // Hit of a piece by a ray, in the piece's frame.
  Hit ray_of(const Facet& piece, const Vec& origin, const Vec& direction) const {
    const double r = self().radius;
    const bool flat = piece.hull.vertices == 3;
    if (r > 0 || !flat) return Round(piece, r).ray(origin, direction);
    const Vec corner[] = {piece.hull.vertex(0), piece.hull.vertex(1), piece.hull.vertex(2)};
    const Crossing c = cross_triangle(corner, origin, direction);
    return {c.t, piece.hull.normal(0) * (c.facing > 0 ? -1.0 : 1.0)};
  }
  // A piece as points only, for the ray of Solid.
  struct Round : Solid<Round> {
    const Facet& piece;
    double radius;
    Round(const Facet& p, double r) : piece(p), radius(r) {}
    double extent() const { return piece.hull.extent; }
    Nearest nearest(const Vec& p) const {
      if (piece.hull.vertices > 3) return Convex(piece.shape(0)).nearest(p);
      const Vec c = nearest_of_triangle(piece.hull.vertex(0), piece.hull.vertex(1), piece.hull.vertex(2), p), away = p - c;
      const double d = norm(away);
      return {c, d > 0 ? away * (1 / d) : piece.hull.normal(0), d, d > 0};
    }
  };
};

}  // namespace dyn::shape
