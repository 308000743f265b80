// Shapes made of pieces, in a tree of boxes: triangles.hpp, height_field.hpp. They are not convex; every query searches the tree for the
// piece that decides. A surface S derives from Surface<S>, holds `radius`, and gives, about its core and in its own frame,
//   type, name
//   Node, root, max_children    a node of the tree, its first one, into how many others a node splits at most
//   box(node)                    holds all pieces below the node
//   slab(node)                   likewise, and where they are flat it is thin
//   split(node, out)             the nodes below it: how many; 0: a leaf
//   pieces(node), piece(node, i, facet)    the pieces of a leaf, as convex shapes (facet.hpp)
//   triangle(node, i, corners)   the triangle of a piece that belongs to the surface, counter-clockwise seen from outside
//   number(node, i, k)           that of its corner k among the surface's vertices
//   closed()                     the surface bounds a solid
//   extent(), solid()            as in shape.hpp; solid() is NaN where nothing is bounded
// and gets what shapes have: support, bounds, signed_distance, ray, mass_properties, volume.
#pragma once

#include "shape/facet.hpp"

namespace dyn::shape {

// Goes to the leaves whose lower(node) is not above the limit, those with less first; leaf(node) may lower the limit.
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
// From a point to a box; from box to box, below zero the least overlap along an axis: no two shapes in them are nearer.
DYN_INLINE double distance_to(const Bounds& b, const Vec& p) { return norm(positive(sizes(p - middle(b)) - half_of(b))); }
DYN_INLINE double distance_between(const Bounds& a, const Bounds& b) {
  const Vec gap = sizes(middle(a) - middle(b)) - half_of(a) - half_of(b);
  const double most = largest(gap);
  return most <= 0 ? most : norm(positive(gap));
}

// How far a box reaches along n.
DYN_INLINE double support_height(const Bounds& b, const Vec& n) { return dot(n, middle(b)) + dot(sizes(n), half_of(b)); }

// All between two planes across a unit normal.
struct Slab {
  Vec normal;
  double low, high;
};
// How far what lies in both reaches along n, at most: what n has along the normal is bounded by the slab, the rest by the box.
DYN_INLINE double support_height(const Bounds& b, const Slab& s, const Vec& n) {
  const double along = dot(n, s.normal);
  return std::min(support_height(b, n), support_height(b, n - s.normal * along) + std::max(along * s.low, along * s.high));
}

// Where a ray meets a triangle from either side (Moeller, Trumbore 1997): t, and the two weights; t infinite: nowhere.
struct Crossing {
  double t, u, v, facing;  // facing: direction . normal, of any length
};
inline Crossing cross_triangle(const Vec corner[3], const Vec& origin, const Vec& direction) {
  const Vec e = corner[1] - corner[0], f = corner[2] - corner[0], h = cross(direction, f), s = origin - corner[0], q = cross(s, e);
  const double det = dot(e, h);
  if (det == 0) return {infinity, 0, 0, 0};
  const double u = dot(s, h) / det, v = dot(direction, q) / det, t = dot(f, q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0)) return {infinity, u, v, 0};
  return {t, u, v, -det};
}
// When a ray enters a box; infinite: it does not.
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

  // no feature: contacts of surfaces are cut from their triangles
  void facing(const Vec&, double, Feature&) const {}

  // of the rounded surface; inside is below zero where the surface is closed
  Nearest signed_distance(const Vec& p) const {
    const Nearest n = self().nearest(p);
    return {n.point + n.normal * self().radius, n.normal, n.distance - self().radius, n.unique};
  }
  Nearest nearest(const Vec& p) const {
    Nearest best = nearest_triangle(p);
    if (!self().closed() || !self().inside(p)) return best;
    return {best.point, -best.normal, -best.distance, best.unique};
  }
  // inside a closed surface, which the ray from p leaves more often than it enters, or less often: along a direction that meets no edge
  bool inside(const Vec& p) const {
    if (!(distance_to(self().box(S::root(self())), p) <= 0)) return false;
    Vec direction = Vec::make(0.5385, 0.3170, 0.7807);
    int crossings = 0;
    for (int attempt = 0; attempt < 16; ++attempt) {
      const double limit = 0;  // lower() answers infinity for what is not met
      bool clear = true;
      crossings = 0;
      search(self(), limit, [&](const auto& node) { return enters(self().box(node), p, direction) < infinity ? 0 : infinity; },
             [&](auto node) {
               Vec corner[3];
               for (Index i = 0, n = self().pieces(node); i < n; ++i) {
                 self().triangle(node, i, corner);
                 const Crossing c = cross_triangle(corner, p, direction);
                 constexpr double edge = 1e-9;
                 if (c.u > -edge && c.v > -edge && c.u + c.v < 1 + edge && (c.u < edge || c.v < edge || c.u + c.v > 1 - edge)) clear = false;
                 if (c.t < infinity) crossings += c.facing > 0 ? 1 : -1;
               }
             });
      if (clear) break;
      direction = zxy(direction) + Vec::make(0.1371, -0.4143, 0.2937) * (1.0 + attempt);
    }
    return crossings != 0;
  }

  // The first piece that is hit. A ray from the inside of a closed surface hits at t = 0.
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
  // The nearest point of the triangles, normal away from it.
  Nearest nearest_triangle(const Vec& p) const {
    return nearest_of(p, [&](auto node, Index i, Facet&) {
      Vec corner[3];
      self().triangle(node, i, corner);
      const Vec c = nearest_of_triangle(corner[0], corner[1], corner[2], p), away = p - c, n = cross(corner[1] - corner[0], corner[2] - corner[0]);
      const double d = norm(away);
      return Nearest{c, d > 0 ? away * (1 / d) : n * (1 / norm(n)), d, d > 0 || self().closed()};
    });
  }
  // The nearest point of the pieces, which have volume.
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
               const bool tied = std::abs(x.distance - best.distance) <= tie, other = tied && norm(x.point - best.point) > 1e3 * tie;
               const bool unique = x.unique && (best.unique || !tied) && !other;
               if (x.distance < best.distance) best = x, limit = x.distance + tie;
               best.unique = unique;
             }
           });
    return best;
  }

  // A piece hit by a ray, in the piece's frame.
  Hit ray_of(const Facet& piece, const Vec& origin, const Vec& direction) const {
    const double r = self().radius;
    const bool flat = piece.hull.vertices == 3;
    if (r > 0 || !flat) return Round(piece, r).ray(origin, direction);
    const Vec corner[] = {piece.hull.vertex(0), piece.hull.vertex(1), piece.hull.vertex(2)};
    const Crossing c = cross_triangle(corner, origin, direction);
    return {c.t, piece.hull.normal(0) * (c.facing > 0 ? -1.0 : 1.0)};
  }
  // A piece by its points alone, so that Solid's ray meets it.
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
