// A triangle mesh, and the solid it bounds if it is closed. The tree of boxes lies elsewhere.
#pragma once

#include "shape/surface.hpp"

namespace dyn::shape {

// Arrays of a Triangles. Nodes are in depth-first order: the first child of a node follows it.
struct TriangleTree {
  static constexpr Index leaf_size = 4, max_depth = 60;

  Index vertices, triangles, nodes;
  Index closed;         // 1: the triangles bound a solid
  double extent;        // farthest vertex from the origin
  alignas(8) const double* vertex; // 3 each
  alignas(8) const double* box;    // 6 a node: lower and upper corner of its box
  alignas(8) const double* slab;   // 5 a node: mean normal of its triangles, lower and upper offset along it
  alignas(8) const Index* corner;  // 3 a triangle, in the order of the leaves
  alignas(8) const Index* link;    // 2 a node: second child and 0; leaf: first triangle and count

  // Calls f for the arrays, in stored order.
  template <class F>
  void each_array(F&& f) {
    f(vertex, 3 * std::size_t(vertices)), f(box, 6 * std::size_t(nodes)), f(slab, 5 * std::size_t(nodes));
    f(corner, 3 * std::size_t(triangles)), f(link, 2 * std::size_t(nodes));
  }
  DYN_INLINE Vec at(Index triangle, int k) const {
    return load3(vertex + 3 * std::ptrdiff_t(corner[3 * std::ptrdiff_t(triangle) + k]));
  }
};

struct Triangles : Surface<Triangles> {
  static constexpr Type type = Type::Triangles;
  static constexpr dynShapeType id = DYN_SHAPE_TYPE_TRIANGLES;
  static constexpr bool from_surface = true;
  const TriangleTree& tree;
  double radius;

  explicit Triangles(const Shape& s) : tree(*s.triangles), radius(s.radius) {}

  using Node = Index;
  static constexpr Index max_children = 2, max_stack = TriangleTree::max_depth + 2;
  static Node root(const Triangles&) { return 0; }
  DYN_INLINE Bounds box(Node n) const {
    return {load3(tree.box + 6 * std::ptrdiff_t(n)), load3(tree.box + 6 * std::ptrdiff_t(n) + 3)};
  }
  DYN_INLINE Slab slab(Node n) const {
    const double* s = tree.slab + 5 * std::ptrdiff_t(n);
    return {load3(s), s[3], s[4]};
  }
  DYN_INLINE Index split(Node n, Node* out) const {
    if (tree.link[2 * std::ptrdiff_t(n) + 1] > 0) return 0;
    out[0] = n + 1, out[1] = tree.link[2 * std::ptrdiff_t(n)];
    return 2;
  }
  DYN_INLINE Index pieces(Node n) const { return tree.link[2 * std::ptrdiff_t(n) + 1]; }
  DYN_INLINE void triangle(Node n, Index i, Vec corner[3]) const {
    const Index t = tree.link[2 * std::ptrdiff_t(n)] + i;
    for (int k = 0; k < 3; ++k) corner[k] = tree.at(t, k);
  }
  int number(Node n, Index i, int k) const { return tree.corner[3 * std::ptrdiff_t(tree.link[2 * std::ptrdiff_t(n)] + i) + k]; }
  DYN_INLINE void piece(Node n, Index i, Facet& f) const {
    Vec corner[3];
    triangle(n, i, corner);
    f.triangle(corner[0], corner[1], corner[2]);
  }
  bool closed() const { return tree.closed != 0; }
  double extent() const { return tree.extent; }

  // Moments of the core by tetrahedra from the centre to all triangles, as Convex::solid. Negated when the mesh is inside out.
  Inertia<double> solid() const {
    const Vec center = middle(box(0));
    Inertia<double> Y = Inertia<double>::zero();
    Sym3<double> S = Sym3<double>::zero();
    for (Index t = 0; t < tree.triangles; ++t) {
      const Vec a = tree.at(t, 0) - center, b = tree.at(t, 1) - center, c = tree.at(t, 2) - center, sum = a + b + c;
      const double V = dot(a, cross(b, c)) / 6;
      Y.m += V, Y.h += sum * (V / 4);
      S = S + (symmetric_outer(a, a) + symmetric_outer(b, b) + symmetric_outer(c, c) + symmetric_outer(sum, sum)) * (V / 20);
    }
    const double trace = S.d[0] + S.d[1] + S.d[2], sign = !closed() ? std::numeric_limits<double>::quiet_NaN() : Y.m < 0 ? -1 : 1;
    Y.I = {Vec::make(trace, trace, trace) - S.d, -S.o};
    return Inertia<double>{Y.m * sign, Y.h * sign, Y.I * sign}.shifted(center);
  }
};

}  // namespace dyn::shape
